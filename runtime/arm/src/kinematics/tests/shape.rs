//! Tests of the shapes of links and hand.

use super::*;
use crate::kinematics::shape::Capsule;
use nalgebra::Point3;

/// Points of a line, tested for the distance to them.
const SAMPLES: u32 = 200;

fn capsule() -> impl Strategy<Value = Capsule> {
    // Lines of no length and along the axes too.
    let number = || prop_oneof![3 => -1.0..1.0f64, 1 => Just(0.0), 1 => Just(0.5)];
    let place = move || prop::array::uniform3(number());
    (place(), place(), 0.0..0.2f64).prop_map(|(from, to, radius_m)| Capsule {
        link: 0,
        ends: [from.into(), to.into()],
        radius_m,
        is_around_mesh: false,
    })
}

fn samples(capsule: &Capsule) -> impl Iterator<Item = Point3<f64>> + use<> {
    let [from, to] = capsule.ends;
    (0..=SAMPLES).map(move |step| from + (to - from) * (f64::from(step) / f64::from(SAMPLES)))
}

proptest! {
    /// No sampled point is nearer, and one is as near as its distance from the next.
    #[test]
    fn distances_are_those_of_sampled_points(one in capsule(), other in capsule()) {
        let step_m = |capsule: &Capsule| (capsule.ends[1] - capsule.ends[0]).norm() / f64::from(SAMPLES);
        let between = samples(&one).flat_map(|at| samples(&other).map(move |there| (at - there).norm()));
        let sampled_m = between.fold(f64::INFINITY, f64::min) - one.radius_m - other.radius_m;
        let found_m = one.gap_m(&other);
        prop_assert!(found_m <= sampled_m + 1e-9, "{} {}", found_m, sampled_m);
        prop_assert!(found_m >= sampled_m - step_m(&one) - step_m(&other), "{} {}", found_m, sampled_m);
        prop_assert!((other.gap_m(&one) - found_m).abs() < 1e-9);
        let corners = other.ends.map(|end| end.coords);
        let (min_m, max_m) = (corners[0].inf(&corners[1]).into(), corners[0].sup(&corners[1]).into());
        let from_box_m = |at: Point3<f64>| (at.coords - at.coords.sup(&corners[0].inf(&corners[1])).inf(&corners[0].sup(&corners[1]))).norm();
        let sampled_m = samples(&one).map(from_box_m).fold(f64::INFINITY, f64::min) - one.radius_m;
        let found_m = one.gap_to_box_m(&min_m, &max_m);
        prop_assert!(found_m <= sampled_m + 1e-9, "{} {}", found_m, sampled_m);
        prop_assert!(found_m >= sampled_m - step_m(&one), "{} {}", found_m, sampled_m);
    }
}

proptest! {
    /// Each joint and the tool are inside the arm: a link without a shape would leave its joints outside.
    #[test]
    fn the_shapes_contain_every_joint_beyond_the_first_and_the_tool((chain, angles) in posed()) {
        let placed = chain.placed_shapes(&angles).unwrap();
        for frame in chain.frames(&angles).unwrap() {
            let at = frame.translation.vector;
            let nearest_m = placed
                .iter()
                .map(|shape| {
                    let [from, to] = shape.ends.map(|end| end.coords);
                    let along = to - from;
                    let share = ((at - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
                    (at - from - along * share).norm() - shape.radius_m
                })
                .fold(f64::INFINITY, f64::min);
            prop_assert!(nearest_m < 0.0, "{nearest_m} m outside");
        }
    }
}

#[test]
fn the_fingers_reach_past_the_tool() {
    for model in MODELS {
        let chain = chain_of(model);
        let shapes = chain.shapes().iter();
        let hand = shapes.filter(|shape| shape.link == chain.joints().len());
        let reach = hand.map(|shape| shape.ends[0].z.max(shape.ends[1].z) + shape.radius_m);
        let beyond_m = reach.fold(0.0, f64::max);
        assert!((0.043..0.050).contains(&beyond_m), "{model}: {beyond_m}");
    }
}
