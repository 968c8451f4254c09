//! `fabc new`: its tasks run at once, and nothing that exists is overwritten.

use super::support::{Captured, fabc, finish, root};
use serde_json::Value;
use std::path::{Path, PathBuf};

pub fn said(folder: &Path, arguments: &[&str]) -> Captured {
    finish(fabc(folder).args(arguments))
}

pub fn json(said: &Captured) -> Value {
    let read = serde_json::from_str(&said.stdout);
    read.unwrap_or_else(|error| panic!("{error}\n{}\n{}", said.stdout, said.stderr))
}

/// Every file below a folder, sorted.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false => found.push(path.strip_prefix(folder).unwrap().to_owned()),
            }
        }
    }
    found.sort();
    found
}

#[test]
#[ignore = "long"]
fn a_new_fold_compiles_without_a_word_and_runs_to_its_goal() {
    let folder = tempfile::tempdir().unwrap();
    let begun = said(folder.path(), &["new", "fold", "napkin", "--json"]);
    assert_eq!((begun.code, begun.stderr.as_str()), (0, ""));
    let written = json(&begun);
    let listed: Vec<PathBuf> = serde_json::from_value(written["files"].clone()).unwrap();
    let there = files(folder.path());
    assert_eq!(there.len(), 6, "{there:?}");
    assert!(there.iter().all(|file| listed.contains(file)), "{listed:?}");
    assert_eq!(written["guesses"], serde_json::json!([]));

    let checked = said(folder.path(), &["check", "napkin.fab", "--json"]);
    assert_eq!(json(&checked)["diagnostics"], serde_json::json!([]));
    let next = serde_json::json!([
        "fabc render napkin.fab",
        "fabc test napkin.fab",
        "fabc run napkin.fab"
    ]);
    assert_eq!(written["next"], next);
    assert_eq!(said(folder.path(), &["render", "napkin.fab"]).code, 0);
    assert_eq!(said(folder.path(), &["test", "napkin.fab"]).code, 0);
    let ended = said(folder.path(), &["run", "napkin.fab", "--json"]);
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    assert_eq!(json(&ended)["outcome"], "goal_reached");
}

/// What the comments of a new task say to try, one edit for each.
const TO_TRY: [(&str, &str, &str); 7] = [
    ("another corner", "-> center", "-> corner(front_left)"),
    (
        "the sides' middles",
        "extends folding {",
        "extends folding_to_sides {",
    ),
    ("a side in metric units", "grid(55, 55)", "square(340mm)"),
    ("fewer corners", "max: 27", "max: 12"),
    (
        "the cloth's colours",
        "is orange and its",
        "is white and its",
    ),
    (
        "places anywhere on the cloth",
        "    # 5. CHECKS",
        "    actions { pick: one of corners  place: any of cloth }\n    # 5. CHECKS",
    ),
    ("a length on the table", "> 10px }", "> 20mm in px }"),
];

#[test]
fn what_the_comments_of_a_new_fold_say_to_try_is_checked_without_a_word() {
    for (what, from, to) in TO_TRY {
        let folder = tempfile::tempdir().unwrap();
        said(folder.path(), &["new", "fold", "napkin"]);
        let file = folder.path().join("napkin.fab");
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains(from), "{what}: {from}");
        std::fs::write(&file, text.replace(from, to)).unwrap();
        for verb in [&["check", "--deny-warnings"][..], &["test"]] {
            let ended = said(folder.path(), &[verb, &["napkin.fab"]].concat());
            assert_eq!(ended.code, 0, "{what}: {verb:?}: {}", ended.stderr);
        }
    }
}

#[test]
#[ignore = "long"]
fn a_new_fold_to_the_middle_of_a_side_reaches_its_goal_as_its_comment_says() {
    let folder = tempfile::tempdir().unwrap();
    said(folder.path(), &["new", "fold", "napkin"]);
    let file = folder.path().join("napkin.fab");
    let text = std::fs::read_to_string(&file).unwrap();
    let text = text.replace("-> center", "-> middle(left)");
    let text = text.replace("extends folding {", "extends folding_to_sides {");
    std::fs::write(&file, text).unwrap();
    assert_eq!(said(folder.path(), &["subgoals", "napkin.fab"]).code, 0);
    for policy in [&[][..], &["--policy", "expert"]] {
        let run = [&["run", "napkin.fab", "--json"], policy].concat();
        let ended = said(folder.path(), &run);
        assert_eq!(json(&ended)["outcome"], "goal_reached", "{}", ended.stderr);
    }
}

