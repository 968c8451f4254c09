//! Tests of traps with joint trajectories: a controller that ignores the stop, and joint paths planned here.

use super::*;
use crate::driver::ArmError;
use crate::kinematics::tool_down::tool_down;

/// In the middle of a motion of 1.3 s.
const ON_THE_WAY_S: f64 = 0.8;

/// Slower than the other tests, m/s.
const SLOWER_M_S: f64 = 0.08;

fn there() -> Isometry3<f64> {
    tool_down(&Point3::new(0.40, -0.25, 0.20), 0.0)
}

fn go<P: Port>(arm: &mut PortArm<P>) -> Result<ArmState, ArmError> {
    go_to(arm, &settings(), &there(), SPEED_M_S, &mut nobody)
}

/// Fails if the arm moves in the next seconds.
#[track_caller]
fn rests(bench: &mut Bench) {
    let at = bench.port().tool();
    bench.port().wait(10.0);
    let moved = bench.port().tool().translation.vector - at.translation.vector;
    assert!(moved.norm() < 1e-9, "it moved by {} m", moved.norm());
}

#[test]
fn a_stopped_trajectory_is_not_gone_on_with() {
    // Stopped by the driver, and enabled by it or by somebody else.
    for by_driver in [true, false] {
        let mut bench = Bench::driven(By::Trajectories, &[]);
        let mut watch = |state: &ArmState| match state.at_s > ON_THE_WAY_S {
            true => Err(Halt::Stop(ArmError::Interrupted)),
            false => Ok(()),
        };
        let halted = go_to(bench.driver(), &settings(), &there(), SPEED_M_S, &mut watch);
        assert_eq!(halted, Err(ArmError::Interrupted));
        bench.driver().stop().unwrap();
        bench.stays_stopped();
        match by_driver {
            true => bench.driver().recover().unwrap(),
            false => bench.port().start().unwrap(),
        }
        rests(&mut bench);
    }
}

#[test]
fn a_trajectory_under_a_pressed_stop_is_not_gone_on_with() {
    // The driver only notices the stop, or stops the arm as well; then the driver or somebody else enables it.
    let cases = [(false, true), (true, true), (true, false)];
    for (is_stopped, by_driver) in cases {
        let mut bench = Bench::driven(By::Trajectories, &[(FaultKind::PressedStop, ON_THE_WAY_S)]);
        let moved = go_to(
            bench.driver(),
            &settings(),
            &there(),
            SLOWER_M_S,
            &mut nobody,
        );
        assert_eq!(moved, Err(ArmError::Stopped));
        if is_stopped {
            bench.driver().stop().unwrap();
        }
        bench.stays_stopped();
        match by_driver {
            true => bench.driver().recover().unwrap(),
            false => bench.port().start().unwrap(),
        }
        rests(&mut bench);
        if by_driver {
            go(bench.driver()).unwrap();
        }
    }
}

/// The controller may still hold a trajectory.
#[test]
fn an_arm_is_not_let_go_while_its_controller_takes_nothing() {
    let mut bench = Bench::driven(By::Trajectories, &[(FaultKind::LostGoal, 1.0)]);
    bench.driver().stop().unwrap();
    bench.port().wait(1.0);
    let enabled = bench.driver().recover();
    assert!(
        matches!(&enabled, Err(ArmError::Failed(why)) if why.contains("did not end within")),
        "{enabled:?}"
    );
    bench.stays_stopped();
    bench.driver().recover().unwrap();
    go(bench.driver()).unwrap();
}

#[test]
fn a_trajectory_that_never_arrived_is_no_obstacle_to_a_stop() {
    let mut bench = Bench::driven(By::Trajectories, &[(FaultKind::LostGoals, 0.1)]);
    let late = go(bench.driver());
    let late = failure(late);
    assert!(late.contains("did not end within"), "{late}");
    bench.driver().stop().unwrap();
    bench.stays_stopped();
}

#[test]
fn joints_that_are_not_heard_are_silent_and_not_stopped() {
    let settings = settings();
    for (deaf_s, wait_s) in [(-1.0, 0.0), (0.0, 2.0), (ON_THE_WAY_S, 0.0)] {
        let port = faulty(&settings, 0, &[], None);
        let mut arm = By::Trajectories.drive(Tapped::deaf(port, deaf_s), &settings);
        arm.wait(wait_s);
        let moved = go(&mut arm);
        let is_told =
            matches!(&moved, Err(ArmError::Failed(why)) if why.contains("where its joints are"));
        assert!(is_told, "{deaf_s}: {moved:?}");
    }
}

#[test]
fn links_do_not_come_below_the_table() {
    let settings = settings();
    let state = |height_m: f64| {
        let port = faulty(&settings, 0, &[], None);
        let mut table = settings.clone();
        table.table.center_m[2] = height_m;
        // The box is another subject: only the table moves.
        table.workspace.min_m[2] = height_m - 0.01 - 0.4;
        let mut arm = By::Trajectories.drive(port, &table);
        let before = arm.port().tool();
        let moved = go_to(&mut arm, &table, &there(), SPEED_M_S, &mut nobody);
        (moved, before, arm.port().tool())
    };
    state(0.02).0.unwrap();
    // As if the table were as high as the wrist: nothing else brings a link of this posture below it.
    let (moved, before, after) = state(0.35);
    let Err(ArmError::Refused(why)) = moved else {
        panic!("links below the table: {moved:?}");
    };
    assert!(why.contains("below the table"), "{why}");
    assert_eq!(after, before);
}

/// A controller alone: no pose server reveals a stop, and no service latches it.
#[test]
fn an_arm_without_the_vendors_servers_moves_and_is_stopped() {
    for (lost, is_verified) in [(0, true), (2, true), (20, false)] {
        let settings = settings();
        let faults = vec![(FaultKind::LostCancel, ON_THE_WAY_S); lost];
        let port = faulty(&settings, 0, &faults, None);
        let mut arm = By::Trajectories.drive(Tapped::generic(port), &settings);
        let mut watch = |state: &ArmState| match state.at_s > ON_THE_WAY_S {
            true => Err(Halt::Stop(ArmError::Interrupted)),
            false => Ok(()),
        };
        // Slow enough that it does not arrive while it is told to stop.
        let halted = go_to(&mut arm, &settings, &there(), 0.2 * SPEED_M_S, &mut watch);
        assert_eq!(halted, Err(ArmError::Interrupted));
        let stopped = arm.stop();
        if !is_verified {
            assert!(
                matches!(stopped, Err(ArmError::NotStopped(_))),
                "{stopped:?}"
            );
            continue;
        }
        stopped.unwrap();
        let at = arm.port().arm.tool();
        arm.wait(5.0);
        let moved = arm.port().arm.tool().translation.vector - at.translation.vector;
        assert!(moved.norm() < 1e-9, "it moved by {} m", moved.norm());
        assert_eq!(go(&mut arm), Err(ArmError::Stopped));
        arm.recover().unwrap();
        go(&mut arm).unwrap();
    }
}
