//! `fabc review` without a terminal: JSON, ids of groups, places, and refused input.

use super::super::support::{Captured, fabc, finish};
use super::fixtures::{accepted, each_kind, files, left, one_edit, pending, prompt, write};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn review(folder: &Path, arguments: &[&str]) -> Captured {
    finish(fabc(folder).arg("review").args(arguments))
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let said = review(folder, &[arguments, &["--json"]].concat());
    assert_eq!(said.code, 0, "{}", said.stderr);
    serde_json::from_str(&said.stdout).unwrap()
}

#[test]
fn one_edit_of_forty_snapshots_is_one_group() {
    let folder = tempfile::tempdir().unwrap();
    one_edit(&folder.path().join("snapshots"), 40);
    let value = json(folder.path(), &[]);
    assert_eq!(value["pending"], 40);
    let [group] = value["groups"].as_array().unwrap().as_slice() else {
        panic!("{value:#}");
    };
    assert_eq!(group["kind"], "edit");
    let cause = serde_json::json!([
        { "component": "visual_context", "file": "lib/folding.fab", "line": 28 }
    ]);
    assert_eq!(group["cause"], cause);
    assert_eq!(
        group["edits"],
        serde_json::json!([{
            "removed": ["The red dots are corners."],
            "added": ["The blue dots are corners."],
        }])
    );
    assert_eq!(group["snapshots"].as_array().unwrap().len(), 40);
    assert_eq!(group["tokens"]["before"], 40 * 810);
    assert_eq!(group["tokens"]["after"], 40 * 812);
}

#[test]
fn what_is_pending_is_told_as_json() {
    let folder = tempfile::tempdir().unwrap();
    each_kind(&folder.path().join("snapshots"));
    let value = json(folder.path(), &[]);
    insta::assert_snapshot!(serde_json::to_string_pretty(&value).unwrap());
}

/// The ids of the groups of a kind, in order.
fn ids(folder: &Path, kind: &str) -> Vec<String> {
    let value = json(folder, &[]);
    let groups = value["groups"].as_array().unwrap().iter();
    let found = groups.filter(|group| group["kind"] == kind);
    let ids = found.map(|group| group["id"].as_str().unwrap().to_owned());
    ids.collect()
}

#[test]
fn groups_are_accepted_and_rejected_by_id_and_parts_of_them_by_only() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    each_kind(&snapshots);
    assert_eq!(
        json(folder.path(), &[]),
        json(folder.path(), &[]),
        "ids last"
    );
    let [edit, picture, new] =
        ["edit", "picture", "new"].map(|kind| ids(folder.path(), kind).remove(0));
    let before = files(&snapshots);
    let said = review(folder.path(), &["--only", "fold_01", "--accept", &edit]);
    assert_eq!(said.stdout, "accepted 1, rejected 0, still pending 0\n");
    let arguments = ["--accept", &picture, "--reject", &edit, "--reject", &new];
    let said = review(folder.path(), &arguments);
    assert_eq!(said.code, 0, "{}", said.stderr);
    assert_eq!(said.stdout, "accepted 1, rejected 3, still pending 1\n");
    assert_eq!(left(&snapshots), ["crate__theirs", "half@start.points"]);
    let after = files(&snapshots);
    for (was, is) in [
        (
            "half@start.subgoal_1.snap.new.png",
            "half@start.subgoal_1.snap.png",
        ),
        (
            "fold_01.describe@start.snap.new",
            "fold_01.describe@start.snap",
        ),
        ("fold_02.describe@start.snap", "fold_02.describe@start.snap"),
    ] {
        assert_eq!(before[was], after[is]);
    }
    let value = json(folder.path(), &["--accept-all"]);
    assert_eq!(value["accepted"], serde_json::json!(["half@start.points"]));
    assert_eq!(value["pending"], 0);
    assert_eq!(left(&snapshots), ["crate__theirs"]);
}

