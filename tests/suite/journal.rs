//! The run folder: complete lines, nothing overwritten, and enough data to recompute the result.

use super::support::{self, Scripted, Trial};
use fab_agent::journal::RunFolder;
use fab_agent::rollout::{Ended, Event};
use fab_base::cache::Cache;
use fab_model::Models;
use fab_sim::{Params, Simulator};
use fab_standins::Geometric;
use fab_world::Look;
use fab_world::start::{Start, StartFrame};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;

/// Runs the small task with two expert sequences into `folder`.
fn run_small(folder: &Path) -> Ended {
    run_and_listen(folder).0
}

/// Also returns what was said of expert results.
fn run_and_listen(folder: &Path) -> (Ended, Vec<String>) {
    let mut program = support::small_task();
    program.experts = support::task("double_triangle").experts[..2].to_vec();
    let mut trial = Trial::new(&program, folder, Look::default());
    trial.cache = Cache::at(folder.join("cache"));
    let models = Models {
        vision: &Geometric,
        text: &Geometric,
    };
    let mut said = Vec::new();
    let ended = trial.run(models, &folder.join("run"), &mut |event| match event {
        Event::Note { note } if note.starts_with("simulating") => said.push(note),
        _ => {}
    });
    (ended, said)
}

fn lines(run: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(run.join("rollout.jsonl")).unwrap();
    assert!(text.ends_with('\n'), "the last line is not whole");
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

#[test]
#[ignore = "long"]
fn every_file_that_the_journal_names_is_there_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    run_small(folder.path());
    let run = folder.path().join("run");
    let lines = lines(&run);
    assert_eq!(lines[0]["type"], "header");
    assert_eq!(lines.last().unwrap()["type"], "end");
    assert_eq!(
        lines.iter().filter(|line| line["type"] == "step").count(),
        2
    );
    let text = serde_json::to_string(&lines).unwrap();
    let mut named = Vec::new();
    lines.iter().for_each(|line| names(line, &mut named));
    assert!(named.len() > 20, "{named:?}");
    for name in named {
        assert!(
            run.join(&name).is_file(),
            "the journal names `{name}`, which is not there"
        );
    }
    let mut files = Vec::new();
    list(&run, &run, &mut files);
    for file in files {
        let image = file
            .strip_prefix("images/")
            .and_then(|name| name.strip_suffix(".png"));
        let named = match image {
            // A request names a picture by its hash.
            Some(hash) => requests(&run, &lines).any(|request| request.contains(hash)),
            None => {
                ["rollout.jsonl", "spent.jsonl", "start.json"].contains(&file.as_str())
                    || text.contains(&format!("\"{file}\""))
            }
        };
        assert!(named, "no line of the journal names `{file}`");
    }
}

/// Collects every text in a line that looks like a file of the run.
fn names(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::String(text)
            if [".png", ".npy", ".json", ".txt"]
                .iter()
                .any(|end| text.ends_with(end)) =>
        {
            found.push(text.clone());
        }
        Value::Array(values) => values.iter().for_each(|value| names(value, found)),
        Value::Object(entries) => entries.values().for_each(|value| names(value, found)),
        _ => {}
    }
}

fn requests<'a>(run: &'a Path, lines: &'a [Value]) -> impl Iterator<Item = String> + 'a {
    let attempts = lines
        .iter()
        .filter_map(|line| line["attempts"].as_array())
        .flatten();
    attempts.map(|attempt| {
        std::fs::read_to_string(run.join(attempt["request"].as_str().unwrap())).unwrap()
    })
}

fn list(root: &Path, folder: &Path, files: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            list(root, &path, files);
        } else {
            files.push(path.strip_prefix(root).unwrap().display().to_string());
        }
    }
}

#[test]
#[ignore = "long"]
fn the_named_files_give_the_reported_distance() {
    let folder = tempfile::tempdir().unwrap();
    let report = run_small(folder.path());
    let run = folder.path().join("run");
    let end = lines(&run).pop().unwrap();
    let positions = |name: &Value| {
        let bytes = std::fs::read(run.join(name.as_str().unwrap())).unwrap();
        // .npy, format 1: a 10-byte preamble and a header, then little-endian float32.
        let body = 10 + u16::from_le_bytes([bytes[8], bytes[9]]) as usize;
        bytes[body..]
            .chunks_exact(4)
            .map(|four| f64::from(f32::from_le_bytes(four.try_into().unwrap())))
            .collect::<Vec<f64>>()
    };
    let last = positions(&end["final"]);
    let mut nearest = f64::INFINITY;
    for expert in end["experts"].as_array().unwrap() {
        let expert = positions(&expert["file"]);
        assert_eq!(expert.len(), last.len());
        let distances = last.chunks(3).zip(expert.chunks(3)).map(|(a, b)| {
            a.iter()
                .zip(b)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
                .sqrt()
        });
        nearest = nearest.min(distances.sum::<f64>() / (last.len() / 3) as f64 * 1000.0);
    }
    let reported = report.mean_particle_distance_mm.unwrap();
    assert!(
        (nearest - reported).abs() < 1e-6,
        "recomputed {nearest}, reported {reported}"
    );
}

