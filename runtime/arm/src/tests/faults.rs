//! Tests any fault at any time: a pick and place ends, the tool stays in its workspace, and a stopped arm stays
//! stopped.

use super::*;
use crate::driver::{ArmError, HandContents};
use crate::supervisor::{NoWatchdog, Unattended};
use fab_base::chance::Chance;

/// How much longer than without a fault a pick and place may take, seconds of the arm's clock.
const LATER_S: f64 = 60.0;

/// How far outside its box a runaway arm may get, metres: it turns at 0.3 rad/s, the farthest corner of the box is 0.92
/// m from the axis, a reading is up to 0.1 s old, and it is checked every 0.05 s, plus a clock tick for each.
const RUNAWAY_M: f64 = 0.3 * 0.92 * (0.1 + 0.05 + 0.02);

/// Executes a pick and place with one fault; returns whether it was completed nevertheless.
fn survives(by: By, seed: u64, usual_s: f64) -> bool {
    let mut chance = Chance::seeded(seed);
    let kind = FaultKind::ALL[chance.below(FaultKind::ALL.len())];
    let from_s = chance.fraction() * usual_s;
    let told = format!("{by:?}, seed {seed}: {kind:?} at {from_s:.2} s");
    let mut bench = Bench::of(by, seed, &[(kind, from_s)]);
    let result = bench.run(&mut Unattended, &mut NoWatchdog);
    let took_s = bench.port().now_s();
    assert!(took_s < usual_s + LATER_S, "{told}: {took_s:.1} s");
    bench.port().wait(5.0);

    let over_m = if kind == FaultKind::Runaway {
        RUNAWAY_M
    } else {
        0.0
    };
    let [least, most] = bench.port().extent_m();
    let workspace = bench.settings.workspace.clone();
    for axis in 0..3 {
        let is_within = least[axis] >= workspace.min_m[axis] - over_m
            && most[axis] <= workspace.max_m[axis] + over_m;
        assert!(is_within, "{told}: {least:?} to {most:?}");
    }
    match &result {
        Ok(done) => {
            let off_m = bench.off_m(workspace.rest_m);
            assert!(off_m <= 0.003, "{told}: {off_m}");
            if done.contents == HandContents::Something {
                let off_m = (bench.cloth.borrow().at - Point3::from(PLACE_M)).norm();
                assert!(off_m < 0.004, "{told}: cloth {off_m} m off");
            }
        }
        Err(broken) => {
            assert!(
                !matches!(broken.why, ArmError::Panicked(_)),
                "{told}: {broken}"
            );
            if matches!(broken.stopped, Some(Ok(()))) {
                assert!(bench.port().is_stopped(), "{told}: {broken}");
                let moved_m = bench.port().moved_after_stop_m().unwrap();
                assert!(moved_m < 1e-9, "{told}: {moved_m} m after a stop");
            }
        }
    }
    if kind == FaultKind::PressedStop && bench.port().now_s() - 5.0 > from_s {
        assert!(bench.port().is_stopped(), "{told}: let go");
    }
    result.is_ok()
}

fn survive(by: By, seeds: std::ops::Range<u64>) -> usize {
    let mut usual = Bench::driven(by, &[]);
    usual.run(&mut Unattended, &mut NoWatchdog).unwrap();
    let usual_s = usual.port().now_s();
    seeds.filter(|seed| survives(by, *seed, usual_s)).count()
}

#[test]
#[ignore = "long"]
fn any_fault_at_any_time_ends_well() {
    for by in By::BOTH {
        let carried_out = survive(by, 0..50);
        // Some faults must end an action, and some must not.
        assert!((10..40).contains(&carried_out), "{carried_out} of 50");
    }
}

#[test]
#[ignore = "long"]
fn many_faults_at_any_time_end_well() {
    for by in By::BOTH {
        let begun = std::time::Instant::now();
        let carried_out = survive(by, 1000..1150);
        println!(
            "by {by:?}: {carried_out} of 150 carried out, the others stopped, in {:.1?}",
            begun.elapsed()
        );
    }
}