#[test]
fn an_id_that_names_no_group_or_is_decided_twice_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = (
        folder.path().join("a/snapshots"),
        folder.path().join("b/snapshots"),
    );
    one_edit(&one, 2);
    one_edit(&two, 1);
    let before = (files(&one), files(&two));
    // One edit in two folders is one group.
    let [id] = ids(folder.path(), "edit").try_into().unwrap();
    let cases: [(&[&str], String); 3] = [
        (
            &["--accept", &id, "--accept", "0badbad0"],
            "no pending group has the id `0badbad0`".to_owned(),
        ),
        (
            &["--accept", &id, "--reject", &id],
            format!("`{id}` is both accepted and rejected"),
        ),
        (
            &["--only", "fold_09", "--accept", &id],
            format!("no pending group has the id `{id}`"),
        ),
    ];
    for (arguments, message) in cases {
        let said = review(folder.path(), arguments);
        assert_eq!(said.code, 64, "{arguments:?}");
        assert!(said.stderr.contains(&message), "{}", said.stderr);
        assert_eq!((files(&one), files(&two)), before);
    }
    assert_eq!(review(folder.path(), &["--accept", &id]).code, 0);
    assert!(left(&one).is_empty() && left(&two).is_empty());
}

#[test]
fn places_and_parts_of_ids_say_what_is_meant() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    one_edit(&root.join("tasks/snapshots"), 3);
    one_edit(&root.join("more/deep/snapshots"), 1);
    for skipped in ["target", "runs", "node_modules", ".hidden"] {
        one_edit(&root.join(skipped).join("snapshots"), 1);
    }
    fs::write(root.join("tasks/fold_02.fab"), "").unwrap();
    let count = |arguments: &[&str]| json(root, arguments)["pending"].as_u64().unwrap();
    assert_eq!(count(&[]), 4);
    assert_eq!(count(&["tasks"]), 3);
    assert_eq!(count(&["tasks/snapshots", "tasks", "more"]), 4);
    assert_eq!(count(&["tasks/fold_02.fab"]), 1);
    assert_eq!(count(&["target"]), 1);
    assert_eq!(count(&["--only", "02"]), 1);
    assert_eq!(count(&["--only", "fold"]), 4);
    assert_eq!(count(&["--only", "@nowhere"]), 0);
    let said = review(root, &["nowhere"]);
    assert_eq!(said.code, 2);
    assert!(
        said.stderr.contains("cannot read `nowhere`"),
        "{}",
        said.stderr
    );
    fs::write(root.join("tasks/more.fab"), "").unwrap();
    let name = "more.describe@start";
    pending(
        &root.join("tasks/snapshots"),
        name,
        &prompt("more", "Dots.", 9),
    );
    let [new] = ids(root, "new").try_into().unwrap();
    let said = review(root, &["--accept-all", "--reject", &new, "tasks"]);
    assert_eq!(said.stdout, "accepted 3, rejected 1, still pending 0\n");
}

#[test]
fn two_components_that_change_side_by_side_are_two_edits() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    let old = prompt("half", "The red dots are corners.", 810);
    let new = prompt("half", "The blue dots are corners.", 812).replace(
        "You fold a cloth",
        "You fold a towel that is a good deal larger",
    );
    accepted(&snapshots, "half.describe@start", &old);
    pending(&snapshots, "half.describe@start", &new);
    let value = json(folder.path(), &[]);
    let [one, other] = value["groups"].as_array().unwrap().as_slice() else {
        panic!("{value:#}");
    };
    assert_eq!(
        one["edits"][0]["removed"][0],
        "You fold a cloth in the task half."
    );
    assert_eq!(one["cause"][0]["component"], "describe.say");
    assert_eq!(other["edits"][0]["added"][0], "The blue dots are corners.");
    assert_eq!(other["cause"][0]["component"], "visual_context");
    // Tokens are those of the whole texts.
    for group in [one, other] {
        let tokens = serde_json::json!({ "before": 810, "after": 812 });
        assert_eq!(group["tokens"], tokens);
    }
}