#[test]
fn the_pictures_of_a_new_fold_are_those_that_subgoals_draws() {
    let folder = tempfile::tempdir().unwrap();
    said(folder.path(), &["new", "fold", "napkin"]);
    let pictures = ["0.png", "1.png", "2.png", "pins.json"].map(|name| {
        let path = folder.path().join("napkin.subgoals").join(name);
        std::fs::read(path).unwrap()
    });
    assert_eq!(said(folder.path(), &["subgoals", "napkin.fab"]).code, 0);
    for (name, bytes) in ["0.png", "1.png", "2.png", "pins.json"]
        .iter()
        .zip(pictures)
    {
        let path = folder.path().join("napkin.subgoals").join(name);
        assert!(std::fs::read(path).unwrap() == bytes, "{name} differs");
    }
}

#[test]
#[ignore = "long"]
fn a_new_smoothing_compiles_without_a_word_and_runs_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let begun = said(folder.path(), &["new", "smoothing", "towel", "--in", "a/b"]);
    assert_eq!(begun.code, 0, "{}", begun.stderr);
    assert_eq!(begun.stdout, "a/b/towel.fab\na/b/lib/smoothing.fab\n");
    assert!(begun.stderr.contains("fabc run a/b/towel.fab"));
    let checked = said(folder.path(), &["check", "a/b/towel.fab", "--json"]);
    assert_eq!(json(&checked)["diagnostics"], serde_json::json!([]));
    assert_eq!(said(folder.path(), &["test", "a/b/towel.fab"]).code, 0);
    let ended = said(folder.path(), &["run", "a/b/towel.fab", "--json"]);
    // The stand-in's geometry smooths little: what counts is that each pull is carried out.
    assert_eq!(ended.code, 3, "{}", ended.stderr);
    assert_eq!(json(&ended)["outcome"], "horizon_reached");
}

#[test]
fn what_exists_is_left_and_nothing_is_written_beside_it() {
    for taken in ["napkin.fab", "napkin.subgoals"] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(taken), "mine").unwrap();
        let ended = said(folder.path(), &["new", "fold", "napkin"]);
        assert_eq!(ended.code, 2, "{}", ended.stderr);
        let told = format!("`{taken}` already exists; choose another name");
        assert!(ended.stderr.contains(&told), "{}", ended.stderr);
        assert_eq!(files(folder.path()), [PathBuf::from(taken)]);
        let kept = std::fs::read_to_string(folder.path().join(taken)).unwrap();
        assert_eq!(kept, "mine");
    }
}

#[test]
fn names_that_the_language_or_the_library_uses_are_wrong_usage() {
    let folder = tempfile::tempdir().unwrap();
    for (name, why) in [
        ("two words", "a name begins with a letter or `_`"),
        ("2fold", "a name begins with a letter or `_`"),
        ("stage", "is no word of the language"),
        ("folding", "`lib/folding.fab` has one of this name"),
        ("a".repeat(191).as_str(), "up to 190 of them"),
    ] {
        let ended = said(folder.path(), &["new", "fold", name, "--json"]);
        assert_eq!(ended.code, 64, "{}", ended.stderr);
        assert!(ended.stderr.contains(why), "{}", ended.stderr);
        assert_eq!(json(&ended)["exit"], 64);
        assert_eq!(files(folder.path()), Vec::<PathBuf>::new());
    }
}

