//! Equal bits: pinned digests of a few runs, with any number of threads, build and instruction set.
//!
//! `digests.json` has the digests, all of the recorded scene's cloth. If its results are meant to change, raise `ALGORITHM_VERSION` and
//! write new digests: `FABC_WRITE_DIGESTS=1 cargo test -p fab-sim --test digests pinned`. Results of cloths of a material have
//! `TEXTILE_VERSION`, and a pinned digest in `suite/textile/folding.rs`.
#![allow(clippy::unwrap_used)]

use fab_sim::{Grid, Mask, Params, RestShortcut, Simulator, Snapshot, diagonal_fold};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

const SPACING_M: f32 = 0.00625;

/// A run that can be interrupted: it passes its cloth through `between` once, halfway.
type Run = fn(RestShortcut, &dyn Fn(Simulator) -> Simulator) -> Simulator;

const RUNS: [(&str, Run); 4] = [
    ("two_folds_16x14", two_folds),
    ("masked_fold_30x24", masked_fold),
    ("crumple_12x12", crumple),
    ("diagonal_fold_20x20", diagonal),
];

fn never() -> bool {
    false
}

fn grid(dimx: usize, dimy: usize) -> Grid {
    Grid::new(dimx, dimy, SPACING_M).unwrap()
}

fn flat(cloth: impl Into<Mask>, shortcut: RestShortcut) -> Simulator {
    let mut cloth = Simulator::flat(cloth, &Params::default());
    cloth.set_rest_shortcut(shortcut);
    cloth
}

/// Two folds with the picker, far enough apart in time for the cloth to rest in between.
fn two_folds(shortcut: RestShortcut, between: &dyn Fn(Simulator) -> Simulator) -> Simulator {
    let mut cloth = flat(grid(16, 14), shortcut);
    cloth
        .pick_and_place([-0.046, 0.04], [0.0, 0.0], &never)
        .unwrap();
    let mut cloth = between(cloth);
    cloth
        .pick_and_place([0.046, -0.04], [0.01, 0.0], &never)
        .unwrap();
    cloth
}

/// A cloth with a hole and a missing corner, folded by hand; it passes through `between` while it hangs.
fn masked_fold(shortcut: RestShortcut, between: &dyn Fn(Simulator) -> Simulator) -> Simulator {
    let there = |ix: usize, iy: usize| {
        !((12..18).contains(&ix) && (8..15).contains(&iy)) && (ix < 24 || iy < 18)
    };
    let mask = Mask::from_fn(grid(30, 24), there).unwrap();
    let mut cloth = flat(&mask, shortcut);
    cloth.hold(&[0, 1]).unwrap();
    let carry = |cloth: &mut Simulator, steps: u32, shift: [f32; 3]| {
        for _ in 0..steps {
            cloth.step_held(shift).unwrap();
        }
    };
    carry(&mut cloth, 10, [0.0, 0.0, 0.005]);
    carry(&mut cloth, 13, [0.004, -0.003, 0.0]);
    let mut cloth = between(cloth);
    carry(&mut cloth, 13, [0.004, -0.003, 0.0]);
    carry(&mut cloth, 10, [0.0, 0.0, -0.004]);
    cloth.hold(&[]).unwrap();
    carry(&mut cloth, 60, [0.0; 3]);
    cloth
}

fn crumple(shortcut: RestShortcut, between: &dyn Fn(Simulator) -> Simulator) -> Simulator {
    let mut cloth = flat(grid(12, 12), shortcut);
    cloth.crumple(7, &never).unwrap();
    let mut cloth = between(cloth);
    cloth.crumple(8, &never).unwrap();
    cloth
}

/// The timed scenario; it computes every step and is not interrupted.
fn diagonal(_: RestShortcut, between: &dyn Fn(Simulator) -> Simulator) -> Simulator {
    let cloth = diagonal_fold(grid(20, 20), &Params::default(), &never).unwrap();
    between(cloth)
}

fn uncut(cloth: Simulator) -> Simulator {
    cloth
}

