//! Layers: a fold stays folded, keeps its thickness, and the picker takes the top one.

use super::*;

const DIM: usize = 36;

/// Folds particle 0 over the middle of a square; returns the settled cloth.
fn folded() -> Simulator {
    let mut cloth = flat(DIM, DIM);
    let opposite = xy(cloth.positions()[DIM * DIM - 1]);
    let to = opposite.map(|value| 0.6 * value);
    assert_eq!(fold_corner(&mut cloth, 0, to), Some(0));
    cloth.settle(300).unwrap();
    cloth
}

/// Returns whether a particle is folded over, by its position in the flat cloth: well behind the crease.
///
/// The crease is the bisector of pick and place, at -0.2 of the half diagonal; `margin` is in diagonal spacings.
fn is_flap(i: usize, margin: f32) -> bool {
    let middle = (DIM - 1) as f32 / 2.0;
    let along = ((i % DIM) as f32 - middle + (i / DIM) as f32 - middle) / 2.0;
    along < -0.2 * middle - margin
}

/// Returns the pairs (flap, base) of particles within 5 mm of each other, seen from above.
///
/// A flap particle in the middle of four base particles is 4.4 mm from each.
fn stacked(points: &[[f32; 3]]) -> Vec<[usize; 2]> {
    let all = 0..points.len();
    let flap = all.clone().filter(|&i| is_flap(i, 3.0));
    let near = |i: usize, j: usize| {
        let (dx, dy) = (points[i][0] - points[j][0], points[i][1] - points[j][1]);
        dx * dx + dy * dy < 0.005 * 0.005
    };
    let base = |j: &usize| !is_flap(*j, -3.0);
    flap.flat_map(|i| {
        all.clone()
            .filter(base)
            .filter(move |&j| near(i, j))
            .map(move |j| [i, j])
    })
    .collect()
}

#[test]
fn a_released_fold_stays_folded_and_no_layer_passes_another() {
    let mut cloth = folded();
    let settled = cloth.positions();
    for _ in 0..2 {
        let before = cloth.positions();
        run(&mut cloth, 100);
        let moved = farthest(&cloth.positions(), &before);
        assert!(moved < 1e-3, "{moved} m in 100 steps");
    }
    for points in [settled, cloth.positions()] {
        let pairs = stacked(&points);
        assert!(pairs.len() > 200, "{} pairs", pairs.len());
        for [upper, lower] in pairs {
            let gap = points[upper][2] - points[lower][2];
            assert!(
                gap > 0.5 * Params::default().self_contact_m,
                "{upper} over {lower}: {gap} m"
            );
        }
    }
}

#[test]
fn layers_keep_the_recorded_distance_within_a_tenth() {
    let points = folded().positions();
    let mut upper: Vec<f32> = (0..points.len())
        .filter(|&i| is_flap(i, 5.0))
        .map(|i| points[i][2])
        .collect();
    upper.sort_by(f32::total_cmp);
    assert!(upper.len() > 150, "{} particles", upper.len());
    let gap = upper[upper.len() / 2] - REST_HEIGHT_M;
    // Less than the contact distance of 11.25 mm, because particles nest between those below. Recorded: 10.7 mm.
    assert!(
        (gap - 0.0107).abs() < 0.1 * 0.0107,
        "layers are {gap} m apart"
    );
}

#[test]
fn a_pick_over_a_stack_takes_its_top_layer_and_leaves_the_lower_one() {
    let mut cloth = folded();
    let before = cloth.positions();
    let pairs = stacked(&before);
    // A stacked pair near the flap's middle.
    let top = (5 * DIM) + 5;
    let [_, below] = *pairs.iter().find(|pair| pair[0] == top).unwrap();
    let pick = xy(before[top]);
    let place = [pick[0] - 0.03, pick[1] + 0.03];
    let done = cloth.pick_and_place(pick, place, &|| false).unwrap();
    assert_eq!(done.grasped, Some(top));
    let after = cloth.positions();
    let moved = |i: usize| distance(before[i], after[i]);
    assert!(moved(top) > 0.01, "{} m", moved(top));
    assert!(moved(below) < 0.001, "{} m", moved(below));
}

/// Returns the particle that the picker grasps with this aim at a point of the folded cloth.
fn grasped(aim: Aim, pick: [f32; 2]) -> Option<usize> {
    let mut cloth = folded();
    cloth.set_aim(aim);
    let done = cloth.pick_and_place(pick, [0.0, 0.0], &|| false);
    done.unwrap().grasped
}

#[test]
fn a_picker_that_aims_takes_what_lies_at_the_point_and_not_the_flap_beside_it() {
    let points = folded().positions();
    // A particle of the lower layer, one spacing outside of the flap's edge.
    let aside = |i: usize, j: usize| {
        let [a, b] = [xy(points[i]), xy(points[j])];
        (a[0] - b[0]).hypot(a[1] - b[1])
    };
    let to_flap = |i: usize| {
        let flap = (0..points.len()).filter(|&j| is_flap(j, 0.0));
        flap.map(|j| aside(i, j)).fold(f32::INFINITY, f32::min)
    };
    let low = (0..points.len())
        .find(|&i| !is_flap(i, -6.0) && (0.004..0.012).contains(&to_flap(i)))
        .unwrap();
    let nearest = grasped(Aim::Nearest, xy(points[low])).unwrap();
    assert!(is_flap(nearest, 0.0), "{nearest}");
    assert_eq!(grasped(Aim::Uppermost, xy(points[low])), Some(low));
}

#[test]
fn a_picker_that_aims_takes_the_top_layer_and_misses_what_is_out_of_reach() {
    let points = folded().positions();
    let top = 5 * DIM + 5;
    assert_eq!(grasped(Aim::Uppermost, xy(points[top])), Some(top));
    // At 3 mm from the cloth its corner is grasped; at 60 mm nothing is.
    let corner = points.len() - 1;
    let [x, y] = xy(points[corner]);
    assert_eq!(
        grasped(Aim::Uppermost, [x + 0.002, y - 0.002]),
        Some(corner)
    );
    assert_eq!(grasped(Aim::Uppermost, [x + 0.06, y]), None);
}
