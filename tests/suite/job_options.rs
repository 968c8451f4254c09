//! What a caller may set about a rollout, and the measures and counts in its report.

use super::steered::{LEFT, RIGHT, answer, play, play_with, steered};
use super::support;
use fab_agent::outcome::Outcome;
use fab_program::Goal;
use fab_program::pointing::Notation;
use fab_program::reply;
use serde_json::Value;

/// A pull outward that the task accepts.
fn pull() -> String {
    answer(RIGHT, "0 deg", "10 mm")
}

/// A second one: after the first, the center lies to the right of the fixed point.
fn pull_back() -> String {
    answer("(112, 112)", "180 deg", "10 mm")
}

#[test]
fn a_job_may_have_fewer_or_more_steps_than_its_program() {
    let program = steered(None);
    let replies = [pull(), pull_back()];
    let replies: Vec<&str> = replies.iter().map(String::as_str).collect();
    for horizon in [0, 1, 2] {
        let played = play_with(&program, &replies, |trial| trial.horizon = Some(horizon));
        let report = played.report;
        assert_eq!(report.outcome, Outcome::HorizonReached, "{report:?}");
        assert_eq!((report.steps, report.queries), (horizon, horizon));
        assert_eq!(played.steps.len(), horizon as usize);
    }
}

#[test]
fn a_goal_that_is_reached_early_ends_the_rollout_only_where_it_shall() {
    let program = steered(Some("covered"));
    let replies = [pull(), pull_back()];
    let replies: Vec<&str> = replies.iter().map(String::as_str).collect();
    let early = play_with(&program, &replies, |trial| trial.horizon = Some(2)).report;
    assert_eq!((early.outcome, early.steps), (Outcome::GoalReached, 1));
    let late = play_with(&program, &replies, |trial| {
        trial.horizon = Some(2);
        trial.early_stop = false;
    });
    assert_eq!(
        (late.report.outcome, late.report.steps),
        (Outcome::GoalReached, 2)
    );
    let after_first = &late.steps[0]["normalized_improvement"];
    assert_eq!(after_first.as_f64(), early.measures.normalized_improvement);
    let mut beyond = program.clone();
    beyond.goal = Some(Goal {
        limit: 2.0,
        ..program.goal.clone().unwrap()
    });
    let missed = play_with(&beyond, &replies, |trial| {
        trial.horizon = Some(2);
        trial.early_stop = false;
    });
    assert_eq!(missed.report.outcome, Outcome::HorizonReached);
    assert_eq!(missed.report.goal_reached, Some(false));
}

#[test]
fn both_measures_stand_side_by_side_after_each_step() {
    let replies = [pull(), pull_back()];
    let replies: Vec<&str> = replies.iter().map(String::as_str).collect();
    let played = play_with(&steered(None), &replies, |trial| trial.horizon = Some(2));
    let report: Value = serde_json::to_value(&played.report).unwrap();
    for name in [
        "coverage",
        "coverage_true",
        "normalized_improvement",
        "normalized_improvement_true",
    ] {
        assert_eq!(report[name], played.steps[1][name], "{name}");
    }
    // A flat cloth has full coverage: exactly by the true measure, roughly by SoftGym's.
    let number = |name: &str| report[name].as_f64().unwrap();
    assert!((number("coverage_true_at_start") - 1.0).abs() < 1e-4);
    assert!((0.85..1.0).contains(&number("coverage_at_start")));
    assert!(number("coverage_true") != number("coverage"));
}

#[test]
fn every_request_holds_the_repetition_and_the_answers_that_the_scene_offers() {
    let program = steered(None);
    let reply = pull();
    let played = play_with(&program, &[&reply], |trial| {
        trial.horizon = Some(1);
        trial.repetition = 4;
    });
    let request = &played.asked[0];
    assert_eq!(request.repetition, 4);
    let schema = request.schema.as_ref().unwrap();
    let listed = |field: &str| schema["properties"][field]["enum"].as_array().unwrap();
    assert!(listed("pick").contains(&RIGHT.into()), "{schema}");
    let fixed = reply::schema_in(&program, &Notation::pixels(), &[]);
    assert_eq!(
        schema["properties"]["direction"],
        fixed["properties"]["direction"]
    );
}

#[test]
fn each_of_two_stages_gets_the_schema_of_what_it_reads() {
    let program = support::small_task();
    let reply = "Instructions: fold it.";
    let played = play_with(&program, &[reply, reply, reply, reply], |trial| {
        trial.horizon = Some(1)
    });
    let properties = [0, 1].map(|at| {
        let schema = played.asked[at].schema.as_ref().unwrap();
        let properties = schema["properties"].as_object().unwrap();
        properties.keys().cloned().collect::<Vec<_>>()
    });
    assert_eq!(
        properties,
        [vec!["instructions"], vec!["reason", "pick", "place"]]
    );
    assert_eq!(played.report.outcome, Outcome::MalformedReply);
    assert_eq!(played.report.malformed_replies, 3);
}

#[test]
fn refusals_are_counted_by_check_and_planning_is_timed() {
    let inward = answer(LEFT, "0 deg", "10 mm");
    let nowhere = answer("(1, 1)", "0 deg", "10 mm");
    let played = play(&steered(None), &[&inward, &nowhere]);
    let report = played.report;
    assert_eq!(report.outcome, Outcome::AttemptsExhausted);
    assert_eq!(report.queries, 2);
    let counts: Vec<_> = report.refusals.clone().into_iter().collect();
    assert_eq!(
        counts,
        [("offered".to_owned(), 1), ("outward".to_owned(), 1)]
    );
    let planning_s = report.took.planning_s.unwrap();
    assert!(planning_s > 0.0 && planning_s <= report.took.wall_s);
    assert_eq!(report.skipped_steps, 0);
}
