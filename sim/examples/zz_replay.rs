//! Replays recorded folding demonstrations and prints how far the cloth ends from the recorded end.
//!
//! `FABC_REFERENCE_DATA=... cargo run --release --example replay -- [TASK[/ID]]... [NAME=VALUE]...`
//! where `NAME=VALUE` replaces one of the solver's parameters.

#[path = "../tests/recorded/mod.rs"]
mod recorded;

use recorded::{Demonstration, mean_distance_mm, replay};
use sim::{Params, RestShortcut};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

struct Outcome {
    error_mm: f64,
    as_recorded: usize,
    picks: usize,
    steps: u64,
    secs: f64,
}

fn main() {
    let Some(mut demos) = recorded::demonstrations("the replay") else {
        return;
    };
    let mut values = serde_json::to_value(Params::default()).expect("parameters are plain numbers");
    let mut wanted = Vec::new();
    let mut verbose = false;
    let mut threads = 1;
    for argument in std::env::args().skip(1) {
        if argument == "--each" {
            verbose = true;
        } else if let Some(number) = argument.strip_prefix("--threads=") {
            threads = number.parse().expect("`--threads` takes a number");
        } else if let Some((name, value)) = argument.split_once('=') {
            values[name] = serde_json::from_str(value).expect("a parameter's value is a number");
        } else {
            wanted.push(argument);
        }
    }
    let params: Params = serde_json::from_value(values).expect("only known parameters");
    if !wanted.is_empty() {
        demos.retain(|demo| {
            let name = format!("{}/{:02}", demo.task, demo.id);
            wanted
                .iter()
                .any(|w| name.starts_with(w.as_str()) || name.ends_with(&format!("/{w}")))
        });
    }
    let outcomes = replay_all(&demos, &params, threads);
    if verbose {
        for (demo, outcome) in demos.iter().zip(&outcomes) {
            println!(
                "{:20} {:02}  {:7.2} mm  grasps {}/{}  {} steps  {:.2} s",
                demo.task,
                demo.id,
                outcome.error_mm,
                outcome.as_recorded,
                outcome.picks,
                outcome.steps,
                outcome.secs
            );
        }
    }
    for task in ["AllCornersInward", "CornersEdgesInward", "DoubleStraight"] {
        let of_task: Vec<&Outcome> = demos
            .iter()
            .zip(&outcomes)
            .filter(|(demo, _)| demo.task == task)
            .map(|(_, o)| o)
            .collect();
        if !of_task.is_empty() {
            print_task(task, &of_task);
        }
    }
}

fn replay_all(demos: &[Demonstration], params: &Params, threads: usize) -> Vec<Outcome> {
    let next = AtomicUsize::new(0);
    let mut outcomes: Vec<(usize, Outcome)> = std::thread::scope(|scope| {
        let worker = || {
            let mut done = Vec::new();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(demo) = demos.get(index) else {
                    return done;
                };
                done.push((index, measure(demo, params)));
            }
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        workers
            .into_iter()
            .flat_map(|w| w.join().expect("a replay does not panic"))
            .collect()
    });
    outcomes.sort_by_key(|(index, _)| *index);
    outcomes.into_iter().map(|(_, outcome)| outcome).collect()
}

fn measure(demo: &Demonstration, params: &Params) -> Outcome {
    let began = Instant::now();
    let (cloth, grasped) = replay(demo, params, RestShortcut::Skip);
    Outcome {
        error_mm: mean_distance_mm(&cloth.positions(), &demo.end),
        as_recorded: grasped
            .iter()
            .zip(&demo.picked)
            .filter(|(g, p)| **g == Some(**p))
            .count(),
        picks: grasped.len(),
        steps: cloth.steps(),
        secs: began.elapsed().as_secs_f64(),
    }
}

fn print_task(task: &str, outcomes: &[&Outcome]) {
    let n = outcomes.len() as f64;
    let mean = outcomes.iter().map(|o| o.error_mm).sum::<f64>() / n;
    let variance = outcomes
        .iter()
        .map(|o| (o.error_mm - mean).powi(2))
        .sum::<f64>()
        / n;
    let max = outcomes.iter().map(|o| o.error_mm).fold(0.0, f64::max);
    let as_recorded: usize = outcomes.iter().map(|o| o.as_recorded).sum();
    let picks: usize = outcomes.iter().map(|o| o.picks).sum();
    let steps: u64 = outcomes.iter().map(|o| o.steps).sum();
    let secs: f64 = outcomes.iter().map(|o| o.secs).sum();
    println!(
        "{task:20} n {n:2}  mean {mean:6.2} mm  sd {:5.2}  max {max:6.2}  recorded grasps {as_recorded}/{picks}  {:.2} s a demo, {:.2} ms a step",
        variance.sqrt(),
        secs / n,
        1000.0 * secs / steps as f64
    );
}
