//! Tests of where a rollout counts as stopped, how it then ended, and what identifies another rollout.
#![allow(clippy::unwrap_used)]

use super::*;
use fab_agent::record::{RECORD_FILE, SPENT_FILE};
use fab_model::calls::Spent;
use fab_program::{Comparison, Metric as GoalMetric};
use serde_json::{Value, json};

fn goal() -> Goal {
    Goal {
        metric: GoalMetric::NormalizedImprovement,
        is: Comparison::Greater,
        limit: 0.95,
    }
}

fn report(outcome: &str) -> Value {
    json!({
        "task": "t", "outcome": outcome, "goal_reached": false, "coverage_source": "particles",
        "steps": 1, "skipped_steps": 0, "skipped": {}, "retries": 0, "queries": 2, "refusals": {},
        "malformed_replies": 0, "policy": "m (stand-in)", "sees_particles": false, "model": "m", "model_is_stand_in": true, "program": "p", "world": "sim", "params": "w",
    })
}

fn step(improvement: Option<f64>) -> Value {
    let point = [0.0, 0.0, 0.0];
    let grip = json!({ "pick": point, "place": point, "grasp": "missed" });
    let executed = json!({ "grips": [grip], "duration_s": 1.0 });
    json!({
        "type": "step", "step": 1, "scene": null, "attempts": [], "executed": improvement.map(|_| executed),
        "normalized_improvement": improvement, "files": {},
    })
}

/// A rollout with these improvements; the last step ended it if `outcome` is a failure.
fn rollout(improvements: &[f64], outcome: Outcome) -> Rollout {
    let failed = !matches!(outcome, Outcome::GoalReached | Outcome::HorizonReached);
    let mut lines: Vec<Value> = improvements.iter().map(|it| step(Some(*it))).collect();
    if failed {
        lines.push(step(None));
    }
    let steps = lines.into_iter().map(|line| Step {
        line: serde_json::from_value(line).unwrap(),
        ..Step::default()
    });
    Rollout {
        report: serde_json::from_value(report(outcome.name())).unwrap(),
        steps: steps.collect(),
        last: None,
    }
}

/// Improvements, outcome, horizon, whether with the stop; then the number of steps that count and the resulting
/// outcome.
type Case<'c> = (&'c [f64], Outcome, u32, bool, usize, Outcome);

#[test]
fn rollouts_stop_at_the_first_step_that_meets_the_goal() {
    use Outcome::{AttemptsExhausted, GoalReached, HorizonReached};
    let rises = [0.2, 0.96, 0.5, 0.97];
    let cases: [Case<'_>; 11] = [
        (&rises, GoalReached, 1, true, 1, HorizonReached),
        (&rises, GoalReached, 2, true, 2, GoalReached),
        (&rises, GoalReached, 3, true, 2, GoalReached),
        (&rises, GoalReached, 4, true, 2, GoalReached),
        (&rises, GoalReached, 3, false, 3, HorizonReached),
        (&rises, GoalReached, 4, false, 4, GoalReached),
        (&[0.1, 0.2], HorizonReached, 2, true, 2, HorizonReached),
        (&[0.1, 0.95], HorizonReached, 9, true, 2, HorizonReached),
        (&[0.1, 0.99], AttemptsExhausted, 9, true, 2, GoalReached),
        (
            &[0.1, 0.99],
            AttemptsExhausted,
            9,
            false,
            3,
            AttemptsExhausted,
        ),
        (&[0.1, 0.2], AttemptsExhausted, 2, true, 2, HorizonReached),
    ];
    let goal = goal();
    for (improvements, ended, horizon, stops, n_steps, outcome) in cases {
        let rollout = rollout(improvements, ended);
        let stop = stops.then_some(&goal);
        let what = format!("{improvements:?} after {horizon}, stop {stops}");
        assert_eq!(rollout.steps_to(horizon, stop).len(), n_steps, "{what}");
        assert_eq!(
            rollout.outcome_at(horizon, Some(&goal), stop),
            outcome,
            "{what}"
        );
    }
}

#[test]
fn a_goal_that_is_judged_in_the_end_stops_nothing() {
    let distance = Goal {
        metric: GoalMetric::ParticleDistance,
        is: Comparison::Less,
        limit: 0.04,
    };
    let rollout = rollout(&[0.99, 0.99], Outcome::HorizonReached);
    assert_eq!(rollout.steps_to(u32::MAX, Some(&distance)).len(), 2);
    let outcome = rollout.outcome_at(u32::MAX, Some(&distance), Some(&distance));
    assert_eq!(outcome, Outcome::HorizonReached);
}

fn model() -> Value {
    let lowering = json!({ "points": "coordinates", "unit": "pixels", "order": "xy", "multiples_of_px": null });
    json!({ "name": "m", "nature": "stand_in", "lowering": lowering, "omits": [] })
}

fn policy() -> Value {
    let models = json!({ "vision": model(), "text": model() });
    json!({ "kind": "prompted", "name": "m", "sees_particles": false, "models": models, "code": null })
}

