//! What counts as one edit, and how a terminal shows a group.
#![allow(clippy::unwrap_used)]

use super::find::Pending;
use super::groups::{self, Group, Kind};
use super::show;
use crate::snapshots::{Contents, Folder, Info, Origin, Snapshot};
use fab_compiler::diag::Color;
use std::path::PathBuf;
use std::rc::Rc;

fn snapshot(text: &str) -> Snapshot {
    let info = Info {
        task: "half".to_owned(),
        stage: Some("describe".to_owned()),
        origin: vec![Origin {
            from: 1,
            to: 100_000,
            component: "visual_context".to_owned(),
            place: Some(("lib/folding.fab".to_owned(), 28)),
        }],
        ..Info::default()
    };
    let contents = Contents::Text(text.to_owned());
    Snapshot::of("half.fab", String::new(), info, contents)
}

fn pending(before: &str, after: &str) -> Pending {
    let proposed = snapshot(after);
    Pending {
        folder: Rc::new(Folder::open("nowhere").unwrap()),
        name: "half.describe@start".to_owned(),
        path: PathBuf::from("snapshots/half.describe@start.snap.new"),
        file: None,
        accepted: Some(snapshot(before)),
        info: proposed.metadata.info.clone().unwrap(),
        proposed,
    }
}

/// A text composed of components: their names, first lines and contents, with a blank line between each two.
fn composed(parts: &[(&str, u32, &str)]) -> Snapshot {
    let texts: Vec<&str> = parts.iter().map(|(_, _, text)| *text).collect();
    let mut one = snapshot(&texts.join("\n\n"));
    let mut from = 1;
    let origin = parts.iter().map(|(component, line, text)| {
        let to = from + text.lines().count() as u32 - 1;
        let origin = Origin {
            from,
            to,
            component: (*component).to_owned(),
            place: Some(("lib/folding.fab".to_owned(), *line)),
        };
        from = to + 2;
        origin
    });
    let origin = origin.collect();
    one.metadata.info.as_mut().unwrap().origin = origin;
    one
}

fn changed(before: Snapshot, after: Snapshot) -> Pending {
    Pending {
        info: after.metadata.info.clone().unwrap(),
        accepted: Some(before),
        proposed: after,
        ..pending("", "")
    }
}

/// The components and file lines that a group names.
fn lines(group: &Group) -> Vec<(&str, u32)> {
    let causes = group.causes.iter();
    causes
        .map(|cause| (cause.component.as_str(), cause.line.unwrap()))
        .collect()
}

#[test]
fn the_cause_is_the_line_that_changed() {
    let cases = [
        ("one\ntwo\nthree", "one\nzwei\nthree", 29),
        ("one\ntwo\nthree", "one\ntwo", 30),
        ("one\ntwo\nthree", "one\ntwo\nthree\nfour\nfive", 31),
    ];
    for (before, after, line) in cases {
        let groups = groups::group(&[pending(before, after)]);
        assert_eq!(lines(&groups[0]), [("visual_context", line)], "{after}");
    }
}

#[test]
fn a_component_dropped_anywhere_is_one_edit() {
    let (one, two, three) = (
        ("frame", 3, "Frame."),
        ("arrow", 31, "An arrow.\nIts tail."),
        ("center", 36, "The center."),
    );
    let pending = [
        changed(composed(&[one, two, three]), composed(&[one, three])),
        changed(composed(&[one, two]), composed(&[one])),
        changed(composed(&[two, three]), composed(&[three])),
    ];
    let groups = groups::group(&pending);
    assert_eq!(groups.len(), 1, "{groups:#?}");
    assert_eq!(groups[0].members, [0, 1, 2]);
    assert_eq!(lines(&groups[0]), [("arrow", 31)]);
    assert_eq!(groups[0].edits[0].removed, ["An arrow.", "Its tail."]);
    // If it is dropped beside one that changed, it is still part of that edit.
    let other = ("center", 36, "The middle.");
    let both = changed(composed(&[one, two, three]), composed(&[one, other]));
    let groups = groups::group(&[both, changed(composed(&[one, two]), composed(&[one]))]);
    let members: Vec<_> = groups.iter().map(|group| group.members.len()).collect();
    assert_eq!(members, [1, 2], "{groups:#?}");
    // A blank line alone is no edit, and still a change.
    let mut spaced = composed(&[one, three]);
    spaced.contents = Contents::Text("Frame.\n\n\nThe center.".to_owned());
    let center = &mut spaced.metadata.info.as_mut().unwrap().origin[1];
    (center.from, center.to) = (4, 4);
    let groups = groups::group(&[changed(composed(&[one, three]), spaced)]);
    assert_eq!((groups.len(), groups[0].edits.len()), (1, 0));
}

fn shown(before: &str, after: &str, color: Color) -> String {
    let pending = [pending(before, after)];
    let groups = groups::group(&pending);
    assert_eq!(groups.len(), 1);
    show::group(&groups[0], &pending, color)
}

fn without_colour(text: &str) -> String {
    let mut parts = text.split("\x1b[");
    let first = parts.next().unwrap().to_owned();
    parts.fold(first, |all, part| all + part.split_once('m').unwrap().1)
}

#[test]
fn words_that_differ_are_marked_in_colour_only() {
    let (before, after) = ("the red dots are corners", "the blue dots are corners");
    let text = shown(before, after, Color::Ansi);
    for (code, word) in [(31, "red"), (32, "blue")] {
        let marked = format!("\x1b[{code}m\x1b[1m\x1b[4m{word}\x1b[0m");
        assert!(text.contains(&marked), "{text:?}");
    }
    let plain = shown(before, after, Color::Plain);
    assert_eq!(without_colour(&text), plain);
    assert!(!plain.contains('\x1b'));
}

#[test]
fn what_a_terminal_would_obey_is_shown_as_a_sign() {
    let text = shown("a", "a\x1b]0;title\x07\u{202e}b\u{9b}2J\tc", Color::Plain);
    assert!(
        text.contains("+ a\\u{1b}]0;title\\u{7}\\u{202e}b\\u{9b}2J    c"),
        "{text:?}"
    );
}

#[test]
fn a_text_in_place_of_a_picture_is_no_edit() {
    let mut one = pending("a", "b");
    one.accepted.as_mut().unwrap().contents = Contents::Picture(vec![1]);
    assert_eq!(groups::group(&[one])[0].kind, Kind::Picture);
}

#[test]
fn new_pictures_are_listed_by_file() {
    let pictures: Vec<Pending> = (10..22)
        .map(|number| {
            let mut one = pending("", "");
            one.accepted = None;
            one.proposed.contents = Contents::Picture(vec![1]);
            one.file = Some(format!("snapshots/half@{number}.snap.new.png").into());
            one
        })
        .collect();
    let groups = groups::group(&pictures);
    let text = show::group(&groups[0], &pictures, Color::Plain);
    for number in 10..22 {
        let line = format!("\nlook at snapshots/half@{number}.snap.new.png\n");
        assert!(text.contains(&line), "{text}");
    }
    assert!(text.ends_with("\n  … and 4 more"), "{text}");
}
