//! A step whose result does not resemble the next subgoal is asked again, a limited number of times.

use super::support::{self, Careless, Trial, words_of};
use fab_agent::rollout::{Ended, Event};
use fab_model::{Models, Part, Request};
use fab_program::Program;
use fab_world::Look;
use serde_json::Value;
use std::sync::Mutex;

struct Played {
    report: Ended,
    asked: Vec<Request>,
    /// The result of each action in the journal.
    results: Vec<Value>,
    /// Number and step of each action that was told, and of each that is said to follow.
    told: Vec<[u32; 2]>,
    again: Vec<[u32; 2]>,
}

fn play(program: &Program, wrong: u32) -> Played {
    let folder = tempfile::tempdir().unwrap();
    let trial = Trial::new(program, folder.path(), Look::default());
    let wrong = Mutex::new(wrong);
    let model = Careless::where_wrong(|_| {
        let mut left = wrong.lock().unwrap();
        let is_wrong = *left > 0;
        *left = left.saturating_sub(1);
        is_wrong
    });
    let models = Models {
        vision: &model,
        text: &model,
    };
    let run = folder.path().join("run");
    let (mut told, mut again) = (Vec::new(), Vec::new());
    let report = trial.run(models, &run, &mut |event| match event {
        Event::Motion { at, .. } => told.push([at.action, at.step]),
        // A step that has a picture already is taken again.
        Event::Picture { at, .. } if at.action > 1 && told.last().unwrap()[1] == at.step => {
            again.push([at.action, at.step]);
        }
        _ => {}
    });
    let journal = std::fs::read_to_string(run.join("rollout.jsonl")).unwrap();
    let lines = journal
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap());
    let steps = lines.filter(|line| line.get("step").is_some_and(|step| !step.is_null()));
    Played {
        report,
        results: steps.map(|line| line["result"].clone()).collect(),
        asked: model.asked.into_inner().unwrap(),
        told,
        again,
    }
}

/// A small task whose steps are compared with their subgoals, loosely because of the small pack.
fn looking() -> Program {
    let mut program = support::small_task();
    program.verify.result = support::task("double_triangle").verify.result;
    program.verify.result.as_mut().unwrap().overlap_above = 0.6;
    program
}

fn pictures(request: &Request) -> Vec<&[u8]> {
    let parts = request.messages.iter().flat_map(|message| &message.parts);
    parts
        .filter_map(|part| match part {
            Part::Image(png) => Some(png.bytes()),
            Part::Text(_) => None,
        })
        .collect()
}

#[test]
#[ignore = "long"]
fn a_step_that_failed_is_asked_again_from_the_new_picture_and_told_so() {
    let played = play(&looking(), 1);
    let steps: Vec<_> = played
        .results
        .iter()
        .map(|result| (result["subgoal"].as_u64(), result["is_enough"].as_bool()))
        .collect();
    assert_eq!(steps[0], (Some(1), Some(false)), "{:?}", played.results);
    assert_eq!(steps[1].0, Some(1));
    assert!(played.report.retries >= 1, "{:?}", played.report);
    assert_eq!(
        played.report.steps,
        2 + played.report.retries,
        "each retry is an action more"
    );
    assert_eq!(played.told[..2], [[1, 1], [2, 1]]);
    assert_eq!(played.again[0], [2, 1]);
    assert_eq!(played.again.len(), played.report.retries as usize);
    let [describe, plan, again, anew] = &played.asked[..4] else {
        panic!("two stages, asked twice")
    };
    assert!(
        !words_of(describe).contains("tried already") && !words_of(plan).contains("tried already")
    );
    let overlap = played.results[0]["overlap"].as_f64().unwrap() * 100.0;
    for request in [again, anew] {
        let told = format!("overlapped only {overlap:.0}%");
        assert!(words_of(request).contains(&told), "{}", words_of(request));
    }
    assert_eq!(
        pictures(describe),
        pictures(again),
        "the same step is shown"
    );
    assert_ne!(
        words_of(plan),
        words_of(anew),
        "the cloth lies otherwise now"
    );
}

#[test]
fn a_step_that_went_well_is_not_asked_again() {
    let played = play(&looking(), 0);
    assert_eq!((played.report.retries, played.report.steps), (0, 2));
    assert!(played.again.is_empty());
    assert!(
        played
            .results
            .iter()
            .all(|result| result["is_enough"] == true),
        "{:?}",
        played.results
    );
}

#[test]
#[ignore = "long"]
fn a_model_that_is_always_wrong_costs_a_bounded_number_of_actions() {
    let mut program = looking();
    program.verify.result.as_mut().unwrap().overlap_above = 0.95;
    let played = play(&program, u32::MAX);
    assert_eq!((played.report.retries, played.report.steps), (2, 4));
    program.verify.result.as_mut().unwrap().retries = 3;
    let played = play(&program, u32::MAX);
    assert_eq!((played.report.retries, played.report.steps), (6, 8));
}

#[test]
fn a_task_that_does_not_look_at_results_goes_on() {
    let played = play(&support::small_task(), 1);
    assert_eq!((played.report.retries, played.report.steps), (0, 2));
    assert!(played.results.iter().all(Value::is_null));
}
