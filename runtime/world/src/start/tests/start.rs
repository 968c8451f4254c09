//! Unit tests of `start`.

use super::*;

fn cloth() -> Cloth {
    Cloth {
        dimx: 5,
        dimy: 3,
        spacing_m: 0.00625,
        start: fab_program::ClothStart::Flat,
        material: None,
    }
}

#[test]
fn a_flat_cloth_begins_at_its_back_left_corner() {
    let start = Start::flat(&cloth());
    assert_eq!(start.positions.len(), 15);
    assert_eq!(start.positions[0], [-0.0125, 0.00625, 0.005]);
    assert_eq!(start.positions[14], [0.0125, -0.00625, 0.005]);
    assert_eq!(start.center_m(), [0.0, 0.0]);
}

#[test]
fn a_moved_cloth_is_turned_about_the_table_and_then_shifted() {
    let start = Start::flat(&cloth());
    assert_eq!(start.clone().moved(0.0, [0.0; 2]), start);
    let moved = start.clone().moved(0.5, [0.0; 2]);
    let turned = Start::turned_by(&cloth(), 0.5);
    let off = |a: &Start, b: &Start, shift_m: [f32; 2]| {
        let pairs = a.positions.iter().zip(&b.positions);
        pairs
            .map(|(a, b)| {
                let [x, y] = [0, 1].map(|axis| a[axis] - b[axis] - shift_m[axis]);
                x.abs() + y.abs() + (a[2] - b[2]).abs()
            })
            .fold(0.0, f32::max)
    };
    assert!(off(&moved, &turned, [0.0; 2]) < 1e-7);
    assert!(off(&start.moved(0.5, [0.1, -0.2]), &turned, [0.1, -0.2]) < 1e-7);
}

#[test]
fn equal_seeds_give_equal_starts_and_turn_at_most_45_degrees() {
    assert_eq!(Start::seeded(&cloth(), 7), Start::seeded(&cloth(), 7));
    assert_ne!(
        Start::seeded(&cloth(), 7).digest(),
        Start::seeded(&cloth(), 8).digest()
    );
    for seed in 0..200 {
        let positions = Start::seeded(&cloth(), seed).positions;
        let edge = [
            positions[4][0] - positions[0][0],
            positions[4][1] - positions[0][1],
        ];
        assert!(
            edge[0] >= edge[1].abs() * 0.9999,
            "seed {seed} turns further: {edge:?}"
        );
    }
}
