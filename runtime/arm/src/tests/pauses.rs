//! Tests of pausing a motion: the arm comes to rest under supervision, and a pressed stop stays.

use super::*;
use crate::driver::{ArmError, Opening};
use crate::kinematics::tool_down::tool_down;

/// When the key is released: in the middle of a motion of 1.3 s.
const LET_GO_S: f64 = 0.85;

fn there() -> Isometry3<f64> {
    tool_down(&Point3::new(0.40, -0.25, 0.20), 0.0)
}

/// Releases the key at a time, for good.
fn lets_go(at_s: f64) -> impl FnMut(&ArmState) -> Result<(), Halt> {
    move |state| match state.at_s > at_s {
        true => Err(Halt::Pause),
        false => Ok(()),
    }
}

fn go(bench: &mut Bench, let_go_s: f64) -> Result<ArmState, ArmError> {
    let mut watch = lets_go(let_go_s);
    bench.arm.move_tool(&there(), SPEED_M_S, &mut watch)
}

#[test]
fn a_paused_arm_is_at_rest_and_goes_on_afterwards() {
    for by in By::BOTH {
        for tenth in 0..20 {
            let mut bench = Bench::driven(by, &[]);
            let paused = go(&mut bench, f64::from(tenth) * 0.1);
            let told = format!("{by:?}, {tenth}: {paused:?}");
            // If it was almost there when the key was released, it arrived.
            assert!(matches!(paused, Err(ArmError::Paused) | Ok(_)), "{told}");
            let off_m = bench.off_m([0.40, -0.25, 0.20]);
            assert!(tenth >= 11 || off_m > 0.02, "{told}");
            assert!(tenth <= 13 || off_m < 0.003, "{told}");
            let rests_at = bench.port().tool();
            bench.port().wait(2.0);
            let moved = bench.port().tool().translation.vector - rests_at.translation.vector;
            assert!(moved.norm() < 1e-9, "{told}");
            assert!(!bench.port().is_stopped(), "{told}");
            go(&mut bench, f64::INFINITY).unwrap();
        }
    }
}

/// The node responds to a cancellation with a stop and a start, and checks ten times a second whether it is stopped.
#[test]
#[ignore = "long"]
fn a_stop_that_is_pressed_before_a_pause_is_not_lifted_unnoticed() {
    let mut settings = settings();
    let mut lifted = 0;
    let looks = (8..28).step_by(5);
    let both = |look: u32| By::BOTH.map(|by| (by, look));
    // A tool that still speeds up goes farther than its last speed tells.
    let accelerations = [60.0, 15.0];
    let cases = accelerations
        .iter()
        .flat_map(|most| looks.clone().flat_map(both).map(move |it| (most, it)));
    for (acceleration_deg_s2, (by, let_go_at_look)) in cases {
        settings.motion.acceleration_deg_s2 = *acceleration_deg_s2;
        // Around the check at which the key is released: the driver checks every 0.05 s.
        for hundredth in 0..70 {
            let pressed_s = f64::from(let_go_at_look) * 0.05 - 0.4 + f64::from(hundredth) * 0.01;
            let pressed = [(FaultKind::PressedStop, pressed_s)];
            let port = faulty(&settings, 0, &pressed, None);
            let mut arm = by.drive(Tapped::deaf(port, f64::INFINITY), &settings);
            let mut looks = 0;
            let mut watch = |_: &ArmState| {
                looks += 1;
                match looks >= let_go_at_look {
                    true => Err(Halt::Pause),
                    false => Ok(()),
                }
            };
            let halted = go_to(&mut arm, &settings, &there(), SPEED_M_S, &mut watch);
            let cancelled_s = arm.port().cancelled_s;
            // A stop pressed while the cancellation is in transit cannot be distinguished from it, at the tool's
            // resolution of a millimetre.
            if cancelled_s.is_some_and(|cancelled_s| pressed_s > cancelled_s - 0.015) {
                continue;
            }
            let told =
                format!("{acceleration_deg_s2}, {by:?}, {let_go_at_look}, {pressed_s}: {halted:?}");
            let is_pressed = arm.port().arm.moved_after_stop_m().is_some();
            lifted += usize::from(is_pressed && !arm.port().arm.is_stopped());
            if halted != Err(ArmError::Stopped) {
                // Not released, or not pressed yet.
                assert!(halted == Err(ArmError::Paused) || halted.is_ok(), "{told}");
                arm.wait(1.5);
                let next = go_to(&mut arm, &settings, &there(), SPEED_M_S, &mut nobody);
                assert_eq!(next, Err(ArmError::Stopped), "{told}");
            }
            arm.stop().unwrap();
            arm.wait(5.0);
            assert!(arm.port().arm.is_stopped(), "{told}");
            assert!(
                arm.port().arm.moved_after_stop_m().unwrap() < 1e-9,
                "{told}"
            );
        }
    }
    // The driver stops it again before it returns.
    assert_eq!(lifted, 0);
}

#[test]
fn a_cancellation_that_is_lost_fails_the_motion() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[(FaultKind::LostCancel, 0.0)]);
        // Far enough that it does not arrive before it is noticed.
        let far = tool_down(&Point3::new(0.40, 0.30, 0.20), 0.0);
        let paused = bench.arm.move_tool(&far, SPEED_M_S, &mut lets_go(0.5));
        let is_told = matches!(&paused, Err(ArmError::Failed(why)) if why.contains("did not end"));
        assert!(is_told, "{by:?}: {paused:?}");
    }
}

#[test]
fn a_pause_lets_the_fingers_end_and_their_hand_not_leave() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[]);
        bench.take_cloth_away();
        let mut watch = lets_go(0.5);
        let paused = bench.arm.move_fingers(Opening::Closed, &mut watch);
        assert_eq!(paused, Err(ArmError::Paused));
        let mut bench = Bench::driven(by, &[(FaultKind::Runaway, 0.7)]);
        bench.take_cloth_away();
        let mut watch = lets_go(0.5);
        let carried_off = bench.arm.move_fingers(Opening::Closed, &mut watch);
        assert!(
            matches!(carried_off, Err(ArmError::OutOfLimits(_))),
            "{carried_off:?}"
        );
        // Noticed at once, not when the fingers have closed.
        assert!(bench.off_m(bench.settings.workspace.rest_m) < 0.05);
    }
}

/// A jammed arm does not move after its pause; whether somebody stopped it is unknown, so it counts as stopped.
#[test]
fn an_arm_that_was_not_seen_to_move_is_stopped_rather_than_paused() {
    let mut bench = Bench::with(&[(FaultKind::StuckJoint, 0.7)]);
    assert_eq!(go(&mut bench, LET_GO_S), Err(ArmError::Stopped));
    bench.stays_stopped();
}
