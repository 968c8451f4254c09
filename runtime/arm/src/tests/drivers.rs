//! Tests of every trap of the real arm's node, in both command modes: a driver must not trust any server.

use super::*;
use crate::driver::{HandContents, Opening};
use crate::kinematics::tool_down::tool_down;
use crate::port::{Ending, Reading};
use crate::settings::{FingerSettings, KeepOut};

/// A place 13 cm from the rest position, reached after slightly more than 1.3 s.
const THERE_M: [f64; 3] = [0.40, -0.25, 0.20];

/// A time at which the arm is in motion towards it.
const ON_THE_WAY_S: f64 = 0.8;

fn there() -> Isometry3<f64> {
    tool_down(&THERE_M.into(), 0.0)
}

fn go(bench: &mut Bench) -> Result<ArmState, ArmError> {
    go_with(bench, &there(), &mut nobody)
}

fn go_with(
    bench: &mut Bench,
    to: &Isometry3<f64>,
    watch: &mut Watch<'_>,
) -> Result<ArmState, ArmError> {
    let settings = bench.settings.clone();
    go_to(bench.driver(), &settings, to, SPEED_M_S, watch)
}

#[test]
fn a_motion_that_was_checked_from_elsewhere_is_not_sent() {
    for by in [By::Poses, By::Trajectories] {
        let mut bench = Bench::driven(by, &[]);
        let guard = guard(&bench.settings);
        let here = bench.driver().state().unwrap();
        let motion = guard.motion(&here, &there(), SPEED_M_S).unwrap();
        go(&mut bench).unwrap();
        let moved = bench.driver().move_tool(&motion, &mut nobody);
        assert!(
            matches!(&moved, Err(ArmError::OutOfLimits(why)) if why.contains("since this motion was checked")),
            "{moved:?}"
        );
    }
}

/// Like `go`, with the checks and corrections of the limits.
fn go_within_limits(bench: &mut Bench) -> Result<ArmState, ArmError> {
    bench.arm.move_tool(&there(), SPEED_M_S, &mut nobody)
}

#[test]
fn the_tool_is_where_a_driver_says() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[]);
        let state = go(&mut bench).unwrap();
        assert!(bench.off_m(THERE_M) < 0.002);
        assert!((state.tool.translation.vector - Point3::from(THERE_M).coords).norm() < 0.002);
        assert!(!bench.port().is_stopped());
    }
}

#[test]
fn short_ways_are_gone_to_their_end() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[]);
        go(&mut bench).unwrap();
        for step_m in [0.0005, 0.001, 0.002, 0.004] {
            let from = bench.port().tool();
            let mut to = from;
            to.translation.vector.x += step_m;
            go_with(&mut bench, &to, &mut nobody).unwrap();
            let moved_m = bench.port().tool().translation.vector.x - from.translation.vector.x;
            assert!((moved_m - step_m).abs() < 0.0011, "{step_m}: {moved_m}");
        }
    }
}

#[test]
fn a_goal_called_reached_too_early_is_corrected() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[(FaultKind::FallsShort, 0.0)]);
        let alone_s = {
            let mut usual = Bench::driven(by, &[]);
            go(&mut usual).unwrap();
            usual.port().now_s()
        };
        go_within_limits(&mut bench).unwrap();
        assert!(bench.off_m(THERE_M) < 0.003);
        // A second goal was needed: the first came to rest 7 mm short.
        assert!(bench.port().now_s() > alone_s + 0.2);
    }
}

#[test]
fn a_goal_that_is_never_reached_is_no_success() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[(FaultKind::FallsShortAlways, 0.0)]);
        let moved = go_within_limits(&mut bench);
        assert!(
            matches!(&moved, Err(ArmError::Short(why)) if why.contains("`reached`, but its tool is")),
            "7 mm short, and called reached: {moved:?}"
        );
        let off_m = bench.off_m(THERE_M);
        assert!((0.003..0.010).contains(&off_m), "{by:?}: {off_m}");
    }
}

