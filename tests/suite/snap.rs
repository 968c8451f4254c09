//! `fabc snap`: what is pinned, what a change makes pending, and what is left alone.

use super::support::{Said, bring_library, fabc, finish, root};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::thread;
use std::time::Duration;
use tempfile::TempDir;

/// A folder with a task that folds a small cloth once, and its base, in which everything is written.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    fs::write(folder.path().join("half.fab"), TASK).unwrap();
    folder
}

const TASK: &str = "\
use \"lib/folding.fab\"

task half extends folding {
    cloth grid(28, 28)
    subgoals { demonstrate { fold corner(back_left) -> corner(front_left) } }
}
";

fn snap(folder: &Path, arguments: &[&str]) -> Said {
    finish(fabc(folder).arg("snap").args(arguments))
}

fn snapshots(folder: &Path) -> PathBuf {
    folder.join("snapshots")
}

/// The names of all files in the folder of snapshots that end so, without that ending.
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

#[test]
fn the_prompts_of_the_shipped_tasks_are_as_accepted() {
    let tasks = fs::read_dir(root().join("tasks")).unwrap();
    let files = tasks.map(|entry| entry.unwrap().path());
    let files: Vec<String> = files
        .filter(|path| path.extension().is_some_and(|it| it == "fab"))
        .map(|path| path.display().to_string())
        .collect();
    assert!(files.len() > 8);
    let said = finish(
        fabc(root())
            .args(["snap", "--check", "--redraw"])
            .args(&files),
    );
    assert_eq!(said.code, 0, "{}{}", said.stdout, said.stderr);
}

#[test]
fn every_stage_and_variant_is_pinned_with_its_scene_and_pictures() {
    let folder = folder();
    let said = snap(folder.path(), &["half.fab"]);
    assert_eq!(said.code, 0, "{}", said.stderr);
    let pending = named(folder.path(), ".snap.new");
    // The task and its five ablations, in two stages each; the scene; the picture with the arrow.
    assert_eq!(pending.len(), 14, "{pending:?}");
    for name in [
        "half.describe@start",
        "half.without_output_format.plan@start",
        "half@start.points",
        "half@start.subgoal_0_with_arrow",
    ] {
        assert!(pending.contains(name), "{name} is not in {pending:?}");
    }
    let picture = snapshots(folder.path()).join("half@start.subgoal_0_with_arrow.snap.new.png");
    assert_eq!(
        runtime::picture::load(&picture).unwrap().dimensions(),
        (224, 224)
    );
    assert_eq!(snap(folder.path(), &["half.fab", "--check"]).code, 1);
    accept_all(folder.path());
    let said = snap(folder.path(), &["half.fab", "--check"]);
    assert_eq!(said.code, 0, "{}{}", said.stdout, said.stderr);
}

#[test]
fn an_edit_makes_pending_what_it_touches_and_names_its_line() {
    let folder = folder();
    accepted(folder.path());
    let library = folder.path().join("lib/folding.fab");
    edit(
        &library,
        "Answer in two lines:",
        "Answer in exactly two lines:",
    );
    let checked = snap(folder.path(), &["half.fab", "--check", "--json"]);
    assert_eq!(checked.code, 1);
    assert!(named(folder.path(), ".snap.new").is_empty());
    let value: Value = serde_json::from_str(&checked.stdout).unwrap();
    // All but the variant without that component.
    assert_eq!((&value["changed"], &value["same"]), (&5.into(), &9.into()));
    assert_eq!(snap(folder.path(), &["half.fab"]).code, 0);
    let pending = named(folder.path(), ".snap.new");
    assert_eq!(pending.len(), 5, "{pending:?}");
    assert!(!pending.contains("half.without_output_format.describe@start"));
    let line = fs::read_to_string(&library).unwrap();
    let line = line
        .lines()
        .position(|line| line.contains("exactly two"))
        .unwrap()
        + 1;
    let file = snapshots(folder.path()).join("half.describe@start.snap.new");
    let text = fs::read_to_string(file).unwrap();
    assert!(
        text.contains(&format!("output_format lib/folding.fab:{line}")),
        "{text}"
    );
    // Undone, nothing waits any more.
    edit(
        &library,
        "Answer in exactly two lines:",
        "Answer in two lines:",
    );
    assert_eq!(snap(folder.path(), &["half.fab"]).code, 0);
    assert!(named(folder.path(), ".snap.new").is_empty());
}

