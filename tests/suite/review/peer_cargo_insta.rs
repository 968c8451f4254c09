//! How the real `cargo insta` handles our pending snapshots, and how we handle those that it accepted.

use super::super::support::{fabc, finish};
use super::fixtures::{each_kind, files, left, one_edit};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn cargo_insta(folder: &Path, arguments: &[&str]) -> Output {
    let program = std::env::var("FABC_PEER_CARGO_INSTA").expect(
        "FABC_PEER_CARGO_INSTA names no `cargo-insta`; `make test-all` sets it, or says what is missing",
    );
    let output = Command::new(program)
        .current_dir(folder)
        .args(arguments)
        .env_remove("CARGO_MANIFEST_DIR")
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {said}");
    output
}

/// Writes a package, since `cargo insta` works only in one.
fn package(folder: &Path) {
    let manifest = "[package]\nname = \"tasks\"\nversion = \"0.1.0\"\nedition = \"2024\"\n[lib]\npath = \"lib.rs\"\n[workspace]\n";
    fs::write(folder.join("Cargo.toml"), manifest).unwrap();
    fs::write(folder.join("lib.rs"), "").unwrap();
}

/// cargo-insta 1.49 panics when it lists a picture as JSON, so this test has none.
#[test]
#[ignore = "needs cargo-insta"]
fn peer_cargo_insta_lists_pending_texts() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    one_edit(&snapshots, 3);
    package(folder.path());
    let listed = cargo_insta(folder.path(), &["pending-snapshots", "--as-json"]);
    let listed: Vec<Value> = String::from_utf8(listed.stdout)
        .unwrap()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(listed.len(), 3, "{listed:?}");
    for one in &listed {
        let path = Path::new(one["path"].as_str().unwrap());
        assert!(path.with_added_extension("new").exists(), "{one}");
    }
}

#[test]
#[ignore = "needs cargo-insta"]
fn peer_cargo_insta_accepts_what_is_pending() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    each_kind(&snapshots);
    package(folder.path());
    let before = files(&snapshots);
    cargo_insta(folder.path(), &["accept"]);
    assert!(left(&snapshots).is_empty());
    let after = files(&snapshots);
    let bytes = |name: &str| &after[name];
    assert_eq!(
        bytes("half@start.subgoal_1.snap.png"),
        &before["half@start.subgoal_1.snap.new.png"]
    );
    // When another text is proposed, the file that `cargo insta` wrote is read as the accepted one.
    let again = String::from_utf8(before["half.describe@start.snap.new"].clone()).unwrap();
    let again = again.replace("Dots.", "Blue dots.").replace("700", "702");
    fs::write(snapshots.join("half.describe@start.snap.new"), again).unwrap();
    let scene = String::from_utf8(before["half@start.points.snap"].clone()).unwrap();
    fs::write(snapshots.join("half@start.points.snap.new"), scene).unwrap();
    let said = finish(fabc(folder.path()).args(["review", "--json"]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    let value: Value = serde_json::from_str(&said.stdout).unwrap();
    let [edit, scene] = value["groups"].as_array().unwrap().as_slice() else {
        panic!("{value:#}");
    };
    assert_eq!(edit["cause"][0]["component"], "visual_context");
    assert_eq!(
        edit["tokens"],
        serde_json::json!({ "before": 700, "after": 702 })
    );
    let moved = &scene["edits"][1]["added"][0];
    assert_eq!(moved, "    \"center\": [[30,40]],");
    let said = finish(fabc(folder.path()).args(["review", "--accept-all"]));
    assert_eq!(said.stdout, "accepted 2, rejected 0, still pending 0\n");
}
