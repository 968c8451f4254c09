//! Outlines: a cloth with a hole or the shape of a garment obeys the laws; missing particles have no effect.

use super::*;
use fab_sim::Mask;

const OUTLINES: [(&str, &str); 2] = [
    ("t_shirt", include_str!("../../../outlines/t_shirt.txt")),
    (
        "square_with_hole",
        include_str!("../../../outlines/square_with_hole.txt"),
    ),
];

fn parsed(text: &str) -> Mask {
    Mask::parse(text, SPACING_M).unwrap()
}

#[test]
fn outlines_fall_as_whole_cloths_do() {
    for (name, text) in OUTLINES {
        let mask = parsed(text);
        // Damping would slow the fall.
        let params = Params {
            damping_per_s: 0.0,
            ..Params::default()
        };
        let start = at_height(mask.grid(), 0.5);
        let mut cloth = Simulator::from_positions(&mask, &start, &params).unwrap();
        run(&mut cloth, 20);
        // As in `falling.rs`.
        let expected = 0.5 * 9.8 * 0.2 * 0.2 + 0.5 * 9.8 * 0.2 * 0.0025;
        for (i, point) in cloth.positions().iter().enumerate() {
            if mask.has(i) {
                let fallen = 0.5 - point[2];
                assert!((fallen - expected).abs() < 5e-4, "{name}: {fallen} m");
            } else {
                assert_eq!(*point, [0.0; 3], "{name}");
            }
        }
    }
}

#[test]
fn outlines_fold_above_the_table_without_stretch() {
    for (name, text) in OUTLINES {
        let mask = parsed(text);
        let grid = mask.grid();
        let mut cloth = Simulator::flat(&mask, &Params::default());
        let before = cloth.positions();
        // The present particle farthest to the back left.
        let score = |i: usize| before[i][1] - before[i][0];
        let corner = (0..before.len())
            .filter(|&i| mask.has(i))
            .max_by(|&i, &j| score(i).total_cmp(&score(j)))
            .unwrap();
        assert_eq!(fold_corner(&mut cloth, corner, [0.0, 0.0]), Some(corner));
        let points = cloth.positions();
        let there: Vec<usize> = (0..points.len()).filter(|&i| mask.has(i)).collect();
        assert!(
            there.iter().all(|&i| points[i][2] > REST_HEIGHT_M - 5e-4),
            "{name}"
        );
        let pairs = there.iter().flat_map(|&i| [[i, i + 1], [i, i + grid.dimx]]);
        let joined = |[i, j]: &[usize; 2]| mask.has(*j) && (*j != i + 1 || j % grid.dimx > 0);
        let lengths = pairs
            .filter(joined)
            .map(|[i, j]| distance(points[i], points[j]) / SPACING_M);
        let longest = lengths.fold(0.0, f32::max);
        assert!(longest < 1.25, "{name}: an edge is {longest} of its length");
        assert!(distance(points[corner], before[corner]) > 0.1, "{name}");
    }
}

/// A rectangle cut out of a larger grid behaves like that rectangle, bit for bit, wherever it was cut.
#[test]
fn missing_particles_influence_nothing() {
    const INNER: [usize; 2] = [19, 14];
    for [left, back] in [[0, 0], [3, 5], [11, 10]] {
        let outer = grid(INNER[0] + 11, INNER[1] + 10);
        let inside = |ix: usize, iy: usize| {
            (left..left + INNER[0]).contains(&ix) && (back..back + INNER[1]).contains(&iy)
        };
        let mask = Mask::from_fn(outer, inside).unwrap();
        let alone = grid(INNER[0], INNER[1]);
        let place = |i: usize| (i / INNER[0] + back) * outer.dimx + i % INNER[0] + left;
        // Missing particles are never read, so their positions may be NaN.
        let mut start = vec![[f32::NAN; 3]; outer.particle_count()];
        for (i, point) in at_height(alone, REST_HEIGHT_M).into_iter().enumerate() {
            start[place(i)] = point;
        }
        let mut cut = Simulator::from_positions(&mask, &start, &Params::default()).unwrap();
        let mut whole = Simulator::flat(alone, &Params::default());
        let corner = xy(whole.positions()[0]);
        for (pick, to) in [(corner, [0.02, -0.01]), ([0.03, -0.03], [-0.02, 0.0])] {
            let cut_done = cut.pick_and_place(pick, to, &|| false).unwrap();
            let whole_done = whole.pick_and_place(pick, to, &|| false).unwrap();
            assert_eq!(cut_done.grasped, whole_done.grasped.map(place));
        }
        let points = cut.positions();
        for (i, point) in whole.positions().iter().enumerate() {
            assert_eq!(
                points[place(i)],
                *point,
                "cut at {left}, {back}: particle {i}"
            );
        }
    }
}
