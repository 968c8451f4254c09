//! A step whose result does not resemble the next subgoal is asked again, a limited number of times.

use super::support::{self, Trial};
use fab_agent::rollout::Ended;
use fab_model::Models;
use fab_model::calls::Calls;
use fab_model::{Message, Model, ModelError, ModelKind, Part, Reply, Request, Speaker};
use fab_program::Program;
use fab_standins::Geometric;
use fab_world::Look;
use serde_json::Value;
use std::sync::Mutex;

/// The stand-in, except that its first actions all place on the center.
struct Careless {
    wrong: Mutex<u32>,
    asked: Mutex<Vec<Request>>,
}

impl Model for Careless {
    fn name(&self) -> &str {
        "careless"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        self.asked.lock().unwrap().push(request.clone());
        let reply = Geometric.ask(request, calls)?;
        let mut wrong = self.wrong.lock().unwrap();
        let Some((pick, _)) = reply
            .text
            .split_once("Place Point = ")
            .filter(|_| *wrong > 0)
        else {
            return Ok(reply);
        };
        *wrong -= 1;
        let asked = said(request);
        let (_, center) = asked.split_once("- Cloth center: ").unwrap();
        let center = center.lines().next().unwrap();
        Ok(Reply::text(format!("{pick}Place Point = {center}\n")))
    }
}

struct Played {
    report: Ended,
    asked: Vec<Request>,
    /// The result of each action in the journal.
    results: Vec<Value>,
}

fn play(program: &Program, wrong: u32) -> Played {
    let folder = tempfile::tempdir().unwrap();
    let trial = Trial::new(program, folder.path(), Look::default());
    let model = Careless {
        wrong: Mutex::new(wrong),
        asked: Mutex::default(),
    };
    let models = Models {
        vision: &model,
        text: &model,
    };
    let run = folder.path().join("run");
    let report = trial.run(models, &run, &mut |_| {});
    let journal = std::fs::read_to_string(run.join("rollout.jsonl")).unwrap();
    let lines = journal
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap());
    let steps = lines.filter(|line| line.get("step").is_some_and(|step| !step.is_null()));
    Played {
        report,
        results: steps.map(|line| line["result"].clone()).collect(),
        asked: model.asked.into_inner().unwrap(),
    }
}

/// A small task whose steps are compared with their subgoals, loosely because of the small pack.
fn looking() -> Program {
    let mut program = support::small_task();
    program.verify.result = support::task("double_triangle").verify.result;
    program.verify.result.as_mut().unwrap().overlap_above = 0.6;
    program
}

/// The message with the question.
fn question(request: &Request) -> &Message {
    let mut users = request.messages.iter();
    users
        .rfind(|message| message.speaker == Speaker::User)
        .unwrap()
}

fn said(request: &Request) -> String {
    let parts = question(request).parts.iter();
    let texts = parts.filter_map(|part| match part {
        Part::Text(text) => Some(text.as_str()),
        Part::Image(_) => None,
    });
    texts.collect::<Vec<_>>().join("\n")
}

fn pictures(request: &Request) -> Vec<&[u8]> {
    let parts = question(request).parts.iter();
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
    let [describe, plan, again, anew] = &played.asked[..4] else {
        panic!("two stages, asked twice")
    };
    assert!(!said(describe).contains("tried already") && !said(plan).contains("tried already"));
    let overlap = played.results[0]["overlap"].as_f64().unwrap() * 100.0;
    for request in [again, anew] {
        let told = format!("overlapped only {overlap:.0}%");
        assert!(said(request).contains(&told), "{}", said(request));
    }
    assert_eq!(
        pictures(describe),
        pictures(again),
        "the same step is shown"
    );
    assert_ne!(said(plan), said(anew), "the cloth lies otherwise now");
}

#[test]
fn a_step_that_went_well_is_not_asked_again() {
    let played = play(&looking(), 0);
    assert_eq!((played.report.retries, played.report.steps), (0, 2));
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
