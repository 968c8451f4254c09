//! `fabc review` in a pseudo-terminal, key by key.

use super::super::pty::Session;
use super::super::support::fabc;
use super::fixtures::{accepted, each_kind, files, left, one_edit, pending, prompt};
use std::path::Path;

/// Starts a review in a terminal of this width.
fn start(folder: &Path, columns: u16, arguments: &[&str]) -> Session {
    let mut command = fabc(folder);
    command.arg("review").args(arguments);
    Session::start(command.process(), columns)
}

const PROMPT: &str = "[q]uit [?] ";

/// Two edits and a new task, which make three groups.
fn three_groups(folder: &Path) {
    one_edit(folder, 2);
    accepted(folder, "half.describe@start", &prompt("half", "Dots.", 700));
    pending(
        folder,
        "half.describe@start",
        &prompt("half", "Red dots.", 690),
    );
    pending(folder, "new.describe@start", &prompt("new", "Dots.", 500));
}

#[test]
fn one_is_accepted_one_rejected_and_one_skipped() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    three_groups(&snapshots);
    let before = files(&snapshots);
    let mut session = start(folder.path(), 100, &[]);
    insta::assert_snapshot!("an_edit_below_each_other", session.until(PROMPT));
    session.press("\r");
    session.until(PROMPT);
    session.press("x");
    session.until(PROMPT);
    assert_eq!(files(&snapshots), before, "nothing was decided");
    session.press("a");
    let shown = session.until(PROMPT);
    assert!(
        shown.contains("2 of 3") && shown.contains("-10 over 1 question"),
        "{shown}"
    );
    assert_eq!(
        left(&snapshots),
        ["half.describe@start", "new.describe@start"]
    );
    session.press("r");
    let shown = session.until(PROMPT);
    assert!(shown.contains("1 new snapshot of `new`"), "{shown}");
    assert_eq!(left(&snapshots), ["new.describe@start"]);
    session.press("s");
    let (code, shown) = session.end();
    assert_eq!(code, Some(0));
    assert!(
        shown.ends_with("accepted 2, rejected 1, still pending 1\n"),
        "{shown}"
    );
    let after = files(&snapshots);
    let (old, new) = (
        "fold_01.describe@start.snap",
        "fold_01.describe@start.snap.new",
    );
    assert_eq!(after[old], before[new]);
    assert_eq!(
        after["half.describe@start.snap"],
        before["half.describe@start.snap"]
    );
}

#[test]
fn one_who_stops_keeps_what_was_decided() {
    for (key, code) in [("q", 0), ("\u{4}", 0), ("\u{3}", 130)] {
        let folder = tempfile::tempdir().unwrap();
        let snapshots = folder.path().join("snapshots");
        three_groups(&snapshots);
        let mut session = start(folder.path(), 100, &[]);
        assert!(session.until(PROMPT).contains("+ The blue dots"));
        session.press("r");
        session.until(PROMPT);
        session.press(key);
        let (found, shown) = session.end();
        assert_eq!(found, Some(code));
        assert!(
            shown.ends_with("accepted 0, rejected 2, still pending 2\n"),
            "{shown}"
        );
        assert_eq!(
            left(&snapshots),
            ["half.describe@start", "new.describe@start"]
        );
    }
}

#[test]
fn all_that_are_left_are_accepted_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    each_kind(&snapshots);
    let mut session = start(folder.path(), 100, &[]);
    session.until(PROMPT);
    session.press("?");
    assert!(
        session
            .until(PROMPT)
            .contains("q  quit, as Ctrl-C and Ctrl-D do; what was settled is kept")
    );
    session.press("s");
    let shown = session.until(PROMPT);
    for words in [
        "\n-   \"seen_of\": \"0a\",\n",
        "\n-     \"center\": [[30,40]],\n",
    ] {
        assert!(shown.contains(words), "{shown}");
    }
    session.press("s");
    let shown = session.until(PROMPT);
    let pictures =
        "snapshots/half@start.subgoal_1.snap.png -> snapshots/half@start.subgoal_1.snap.new.png\n";
    assert!(shown.contains(pictures), "{shown}");
    session.press("A");
    let (code, shown) = session.end();
    assert_eq!(code, Some(0));
    assert!(
        shown.ends_with("accepted 3, rejected 0, still pending 3\n"),
        "{shown}"
    );
    let left = left(&snapshots);
    assert_eq!(left.len(), 4, "{left:?}");
}

#[test]
fn of_many_snapshots_the_first_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    one_edit(&folder.path().join("snapshots"), 40);
    let mut session = start(folder.path(), 60, &[]);
    let shown = session.until(PROMPT);
    assert!(shown.contains("one edit changes 40 snapshots"), "{shown}");
    assert!(shown.contains("… and 32 more\n"), "{shown}");
    session.press("q");
    let (code, shown) = session.end();
    assert_eq!(code, Some(0));
    assert!(shown.ends_with("still pending 40\n"), "{shown}");
}

/// Two edits in three snapshots: each is shown once, and the snapshot with both waits for the second decision.
#[test]
fn each_edit_is_asked_for_once_and_a_text_with_two_waits_for_both() {
    let folder = tempfile::tempdir().unwrap();
    let snapshots = folder.path().join("snapshots");
    let old = prompt("half", "The red dots are corners.", 810);
    let second = prompt("half", "The blue dots are corners.", 812);
    let first = old.replace("You fold a cloth", "You fold a towel");
    let both = second.replace("You fold a cloth", "You fold a towel");
    for (name, new) in [
        ("a@start", &both),
        ("b@start", &first),
        ("c@start", &second),
    ] {
        accepted(&snapshots, name, &old);
        pending(&snapshots, name, new);
    }
    let mut session = start(folder.path(), 100, &[]);
    let shown = session.until(PROMPT);
    assert!(shown.contains("1 of 2"), "{shown}");
    assert!(shown.contains("one edit changes 2 snapshots"), "{shown}");
    session.press("a");
    let shown = session.until(PROMPT);
    assert!(
        shown.contains("1 snapshot waits until its other edits"),
        "{shown}"
    );
    assert!(shown.contains("one edit changes 2 snapshots"), "{shown}");
    assert_eq!(left(&snapshots), ["a@start", "c@start"]);
    session.press("a");
    let (code, shown) = session.end();
    assert_eq!(code, Some(0));
    assert!(
        shown.ends_with("accepted 3, rejected 0, still pending 0\n"),
        "{shown}"
    );
    assert!(left(&snapshots).is_empty());
}

/// Two edits of one text, the first of which is accepted: however the session ends, that acceptance is discarded.
#[test]
fn an_accepted_edit_of_a_text_that_waits_is_said_to_be_forgotten() {
    for (key, code) in [("s", 0), ("q", 0), ("\u{3}", 130)] {
        let folder = tempfile::tempdir().unwrap();
        let snapshots = folder.path().join("snapshots");
        let old = prompt("half", "The red dots are corners.", 810);
        let new = old.replace("You fold", "You turn").replace("red", "blue");
        accepted(&snapshots, "half.describe@start", &old);
        pending(&snapshots, "half.describe@start", &new);
        let mut session = start(folder.path(), 100, &[]);
        session.until(PROMPT);
        session.press("a");
        session.until(PROMPT);
        session.press(key);
        let (found, shown) = session.end();
        assert_eq!(found, Some(code));
        let words =
            "1 snapshot waits until its other edits are decided; decide about all of them at once";
        assert!(shown.contains(words), "{shown}");
        assert_eq!(left(&snapshots), ["half.describe@start"]);
    }
}