#[test]
#[ignore = "long"]
fn every_step_has_the_digest_of_the_positions_that_it_keeps() {
    let folder = tempfile::tempdir().unwrap();
    run_small(folder.path());
    let run = folder.path().join("run");
    let lines = lines(&run);
    let frame: StartFrame = serde_json::from_value(json!({
        "dimx": lines[0]["start"]["grid"]["dimx"],
        "dimy": lines[0]["start"]["grid"]["dimy"],
        "spacing_m": lines[0]["start"]["grid"]["spacing_m"],
        "up": "z",
    }))
    .unwrap();
    let grid = fab_sim::Grid::new(28, 28, 0.00625).unwrap();
    let mut digests = BTreeSet::new();
    for line in lines.iter().filter(|line| line["type"] == "step") {
        let file = run.join(line["files"]["positions"].as_str().unwrap());
        let kept = Start::load(&file, Some(frame)).unwrap().positions;
        let cloth = Simulator::from_positions(grid, &kept, &Params::default()).unwrap();
        assert_eq!(line["digest"], cloth.digest(), "step {}", line["step"]);
        digests.insert(cloth.digest());
    }
    assert_eq!(digests.len(), 2, "two folds, two states");
}

#[test]
#[ignore = "long"]
fn expert_results_are_simulated_once() {
    let folder = tempfile::tempdir().unwrap();
    let (first, simulated) = run_and_listen(folder.path());
    assert!(
        simulated[0].starts_with("simulating 2 of 2"),
        "{simulated:?}"
    );
    std::fs::remove_dir_all(folder.path().join("run")).unwrap();
    let (second, simulated) = run_and_listen(folder.path());
    assert!(simulated.is_empty(), "{simulated:?}");
    assert_eq!(
        first.mean_particle_distance_mm,
        second.mean_particle_distance_mm
    );
}

#[test]
#[ignore = "long"]
fn a_damaged_cache_entry_is_simulated_again() {
    let folder = tempfile::tempdir().unwrap();
    let first = run_small(folder.path());
    let entry = std::fs::read_dir(folder.path().join("cache"))
        .unwrap()
        .next()
        .unwrap()
        .unwrap()
        .path();
    let bytes = std::fs::read(&entry).unwrap();
    std::fs::write(&entry, &bytes[..bytes.len() / 2]).unwrap();
    std::fs::remove_dir_all(folder.path().join("run")).unwrap();
    let (second, simulated) = run_and_listen(folder.path());
    assert!(
        simulated[0].starts_with("simulating 1 of 2"),
        "{simulated:?}"
    );
    assert_eq!(
        first.mean_particle_distance_mm,
        second.mean_particle_distance_mm
    );
}

#[test]
fn a_run_folder_with_something_in_it_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("mine.txt"), "mine").unwrap();
    let refused = RunFolder::create(folder.path()).unwrap_err().to_string();
    assert!(refused.contains("is not empty"), "{refused}");
    assert_eq!(
        std::fs::read_to_string(folder.path().join("mine.txt")).unwrap(),
        "mine"
    );
}

#[test]
fn numbered_run_folders_do_not_collide() {
    let folder = tempfile::tempdir().unwrap();
    let names: Vec<_> = (0..3)
        .map(|_| {
            RunFolder::create_next(folder.path(), "fold")
                .unwrap()
                .path()
                .to_owned()
        })
        .collect();
    assert_eq!(
        names,
        ["fold-0001", "fold-0002", "fold-0003"].map(|name| folder.path().join(name))
    );
}

#[test]
fn a_rollout_that_is_cut_off_leaves_no_end_line() {
    let folder = tempfile::tempdir().unwrap();
    let program = support::small_task();
    let trial = Trial::new(&program, folder.path(), Look::default());
    let run = folder.path().join("run");
    let models = Models {
        vision: &Geometric,
        text: &Scripted::new(&[]),
    };
    let cut = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        trial.run(models, &run, &mut |_| {
            std::panic::resume_unwind(Box::new("the power fails"))
        })
    }));
    assert!(cut.is_err());
    let lines = lines(&run);
    assert_eq!(lines[0]["type"], "header");
    assert!(lines.iter().all(|line| line["type"] != "end"));
}
