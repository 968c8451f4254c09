//! A task by direction and distance with scripted models: what it shows, what it does, how it ends.
//!
//! In: `tests/fixtures/tasks/steered.fab`, which uses features that the shipped folds do not.

use super::support::{self, ProjectFiles, Scripted, Trial, words_of};
use fab_agent::outcome::Outcome;
use fab_agent::rollout::{Ended, Event};
use fab_base::cache::Cache;
use fab_compiler::{LoadError, Loader};
use fab_model::Models;
use fab_model::{Part, Request, Speaker};
use fab_program::{Program, Reasoning};
use fab_world::{Grip, Look};
use serde_json::Value;

const FILE: &str = "tests/fixtures/tasks/steered.fab";

/// Returns the task, or a variant of it.
pub(super) fn steered(variant: Option<&str>) -> Program {
    let compiled = fab_compiler::compile(FILE, &ProjectFiles).unwrap();
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    let mut programs = compiled.programs.into_iter();
    programs
        .find(|program| program.variant.as_deref() == variant)
        .unwrap()
}

fn text() -> String {
    std::fs::read_to_string(support::project(FILE)).unwrap()
}

/// A loader that returns one text for every path.
struct Changed(String);

impl Loader for Changed {
    fn load(&self, _: &str) -> Result<String, LoadError> {
        Ok(self.0.clone())
    }
}

/// Returns the task with some parts of its text replaced.
pub(super) fn steered_but(changes: &[(&str, &str)]) -> Program {
    let mut text = text();
    for (part, other) in changes {
        assert!(text.contains(part), "{part}");
        text = text.replace(part, other);
    }
    let compiled = fab_compiler::compile("steered.fab", &Changed(text)).unwrap();
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    compiled.programs.into_iter().next().unwrap()
}

pub(super) struct Played {
    pub report: Ended,
    pub asked: Vec<Request>,
    pub grips: Vec<Grip>,
    /// The journal's step lines.
    pub steps: Vec<Value>,
}

pub(super) fn play(program: &Program, replies: &[&str]) -> Played {
    play_with(program, replies, |_| {})
}

/// Plays a rollout after a test's changes.
pub(super) fn play_with(
    program: &Program,
    replies: &[&str],
    change: impl FnOnce(&mut Trial<'_>),
) -> Played {
    let folder = tempfile::tempdir().unwrap();
    let model = Scripted::new(replies);
    let mut trial = Trial::new(program, folder.path(), Look::default());
    trial.cache = Cache::none();
    change(&mut trial);
    let mut grips = Vec::new();
    let mut watch = |event: Event| {
        if let Event::Motion { line, .. } = event {
            grips.extend(line.action.iter().flatten().map(|it| it.grip));
        }
    };
    let models = Models {
        vision: &model,
        text: &model,
    };
    let run = folder.path().join("run");
    let report = trial.run(models, &run, &mut watch);
    let journal = std::fs::read_to_string(run.join("rollout.jsonl")).unwrap();
    let steps = journal
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap())
        .filter(|line| line.get("step").is_some_and(|step| !step.is_null()))
        .collect();
    Played {
        report,
        asked: model.asked.into_inner().unwrap(),
        grips,
        steps,
    }
}

pub(super) fn answer(pick: &str, direction: &str, distance: &str) -> String {
    format!("Pick Point = {pick}\nDirection = {direction}\nDistance = {distance}\nGrip = soft")
}

/// The detected corners of the flat cloth, as its prompt lists them.
pub(super) const RIGHT: &str = "(157, 157)";
pub(super) const LEFT: &str = "(66, 66)";

#[test]
fn a_direction_is_one_of_the_picture_whichever_way_is_up() {
    for (variant, expected) in [(None, [0.02, 0.0]), (Some("turned"), [0.0, -0.02])] {
        let played = play(&steered(variant), &[&answer(RIGHT, "0 deg", "20 mm")]);
        let Grip { pick, place, .. } = played.grips[0];
        let moved = place - pick;
        assert!(
            (moved.x - expected[0]).abs() < 1e-9 && (moved.y - expected[1]).abs() < 1e-9,
            "{variant:?}: {moved:?}"
        );
        assert_eq!(played.report.header.variant.as_deref(), variant);
    }
}

#[test]
fn both_pictures_and_the_example_reach_the_model() {
    let played = play(&steered(None), &[&answer(RIGHT, "0 deg", "20 mm")]);
    let first = &played.asked[0];
    let speakers: Vec<Speaker> = first
        .messages
        .iter()
        .map(|message| message.speaker)
        .collect();
    assert_eq!(speakers, [Speaker::User, Speaker::Assistant, Speaker::User]);
    assert_eq!(
        (first.temperature, first.top_p, first.reasoning),
        (Some(0.1), Some(0.9), Some(Reasoning::Tokens(2048)))
    );
    let pictures: Vec<&[u8]> = images(first);
    assert_eq!(pictures.len(), 2);
    assert_ne!(pictures[0], pictures[1], "the second is annotated");
    assert!(
        !words_of(first).contains("last action"),
        "{}",
        words_of(first)
    );
    // From the second step on there is a previous action to mention and to draw.
    let second = &played.asked[1];
    assert!(
        words_of(second).contains("going 0 deg"),
        "{}",
        words_of(second)
    );
    let has_red = |png: &[u8]| {
        let picture = image::load_from_memory(png).unwrap().to_rgb8();
        picture.pixels().any(|pixel| pixel.0 == [255, 0, 0])
    };
    assert!(!has_red(images(first)[1]) && has_red(images(second)[1]));
}