#[test]
fn lines_that_only_move_in_their_file_change_nothing() {
    let folder = folder();
    accepted(folder.path());
    let library = folder.path().join("lib/folding.fab");
    let text = fs::read_to_string(&library).unwrap();
    fs::write(&library, format!("# One line more.\n\n{text}")).unwrap();
    assert_eq!(snap(folder.path(), &["half.fab", "--check"]).code, 0);
}

#[test]
fn other_keypoints_are_looked_for_anew_and_shown_as_a_change_of_the_scene() {
    let folder = folder();
    accepted(folder.path());
    edit(&folder.path().join("lib/folding.fab"), "max: 27", "max: 2");
    assert_eq!(snap(folder.path(), &["half.fab"]).code, 0);
    let pending = named(folder.path(), ".snap.new");
    assert!(pending.contains("half@start.points"), "{pending:?}");
    let file = snapshots(folder.path()).join("half.plan@start.snap.new");
    let text = fs::read_to_string(file).unwrap();
    let corners = text
        .lines()
        .find(|line| line.contains("Cloth corners"))
        .unwrap();
    assert_eq!(corners.matches('(').count(), 2, "{corners}");
}

#[test]
fn points_that_were_edited_by_hand_are_used_as_they_stand() {
    let folder = folder();
    accepted(folder.path());
    let scene = snapshots(folder.path()).join("half@start.points.snap");
    let text = fs::read_to_string(&scene).unwrap();
    let center = text.find("\"center\": [[").unwrap() + "\"center\": [[".len();
    let end = center + text[center..].find(']').unwrap();
    fs::write(&scene, format!("{}7,8{}", &text[..center], &text[end..])).unwrap();
    assert_eq!(snap(folder.path(), &["half.fab"]).code, 0);
    let file = snapshots(folder.path()).join("half.plan@start.snap.new");
    assert!(
        fs::read_to_string(file)
            .unwrap()
            .contains("Cloth center: (7, 8)")
    );
}

#[test]
fn more_scenes_are_kept_once_they_were_asked_for() {
    let folder = folder();
    accepted(folder.path());
    let said = snap(
        folder.path(),
        &["half.fab", "--scene", "turned", "--start", "7"],
    );
    assert_eq!(said.code, 0, "{}", said.stderr);
    assert_eq!(named(folder.path(), ".snap.new").len(), 14);
    accept_all(folder.path());
    let turned = snapshots(folder.path()).join("half.plan@turned.snap");
    let start = snapshots(folder.path()).join("half.plan@start.snap");
    assert_ne!(fs::read(turned).unwrap(), fs::read(start).unwrap());
    assert_eq!(snap(folder.path(), &["half.fab", "--check"]).code, 0);
    let library = folder.path().join("lib/folding.fab");
    edit(
        &library,
        "Answer in two lines:",
        "Answer in exactly two lines:",
    );
    assert_eq!(snap(folder.path(), &["half.fab"]).code, 0);
    assert_eq!(named(folder.path(), ".snap.new").len(), 10);
}

#[test]
fn what_nothing_declares_any_more_is_orphaned_and_goes_only_when_told() {
    let folder = folder();
    accepted(folder.path());
    let whole = named(folder.path(), ".snap");
    edit(
        &folder.path().join("half.fab"),
        "    subgoals",
        "    without component center_pivoting\n    subgoals",
    );
    // A file that cannot be compiled says nothing of what it declares.
    let broken = folder.path().join("broken.fab");
    fs::write(&broken, "task broken {").unwrap();
    let said = snap(folder.path(), &["half.fab", "broken.fab", "--prune"]);
    assert_eq!(said.code, 1);
    assert_eq!(named(folder.path(), ".snap"), whole);
    assert!(named(folder.path(), ".snap.new").is_empty());
    let said = snap(folder.path(), &["half.fab", "--check"]);
    assert_eq!(said.code, 1);
    let orphan = "orphaned snapshots/half.without_center_pivoting.plan@start.snap";
    assert!(said.stdout.contains(orphan), "{}", said.stdout);
    assert_eq!(snap(folder.path(), &["half.fab"]).code, 0);
    assert_eq!(named(folder.path(), ".snap"), whole);
    assert_eq!(snap(folder.path(), &["half.fab", "--prune"]).code, 0);
    assert_eq!(named(folder.path(), ".snap").len(), whole.len() - 2);
}

