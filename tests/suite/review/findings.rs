//! What `fabc review` finds: unreadable files, other tools' files, and pictures.

use super::super::support::{Captured, fabc, finish};
use super::fixtures::{accepted, files, left, one_edit, pending, png, prompt, write};
use serde_json::{Value, json};
use std::path::Path;

fn review(folder: &Path, arguments: &[&str]) -> Captured {
    finish(fabc(folder).arg("review").args(arguments))
}

fn as_json(folder: &Path, arguments: &[&str]) -> Value {
    let said = review(folder, &[arguments, &["--json"]].concat());
    assert_eq!(said.code, 0, "{}", said.stderr);
    serde_json::from_str(&said.stdout).unwrap()
}

#[test]
fn files_of_other_programs_are_left_alone_whatever_is_in_them() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    one_edit(&snapshots, 1);
    let theirs: [(&str, &[u8]); 5] = [
        (
            "crate__binary",
            b"---\nsource: a.rs\nsnapshot_kind: binary\nextension: txt\n---\n",
        ),
        (
            "crate__old",
            b"Created: 2018-01-01T00:00:00+00:00\nSource: a.rs\n\nx\n",
        ),
        ("crate__empty", b""),
        ("crate__latin", b"---\n---\n\xe9"),
        ("crate__large", &vec![b'x'; (4 << 20) + 1]),
    ];
    for (name, bytes) in theirs {
        write(&snapshots, &format!("{name}.snap.new"), bytes);
    }
    let value = as_json(folder.path(), &["--accept-all"]);
    assert_eq!(value["accepted"], json!(["fold_01.describe@start"]));
    assert_eq!(left(&snapshots).len(), 5);
}

#[test]
fn a_merge_conflict_in_what_is_pending_is_named_by_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    one_edit(&snapshots, 1);
    let text = prompt("half", "Dots.", 700).replace(
        "  tokens: 700\n",
        "<<<<<<< ours\n  tokens: 700\n=======\n  tokens: 701\n>>>>>>> theirs\n",
    );
    pending(&snapshots, "half.describe@start", &text);
    let before = files(&snapshots);
    let said = review(folder.path(), &["--accept-all"]);
    assert_eq!(said.code, 2);
    for words in [
        "`snapshots/half.describe@start.snap.new` is not a snapshot that can be read",
        ": line 8 begins a merge conflict; run `fabc snap` again",
    ] {
        assert!(said.stderr.contains(words), "{}", said.stderr);
    }
    assert_eq!(files(&snapshots), before);
}

#[test]
fn an_accepted_snapshot_that_cannot_be_read_counts_as_absent() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    one_edit(&snapshots, 2);
    accepted(&snapshots, "fold_02.describe@start", "<<<<<<< ours\n");
    let said = review(folder.path(), &["--json"]);
    assert_eq!(said.code, 0, "{}", said.stderr);
    let words = "counted as new: `snapshots/fold_02.describe@start.snap` is not a snapshot that can be read: line 1 begins a merge conflict";
    assert!(said.stderr.contains(words), "{}", said.stderr);
    assert_eq!(said.stderr.lines().count(), 1, "{}", said.stderr);
    let value: Value = serde_json::from_str(&said.stdout).unwrap();
    let new = &value["groups"][1];
    assert_eq!(new["kind"], "new");
    assert_eq!(new["snapshots"][0]["id"], "fold_02.describe@start");
    assert_eq!(
        review(folder.path(), &["--only", "01", "--json"]).stderr,
        ""
    );
    let said = review(folder.path(), &["--accept-all"]);
    assert_eq!(said.stdout, "accepted 2, rejected 0, still pending 0\n");
    assert!(files(&snapshots)["fold_02.describe@start.snap"].starts_with(b"---\n"));
}

#[test]
fn new_pictures_name_their_files() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    pending(
        &snapshots,
        "half.describe@start",
        &prompt("half", "Dots.", 700),
    );
    let header = "---\nsource: half.fab\ninfo:\n  task: half\n  scene: start\n  picture: scene\nextension: png\nsnapshot_kind: binary\n---\n";
    pending(&snapshots, "half@start.scene", header);
    write(
        &snapshots,
        "half@start.scene.snap.new.png",
        &png(8, 8, None),
    );
    let value = as_json(folder.path(), &[]);
    let files: Vec<&Value> = value["groups"][0]["snapshots"]
        .as_array()
        .unwrap()
        .iter()
        .map(|snapshot| &snapshot["file"])
        .collect();
    let file = "snapshots/half@start.scene.snap.new.png";
    assert_eq!(files, [&Value::Null, &json!(file)]);
    assert!(folder.path().join(file).is_file());
}
