//! A few diagnostics in full, as users see them. The fault fixtures check codes and places of the others.

use crate::common;
use crate::common::{Memory, TASK};
use fab_compiler::diag::{self, Color};

fn shown(child: &str) -> String {
    let files = Memory::of([("child.fab", child), ("lib/base.fab", TASK)]);
    let compiled = fab_compiler::compile("child.fab", &files).unwrap();
    diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain)
}

#[test]
fn a_length_and_an_angle_are_told_apart() {
    insta::assert_snapshot!(shown(
        "use \"lib/base.fab\"\n\ntask tried extends small {\n    goal particle_distance < 40deg\n}\n"
    ));
}

#[test]
fn a_misspelt_section_is_recognised() {
    insta::assert_snapshot!(shown(
        "use \"lib/base.fab\"\n\ntask tried extends small {\n    subgaols {\n        demonstrate { }\n    }\n}\n"
    ));
}

#[test]
fn two_files_are_shown_where_two_are_involved() {
    insta::assert_snapshot!(shown(
        "use \"lib/base.fab\"\n\ntask tried extends small {\n    component role \"You fold.\"\n}\n"
    ));
}

#[test]
fn several_faults_are_shown_in_the_order_of_the_source() {
    insta::assert_snapshot!(shown(
        "use \"lib/base.fab\"\n\ntask tried extends smal {\n    actions {\n        pick = one of corners,\n    }\n    verify {\n        check a { pick within cloth } else “No.”\n\n}\n"
    ));
}

#[test]
fn tools_get_places_and_edits() {
    let files = Memory::of([(
        "child.fab",
        "task tried {\r\n    horizon 2.5\r\n    camera top_down(hieght: 1m)\r\n}\r\n",
    )]);
    let compiled = fab_compiler::compile("child.fab", &files).unwrap();
    insta::assert_snapshot!(
        serde_json::to_string_pretty(&diag::to_json(&compiled.diagnostics, &compiled.sources))
            .unwrap()
    );
}

#[test]
fn line_ends_of_other_systems_are_not_shown() {
    let text = "task tried {\r\n    horizon 2.5\r\n    component a \"\"\"\r\n    x {{ nothing }}\r\n    \"\"\"\r\n}\r\n";
    for text in [text.to_owned(), text.replace("\r\n", "\n")] {
        let compiled = common::compile("child.fab", &text);
        let shown = diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain);
        assert!(shown.contains("2 |     horizon 2.5\n"), "{shown}");
        assert!(!shown.contains(['\r', '␍']), "{shown}");
    }
}

#[test]
fn source_lines_cannot_act_on_a_terminal() {
    let compiled = common::compile(
        "child.fab",
        "task a { # \u{9b}31m \u{1b}[31m\n    goal \u{85}1\n}",
    );
    let shown = diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain);
    let is_control = |letter: char| letter.is_control() && letter != '\n';
    assert!(!shown.contains(is_control), "{shown:?}");
    let marked = "1 | task a { # \\u{9b}31m ␛[31m\n  |            ^^^^^^\n";
    assert!(shown.contains(marked), "{shown}");
}

#[test]
fn colours_are_asked_for() {
    let compiled = common::compile("child.fab", "task {");
    assert!(
        diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Ansi).contains("\u{1b}[")
    );
    assert!(
        !diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain).contains('\u{1b}')
    );
}

#[test]
fn a_flood_is_cut_and_counted() {
    let compiled = common::compile("child.fab", &"task { }\n".repeat(150));
    let shown = diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain);
    assert!(
        shown.ends_with("… and 50 more\n"),
        "{}",
        &shown[shown.len() - 100..]
    );
}
