//! Input that no rollout can use: each kind ends in its own outcome, recorded in the run folder and in the report.

use super::support::{self, Scripted, Trial};
use fab_agent::outcome::Outcome;
use fab_model::Model;
use fab_model::Models;
use fab_program::{Extractor, Program, Sight};
use fab_standins::Geometric;
use fab_world::Look;
use serde_json::Value;

/// Runs the small task after a change and asserts how it ends, in the report and on disk.
fn ends(outcome: Outcome, model: &dyn Model, change: impl FnOnce(&mut Program, &mut Shift)) {
    let folder = tempfile::tempdir().unwrap();
    let mut program = support::small_task();
    let mut shift = Shift::default();
    change(&mut program, &mut shift);
    let mut trial = Trial::new(&program, folder.path(), Look::default());
    for position in &mut trial.start.positions {
        position[0] += shift.by_m;
    }
    if shift.without_arrows {
        trial
            .subgoals
            .arrows
            .iter_mut()
            .for_each(|arrow| *arrow = None);
    }
    let run = folder.path().join("run");
    let models = Models {
        vision: model,
        text: model,
    };
    let report = trial.run(models, &run, &mut |_| {});
    assert_eq!(report.outcome, outcome, "{report:?}");
    assert_eq!(report.steps, 0);
    let journal = std::fs::read_to_string(run.join("rollout.jsonl")).unwrap();
    let lines: Vec<Value> = journal
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let end = lines.last().unwrap();
    assert_eq!(end["report"]["outcome"], outcome.name());
    let why = lines[lines.len() - 2]["stopped"].as_str().unwrap();
    assert!(!why.is_empty());
}

/// Changes of the start and the pictures.
#[derive(Default)]
struct Shift {
    by_m: f32,
    without_arrows: bool,
}

/// Makes the cloth's mask include everything nearer than a depth.
fn mask_below(program: &mut Program, depth_m: f64) {
    for keypoint in &mut program.keypoints {
        if let Extractor::DepthMask { below_m } = &mut keypoint.extractor {
            *below_m = depth_m;
        }
    }
}

#[test]
fn a_cloth_beside_the_picture() {
    ends(Outcome::ClothOutOfView, &Geometric, |_, shift| {
        shift.by_m = 1.0;
    });
}

#[test]
fn a_mask_that_takes_the_whole_picture() {
    // The detector works on the mask's outline, and a mask of everything has none.
    ends(Outcome::NoCandidates, &Geometric, |program, _| {
        mask_below(program, 5.0);
        for keypoint in &mut program.keypoints {
            if let Extractor::Corners { of, .. } = &mut keypoint.extractor {
                *of = Sight::Mask;
            }
        }
    });
}

#[test]
fn a_mask_that_takes_nothing() {
    ends(Outcome::ClothOutOfView, &Geometric, |program, _| {
        mask_below(program, 0.1);
    });
}

#[test]
fn subgoal_pictures_without_an_arrow() {
    ends(Outcome::MalformedReply, &Geometric, |_, shift| {
        shift.without_arrows = true;
    });
}

#[test]
fn a_model_that_never_keeps_to_the_format() {
    let model = Scripted::new(&["I cannot help with that."; 3]);
    ends(Outcome::MalformedReply, &model, |_, _| {});
}

#[test]
fn a_model_that_always_answers_wrongly() {
    let wrong = "Pick Point = (1, 1)\nPlace Point = (2, 2)";
    let model = Scripted::new(&["Instructions: fold it.", wrong, wrong, wrong]);
    ends(Outcome::AttemptsExhausted, &model, |_, _| {});
}

#[test]
fn a_model_that_gives_no_answer() {
    ends(Outcome::ModelFailed, &Scripted::new(&[]), |_, _| {});
}

#[test]
fn the_page_of_records_lists_every_outcome() {
    let page = include_str!("../../docs/records.md");
    let missing = Outcome::ALL.map(Outcome::name).into_iter();
    let missing: Vec<_> = missing
        .filter(|name| !page.contains(&format!("`{name}`")))
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
}
