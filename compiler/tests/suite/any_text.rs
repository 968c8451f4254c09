//! No text makes the compiler panic, hang, or lose a byte.

use crate::common::{TASK, compile};
use crate::growth;
use fab_compiler::diag::{self, Code, Color};
use proptest::prelude::*;

/// Compiles and writes every diagnostic in each form.
fn survive(text: &str) {
    let compiled = compile("task.fab", text);
    let shown = diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain);
    assert_eq!(shown.is_empty(), compiled.diagnostics.is_empty());
    diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Ansi);
    let json = diag::to_json(&compiled.diagnostics, &compiled.sources);
    assert_eq!(json.as_array().unwrap().len(), compiled.diagnostics.len());
    // A task without an error is a program, or is reported as a base.
    let has_task = fab_grammar::parse(fab_grammar::FileId::FIRST, text)
        .tree
        .nodes()
        .any(|node| node.kind() == fab_grammar::Kind::Task);
    let is_base = compiled
        .diagnostics
        .iter()
        .any(|diagnostic| diagnostic.code == Code::BaseOnly);
    assert!(
        compiled.has_errors() || !has_task || is_base || !compiled.programs.is_empty(),
        "{text}"
    );
}

fn words() -> Vec<&'static str> {
    let mut words: Vec<&str> = TASK
        .split_inclusive([' ', '\n', '(', ')', ',', '"', '{', '}'])
        .collect();
    words.extend([
        "\"\"\"",
        "{{",
        "}}",
        "“",
        "'",
        "\\",
        "\r",
        "\u{feff}",
        "#",
        "->",
        "extends",
        "override component",
        "override check",
        "without check",
        "without variant",
        "say a in b after",
        "use \"task.fab\"",
        "é",
        "9e9",
        "-1mm",
    ]);
    words
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_compiled_or_refused(text in any::<String>()) {
        survive(&text);
    }

    #[test]
    fn any_order_of_a_tasks_words_is_compiled_or_refused(words in prop::collection::vec(prop::sample::select(words()), 0..120)) {
        survive(&words.concat());
    }

    #[test]
    fn a_task_with_a_slip_is_compiled_or_refused(at in 0..TASK.len(), length in 0usize..40, put in prop::sample::select(words())) {
        prop_assume!(TASK.is_char_boundary(at));
        let end = (at..=TASK.len()).rev().find(|end| *end <= at + length && TASK.is_char_boundary(*end)).unwrap_or(at);
        survive(&format!("{}{put}{}", &TASK[..at], &TASK[end..]));
    }
}

#[test]
fn a_file_full_of_open_brackets_is_one_error() {
    for bracket in ["(", "{", "sequence {", "not (", "{ (", "f("] {
        for prefix in [
            "",
            "task t { goal ",
            "task t { verify { check a { ",
            "experts e { ",
        ] {
            let most = (fab_grammar::MAX_BYTES - prefix.len()) / bracket.len();
            let text = format!("{prefix}{}", bracket.repeat(most));
            let compiled = compile("task.fab", &text);
            assert_eq!(compiled.diagnostics.len(), 1, "{prefix}{bracket}");
            assert_eq!(compiled.diagnostics[0].code.as_str(), "F0112");
        }
    }
}

#[test]
fn as_many_brackets_as_are_allowed_fit_the_stack() {
    // The task, the section, the check and `distance(` are open too.
    let deepest = fab_grammar::MAX_NESTING - 4;
    let text = TASK.replace(
        "distance(pick, place) > 10px",
        &format!(
            "{}distance(pick, place) > 10px{}",
            "not (".repeat(deepest),
            ")".repeat(deepest)
        ),
    );
    // It must also work with half the stack that Rust gives a thread.
    let thread = std::thread::Builder::new()
        .stack_size(1 << 20)
        .spawn(move || compile("task.fab", &text).programs.len());
    assert_eq!(thread.unwrap().join().unwrap(), 1);
}

#[test]
fn large_nonsense_takes_linear_time() {
    let line = "task t extends t { horizon 1 }\n";
    for piece in [
        "\"",
        "\"\"\"",
        "{{",
        "# \n",
        "x ",
        "a = ",
        ",",
        "} ",
        "\\\"",
        "use \"\"\n",
        "“",
        "'",
        "not ",
        "a -> ",
        line,
        "experts a { sequence { } }\n",
        "task a { stage b { model text } }\n",
        "component a \"\"\"\n",
        "1 < ",
        "a and ",
        "}\n",
        "override component x \"y\"\n",
        "override check x { 1 < 2 } else \"y\"\n",
        "without check x\n",
        "without variant x\n",
        "say x in y after z\n",
        "check x { 1 < 2 } else \"y\"\n",
    ] {
        for prefix in ["", "task t {\n", "task t { verify { check a { "] {
            growth::assert_linear(&format!("{prefix}{piece}"), 1 << 11, |length| {
                let text = format!("{prefix}{}", piece.repeat(length / piece.len()));
                compile("task.fab", &text);
            });
        }
    }
}