#[test]
fn cloth_between_the_fingers_is_told_by_their_place() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[]);
        let over = tool_down(&PICK_M.into(), 0.0);
        go_with(&mut bench, &over, &mut nobody).unwrap();
        let between = bench.driver().move_fingers(Opening::Closed, &mut nobody);
        assert_eq!(between, Ok(HandContents::Something));
        let opened = bench.driver().move_fingers(Opening::Open, &mut nobody);
        assert_eq!(opened, Ok(HandContents::Unknown));
        bench.take_cloth_away();
        let between = bench.driver().move_fingers(Opening::Closed, &mut nobody);
        assert_eq!(between, Ok(HandContents::Nothing));
    }
}

/// The vendor's documents give degrees, turns, or fractions of a turn, with zero at either end.
#[test]
fn fingers_are_told_by_their_place_in_whichever_units() {
    let turns = [[0.0, 6400.0], [0.0, 6800.0], [60.0, 0.0], [-1.0, 51.0]];
    for (by, [open, closed]) in By::BOTH.into_iter().flat_map(|by| turns.map(|it| (by, it))) {
        let mut settings = settings();
        let way: f64 = closed - open;
        settings.fingers = FingerSettings {
            open,
            closed,
            cloth: Some(0.03 * way.abs()),
            tolerance: 0.015 * way.abs(),
            ..settings.fingers
        };
        let port = faulty(&settings, 0, &[], None);
        let mut arm = by.drive(port, &settings);
        let close = |arm: &mut Driven| arm.move_fingers(Opening::Closed, &mut nobody);
        assert_eq!(
            close(&mut arm),
            Ok(HandContents::Nothing),
            "{open} to {closed}"
        );
        let opened = arm.move_fingers(Opening::Open, &mut nobody);
        assert_eq!(opened, Ok(HandContents::Unknown), "{open} to {closed}");
        let cloth = Patch {
            at: Point3::from(arm.port().tool().translation.vector),
            is_grasped: false,
        };
        let table = Rc::new(RefCell::new(cloth));
        let port = faulty(&settings, 0, &[], Some(table));
        let between = close(&mut by.drive(port, &settings));
        assert_eq!(between, Ok(HandContents::Something), "{open} to {closed}");
    }
}

#[test]
fn fingers_that_are_stopped_half_way_hold_nothing() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[(FaultKind::PressedStop, 0.7)]);
        bench.take_cloth_away();
        let between = bench.driver().move_fingers(Opening::Closed, &mut nobody);
        assert_eq!(between, Err(ArmError::Stopped));
        bench.stays_stopped();
    }
}

#[test]
fn fingers_that_do_not_move_are_an_error() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[(FaultKind::StuckFingers, 0.0)]);
        let between = bench.driver().move_fingers(Opening::Closed, &mut nobody);
        assert!(
            matches!(&between, Err(ArmError::Failed(why)) if why.starts_with("the fingers are at")),
            "{between:?}"
        );
    }
}

#[test]
fn an_arm_that_stalls_says_so_and_can_be_stopped() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[(FaultKind::StuckJoint, ON_THE_WAY_S)]);
        // A trajectory controller does not detect a stall: it gives up long after the planned time.
        let why = failure(go(&mut bench));
        let expected = match by {
            By::Poses => "the arm stalled",
            By::Trajectories => "the arm reported `aborted`, but its tool is",
        };
        assert!(why.starts_with(expected), "{why}");
        assert!(bench.off_m(THERE_M) > 0.05);
        // The node that gave up the goal enabled the arm again.
        assert!(!bench.port().is_stopped());
        bench.driver().stop().unwrap();
        bench.stays_stopped();
    }
}

#[test]
#[ignore = "long"]
fn a_pressed_stop_is_never_taken_back() {
    for by in By::BOTH {
        for pressed_s in (0..30).map(|tenth| f64::from(tenth) * 0.1) {
            let mut bench = Bench::driven(by, &[(FaultKind::PressedStop, pressed_s)]);
            while bench.port().now_s() < 3.0 {
                let moved = go(&mut bench);
                if let Err(error) = moved {
                    assert_eq!(error, ArmError::Stopped, "{pressed_s}");
                }
                bench.port().wait(0.1);
            }
            assert_eq!(go(&mut bench), Err(ArmError::Stopped), "{pressed_s}");
            let fingers = bench.driver().move_fingers(Opening::Closed, &mut nobody);
            assert_eq!(fingers, Err(ArmError::Stopped), "{pressed_s}");
            bench.stays_stopped();
        }
    }
}

