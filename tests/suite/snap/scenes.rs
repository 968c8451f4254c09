//! Scenes: when they are captured again, or edited by hand.

use super::{ALL, accept_all, accepted, edit, folder, named, snap, snapshots};
use std::fs;
use std::path::{Path, PathBuf};

/// Changes the center in the pinned scene, as a person would; returns its file.
fn edit_center(folder: &Path) -> PathBuf {
    let scene = snapshots(folder).join("half@start.points.snap");
    let text = fs::read_to_string(&scene).unwrap();
    let center = text.find("\"center\": [[").unwrap() + "\"center\": [[".len();
    let end = center + text[center..].find(']').unwrap();
    let edited = format!("{}7,8{}", &text[..center], &text[end..]);
    fs::write(&scene, edited).unwrap();
    scene
}

#[test]
fn every_stage_and_variant_is_pinned_with_its_scene_and_pictures() {
    let folder = folder();
    let said = snap(folder.path(), &["half.fab"]);
    assert_eq!(said.code, 0, "{}", said.stderr);
    let pending = named(folder.path(), ".snap.new");
    assert_eq!(pending.len(), ALL, "{pending:?}");
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
        fab_picture::png::load(&picture).unwrap().dimensions(),
        (224, 224)
    );
    assert_eq!(snap(folder.path(), &["half.fab", "--check"]).code, 1);
    accept_all(folder.path());
    let said = snap(folder.path(), &["half.fab", "--check"]);
    assert_eq!(said.code, 0, "{}{}", said.stdout, said.stderr);
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
    edit_center(folder.path());
    assert_eq!(snap(folder.path(), &["half.fab"]).code, 0);
    let file = snapshots(folder.path()).join("half.plan@start.snap.new");
    assert!(
        fs::read_to_string(file)
            .unwrap()
            .contains("Cloth center: (7, 8)")
    );
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
fn points_that_were_edited_by_hand_outlive_an_edit_that_is_undone() {
    let folder = folder();
    accepted(folder.path());
    let scene = edit_center(folder.path());
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
