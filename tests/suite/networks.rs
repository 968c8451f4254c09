//! Policies that play networks: which files are refused, and which action is played.
//!
//! `tests/fixtures/networks/make.py` makes the networks. `crumpled.png` is the simulated camera's picture of the first
//! recorded crumpled start.

use super::support;
use fab_agent::examples::Examples;
use fab_agent::outcome::Outcome;
use fab_agent::pictures::Pictures;
use fab_agent::policy::{Asking, Decision, Exchange, Onnx, Policy, StepView};
use fab_agent::record::SentFiles;
use fab_agent::scene::Scene;
use fab_base::interrupt::Interrupt;
use fab_model::Lowering;
use fab_model::calls::{Budget, Ledger};
use fab_picture::DepthImage;
use fab_picture::observation::Observation;
use fab_program::facts::Facts;
use fab_program::verify::{self, Strictness, Verdict};
use fab_program::{PixelPoint, Program, Proposal, Value, space};
use image::{Luma, RgbImage};
use std::collections::BTreeMap;
use std::path::PathBuf;

fn fixture(name: &str) -> PathBuf {
    support::root().join("tests/fixtures/networks").join(name)
}

fn network(name: &str) -> Onnx {
    Onnx::read(&fixture(&format!("{name}.onnx"))).unwrap()
}

#[test]
fn a_file_that_no_policy_can_play_is_refused_with_what_would_be_right() {
    for (name, expected) in [
        ("absent.onnx", "cannot be read: No such file"),
        ("crumpled.png", "is not an ONNX network that fabc can run: "),
        (
            "unknown_input.onnx",
            "takes or returns `image`, which fabc does not know; the inputs are `color`, `depth`, `cloth`, `faces`, `edge`, `picks`, `places`",
        ),
        (
            "channels_first.onnx",
            "declares `color` as [1, 3, H, W]; it must be [H, W, 3]",
        ),
        (
            "small_picture.onnx",
            "declares `color` as [100, 100, 3]; it must be [H, W, 3], where H and W are 720",
        ),
        (
            "without_actions.onnx",
            "takes neither `picks` nor `places`, so it cannot tell actions apart",
        ),
        ("scores.onnx", "and the output is `values`"),
        ("table.onnx", "declares `values` as [N, 2]; it must be [N]"),
        ("one_value.onnx", "declares `values` as [1]; it must be [N]"),
        (
            "whole_numbers.onnx",
            "declares `picks` of another type; it must be float32",
        ),
    ] {
        let read = Onnx::read(&fixture(name));
        let refused = read.and_then(|network| {
            let prepared = network.prepare(&support::task("smoothing"));
            prepared.map_err(|error| error.to_string())
        });
        let error = refused.err().unwrap_or_default();
        assert!(
            error.contains(name) && error.contains(expected),
            "{name}: {error}"
        );
    }
}

#[test]
fn a_task_that_a_network_cannot_do_is_refused_before_the_first_step() {
    let smoothing = support::task("smoothing");
    let pictures = fab_compiler::compile("tasks/smoothing.fab", &support::ProjectFiles).unwrap();
    let is_region = |it: &&Program| it.variant.as_deref() == Some("without_preprocessing");
    let program = pictures.programs.iter().find(is_region).unwrap();
    let region = Onnx::smoother().prepare(program).unwrap_err().to_string();
    assert!(region.contains("compares listed points"), "{region}");
    Onnx::smoother().prepare(&smoothing).unwrap();
}

/// The crumpled cloth, as the task's camera sees it.
fn crumpled(program: &Program) -> (Observation, Scene) {
    let bytes = std::fs::read(fixture("crumpled.png")).unwrap();
    let rgb: RgbImage = image::load_from_memory(&bytes).unwrap().to_rgb8();
    // The table is grey, 1 m away.
    let depth = DepthImage::from_fn(rgb.width(), rgb.height(), |column, row| {
        let [red, green, blue] = rgb.get_pixel(column, row).0;
        let is_cloth = i32::from(red) - i32::from(green.min(blue)) > 40;
        Luma([if is_cloth { 0.99 } else { 1.0 }])
    });
    let observation = Observation::of_picture(&program.camera, rgb, Some(depth)).unwrap();
    let scene = Scene::of(program, &observation, None).unwrap();
    (observation, scene)
}

/// What a network decides about the crumpled cloth.
fn decided(mut policy: Onnx) -> Decision {
    let program = support::task("smoothing");
    let (observation, scene) = crumpled(&program);
    let examples = Examples::default();
    let pictures = Pictures::of(&program, &scene, &observation, None, None, examples).unwrap();
    let view = StepView::without_rollout(&program, &scene, &observation, 1, None, &pictures);
    let budget = Budget::default();
    let mut exchange = Exchange {
        asking: &mut Asking::of(Ledger::unwritten(&budget)),
        record: &mut |_| Ok(SentFiles::default()),
        interrupt: &Interrupt::default(),
    };
    policy.decide(&view, &mut exchange).unwrap()
}