#[test]
fn snapshots_of_a_file_that_is_gone_are_orphaned_and_those_of_others_are_not() {
    let folder = folder();
    accepted(folder.path());
    fs::rename(
        folder.path().join("half.fab"),
        folder.path().join("other.fab"),
    )
    .unwrap();
    edit(&folder.path().join("other.fab"), "task half", "task other");
    let theirs = snapshots(folder.path()).join("tests__theirs.snap");
    fs::write(
        &theirs,
        "---\nsource: tests/theirs.rs\nexpression: x\n---\n1\n",
    )
    .unwrap();
    fs::write(snapshots(folder.path()).join("old.snap"), "Created: 2019\n").unwrap();
    let said = snap(folder.path(), &["other.fab", "--json"]);
    let value: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(
        (&value["orphaned"], &value["new"]),
        (&14.into(), &14.into())
    );
    assert!(theirs.exists());
}

#[test]
fn two_files_that_would_share_names_are_refused() {
    let folder = folder();
    fs::write(folder.path().join("again.fab"), TASK).unwrap();
    let said = snap(folder.path(), &["half.fab", "again.fab"]);
    assert_eq!(said.code, 64);
    assert!(said.stderr.contains("rename a task"), "{}", said.stderr);
    assert!(named(folder.path(), ".snap.new").is_empty());
}

#[test]
fn a_scene_that_was_edited_into_none_is_named() {
    let folder = folder();
    accepted(folder.path());
    let file = snapshots(folder.path()).join("half@start.points.snap");
    let text = b"---\nsource: half.fab\n---\n{}\n";
    fs::write(&file, text).unwrap();
    let said = snap(folder.path(), &["half.fab"]);
    assert_eq!(said.code, 2, "{}", said.stderr);
    assert!(
        said.stderr
            .contains("half@start.points.snap` is no scene: missing field"),
        "{}",
        said.stderr
    );
    assert_eq!(fs::read(&file).unwrap(), text);
}

#[test]
fn an_accepted_snapshot_that_cannot_be_read_is_named_and_proposed_anew() {
    let cases: [(&str, Option<&[u8]>, &str); 4] = [
        (
            "half@start.points.snap",
            Some(b"<<<<<<< ours\n"),
            "not a snapshot",
        ),
        ("half.plan@start.snap", Some(&[0xff, 0xfe]), "UTF-8"),
        (
            "half@start.subgoal_0_with_arrow.snap.png",
            None,
            "is missing",
        ),
        (
            "half@start.subgoal_0_with_arrow.snap.png",
            Some(b"other bytes"),
            "",
        ),
    ];
    for (name, bytes, words) in cases {
        let folder = folder();
        accepted(folder.path());
        let file = snapshots(folder.path()).join(name);
        match bytes {
            Some(bytes) => fs::write(&file, bytes).unwrap(),
            None => fs::remove_file(&file).unwrap(),
        }
        let checked = snap(folder.path(), &["half.fab", "--check"]);
        assert_eq!(checked.code, 1, "{name}");
        let said = snap(folder.path(), &["half.fab", "--json"]);
        assert_eq!(said.code, 0, "{name}: {}", said.stderr);
        assert!(said.stderr.contains(words), "{name}: {}", said.stderr);
        let value: Value = serde_json::from_str(&said.stdout).unwrap();
        let counts = (&value["changed"], &value["pending"], &value["same"]);
        assert_eq!(counts, (&1.into(), &1.into(), &13.into()), "{name}");
        assert_eq!(fs::read(&file).ok().as_deref(), bytes);
    }
}

#[test]
fn what_fails_in_one_folder_leaves_every_folder_as_it_was() {
    let root = tempfile::tempdir().unwrap();
    for name in ["one", "two"] {
        let inner = root.path().join(name);
        fs::create_dir(&inner).unwrap();
        bring_library(&inner);
        fs::write(inner.join("half.fab"), TASK).unwrap();
        accepted(&inner);
    }
    edit(&root.path().join("one/half.fab"), "task half", "task other");
    let broken = root.path().join("two/snapshots/half@start.points.snap");
    fs::write(broken, "---\nsource: half.fab\n---\n{}\n").unwrap();
    let said = snap(root.path(), &["one/half.fab", "two/half.fab", "--prune"]);
    assert_eq!(said.code, 2);
    let one = root.path().join("one");
    assert_eq!(named(&one, ".snap").len(), 14);
    assert!(named(&one, ".snap.new").is_empty());
}