/// A finger motion that is interrupted just after somebody pressed the stop: a goal sent then would enable the arm.
#[test]
fn a_pressed_stop_outlives_an_interrupted_hand() {
    for by in By::BOTH {
        for hundredth in 0..25 {
            let pressed_s = 0.5 + f64::from(hundredth) * 0.01;
            let mut bench = Bench::driven(by, &[(FaultKind::PressedStop, pressed_s)]);
            let halted = bench.driver().move_fingers(
                Opening::Closed,
                &mut |state| match state.at_s > 0.55 {
                    true => Err(Halt::Stop(ArmError::Interrupted)),
                    false => Ok(()),
                },
            );
            assert!(halted.is_err());
            let is_pressed = bench.port().now_s() >= pressed_s;
            assert_eq!(bench.port().is_stopped(), is_pressed, "{pressed_s}");
        }
    }
}

#[test]
fn a_cancelled_arm_is_enabled_and_a_stop_after_it_holds() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[]);
        let mut watch = |state: &ArmState| match state.at_s > ON_THE_WAY_S {
            true => Err(Halt::Pause),
            false => Ok(()),
        };
        let paused = go_with(&mut bench, &there(), &mut watch);
        assert_eq!(paused, Err(ArmError::Paused));
        bench.port().wait(1.0);
        assert!(!bench.port().is_stopped());
        assert!(bench.off_m(THERE_M) > 0.02);
        bench.driver().stop().unwrap();
        bench.stays_stopped();
        assert_eq!(go(&mut bench), Err(ArmError::Stopped));
        bench.driver().recover().unwrap();
        go(&mut bench).unwrap();
    }
}

#[test]
fn a_stop_without_an_answer_is_asked_for_again() {
    for by in By::BOTH {
        let mut bench = Bench::driven(
            by,
            &[(FaultKind::LostStop, 0.0), (FaultKind::LostStop, 0.0)],
        );
        bench.driver().stop().unwrap();
        bench.stays_stopped();
        let mut bench = Bench::driven(by, &[(FaultKind::LostStop, 0.0); 3]);
        let not_stopped = bench.driver().stop();
        assert!(
            matches!(not_stopped, Err(ArmError::NotStopped(_))),
            "{not_stopped:?}"
        );
    }
}

#[test]
fn a_result_that_is_lost_is_replaced_by_a_look() {
    for by in By::BOTH {
        // The result of the probe, and that of the motion.
        for lost_s in [0.0, ON_THE_WAY_S] {
            let mut bench = Bench::driven(by, &[(FaultKind::LostResult, lost_s)]);
            go(&mut bench).unwrap();
            assert!(bench.off_m(THERE_M) < 0.003);
        }
    }
}

#[test]
fn a_goal_whose_status_is_lost_is_judged_by_where_the_tool_is() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[(FaultKind::LostStatus, 0.0)]);
        go(&mut bench).unwrap();
        assert!(bench.off_m(THERE_M) < 0.003);
    }
}

#[test]
fn a_goal_that_does_not_arrive_is_not_sent_again() {
    for by in By::BOTH {
        // After the probe.
        let mut bench = Bench::driven(by, &[(FaultKind::LostGoal, 0.01)]);
        let why = failure(go(&mut bench));
        assert!(why.contains("did not end within"), "{why}");
        assert!(bench.off_m(bench.settings.workspace.rest_m) < 0.002);
    }
}

/// An arm that is carried elsewhere by its first goal, and reports it as reached.
struct Carried {
    at: Isometry3<f64>,
    now_s: f64,
    n_motions: u32,
}