fn identity() -> Identity {
    Identity {
        program: "p".to_owned(),
        vary: AxisValues([("size".to_owned(), 1.05)].into()),
        params: "w".to_owned(),
        code: "c".to_owned(),
        start: "s".to_owned(),
        policy: serde_json::from_value(policy()).unwrap(),
        horizon: 3,
        early_stop: true,
        repetition: 1,
        drawn_for: Some(4),
    }
}

fn header() -> Value {
    json!({
        "type": "header", "schema": 4, "fabc": "0", "task": "t", "program": "p", "program_file": "program.json",
        "world": "sim", "params": "w", "code": "c", "vary": {"size": 1.05}, "policy": policy(),
        "start": {
            "name": "flat", "file": "start.npy", "digest": "s", "up": "z",
            "grid": { "dimx": 2, "dimy": 2, "spacing_m": 0.01 },
        },
        "subgoals": "drawn", "subgoal_pictures": "d", "horizon": 3, "early_stop": true, "repetition": 1, "drawn_for": 4, "attempts": 3,
    })
}

#[test]
fn every_part_of_an_identity_tells_rollouts_apart() {
    let difference =
        |header: Value| identity().difference(&serde_json::from_value(header).unwrap());
    assert_eq!(difference(header()), None);
    for (pointer, other, name) in [
        ("/program", json!("other"), "program"),
        ("/vary/size", json!(1.06), "vary"),
        ("/vary", json!({}), "vary"),
        ("/params", json!("other"), "params"),
        ("/code", json!("other"), "code"),
        ("/start/digest", json!("other"), "start"),
        ("/policy/name", json!("other"), "policy"),
        ("/policy/models/vision/name", json!("other"), "policy"),
        ("/policy/sees_particles", json!(true), "policy"),
        ("/horizon", json!(9), "horizon"),
        ("/early_stop", json!(false), "early_stop"),
        ("/repetition", json!(9), "repetition"),
        ("/drawn_for", json!(9), "drawn_for"),
        ("/drawn_for", Value::Null, "drawn_for"),
    ] {
        let mut changed = header();
        *changed.pointer_mut(pointer).unwrap() = other;
        let why = difference(changed).unwrap();
        let begins = format!("it is not what the suite asks for: it differs in `{name}");
        assert!(why.starts_with(&begins), "{why}");
        assert_eq!(
            why.contains("--share-answers"),
            name == "drawn_for",
            "{why}"
        );
    }
}

#[test]
fn folders_are_read_for_what_they_hold() {
    let folder = tempfile::tempdir().unwrap();
    let find = |lines: &[Value]| {
        let text: Vec<String> = lines.iter().map(|line| format!("{line}\n")).collect();
        std::fs::write(folder.path().join(RECORD_FILE), text.concat()).unwrap();
        super::find(folder.path(), &identity())
    };
    // If a step was repeated when the rollout was resumed, the first time counts.
    let spent = |seconds: Value, planning_s: f64, cost: u64| {
        let so_far = Spent {
            cost: Usd::from_nano(cost),
            ..Spent::default()
        };
        json!({ "type": "step", "step": 1, "seconds": seconds, "planning_s": planning_s, "so_far": so_far })
    };
    let first = spent(json!({ "act": 0.5, "observe": 0.25 }), 0.125, 500_000_000);
    let again = spent(json!({ "act": 9.0 }), 9.0, 750_000_000);
    std::fs::write(
        folder.path().join(SPENT_FILE),
        format!("{first}\n{again}\n"),
    )
    .unwrap();
    let end = |outcome: &str, file: Option<&str>| json!({ "type": "end", "report": report(outcome), "final": file });
    let step = step(Some(0.25));
    assert_eq!(
        super::find(&folder.path().join("none"), &identity()),
        FolderContents::Unfinished
    );
    assert_eq!(find(&[]), FolderContents::Unfinished);
    assert_eq!(find(&[header(), step.clone()]), FolderContents::Unfinished);
    let found = find(&[header(), step.clone(), end("horizon_reached", None)]);
    let FolderContents::Finished(rollout) = found else {
        panic!("a rollout with an end line has ended: {found:?}");
    };
    assert_eq!((rollout.steps.len(), rollout.last), (1, None));
    let first = &rollout.steps[0];
    assert_eq!(first.line.measures.normalized_improvement, Some(0.25));
    assert_eq!((first.spent.took_s(), first.cost_usd), (0.75, Some(0.5)));
    assert_eq!(first.spent.planning_s, Some(0.125));
    for stopped in ["interrupted", "budget_exhausted"] {
        assert_eq!(
            find(&[header(), end(stopped, None)]),
            FolderContents::Unfinished,
            "{stopped}"
        );
    }
    let lost = end("horizon_reached", Some("gone.npy"));
    assert_eq!(find(&[header(), step, lost]), FolderContents::Unfinished);
    let mut newer = header();
    newer["schema"] = json!(5);
    let FolderContents::Other(why) = find(&[newer]) else {
        panic!("lines of another version are not written over");
    };
    assert_eq!(
        why,
        "its lines have version 5, and this program reads version 4"
    );
}
