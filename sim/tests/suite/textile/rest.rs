//! A cloth stops when nothing moves it, and not before.

use super::*;

/// A strip that is let go from the horizontal hangs down in the end as one that hung down from the start, at 1 mm.
#[test]
fn a_released_strip_is_never_still_above_its_hanging_shape() {
    let grid = Grid::new(4, 13, SPACING_M).unwrap();
    for (name, material) in materials() {
        let springy = Material {
            crease_recovery_deg: 180.0,
            ..material
        };
        let tip = |place: &dyn Fn(f32) -> [f32; 2]| {
            let start: Vec<[f32; 3]> = (0..grid.particle_count())
                .map(|i| {
                    let [y, z] = place((i / 4) as f32 * SPACING_M);
                    [(i % 4) as f32 * SPACING_M, -y, 0.5 + z]
                })
                .collect();
            let calm = Params {
                damping_per_s: 4.0,
                ..params(&springy)
            };
            let mut cloth = Simulator::from_positions(grid, &start, &calm).unwrap();
            cloth.hold(&[0, 1, 2, 3, 4, 5, 6, 7]).unwrap();
            for _ in 0..300 {
                cloth.step().unwrap();
            }
            cloth.positions()[50][2]
        };
        let level = tip(&|s| [s, 0.0]);
        let down = tip(&|s| {
            if s < 0.007 {
                [s, 0.0]
            } else {
                [SPACING_M, SPACING_M - s]
            }
        });
        assert!(
            (level - down).abs() < 1e-3,
            "{name}: {level} m and {down} m"
        );
    }
}

#[test]
fn a_cloth_that_is_let_go_slowly_lands() {
    let grid = Grid::new(10, 10, SPACING_M).unwrap();
    for (name, material) in materials() {
        let params = params(&material);
        let start: Vec<[f32; 3]> = grid
            .flat_positions(&params)
            .iter()
            .map(|p| [p[0], p[1], 0.1])
            .collect();
        let mut cloth = Simulator::from_positions(grid, &start, &params).unwrap();
        cloth.set_velocities(&[[0.0, 0.0, -0.001]; 100]).unwrap();
        let steps = cloth.settle(200).unwrap();
        assert!(steps < 100, "{name}: {steps}");
        let highest = cloth.positions().iter().map(|p| p[2]).fold(0.0, f32::max);
        assert!(
            highest < params.rest_height_m() + 1e-4,
            "{name}: {highest} m"
        );
    }
}

/// A fold that is let go rests within 3 s, and then each step leaves it as it is, bit for bit.
#[test]
fn a_released_fold_comes_to_rest() {
    for (name, material) in materials() {
        let mut cloth = square(30, &material);
        let corner = cloth.positions()[0];
        let to = [0.6 * -corner[0], 0.6 * -corner[1]];
        cloth
            .pick_and_place([corner[0], corner[1]], to, &|| false)
            .unwrap();
        let steps = cloth.settle(300).unwrap();
        assert!(steps < 300, "{name}: still moves after 3 s");
        let digest = cloth.digest();
        cloth.set_rest_shortcut(fab_sim::RestShortcut::Compute);
        run(&mut cloth, 3);
        assert_eq!(cloth.digest(), digest, "{name}");
        // What rests is moved again by a hand.
        cloth.hold(&[0]).unwrap();
        cloth.step_held([0.0, 0.0, 0.005]).unwrap();
        assert_ne!(cloth.digest(), digest, "{name}");
    }
}
