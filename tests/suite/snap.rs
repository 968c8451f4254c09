//! `fabc snap`: what it pins, what a change makes pending, and what it leaves alone.

mod edits;
mod refusals;
mod scenes;

use super::support::{Captured, bring_library, fabc, finish};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder with a task that folds a small cloth once, and the task's base; all files are written there.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    fs::write(folder.path().join("half.fab"), TASK).unwrap();
    folder
}

/// The number of its snapshots: two stages of the task and its five ablations, the scene, the two pictures.
const ALL: usize = 15;

const TASK: &str = "\
use \"lib/folding.fab\"

task half extends folding {
    cloth grid(28, 28)
    subgoals { demonstrate { fold corner(back_left) -> corner(front_left) } }
}
";

fn snap(folder: &Path, arguments: &[&str]) -> Captured {
    finish(fabc(folder).arg("snap").args(arguments))
}

fn snapshots(folder: &Path) -> PathBuf {
    folder.join("snapshots")
}

/// The names of all snapshot files with this ending, without the ending.
fn named(folder: &Path, ending: &str) -> BTreeSet<String> {
    let Ok(entries) = fs::read_dir(snapshots(folder)) else {
        return BTreeSet::new();
    };
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let names = names.filter_map(|name| Some(name.strip_suffix(ending)?.to_owned()));
    names.collect()
}

fn accept_all(folder: &Path) {
    for ending in [".snap.new.png", ".snap.new"] {
        for name in named(folder, ending) {
            let to = format!("{name}{}", ending.replace(".new", ""));
            let file = snapshots(folder);
            fs::rename(file.join(format!("{name}{ending}")), file.join(to)).unwrap();
        }
    }
}

fn accepted(folder: &Path) {
    let said = snap(folder, &["half.fab"]);
    assert_eq!(said.code, 0, "{}", said.stderr);
    accept_all(folder);
}

fn edit(file: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(file).unwrap();
    assert_eq!(text.matches(from).count(), 1, "{from}");
    fs::write(file, text.replace(from, to)).unwrap();
}
