//! What is pinned, and what an edit makes pending.

use super::super::support::{fabc, finish, root};
use super::{ALL, accepted, edit, folder, named, snap, snapshots};
use serde_json::Value;
use std::fs;

#[test]
fn the_prompts_of_the_shipped_tasks_are_as_accepted() {
    let of_materials = ["hem", "pocket_envelope", "paper_plane"];
    let of_materials = of_materials.map(|name| root().join(format!("tasks/{name}.fab")));
    let tasks = fs::read_dir(root().join("tasks")).unwrap();
    let files = tasks.map(|entry| entry.unwrap().path());
    let files: Vec<String> = files
        .filter(|path| path.extension().is_some_and(|it| it == "fab"))
        .filter(|path| !of_materials.contains(path))
        .map(|path| path.display().to_string())
        .collect();
    assert!(files.len() > 8);
    let said = finish(
        fabc(root())
            .args(["snap", "--check", "--redraw"])
            .args(&files),
    );
    assert_eq!(said.code, 0, "{}{}", said.stdout, said.stderr);
    // Drawing a cloth of a material takes longer, so the pictures of these are as pinned.
    let files = of_materials.map(|path| path.display().to_string());
    let said = finish(fabc(root()).args(["snap", "--check"]).args(&files));
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
    // All except the variant without that component.
    assert_eq!(
        (&value["changed"], &value["same"]),
        (&5.into(), &(ALL - 5).into())
    );
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
    // After the edit is undone, nothing is pending.
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
fn another_picture_in_the_place_of_a_subgoal_is_a_change() {
    let folder = folder();
    let house = root().join("tasks/house.subgoals");
    for name in ["0.png", "1.png"] {
        fs::copy(house.join(name), folder.path().join(name)).unwrap();
    }
    edit(
        &folder.path().join("half.fab"),
        "demonstrate { fold corner(back_left) -> corner(front_left) }",
        "image \"0.png\" arrow (40px, 40px) -> (111px, 111px)\n        image \"1.png\"",
    );
    accepted(folder.path());
    assert_eq!(snap(folder.path(), &["half.fab", "--check"]).code, 0);
    fs::copy(house.join("2.png"), folder.path().join("1.png")).unwrap();
    let said = snap(folder.path(), &["half.fab", "--check"]);
    assert_eq!(said.code, 1, "{}", said.stderr);
    assert_eq!(
        said.stdout,
        "changed  snapshots/half@start.subgoal_1.snap\n"
    );
}

#[test]
fn pinned_subgoals_that_are_lost_or_exchanged_are_drawn_anew_and_said() {
    let folder = folder();
    let subgoals = |verb: &str| finish(fabc(folder.path()).args([verb, "half.fab"]));
    assert_eq!(subgoals("subgoals").code, 0);
    accepted(folder.path());
    let pinned = folder.path().join("half.subgoals/1.png");
    let drawn = fs::read(&pinned).unwrap();
    assert!(!subgoals("render").stderr.contains("drawn anew"));
    for bytes in [
        None,
        Some(fs::read(root().join("tasks/house.subgoals/1.png")).unwrap()),
    ] {
        match &bytes {
            None => fs::remove_file(&pinned).unwrap(),
            Some(bytes) => fs::write(&pinned, bytes).unwrap(),
        }
        let said = subgoals("render");
        assert_eq!(said.code, 0, "{}", said.stderr);
        assert!(
            said.stderr.contains("not all there as they were drawn"),
            "{}",
            said.stderr
        );
        // The run's picture is drawn again, so it is the accepted one.
        let said = snap(folder.path(), &["half.fab", "--check"]);
        assert_eq!(said.code, 0, "{}{}", said.stdout, said.stderr);
    }
    assert_eq!(subgoals("subgoals").code, 0);
    assert_eq!(fs::read(&pinned).unwrap(), drawn);
}
