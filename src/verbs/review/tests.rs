//! What counts as one edit, how a terminal shows a group, and which ids match a pattern.
#![allow(clippy::unwrap_used)]

use super::cost;
use super::decide::fits;
use super::find::Pending;
use super::groups::{self, Group, Kind, Tokens};
use super::show::{self, Extent, Layout, View};
use super::styled::{Line, Style};
use crate::snapshots::{Contents, Info, Metadata, Name, Origin, Snapshot};
use fab_compiler::diag::Color;
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
        unreadable: None,
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
    let removed = &groups[0].edits[0].removed;
    assert_eq!(removed.iter().filter(|line| line.is_empty()).count(), 1);
    // If it is dropped beside one that changed, it is still part of that edit.
    let other = ("center", 36, "The middle.");
    let both = changed(composed(&[one, two, three]), composed(&[one, other]));
    let groups = groups::group(&[both, changed(composed(&[one, two]), composed(&[one]))]);
    let members: Vec<_> = groups.iter().map(|group| group.members.len()).collect();
    assert_eq!(members, [1, 2], "{groups:#?}");
    // A blank line alone is an edit without a known cause.
    let mut spaced = composed(&[one, three]);
    spaced.contents = Contents::Text("Frame.\n\n\nThe center.".to_owned());
    let groups = groups::group(&[changed(composed(&[one, three]), spaced)]);
    assert_eq!(groups[0].edits[0].added, [""]);
}

#[test]
fn token_counts_of_any_size_are_added_up() {
    let tokens = |questions: &[[u64; 2]]| Tokens {
        questions: questions.to_vec(),
    };
    let large = tokens(&[[u64::MAX, 0], [1, u64::MAX], [u64::MAX, u64::MAX]]);
    assert_eq!(large.sums(), Some([u64::MAX, u64::MAX]));
    assert_eq!(large.range(), Some([i64::MIN, i64::MAX]));
    assert!(cost::in_words(&large, None).is_some());
    assert_eq!(tokens(&[]).sums(), None);
    let mut one = pending("a\n\nb", "c\n\nd");
    for snapshot in [&mut one.proposed, one.accepted.as_mut().unwrap()] {
        snapshot.metadata.info.as_mut().unwrap().tokens = Some(u64::MAX);
    }
    one.info.tokens = Some(u64::MAX);
    assert!(!groups::group(&[one]).is_empty());
}

#[test]
fn rows_are_broken_behind_their_first_word_and_set_in() {
    let rows = |text: &str, columns: usize| -> Vec<String> {
        let rows = Line::of(text, Style::Plain).wrapped(columns, 2);
        rows.iter().map(|row| row.painted(Color::Plain)).collect()
    };
    let cases: [(&str, usize, &[&str]); 7] = [
        ("  one.two.three", 9, &["  one.two", "    .thre", "    e"]),
        ("  one two three", 10, &["  one two", "    three"]),
        ("one two", 7, &["one two"]),
        ("one two", 4, &["one", "  tw", "  o"]),
        ("折折折", 3, &["折", " 折", " 折"]),
        ("        one", 4, &["", "", "", "  on", "  e"]),
        ("", 4, &[""]),
    ];
    for (text, columns, expected) in cases {
        assert_eq!(rows(text, columns), expected, "{text} {columns}");
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
fn new_pictures_are_listed_by_file_and_folded() {
    let pictures: Vec<Pending> = (10..22)
        .map(|number| {
            let mut one = pending("", "");
            one.accepted = None;
            one.proposed.contents = Contents::Picture(vec![1]);
            one.path = PathBuf::from(format!("snapshots/half@{number}.snap.new"));
            one
        })
        .collect();
    let groups = groups::group(&pictures);
    let shown = |extent| show::group(&groups[0], &pictures, None, &View { extent, ..NARROW });
    let folded = shown(Extent::Folded);
    let list = "\npictures to look at:\n  snapshots/half@10.snap.new.png\n";
    assert!(folded.contains(list), "{folded}");
    let end = "\n  snapshots/half@17.snap.new.png\n  … and 4 more\n";
    assert!(folded.contains(end), "{folded}");
    assert!(shown(Extent::Full).contains("\n  snapshots/half@21.snap.new.png\n"));
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