/// Two edits of one text; another text has only the second. Returns the ids of both.
fn two_edits(snapshots: &Path) -> [String; 2] {
    let folder = snapshots.parent().unwrap();
    let old = prompt("half", "The red dots are corners.", 810);
    let second = prompt("half", "The blue dots are corners.", 812);
    let both = second.replace("You fold a cloth", "You fold a towel");
    for (name, new) in [
        ("half.describe@start", &both),
        ("half.describe@later", &second),
    ] {
        accepted(snapshots, name, &old);
        pending(snapshots, name, new);
    }
    let value = json(folder, &[]);
    let groups = value["groups"].as_array().unwrap().iter();
    let of = |removed: &str| {
        let group = groups.clone().find(|group| {
            let line = group["edits"][0]["removed"][0].as_str().unwrap();
            line.starts_with(removed)
        });
        group.unwrap()["id"].as_str().unwrap().to_owned()
    };
    [of("You fold"), of("The red")]
}

#[test]
fn a_text_is_accepted_once_each_of_its_edits_is_and_rejected_with_any() {
    let cases: [(&[&str], &[&str], &str); 5] = [
        (
            &["second"],
            &[],
            "accepted 1, rejected 0, still pending 1\n",
        ),
        (&["first"], &[], "accepted 0, rejected 0, still pending 2\n"),
        (
            &["first", "second"],
            &[],
            "accepted 2, rejected 0, still pending 0\n",
        ),
        (
            &["second"],
            &["first"],
            "accepted 1, rejected 1, still pending 0\n",
        ),
        (
            &[],
            &["second"],
            "accepted 0, rejected 2, still pending 0\n",
        ),
    ];
    for (accepts, rejects, said) in cases {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = two_edits(&folder.path().join("snapshots"));
        let id = |name: &&str| match *name {
            "first" => first.clone(),
            _ => second.clone(),
        };
        let mut arguments = Vec::new();
        for (flag, names) in [("--accept", accepts), ("--reject", rejects)] {
            arguments.extend(names.iter().flat_map(|name| [flag.to_owned(), id(name)]));
        }
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let found = review(folder.path(), &arguments);
        assert_eq!(found.stdout, said, "{accepts:?} {rejects:?}");
        let waits = found.stderr.contains(
            "1 snapshot waits until its other edits are decided; decide about all of them at once",
        );
        let expected = accepts.len() == 1 && rejects.is_empty();
        assert_eq!(waits, expected, "{}", found.stderr);
    }
}

#[test]
fn without_a_terminal_it_says_what_to_use() {
    let folder = tempfile::tempdir().unwrap();
    let said = review(folder.path(), &[]);
    assert_eq!(
        (said.code, said.stderr.as_str()),
        (0, "nothing is pending\n")
    );
    one_edit(&folder.path().join("snapshots"), 2);
    let said = review(folder.path(), &[]);
    assert_eq!(said.code, 64);
    assert!(
        said.stderr
            .contains("this is not a terminal; use --json, --accept"),
        "{}",
        said.stderr
    );
}

#[test]
fn a_file_that_cannot_be_read_is_named_and_nothing_changes() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    one_edit(&snapshots, 2);
    write(
        &snapshots,
        "fold_02.describe@start.snap.new",
        b"---\n---\n\xff",
    );
    let before = files(&snapshots);
    for arguments in [&["--accept-all"][..], &["--json"]] {
        let said = review(folder.path(), arguments);
        assert_eq!(said.code, 2);
        let place = "cannot read `snapshots/fold_02.describe@start.snap.new`: it is not UTF-8";
        assert!(said.stderr.contains(place), "{}", said.stderr);
        assert_eq!(files(&snapshots), before);
    }
    write(&snapshots, "fold_02.describe@start.snap.new", b"");
    let said = review(folder.path(), &["--accept-all"]);
    assert!(said.stderr.contains("does not begin with a line `---`"));
}
