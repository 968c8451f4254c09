//! Rollouts over ROS with faults: each ends in a named outcome, the arm stays in its box, and an arm that was stopped
//! does not move again.
//!
//! A fault begins during the first pick and place, at a segment that the arm's journal names.

use super::fault::FaultKind;
use super::fault::FaultKind::*;
use super::key::Key;
use super::lab::{BOX_M, Ended, Lab, Truth};
use super::nodes::Driver;
use super::touching::{Touching, calibrate};
use fab_arm::port::Port;
use serde_json::Value;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// A fault.
#[derive(Clone, Copy, Debug)]
enum What {
    Fails(FaultKind),
    /// `fabc` gets a signal.
    Signal(&'static str),
    /// The same, and the first stop request is lost.
    SignalAndLostStop(&'static str),
    /// The machine of the arm's node hangs.
    NodeHangs,
    /// The key that must be held is released for a while, and the first cancel request is lost.
    LetsGoAndLostCancel,
}

/// How a rollout ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// Both folds are done.
    Made,
    /// Exit code 2, `world_failed`, and the arm verified to be stopped; its journal contains these words.
    Stopped(&'static str),
    /// The same, but the stop could not be verified.
    Unverified(&'static str),
    /// Exit code 2 with nothing in the hand and nothing to stop; the message contains these words.
    Failed(&'static str),
    /// Exit code 130, and the arm verified to be stopped.
    Interrupted,
    /// Killed, and the arm stopped from outside; `may_hold` says whether the hand may hold cloth.
    Killed { may_hold: bool },
}

use End::*;
use What::*;

const CASES: [(What, &str, End); 24] = [
    (Fails(LostGoal), "over_pick", Made),
    (Fails(LostResult), "over", Made),
    (Fails(ShortSilence), "down", Made),
    (Fails(LostGoals), "over_pick", Stopped("did not end within")),
    (LetsGoAndLostCancel, "over", Stopped("did not end within")),
    (
        Fails(RepeatedReading),
        "over",
        Unverified("has not reported for"),
    ),
    (Fails(StuckJoint), "over_pick", Stopped("stalled")),
    (Fails(StuckJoint), "over", Stopped("stalled")),
    (Fails(StuckFingers), "grasp", Stopped("the fingers are at")),
    (
        Fails(AbortedGoal),
        "pre_pick",
        Stopped("reported `aborted`"),
    ),
    (
        Fails(FallsShortAlways),
        "lift",
        Stopped("reported `reached`"),
    ),
    (Fails(Runaway), "over_pick", Stopped("workspace")),
    (Fails(PressedStop), "over", Stopped("refuses motion")),
    (Fails(PressedStop), "grasp", Stopped("refuses motion")),
    (Fails(Silence), "over", Unverified("has not reported for")),
    (NodeHangs, "lift", Unverified("use the physical stop")),
    (Fails(NoPicture), "away", Failed("gave no picture")),
    (Signal("INT"), "down_to_place", Interrupted),
    (SignalAndLostStop("TERM"), "over", Interrupted),
    (Signal("KILL"), "over_pick", Killed { may_hold: false }),
    (Signal("KILL"), "grasp", Killed { may_hold: true }),
    (Signal("KILL"), "over", Killed { may_hold: true }),
    (Signal("KILL"), "release", Killed { may_hold: true }),
    (Signal("STOP"), "over", Killed { may_hold: true }),
];

/// Time from the beginning of a segment until its motion has certainly begun.
pub const UNDER_WAY: Duration = Duration::from_millis(500);

/// How long the key is released: it counts as held for 0.6 s.
const LET_GO: Duration = Duration::from_millis(2500);

/// Time limit for the watchdog to stop the arm: 1.5 s without a heartbeat, plus time on a busy machine.
const STOPPED_WITHIN: Duration = Duration::from_secs(20);

/// Time limit for a rollout to end after a fault: a stop is requested three times, and if there is no answer, the
/// current motion may run to its end.
const TOLD_WITHIN: Duration = Duration::from_secs(40);

/// How far a runaway arm may leave its box, metres: it turns at 0.3 rad/s, the farthest corner is 0.92 m from the axis,
/// a reading is up to 0.1 s old, it is checked every 0.05 s, and a stop takes 0.15 s to arrive.
const RUNAWAY_M: f64 = 0.3 * 0.92 * (0.1 + 0.05 + 0.15);

/// Rounding, metres.
const STILL_M: f64 = 1e-6;

#[test]
#[ignore = "needs ROS"]
fn peer_ros_whatever_goes_wrong_a_rollout_ends_with_a_word_for_it() {
    let cases = Mutex::new(VecDeque::from(CASES));
    let wrong = Mutex::new(Vec::new());
    // Each case has its own master, node and arm, and a machine with two cores must keep up.
    std::thread::scope(|scope| {
        for lane in 0..2 {
            let (cases, wrong) = (&cases, &wrong);
            scope.spawn(move || {
                let next = || cases.lock().unwrap().pop_front();
                let mut seed = 100 * lane;
                while let Some((what, when, end)) = next() {
                    seed += 1;
                    let begun = Instant::now();
                    let held = catch_unwind(AssertUnwindSafe(|| rollout(seed, what, when, end)));
                    let took_s = begun.elapsed().as_secs_f64();
                    println!(
                        "{what:?} in `{when}`: {end:?} {} ({took_s:.0} s)",
                        if held.is_ok() { "held" } else { "WRONG" }
                    );
                    if held.is_err() {
                        wrong
                            .lock()
                            .unwrap()
                            .push(format!("{what:?} in `{when}`: {end:?}"));
                    }
                }
            });
        }
    });
    let wrong = wrong.into_inner().unwrap();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

fn rollout(seed: u64, what: What, when: &str, end: End) {
    let mut lab = Lab::new(Driver::Kinova, seed);
    calibrate(&mut lab, Touching::Reckoned);
    lab.lay();
    let (mut run, key) = match what {
        LetsGoAndLostCancel => {
            let (terminal, key) = Key::held(lab.folder().join("stderr"));
            (lab.run_from(terminal, &["--hold-to-run"]), Some(key))
        }
        _ => (lab.run(), None),
    };
    run.until(when);
    match what {
        // During a motion: the request before the next one is to be lost, which is sent twice, because a motion's own goal is
        // sent once; and an arm that runs away before its motion never reaches its limits.
        Fails(kind @ (LostGoal | LostGoals | Runaway)) => {
            std::thread::sleep(3 * UNDER_WAY);
            lab.fail(kind);
        }
        Fails(kind) => lab.fail(kind),
        NodeHangs => lab.ros.halt_node(),
        LetsGoAndLostCancel => {
            lab.fail(LostCancel);
            std::thread::sleep(UNDER_WAY);
            key.as_ref().unwrap().let_go_for(LET_GO);
        }
        Signal(name) => {
            std::thread::sleep(UNDER_WAY);
            run.signal(name);
        }
        SignalAndLostStop(name) => {
            lab.fail(LostStop);
            std::thread::sleep(UNDER_WAY);
            run.signal(name);
        }
    }
    let failed = Instant::now();
    if let Killed { .. } = end {
        wait_until_stopped(&mut lab);
    }
    if let Signal("STOP") = what {
        run.signal("KILL");
    }
    let ended = run.end();
    assert!(!ended.stderr.contains("panicked"), "{ended:#?}");
    if end != Made {
        let took = failed.elapsed();
        assert!(took < TOLD_WITHIN, "{took:?}: {ended:#?}");
    }
    let truth = lab.truth();
    std::thread::sleep(Duration::from_secs(1));
    let later = lab.truth();
    let over_m = if matches!(what, Fails(Runaway)) {
        RUNAWAY_M
    } else {
        0.0
    };
    assert!(is_in_box(&later, over_m), "{later:?} {ended:#?}");
    let moved = (0..3).map(|axis| (later.tool_m[axis] - truth.tool_m[axis]).abs());
    assert!(moved.fold(0.0, f64::max) < STILL_M, "{truth:?} {later:?}");
    if later.is_stopped {
        let moved_m = later.moved_after_stop_m.unwrap();
        assert!(moved_m < STILL_M, "{moved_m} m after a stop");
    }
    let halted = || -> Value {
        let last = ended.journal.lines().last().unwrap();
        let entry: Value = serde_json::from_str(last).unwrap();
        assert_eq!(entry["type"], "halted", "{ended:#?}");
        entry
    };
    match end {
        Made => {
            ends(&ended, 0, "horizon_reached");
            assert!(!later.is_stopped);
            let begun = ended
                .journal
                .matches(&format!("\"segment\":\"{when}\""))
                .count();
            // A paused motion is restarted.
            let paused = usize::from(key.is_some());
            // A busy machine stalls, which pauses it as well.
            let is_expected = begun == 2 || begun > 2 && key.is_some();
            assert!(is_expected && begun >= 2 + paused, "{}", ended.journal);
        }
        Stopped(words) | Unverified(words) => {
            ends(&ended, 2, "world_failed");
            assert_eq!(halted()["stopped"], matches!(end, Stopped(_)));
            assert!(ended.why.contains(words), "{ended:#?}");
            assert!(later.is_stopped || matches!(what, NodeHangs));
        }
        Failed(words) => {
            ends(&ended, 2, "world_failed");
            assert!(ended.why.contains(words), "{ended:#?}");
        }
        Interrupted => {
            ends(&ended, 130, "interrupted");
            assert_eq!(halted()["stopped"], true);
            assert!(later.is_stopped);
        }
        Killed { may_hold } => {
            assert_eq!(ended.code, None, "{ended:#?}");
            assert!(later.is_stopped);
            recovers(&lab, when, may_hold);
        }
    }
}

fn ends(ended: &Ended, code: i32, outcome: &str) {
    assert_eq!(ended.code, Some(code), "{ended:#?}");
    assert_eq!(ended.report["outcome"], outcome, "{ended:#?}");
}

fn is_in_box(truth: &Truth, over_m: f64) -> bool {
    let [least, most] = truth.extent_m;
    let mut reaches = least.iter().zip(&most).zip(BOX_M[0].iter().zip(&BOX_M[1]));
    reaches.all(|((from, to), (low, high))| *from >= low - over_m && *to <= high + over_m)
}

fn wait_until_stopped(lab: &mut Lab) {
    let deadline = Instant::now() + STOPPED_WITHIN;
    while !lab.truth().is_stopped {
        assert!(Instant::now() < deadline, "nobody stops the arm");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// After a kill, `fabc robot recover` reports the state, and does not accept silence as an answer.
fn recovers(lab: &Lab, segment: &str, may_hold: bool) {
    let recover = |more: &[&str]| {
        let output = lab
            .fabc()
            .args(["robot", "recover", "--robot", "robot.toml", "--json"])
            .args(more)
            .output()
            .unwrap();
        let told: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
        (output.status.code(), told)
    };
    assert_eq!(recover(&[]).0, Some(2));
    let (code, told) = recover(&["--how", "the cloth was taken out of the fingers"]);
    assert_eq!(code, Some(0), "{told}");
    assert_eq!(told["left"], "unclear", "{told}");
    assert_eq!(told["segment"], segment, "{told}");
    assert_eq!(told["may_hold"], may_hold, "{told}");
    let (code, told) = recover(&[]);
    assert_eq!((code, told["left"].as_str()), (Some(0), Some("clear")));
    assert_eq!(told["recovered"], Value::Null);
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_a_trajectory_of_a_killed_run_does_not_go_on() {
    let mut lab = Lab::new(Driver::Trajectory, 200);
    calibrate(&mut lab, Touching::Reckoned);
    lab.lay();
    let mut run = lab.run();
    run.until("over");
    std::thread::sleep(UNDER_WAY);
    run.signal("KILL");
    wait_until_stopped(&mut lab);
    run.end();
    // A controller that kept its trajectory would continue it now.
    lab.ros.connect().start().unwrap();
    let before = lab.truth().tool_m;
    std::thread::sleep(Duration::from_secs(2));
    assert_eq!(lab.truth().tool_m, before);
}
