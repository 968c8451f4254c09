//! Recorded folding demonstrations, replayed open loop: the cloth must end near where PyFleX's cloth ended.

use crate::recorded;
use crate::recorded::{mean_distance_mm, replay};
use fab_sim::{Params, RestShortcut};

/// Replays the demonstrations of a task with the given ids (all if empty); returns the errors, millimetres.
fn errors_mm(test: &str, task: &str, ids: &[u64]) -> Option<Vec<f64>> {
    let demos = recorded::demonstrations(test)?;
    let wanted = demos
        .iter()
        .filter(|demo| demo.task == task && (ids.is_empty() || ids.contains(&demo.id)));
    let errors: Vec<f64> = wanted
        .map(|demo| {
            let (cloth, grasped) = replay(demo, &Params::default(), RestShortcut::Skip);
            assert!(
                grasped.iter().all(Option::is_some),
                "{task} {} missed a grasp",
                demo.id
            );
            mean_distance_mm(&cloth.positions(), &demo.end)
        })
        .collect();
    println!("{task}: {errors:.2?} mm");
    Some(errors)
}

fn mean(errors: &[f64]) -> f64 {
    errors.iter().sum::<f64>() / errors.len() as f64
}

fn max(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |a, &b| a.max(b))
}

#[test]
fn one_demonstration_of_each_task_ends_near_the_recorded_end() {
    for (task, limit_mm) in [
        ("AllCornersInward", 3.0),
        ("CornersEdgesInward", 5.0),
        ("DoubleStraight", 35.0),
    ] {
        let Some(errors) = errors_mm(
            "one_demonstration_of_each_task_ends_near_the_recorded_end",
            task,
            &[10],
        ) else {
            return;
        };
        assert_eq!(errors.len(), 1);
        assert!(errors[0] < limit_mm, "{task}: {} mm", errors[0]);
    }
}

#[test]
#[ignore = "long"]
fn skipping_resting_steps_changes_no_bit_of_a_replay() {
    let Some(demos) = recorded::demonstrations("skipping_resting_steps_changes_no_bit_of_a_replay")
    else {
        return;
    };
    let demo = demos
        .iter()
        .find(|demo| demo.task == "CornersEdgesInward")
        .unwrap();
    let [skipped, computed] = [RestShortcut::Skip, RestShortcut::Compute]
        .map(|shortcut| replay(demo, &Params::default(), shortcut).0.digest());
    assert_eq!(skipped, computed);
}

#[test]
#[ignore = "long"]
fn all_demonstrations_end_near_the_recorded_ends() {
    for (task, mean_mm, max_mm) in [
        ("AllCornersInward", 1.7, 4.0),
        ("CornersEdgesInward", 2.7, 6.0),
        ("DoubleStraight", 20.0, 40.0),
    ] {
        let Some(errors) = errors_mm(
            "long_all_demonstrations_end_near_the_recorded_ends",
            task,
            &[],
        ) else {
            return;
        };
        assert_eq!(errors.len(), 20);
        assert!(mean(&errors) < mean_mm, "{task}: mean {} mm", mean(&errors));
        assert!(max(&errors) < max_mm, "{task}: max {} mm", max(&errors));
    }
}
