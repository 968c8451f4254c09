//! Pixels.

use fab_program::PixelPoint;

#[test]
fn a_pixel_is_two_numbers_in_json_and_has_a_distance_to_another() {
    for (a, b, apart_px) in [
        ([0, 0], [3, 4], 5.0),
        ([10, -3], [4, 5], 10.0),
        ([7, 2], [7, 2], 0.0),
    ] {
        let [from, to] = [a, b].map(PixelPoint::from);
        assert_eq!(from.distance_px(to), apart_px, "{from} {to}");
        let json = serde_json::to_value(from).expect("two numbers");
        assert_eq!(json, serde_json::json!(a));
    }
}