#[test]
#[ignore = "long"]
fn a_library_of_the_users_is_used_and_one_that_does_not_fit_stops_it() {
    let folder = tempfile::tempdir().unwrap();
    let library = folder.path().join("lib/folding.fab");
    std::fs::create_dir(library.parent().unwrap()).unwrap();
    let shipped = std::fs::read_to_string(root().join("tasks/lib/folding.fab")).unwrap();

    std::fs::write(&library, format!("{shipped}\n# mine\n")).unwrap();
    let begun = said(folder.path(), &["new", "fold", "one"]);
    assert_eq!(begun.code, 0, "{}", begun.stderr);
    assert!(begun.stderr.contains("differs from the shipped version"));
    assert!(!begun.stdout.contains("folding.fab"), "{}", begun.stdout);
    assert!(
        std::fs::read_to_string(&library)
            .unwrap()
            .ends_with("# mine\n")
    );

    std::fs::write(&library, &shipped).unwrap();
    let begun = said(folder.path(), &["new", "fold", "two"]);
    assert_eq!(begun.code, 0, "{}", begun.stderr);
    assert!(!begun.stderr.contains("note:"), "{}", begun.stderr);

    let before = files(folder.path());
    for broken in ["task folding { }\n", "\u{0}"] {
        std::fs::write(&library, broken).unwrap();
        let ended = said(folder.path(), &["new", "fold", "three"]);
        assert_eq!(ended.code, 2, "{}", ended.stderr);
        assert!(
            ended.stderr.contains("would not compile with"),
            "{}",
            ended.stderr
        );
        assert_eq!(files(folder.path()), before);
    }
}

#[test]
fn a_folder_that_takes_no_files_is_named() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    let ended = said(
        folder.path(),
        &["new", "smoothing", "towel", "--in", "file/below"],
    );
    assert_eq!(ended.code, 2, "{}", ended.stderr);
    let told = "cannot write `file/below";
    assert!(ended.stderr.contains(told), "{}", ended.stderr);
    assert_eq!(files(folder.path()), [PathBuf::from("file")]);
}

#[test]
fn libraries_are_copied_beside_own_tasks_and_changed_ones_stay() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own.fab");
    std::fs::write(&own, "use \"hem.fab\"\ntask own extends hem {}\n").unwrap();
    let told = |arguments: &[&str]| finish(fabc(folder.path()).args(arguments));
    let missing = told(&["check", "own.fab"]);
    assert_eq!(missing.code, 1, "{}", missing.stdout);
    let copied = told(&["new", "library", "hem"]);
    assert_eq!(copied.code, 0, "{}", copied.stderr);
    assert!(
        copied.stdout.contains("lib/materials.fab\n"),
        "{}",
        copied.stdout
    );
    assert_eq!(told(&["check", "own.fab"]).code, 0);
    let changed = folder.path().join("lib/folding.fab");
    let text = std::fs::read_to_string(&changed).unwrap() + "# mine\n";
    std::fs::write(&changed, &text).unwrap();
    let again = told(&["new", "library"]);
    assert!(
        again.stderr.contains("`lib/folding.fab` differs"),
        "{}",
        again.stderr
    );
    assert_eq!(std::fs::read_to_string(&changed).unwrap(), text);
    let unknown = told(&["new", "library", "hemm"]);
    assert_eq!(unknown.code, 2);
    assert!(
        unknown.stderr.contains("did you mean `hem`?"),
        "{}",
        unknown.stderr
    );
    let all = [
        "all_corners_inward",
        "double_triangle",
        "smoothing",
        "hem",
        "hem",
    ];
    let copied = told(&[&["new", "library"], &all[..]].concat());
    assert_eq!(copied.code, 0, "{}", copied.stderr);
    for task in all {
        let checked = told(&["check", &format!("{task}.fab"), "--deny-warnings"]);
        assert_eq!(checked.code, 0, "{}{}", checked.stdout, checked.stderr);
        assert!(
            !checked.stdout.contains("variants with errors"),
            "{}",
            checked.stdout
        );
    }
    let empty = tempfile::tempdir().unwrap();
    std::fs::write(empty.path().join("x.fab"), "use \"lib/materials.fab\"\n").unwrap();
    let advised = finish(fabc(empty.path()).args(["check", "x.fab"]));
    assert!(
        advised.stdout.contains("`fabc new library` copies it"),
        "{}",
        advised.stdout
    );
}
