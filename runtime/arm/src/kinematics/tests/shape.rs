//! Tests of the shapes of links and hand.

use super::*;

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
        let lowest_m = placed.iter().map(|shape| shape.lowest_m()).fold(f64::INFINITY, f64::min);
        for frame in chain.frames(&angles).unwrap() {
            prop_assert!(lowest_m < frame.translation.z);
        }
    }
}

#[test]
fn the_fingers_reach_past_the_tool() {
    for model in MODELS {
        let chain = chain_of(model);
        let shapes = chain.shapes().iter();
        let hand = shapes.filter(|shape| shape.link == chain.joints().len());
        let reach = hand.map(|shape| shape.from.z.max(shape.to.z) + shape.radius_m);
        let beyond_m = reach.fold(0.0, f64::max);
        assert!((0.043..0.050).contains(&beyond_m), "{model}: {beyond_m}");
    }
}