fn played(decision: Decision) -> Proposal {
    match decision {
        Decision::Act { grips, .. } => grips.into_iter().next().unwrap(),
        other => panic!("{other:?}"),
    }
}

fn pull(pick: [i32; 2], deg: f64, length: f64) -> Proposal {
    let fields = [
        ("pick", Value::Point(PixelPoint::new(pick[0], pick[1]))),
        ("direction", Value::Direction { deg }),
        ("distance", Value::Length { length }),
    ];
    Proposal {
        fields: fields.map(|(name, value)| (name.to_owned(), value)).into(),
    }
}

/// The networks that were computed by hand before they were an ONNX file chose this pull as well.
#[test]
fn the_smoother_pulls_what_its_networks_always_pulled() {
    assert_eq!(
        played(decided(Onnx::smoother())),
        pull([394, 278], 0.0, 0.5)
    );
}

/// The distances that the task offers, and those of the pulls of the crumpled cloth that its checks accept.
fn offered_and_accepted_distances() -> [Vec<f64>; 2] {
    let program = support::task("smoothing");
    let (observation, scene) = crumpled(&program);
    let texts = BTreeMap::new();
    let facts = Facts {
        scene: &scene,
        texts: &texts,
        step: 1,
        last: None,
        proposal: None,
        pointing: Lowering::PIXELS.pointing(observation.rgb.dimensions().into()),
    };
    let choices = |name: &str| space::choices(program.field(name).unwrap(), &scene);
    let [picks, directions, distances] = ["pick", "direction", "distance"].map(choices);
    let length_of = |distance: &Value| match distance {
        Value::Length { length } => *length,
        other => panic!("{other:?}"),
    };
    let is_accepted = |distance: &Value| {
        picks.iter().any(|pick| {
            directions.iter().any(|direction| {
                let fields = [
                    ("pick", pick),
                    ("direction", direction),
                    ("distance", distance),
                ];
                let proposal = Proposal {
                    fields: fields
                        .map(|(name, value)| (name.to_owned(), value.clone()))
                        .into(),
                };
                let verdict = verify::verdict(&program, facts, &proposal, Strictness::Full);
                verdict.unwrap() == Verdict::Accept
            })
        })
    };
    let accepted = distances.iter().filter(|distance| is_accepted(distance));
    let accepted = accepted.map(length_of).collect();
    [distances.iter().map(length_of).collect(), accepted]
}

#[test]
fn a_network_made_elsewhere_plays_its_highest_value_among_accepted_actions() {
    let longest_of = |lengths: &[f64]| lengths.iter().copied().fold(0.0, f64::max);
    let [offered, accepted] = offered_and_accepted_distances();
    let longest = longest_of(&accepted);
    assert!(
        offered[0] < longest && longest < longest_of(&offered),
        "{offered:?}, of which some pull is accepted: {accepted:?}"
    );
    let played = played(decided(network("longest")));
    assert_eq!(
        played.get("distance"),
        Some(&Value::Length { length: longest })
    );
}

#[test]
#[ignore = "long"]
fn values_do_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    support::bring_library(folder.path());
    let task = r#"
        use "lib/smoothing.fab"
        task one_pull extends smoothing_by_corners {
            cloth   grid(42, 42, start: crumpled)
            horizon 1
        }
    "#;
    std::fs::write(folder.path().join("one_pull.fab"), task).unwrap();
    let rollout = |threads: &str| {
        let mut run = support::fabc(folder.path());
        run.args(["run", "one_pull.fab", "--policy", "smoother"]);
        run.args(["--start", "1", "--out", threads]);
        run.env("RTEN_NUM_THREADS", threads);
        let captured = support::finish(&mut run);
        assert_eq!(captured.code, 0, "{}", captured.stderr);
        let rollout = folder.path().join(threads).join("rollout.jsonl");
        std::fs::read_to_string(rollout).unwrap()
    };
    let alone = rollout("1");
    assert!(alone.contains("\"pick_px\""), "{alone}");
    assert_eq!(alone, rollout("2"));
}

#[test]
fn a_network_that_returns_no_usable_values_ends_the_rollout() {
    for (name, expected) in [
        ("two_values", " values for "),
        ("not_a_number", "is NaN, which is not finite"),
    ] {
        match decided(network(name)) {
            Decision::Stop {
                outcome: Outcome::PolicyFailed,
                why,
            } => assert!(why.contains(expected), "{name}: {why}"),
            other => panic!("{name}: {other:?}"),
        }
    }
}
