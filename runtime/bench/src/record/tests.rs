//! Where a rollout counts as stopped, how it then ended, and what makes a folder that of another rollout.
#![allow(clippy::unwrap_used)]

use super::*;
use fab_program::Comparison;
use serde_json::json;

fn goal() -> Goal {
    Goal {
        metric: GoalMetric::NormalizedImprovement,
        is: Comparison::Greater,
        limit: 0.95,
    }
}

/// A rollout of these improvements; the last step ended it where `outcome` is a failure.
fn record(improvements: &[f64], outcome: Outcome) -> Record {
    let failed = !matches!(outcome, Outcome::GoalReached | Outcome::HorizonReached);
    let mut steps: Vec<Step> = improvements
        .iter()
        .map(|improvement| Step {
            is_taken: true,
            improvement: Some(*improvement),
            ..Step::default()
        })
        .collect();
    if failed {
        steps.push(Step::default());
    }
    Record {
        coverage_source: Some(CoverageSource::Particles),
        is_goal_judged: true,
        operator: None,
        outcome,
        steps,
        last: None,
    }
}

/// Improvements, how the rollout ended, after how many actions one looks, whether with the stop; how many steps
/// count then, and how it then ended.
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
        let record = record(improvements, ended);
        let stop = stops.then_some(&goal);
        let what = format!("{improvements:?} after {horizon}, stop {stops}");
        assert_eq!(record.steps_to(horizon, stop).len(), n_steps, "{what}");
        assert_eq!(
            record.outcome_at(horizon, Some(&goal), stop),
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
    let record = record(&[0.99, 0.99], Outcome::HorizonReached);
    assert_eq!(record.steps_to(u32::MAX, Some(&distance)).len(), 2);
    let outcome = record.outcome_at(u32::MAX, Some(&distance), Some(&distance));
    assert_eq!(outcome, Outcome::HorizonReached);
}

fn identity() -> Identity {
    Identity {
        program: "p".to_owned(),
        params: "w".to_owned(),
        code: "c".to_owned(),
        start: "s".to_owned(),
        models: ["m", "m"].map(|name| json!(name)),
        horizon: 3,
        early_stop: true,
        repetition: 1,
    }
}

fn header() -> Value {
    json!({
        "type": "header", "program": "p", "params": "w", "code": "c", "start": { "digest": "s" },
        "models": { "vision": "m", "text": "m" },
        "horizon": 3, "early_stop": true, "repetition": 1,
    })
}

#[test]
fn every_part_of_an_identity_tells_rollouts_apart() {
    assert_eq!(identity().difference(&header()), None);
    for (pointer, name) in [
        ("/program", "program"),
        ("/params", "params"),
        ("/code", "code"),
        ("/start/digest", "start"),
        ("/models/vision", "vision model"),
        ("/models/text", "text model"),
        ("/horizon", "horizon"),
        ("/early_stop", "early_stop"),
        ("/repetition", "repetition"),
    ] {
        let mut other = header();
        *other.pointer_mut(pointer).unwrap() = json!("other");
        let said = identity().difference(&other).unwrap();
        assert!(
            said.starts_with(&format!("its {name} is `other`")),
            "{said}"
        );
    }
}

#[test]
fn folders_are_read_for_what_they_hold() {
    let folder = tempfile::tempdir().unwrap();
    let find = |lines: &[Value]| {
        let text: Vec<String> = lines.iter().map(|line| format!("{line}\n")).collect();
        std::fs::write(folder.path().join(JOURNAL_FILE), text.concat()).unwrap();
        super::find(folder.path(), &identity())
    };
    let step = json!({
        "type": "step", "step": 1, "attempts": [{}, {}], "executed": {}, "normalized_improvement": 0.25,
        "normalized_improvement_true": 0.5, "coverage": 0.7,
    });
    // Of a step that was done again when the rollout was gone on with, the first time counts.
    let spent = "{\"type\":\"begin\",\"run_id\":\"r\"}\n\
        {\"type\":\"step\",\"step\":1,\"seconds\":{\"act\":0.5,\"observe\":0.25},\"planning_s\":0.125,\"cost_usd_so_far\":0.5}\n\
        {\"type\":\"step\",\"step\":1,\"seconds\":{\"act\":9.0},\"planning_s\":9.0,\"cost_usd_so_far\":0.75}\n";
    std::fs::write(folder.path().join(SPENT_FILE), spent).unwrap();
    let end = json!({ "type": "end", "report": { "outcome": "horizon_reached" }, "final": null });
    assert_eq!(
        super::find(&folder.path().join("none"), &identity()),
        Found::Unfinished
    );
    assert_eq!(find(&[]), Found::Unfinished);
    assert_eq!(find(&[header(), step.clone()]), Found::Unfinished);
    let Found::Finished(record) = find(&[header(), step.clone(), end.clone()]) else {
        panic!("a rollout with an end line has ended");
    };
    let expected = Step {
        is_taken: true,
        queries: 2,
        coverage: Some(0.7),
        improvement: Some(0.25),
        improvement_true: Some(0.5),
        seconds: 0.75,
        planning_s: Some(0.125),
        cost_usd: Some(0.5),
    };
    assert_eq!((record.steps, record.last), (vec![expected], None));
    for stopped in ["interrupted", "budget_exhausted"] {
        let end = json!({ "type": "end", "report": { "outcome": stopped }, "final": null });
        assert_eq!(find(&[header(), end]), Found::Unfinished, "{stopped}");
    }
    let lost =
        json!({ "type": "end", "report": { "outcome": "horizon_reached" }, "final": "gone.npy" });
    assert_eq!(find(&[header(), step, lost]), Found::Unfinished);
}
