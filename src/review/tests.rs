//! What a group looks like in a terminal, and which ids fit a pattern.
#![allow(clippy::unwrap_used)]

use super::decide::fits;
use super::find::Pending;
use super::groups::{self, Kind};
use super::show::{self, Extent, Layout, View};
use crate::snapshots::{Contents, Info, Metadata, Name, Origin, Snapshot};
use compiler::diag::Color;
use std::path::PathBuf;

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
    Snapshot {
        metadata: Metadata {
            info: Some(info),
            ..Metadata::default()
        },
        contents: Contents::Text(text.to_owned()),
    }
}

fn pending(before: &str, after: &str) -> Pending {
    let proposed = snapshot(after);
    Pending {
        folder: 0,
        name: Name::new("half.describe@start").unwrap(),
        path: PathBuf::from("snapshots/half.describe@start.snap.new"),
        accepted: Some(snapshot(before)),
        info: proposed.metadata.info.clone().unwrap(),
        proposed,
    }
}

fn shown(before: &str, after: &str, view: &View) -> String {
    let pending = [pending(before, after)];
    let groups = groups::group(&pending);
    assert_eq!(groups.len(), 1);
    show::group(&groups[0], &pending, None, view)
}

const NARROW: View = View {
    columns: 60,
    color: Color::Plain,
    layout: Layout::Unified,
    extent: Extent::Folded,
};

#[test]
fn lines_that_go_and_come_carry_their_sign_at_any_width() {
    let before = format!("kept\n{}\nkept too", "one two three ".repeat(20));
    let after = before.replacen("two", "折 zwei", 1);
    for (layout, columns) in [
        (Layout::Unified, 60),
        (Layout::SideBySide, 60),
        (Layout::SideBySide, 100),
        (Layout::Unified, 20),
    ] {
        let view = View {
            columns,
            layout,
            ..NARROW
        };
        let text = shown(&before, &after, &view);
        for line in text.lines() {
            assert!(console::measure_text_width(line) <= columns, "{line:?}");
        }
        let signed = |sign: &str| text.lines().filter(|line| line.starts_with(sign)).count();
        assert!(signed("- ") > 3, "{text}");
        match layout {
            Layout::Unified => assert!(signed("+ ") > 3, "{text}"),
            Layout::SideBySide => assert!(text.contains("│ + one 折 zwei"), "{text}"),
        }
    }
}

#[test]
fn words_that_differ_are_marked_in_colour_only() {
    let color = View {
        color: Color::Ansi,
        ..NARROW
    };
    let (before, after) = ("the red dots are corners", "the blue dots are corners");
    let text = shown(before, after, &color);
    assert!(
        text.contains("\x1b[1;4;31mred\x1b[0m\x1b[31m dots"),
        "{text:?}"
    );
    assert!(
        text.contains("\x1b[1;4;32mblue\x1b[0m\x1b[32m dots"),
        "{text:?}"
    );
    let plain = shown(before, after, &NARROW);
    let mut parts = text.split("\x1b[");
    let first = parts.next().unwrap().to_owned();
    let uncoloured = parts.fold(first, |all, part| all + part.split_once('m').unwrap().1);
    assert_eq!(uncoloured, plain);
    assert!(!plain.contains('\x1b'));
}

#[test]
fn what_a_terminal_would_obey_is_shown_as_a_sign() {
    let text = shown("a", "a\x1b]0;title\x07\u{202e}b\u{9b}2J\tc", &NARROW);
    assert!(
        text.contains("+ a␛]0;title␇\u{fffd}b\u{fffd}2J    c"),
        "{text:?}"
    );
}

#[test]
fn texts_of_any_length_are_compared_in_bounded_time() {
    let many = |start: usize| -> String {
        (start..start + 60_000)
            .map(|line| format!("{line}\n"))
            .collect()
    };
    let pending = [pending(&many(0), &many(70_000))];
    let groups = groups::group(&pending);
    assert_eq!(groups[0].edits[0].added.len(), 60_000);
    let text = shown(&"a b ".repeat(100_000), &"b a ".repeat(100_000), &NARROW);
    assert!(text.contains("\n- a b a b"));
}

#[test]
fn a_text_in_place_of_a_picture_is_no_edit() {
    let mut one = pending("a", "b");
    one.accepted.as_mut().unwrap().contents = Contents::Picture(vec![1]);
    assert_eq!(groups::group(&[one])[0].kind, Kind::Picture);
}

#[test]
fn a_pattern_is_a_part_or_fits_the_whole() {
    let cases = [
        ("half", "half.describe@start", true),
        ("@start", "half.describe@start", true),
        ("", "half", true),
        ("Half", "half", false),
        ("half*", "half.describe@start", true),
        ("*half", "half.describe@start", false),
        ("*.describe@*", "half.v.describe@start", true),
        ("h?lf", "half", true),
        ("h?lf", "half.a", false),
        ("*", "", true),
        ("?", "", false),
        ("a*b*c", "a1b2b3c", true),
        ("a*b*c", "a1b2b3", false),
        ("*a*a*a*a*a*a*b", &"a".repeat(200), false),
    ];
    for (pattern, id, expected) in cases {
        assert_eq!(fits(pattern, id), expected, "{pattern} {id}");
    }
}
