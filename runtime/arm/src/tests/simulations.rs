//! Tests that the simulated arm behaves as documented.

use super::*;
use crate::port::{Ending, GoalState};

/// Like kinova-ros's controller, which ignores a stop.
#[test]
fn a_trajectory_goes_on_where_an_arm_is_let_go() {
    let settings = settings();
    let mut port = faulty(&settings, 0, &[], None);
    let mut turned = SimulatedArm::new(&settings, None)
        .unwrap()
        .joints_rad()
        .to_vec();
    turned[0] += 0.2;
    let at = |at_s, joints_rad: &[f64]| Waypoint::at_rest(joints_rad.to_vec(), at_s);
    let id = port
        .send_trajectory(&[at(1.0, &turned), at(1.1, &turned)])
        .unwrap();
    port.wait(0.5);
    port.stop().unwrap();
    port.wait(1.0);
    assert_eq!(port.goal(&id), GoalState::Active);
    let at = port.tool();
    assert!(port.moved_after_stop_m().unwrap() < 1e-9);
    port.start().unwrap();
    port.wait(2.0);
    let moved = port.tool().translation.vector - at.translation.vector;
    assert!(moved.norm() > 0.02);
}

#[test]
fn the_next_three_goals_are_lost_and_no_fourth() {
    let settings = settings();
    let mut port = faulty(&settings, 0, &[(FaultKind::LostGoals, 0.0)], None);
    let here = port.tool();
    let arrived = [(); 5].map(|()| {
        let id = port.send_pose(&here).unwrap();
        port.wait(5.0);
        port.goal(&id) == GoalState::Ended(Ending::Succeeded)
    });
    assert_eq!(arrived, [false, false, false, true, true]);
}