#[test]
fn a_file_that_is_named_twice_counts_once_and_a_place_to_review_is_told() {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir(root.path().join("tasks")).unwrap();
    bring_library(&root.path().join("tasks"));
    fs::write(root.path().join("tasks/half.fab"), TASK).unwrap();
    let said = snap(root.path(), &["tasks/half.fab", "./tasks/half.fab"]);
    assert!(said.stderr.contains("14 new"), "{}", said.stderr);
    assert!(
        said.stderr
            .contains("`fabc review tasks/snapshots` shows what waits"),
        "{}",
        said.stderr
    );
}

#[test]
fn points_that_were_edited_by_hand_outlive_an_edit_that_is_undone() {
    let folder = folder();
    accepted(folder.path());
    let scene = snapshots(folder.path()).join("half@start.points.snap");
    let text = fs::read_to_string(&scene).unwrap();
    let center = text.find("\"center\": [[").unwrap() + "\"center\": [[".len();
    let end = center + text[center..].find(']').unwrap();
    fs::write(&scene, format!("{}7,8{}", &text[..center], &text[end..])).unwrap();
    accepted(folder.path());
    let library = folder.path().join("lib/folding.fab");
    edit(&library, "max: 27", "max: 2");
    assert_eq!(snap(folder.path(), &["half.fab"]).code, 0);
    assert!(!named(folder.path(), ".snap.new").is_empty());
    edit(&library, "max: 2,", "max: 27,");
    assert_eq!(snap(folder.path(), &["half.fab"]).code, 0);
    assert!(named(folder.path(), ".snap.new").is_empty());
    assert!(fs::read_to_string(&scene).unwrap().contains("[[7,8]]"));
}

#[test]
fn a_scene_that_cannot_be_pinned_so_is_refused_with_what_is_pinned() {
    let folder = folder();
    accepted(folder.path());
    let late = ["half.fab", "--scene", "late", "--start", "4"];
    assert_eq!(snap(folder.path(), &late).code, 0);
    let cases: [(&[&str], &str); 4] = [
        (
            &["half.fab", "--scene", "late", "--start", "5"],
            "the scene `late` of `half` is pinned already: start 4, step 1",
        ),
        (
            &["half.fab", "--scene", "far", "--step", "2"],
            "`half` has 1 steps; there is no step 2 to pin",
        ),
        (
            &["half.fab", "--scene", "a b"],
            "use letters, digits and `_`",
        ),
        (&["half.fab", "--scene", "start"], "always pinned"),
    ];
    for (arguments, words) in cases {
        let said = snap(folder.path(), arguments);
        assert_eq!(said.code, 64, "{arguments:?}: {}", said.stderr);
        assert!(said.stderr.contains(words), "{}", said.stderr);
    }
    // The same once more is no other.
    assert_eq!(snap(folder.path(), &late).code, 0);
}

#[test]
fn a_killed_snap_leaves_all_that_it_proposes_or_nothing() {
    let folder = folder();
    let took = std::time::Instant::now();
    accepted(folder.path());
    let took = took.elapsed();
    let library = folder.path().join("lib/folding.fab");
    edit(
        &library,
        "Answer in two lines:",
        "Answer in exactly two lines:",
    );
    let (mut none, mut all) = (0, 0);
    for moment in 0..24u32 {
        let mut child = fabc(folder.path())
            .args(["snap", "half.fab"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        thread::sleep(Duration::from_micros(
            took.as_micros() as u64 * u64::from(moment) / 20,
        ));
        child.kill().unwrap();
        child.wait().unwrap();
        // Whoever looks next ends what was begun.
        snap(folder.path(), &["half.fab", "--check"]);
        match named(folder.path(), ".snap.new").len() {
            0 => none += 1,
            5 => all += 1,
            some => panic!("{some} of 5 are pending after the kill at {moment}"),
        }
        assert_eq!(named(folder.path(), ".snap").len(), 14);
        if all > 0 {
            edit(
                &library,
                "Answer in exactly two lines:",
                "Answer in two lines:",
            );
            assert_eq!(snap(folder.path(), &["half.fab"]).code, 0);
            edit(
                &library,
                "Answer in two lines:",
                "Answer in exactly two lines:",
            );
        }
    }
    assert!(none + all == 24 && all > 0, "{none} {all}");
}
