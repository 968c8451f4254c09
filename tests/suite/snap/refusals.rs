//! Unreadable snapshots, orphans, and failures halfway: nothing is lost.

use super::super::support::bring_library;
use super::{ALL, TASK, accepted, edit, folder, named, snap, snapshots};
use serde_json::Value;
use std::fs;

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
    // A file that does not compile leaves its declarations unknown.
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
        (&ALL.into(), &ALL.into())
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
#[ignore = "long"]
fn an_accepted_snapshot_that_cannot_be_read_is_named_and_proposed_anew() {
    let cases: [(&str, Option<&[u8]>, &str); 4] = [
        (
            "half@start.points.snap",
            Some(b"<<<<<<< ours\n"),
            "line 1 begins a merge conflict",
        ),
        ("half.plan@start.snap", Some(&[0xff, 0xfe]), "UTF-8"),
        (
            "half@start.subgoal_0_with_arrow.snap.png",
            None,
            "No such file",
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
        assert_eq!(counts, (&1.into(), &1.into(), &(ALL - 1).into()), "{name}");
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
    assert_eq!(named(&one, ".snap").len(), ALL);
    assert!(named(&one, ".snap.new").is_empty());
}

#[test]
fn a_file_that_is_named_twice_counts_once_and_what_to_review_is_told() {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir(root.path().join("tasks")).unwrap();
    bring_library(&root.path().join("tasks"));
    fs::write(root.path().join("tasks/half.fab"), TASK).unwrap();
    let said = snap(root.path(), &["tasks/half.fab", "tasks/half.fab"]);
    assert!(
        said.stderr.contains(&format!("{ALL} new")),
        "{}",
        said.stderr
    );
    assert!(
        said.stderr
            .contains("`fabc review tasks/half.fab tasks/half.fab` shows what waits"),
        "{}",
        said.stderr
    );
}