impl Port for Carried {
    fn now_s(&self) -> f64 {
        self.now_s
    }
    fn wait(&mut self, seconds: f64) {
        self.now_s += seconds;
    }
    fn send_trajectory(&mut self, _: &[Waypoint]) -> Result<GoalId, PortError> {
        panic!("it is driven by poses")
    }
    fn send_pose(&mut self, _: &Isometry3<f64>) -> Result<GoalId, PortError> {
        self.n_motions += 1;
        self.at = tool_down(&Point3::new(0.40, 0.30, 0.20), 0.0);
        Ok(GoalId(String::new()))
    }
    fn send_fingers(&mut self, _: &[f64]) -> Result<GoalId, PortError> {
        panic!("its fingers stay")
    }
    fn goal(&mut self, _: &GoalId) -> GoalState {
        GoalState::Ended(Ending::Succeeded)
    }
    fn cancel(&mut self, _: &GoalId) -> Result<(), PortError> {
        Ok(())
    }
    fn stop(&mut self) -> Result<(), PortError> {
        Ok(())
    }
    fn start(&mut self) -> Result<(), PortError> {
        Ok(())
    }
    fn state(&mut self) -> Readings {
        let at_s = self.now_s;
        Readings {
            tool: Some(Reading {
                value: self.at,
                at_s,
            }),
            joints_rad: Some(Reading {
                value: ArmState::hand_down(&settings(), &self.at.translation.vector.into())
                    .unwrap()
                    .joints_rad,
                at_s,
            }),
            fingers: Some(Reading {
                value: vec![0.0; 2],
                at_s,
            }),
        }
    }
}

#[test]
fn a_correction_is_checked_like_the_motion_before() {
    let mut settings = settings();
    settings.workspace.keep_out = vec![KeepOut {
        name: "lamp".to_owned(),
        min_m: [0.30, 0.10, 0.0],
        max_m: [0.50, 0.12, 0.40],
    }];
    let port = Carried {
        at: tool_down(&settings.workspace.rest_m.into(), 0.0),
        now_s: 0.0,
        n_motions: 0,
    };
    let mut arm = Limited::new(By::Poses.drive(port, &settings), guard(&settings));
    // From where it is now the way back leads through the zone.
    let moved = arm.move_tool(&there(), SPEED_M_S, &mut nobody);
    assert!(
        matches!(&moved, Err(ArmError::Refused(why)) if why.contains("`lamp`")),
        "{moved:?}"
    );
    assert_eq!(arm.arm().port().n_motions, 1);
}

#[test]
fn an_arm_that_says_the_same_over_and_over_is_silent() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[(FaultKind::RepeatedReading, ON_THE_WAY_S)]);
        let moved = go(&mut bench);
        let why = failure(moved);
        assert!(why.starts_with("the arm has not reported for"), "{why}");
        assert!(bench.port().now_s() < ON_THE_WAY_S + 1.0 + 0.2);
    }
}

#[test]
fn an_arm_that_says_nothing_is_an_error_within_its_time() {
    for by in By::BOTH {
        let mut bench = Bench::driven(by, &[(FaultKind::Silence, ON_THE_WAY_S)]);
        let moved = go(&mut bench);
        let why = failure(moved);
        assert!(why.starts_with("the arm has not reported for"), "{why}");
        assert!(bench.port().now_s() < ON_THE_WAY_S + 1.0 + 0.2);
        let not_stopped = bench.driver().stop();
        assert!(
            matches!(not_stopped, Err(ArmError::NotStopped(_))),
            "{not_stopped:?}"
        );
        bench.stays_stopped();
        let mut bench = Bench::driven(by, &[(FaultKind::ShortSilence, ON_THE_WAY_S)]);
        go(&mut bench).unwrap();
    }
}

/// A message that is late must not make fingers that still move look at rest.
#[test]
fn fingers_come_to_rest_whenever_the_readings_pause() {
    for silent_s in (2..40).map(|tenth| f64::from(tenth) * 0.1) {
        let mut bench = Bench::driven(By::Trajectories, &[(FaultKind::ShortSilence, silent_s)]);
        bench.take_cloth_away();
        for (opening, expected) in [
            (Opening::Closed, HandContents::Nothing),
            (Opening::Open, HandContents::Unknown),
        ] {
            let contents = bench.driver().move_fingers(opening, &mut nobody);
            assert_eq!(
                contents,
                Ok(expected),
                "{opening:?}, silent from {silent_s} s"
            );
        }
    }
}
