//! Tests of `goals.rs`.

use super::*;

fn waypoint(at_s: f64, angle: f64) -> Waypoint {
    Waypoint::at_rest(vec![angle, 0.0], at_s)
}

fn names() -> Vec<String> {
    vec!["a".to_owned(), "b".to_owned()]
}

#[test]
fn a_trajectory_says_how_fast_each_point_is_passed() {
    let mut points = [
        waypoint(0.0, 0.0),
        waypoint(0.5, 1.0),
        waypoint(1.9999999999, 4.0),
    ];
    points[1].speeds_rad_s = vec![2.0, 0.5];
    points[1].accelerations_rad_s2 = vec![-3.0, 0.25];
    let sent = trajectory(&points, &names()).trajectory;
    assert_eq!(sent.joint_names, names());
    assert_eq!(sent.points[0].velocities, [0.0, 0.0]);
    assert_eq!(sent.points[1].velocities, [2.0, 0.5]);
    assert_eq!(sent.points[1].accelerations, [-3.0, 0.25]);
    assert_eq!(sent.points[2].velocities, [0.0, 0.0]);
    let times: Vec<_> = sent
        .points
        .iter()
        .map(|point| (point.time_from_start.sec, point.time_from_start.nanosec))
        .collect();
    assert_eq!(times, [(0, 0), (0, 500_000_000), (2, 0)]);
}
