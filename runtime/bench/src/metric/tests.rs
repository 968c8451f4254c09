//! Tests of metrics on a rollout: each case is a metric, with its values after one step and after all.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::record::Rollout;
use serde_json::{Value, json};

/// A question and its result.
fn asked(result: Value) -> Value {
    json!({
        "stage": "plan", "attempt": 1, "request_key": "k", "request": "r", "prompt": "p", "reply": "a",
        "result": result,
    })
}

fn action(verdict: Value) -> Value {
    asked(json!({ "finding": "action", "fields": [], "verdict": verdict }))
}

fn step(attempts: &[Value], coverage: f64, improvement: f64) -> Step {
    let grip = json!({ "pick": [0.0, 0.0, 0.0], "place": [0.0, 0.0, 0.0], "grasp": "missed" });
    let line = json!({
        "step": 1, "scene": null, "attempts": attempts, "coverage": coverage,
        "normalized_improvement": improvement, "normalized_improvement_true": improvement - 0.1,
        "executed": { "grips": [grip], "duration_s": 1.0 }, "files": {},
    });
    Step {
        line: serde_json::from_value(line).unwrap(),
        ..Step::default()
    }
}

/// Two steps: in the first, one answer is refused, the second cannot be read, the third is taken; in the second, one
/// answer is taken.
fn played() -> Played {
    let refused = action(json!({
        "verdict": "reject", "check": "moves", "values": [], "message": "Nothing would be folded.",
    }));
    let unread =
        asked(json!({ "finding": "malformed", "field": "pick", "message": "Name a point." }));
    let taken = action(json!({ "verdict": "accept" }));
    let report = json!({
        "task": "t", "outcome": "horizon_reached", "goal_reached": false, "coverage_source": "particles",
        "operator": { "reached": true, "why": null, "words": null }, "steps": 2,
        "skipped_steps": 0, "skipped": {}, "retries": 0, "queries": 4, "refusals": { "moves": 1 },
        "malformed_replies": 1, "policy": "m (stand-in)", "sees_particles": false, "model": "m", "model_is_stand_in": true, "program": "p", "world": "sim", "params": "w",
    });
    Played {
        entry: 0,
        start: 0,
        rollout: Rollout {
            report: serde_json::from_value(report).unwrap(),
            steps: vec![
                step(&[refused, unread, taken.clone()], 0.8, 0.5),
                step(&[taken], 0.9, 0.75),
            ],
            last: None,
        },
        distances: [(1.0, 0.012, 0.005), (0.9, 0.034, 0.006)]
            .map(|(fold_fraction, mean_m, shape_m)| ExpertDistance {
                fold_fraction,
                mean_m,
                shape_m,
            })
            .to_vec(),
    }
}

#[test]
fn values_are_read_as_the_rows_say() {
    for (name, after_one, after_all) in [
        ("mean_particle_distance_mm", Some(12.0), Some(12.0)),
        (
            "mean_particle_distance_mm_gamma_0.9",
            Some(34.0),
            Some(34.0),
        ),
        ("shape_distance_mm", Some(5.0), Some(5.0)),
        ("normalized_improvement_source", Some(0.5), Some(0.75)),
        ("normalized_improvement_true", Some(0.4), Some(0.65)),
        (
            "normalized_improvement_source_without_stop",
            Some(0.5),
            Some(0.75),
        ),
        ("normalized_improvement_picture", None, None),
        ("covered_0.85_source", Some(0.0), Some(1.0)),
        ("covered_0.85_picture", None, None),
        ("picks_refused", Some(1.0), Some(0.5)),
        ("goal_reached", Some(0.0), Some(0.0)),
        ("reached_by_operator", Some(1.0), Some(1.0)),
    ] {
        let metric = Metric::find(name).unwrap();
        let values = [1, u32::MAX].map(|cut| metric.value(&played(), cut, None));
        assert_eq!(values, [after_one, after_all], "{name}");
    }
}
