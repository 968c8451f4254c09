//! Scenes: when they are captured again, edited by hand, or requested.

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
fn more_scenes_are_kept_once_they_were_asked_for() {
    let folder = folder();
    accepted(folder.path());
    let said = snap(
        folder.path(),
        &["half.fab", "--scene", "turned", "--start", "7"],
    );
    assert_eq!(said.code, 0, "{}", said.stderr);
    assert_eq!(named(folder.path(), ".snap.new").len(), ALL);
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

#[test]
fn a_scene_that_cannot_be_pinned_is_refused_and_another_start_is_a_change() {
    let folder = folder();
    accepted(folder.path());
    let late = ["half.fab", "--scene", "late", "--start", "4"];
    assert_eq!(snap(folder.path(), &late).code, 0);
    let cases: [(&[&str], &str); 3] = [
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
    // The same request again changes nothing; another start is a change to review.
    accept_all(folder.path());
    assert_eq!(snap(folder.path(), &late).code, 0);
    assert!(named(folder.path(), ".snap.new").is_empty());
    let other = ["half.fab", "--scene", "late", "--start", "5"];
    assert_eq!(snap(folder.path(), &other).code, 0);
    assert!(named(folder.path(), ".snap.new").contains("half@late.points"));
}