/// Continues with a new cloth, restored from a snapshot that was written as text.
fn through_json(cloth: Simulator) -> Simulator {
    let text = serde_json::to_string(&cloth.snapshot()).unwrap();
    let snapshot: Snapshot = serde_json::from_str(&text).unwrap();
    let mut other = Simulator::flat(cloth.mask(), &Params::default());
    other.restore(&snapshot).unwrap();
    other
}

fn digests(
    shortcut: RestShortcut,
    between: &dyn Fn(Simulator) -> Simulator,
) -> BTreeMap<String, String> {
    let run = |(name, run): (&str, Run)| (name.to_owned(), run(shortcut, between).digest());
    RUNS.into_iter().map(run).collect()
}

fn here() -> BTreeMap<String, String> {
    digests(RestShortcut::Skip, &uncut)
}

#[test]
fn runs_give_the_pinned_digests() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/digests.json");
    let got = here();
    if std::env::var_os("FABC_WRITE_DIGESTS").is_some() {
        let text = serde_json::to_string_pretty(&got).unwrap();
        std::fs::write(&path, text + "\n").unwrap();
    }
    let pinned: BTreeMap<String, String> =
        serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    assert_eq!(got, pinned, "the head of this file says how to pin anew");
}

#[test]
fn four_threads_at_once_give_the_digests_of_one() {
    let alone = here();
    let together: Vec<_> = std::thread::scope(|scope| {
        let runs: Vec<_> = (0..4).map(|_| scope.spawn(here)).collect();
        runs.into_iter().map(|run| run.join().unwrap()).collect()
    });
    assert!(together.iter().all(|digests| *digests == alone));
}

#[test]
fn computing_the_steps_of_a_resting_cloth_changes_no_bit() {
    assert_eq!(digests(RestShortcut::Compute, &uncut), here());
    for (name, run) in RUNS {
        let [skipped, computed] =
            [RestShortcut::Skip, RestShortcut::Compute].map(|shortcut| run(shortcut, &uncut));
        assert_eq!(skipped.velocities(), computed.velocities(), "{name}");
        assert_eq!(skipped.steps(), computed.steps(), "{name}");
    }
}

#[test]
fn a_snapshot_goes_on_with_the_same_bits_even_after_being_text() {
    let copied = |cloth: Simulator| {
        let mut other = Simulator::flat(cloth.mask(), &Params::default());
        other.restore(&cloth.snapshot()).unwrap();
        other
    };
    assert_eq!(digests(RestShortcut::Skip, &copied), here());
    assert_eq!(digests(RestShortcut::Skip, &through_json), here());
}

/// The tests above need the shortcut to be taken: a sphere far from a resting cloth moves none of it.
#[test]
fn a_picker_on_its_way_leaves_a_resting_cloth_alone() {
    let cloth = two_folds(RestShortcut::Skip, &uncut);
    assert!(
        cloth.snapshot().at_rest,
        "the way home is long enough to come to rest"
    );
}

/// Runs the pinned digests in another build of this crate.
fn the_pinned_digests_hold_with(arguments: &[&str]) {
    let run = Command::new(env!("CARGO"))
        .args([
            "test",
            "--locked",
            "--package",
            env!("CARGO_PKG_NAME"),
            "--test",
            "digests",
        ])
        .args(arguments)
        .args(["--", "--exact", "runs_give_the_pinned_digests"])
        .env_remove("FABC_WRITE_DIGESTS")
        .output()
        .unwrap();
    let [out, log] =
        [run.stdout, run.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(run.status.success(), "{arguments:?}:\n{out}\n{log}");
    assert!(out.contains("1 passed"), "{arguments:?}:\n{out}\n{log}");
}

#[test]
#[ignore = "long"]
fn optimised_code_gives_the_pinned_digests() {
    the_pinned_digests_hold_with(&["--release"]);
}

#[test]
#[ignore = "long"]
fn unoptimised_code_gives_the_pinned_digests() {
    the_pinned_digests_hold_with(&[
        "--config",
        concat!(
            "profile.dev.package.",
            env!("CARGO_PKG_NAME"),
            ".opt-level=0"
        ),
    ]);
}

#[test]
#[ignore = "long"]
fn the_baseline_instruction_set_gives_the_pinned_digests() {
    the_pinned_digests_hold_with(&["--features", "narrow"]);
}