fn images(request: &Request) -> Vec<&[u8]> {
    let parts = request.messages.iter().flat_map(|message| &message.parts);
    parts
        .filter_map(|part| match part {
            Part::Image(png) => Some(png.bytes()),
            Part::Text(_) => None,
        })
        .collect()
}

#[test]
fn at_last_the_answers_are_judged_without_what_the_task_leaves_out() {
    // The second step's answers pick where the first one ended, twice; the second answer is executed anyway. The first
    // pull takes the cloth's center to the right, so that the fixed point lies to its left.
    let right = answer("(112, 112)", "0 deg", "10 mm");
    let left = answer("(112, 112)", "180 deg", "10 mm");
    let played = play(&steered(None), &[&right, &left, &left]);
    assert_eq!(played.grips.len(), 2, "{:?}", played.report);
    let accepted = &played.steps[1]["accepted"];
    assert_eq!(
        (&accepted["attempt"], &accepted["without"][0]),
        (&2.into(), &"new_place".into())
    );
    assert_eq!(
        played.steps[1]["attempts"][1]["result"]["verdict"]["check"],
        "new_place"
    );
}

#[test]
fn answers_that_fail_another_check_are_not_executed() {
    let inward = answer(LEFT, "0 deg", "10 mm");
    let played = play(&steered(None), &[&inward, &inward]);
    assert_eq!(played.report.outcome, Outcome::AttemptsExhausted);
    assert!(played.grips.is_empty());
    let told = words_of(&played.asked[1]);
    assert!(told.contains("0 deg leads inward; take"), "{told}");
}

#[test]
fn a_goal_of_coverage_is_judged_after_each_step() {
    let played = play(
        &steered(Some("covered")),
        &[&answer(RIGHT, "0 deg", "10 mm")],
    );
    assert_eq!(played.report.outcome, Outcome::GoalReached);
    assert_eq!(played.report.steps, 1);
    let coverage = played.report.measures.coverage.unwrap();
    assert!((0.5..1.1).contains(&coverage), "{coverage}");
}

#[test]
fn a_value_that_was_not_offered_is_refused_with_the_choices() {
    let played = play(
        &steered(None),
        &[
            &answer(RIGHT, "45 deg", "10 mm"),
            &answer(RIGHT, "0 deg", "10 mm"),
        ],
    );
    let told = words_of(&played.asked[1]);
    assert!(
        told.contains("45 deg") && told.contains("0 deg, 90 deg, 180 deg, 270 deg"),
        "{told}"
    );
    assert_eq!(played.grips.len(), 1);
}

#[test]
fn the_command_runs_the_tests_of_a_task() {
    let folder = tempfile::tempdir().unwrap();
    let text = text();
    std::fs::write(folder.path().join("steered.fab"), &text).unwrap();
    let said =
        support::finish(support::fabc(folder.path()).args(["test", "steered.fab", "--json"]));
    let report: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(
        (said.code, &report["passed"], &report["failed"]),
        (0, &3.into(), &0.into())
    );
    let wrong = text.replace("expect reject(outward)", "expect accept");
    std::fs::write(folder.path().join("wrong.fab"), wrong).unwrap();
    let said = support::finish(support::fabc(folder.path()).args(["test", "wrong.fab"]));
    assert_eq!(said.code, 1);
    assert!(
        said.stdout
            .contains("the check `outward` refuses the answer"),
        "{}",
        said.stdout
    );
    assert!(
        said.stdout.ends_with("2 passed, 1 failed\n"),
        "{}",
        said.stdout
    );
}

#[test]
fn a_variant_is_chosen_by_name_and_an_unknown_one_is_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("steered.fab"), text()).unwrap();
    let render = |variant: &str| {
        support::finish(support::fabc(folder.path()).args([
            "render",
            "steered.fab",
            "--variant",
            variant,
        ]))
    };
    let without = render("without_scene_words");
    assert_eq!(without.code, 0, "{}", without.stderr);
    assert!(
        !without.stdout.contains("are the corners"),
        "{}",
        without.stdout
    );
    let unknown = render("without_anything");
    assert_eq!(unknown.code, 64);
    assert!(
        unknown
            .stderr
            .contains("there is `turned`, `covered`, `without_scene_words`"),
        "{}",
        unknown.stderr
    );
}

#[test]
fn certain_slips_are_repaired_and_likely_ones_left() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("steered.fab");
    let right = text();
    let wrong = right
        .replace(
            "fov: 45deg, image: 224px)\n    horizon",
            "fov: 45°, image: 224px)\n    horizon",
        )
        .replace("pick:      one of", "pick =     one of")
        .replace(
            "frame   = bounding_box(orange)",
            "frame   : bounding_box(orange)",
        )
        .replace("grip:      one of \"soft\"", "grip:      one of 'soft'")
        .replace(
            "say   scene_words, last_words",
            "say   scene_words, last_wordz",
        );
    std::fs::write(&file, &wrong).unwrap();
    let said =
        support::finish(support::fabc(folder.path()).args(["check", "steered.fab", "--fix"]));
    assert_eq!(said.code, 1, "the misspelt name is left to the author");
    assert!(
        said.stdout.contains("did you mean `last_words`?"),
        "{}",
        said.stdout
    );
    let left = std::fs::read_to_string(&file).unwrap();
    let spaced = left.replace("pick :     one of", "pick:      one of");
    assert_eq!(spaced, right.replace("last_words, \"", "last_wordz, \""));
    // No certain fix is left, so nothing changes.
    support::finish(support::fabc(folder.path()).args(["check", "steered.fab", "--fix"]));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), left);
}
