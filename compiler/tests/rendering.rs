//! Templates render to the text that the author wrote, in Rust and in Python alike.

#![allow(clippy::unwrap_used)]

mod common;

use common::{Known, TASK, pixels, program};
use fab_program::Program;
use fab_program::render::{self, PromptMessage, PromptSpeaker, RenderError, Values};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

fn known() -> Known {
    Known {
        points: vec![
            ("corners", pixels(&[(1, 2), (-3, 4)])),
            ("center", pixels(&[(5, 6)])),
        ],
        texts: [("instruction".to_owned(), "fold {{ it }} & <b>".to_owned())].into(),
        ..Known::default()
    }
}

/// Renders a stage's messages.
fn rendered(
    program: &Program,
    stage: usize,
    known: &Known,
) -> Result<Vec<PromptMessage>, RenderError> {
    render::messages(
        program,
        &program.stages[stage],
        Values::Known(known.facts()),
    )
}

#[test]
fn a_stage_becomes_its_messages() {
    let program = program("task.fab", TASK);
    let messages = rendered(&program, 1, &known()).unwrap();
    assert_eq!(
        (messages[0].speaker, messages[0].content.text.as_str()),
        (PromptSpeaker::System, "You fold cloth.")
    );
    assert_eq!(
        messages[1].content.text,
        "- Instruction: fold {{ it }} & <b>\n- Corners: (1, 2), (-3, 4)\n- Center: (5, 6)\n\nPick Point = (x, y)\nPlace Point = (x, y)"
    );
    let asked = rendered(&program, 0, &Known::default()).unwrap();
    assert_eq!(
        (asked.len(), asked[0].pictures.len()),
        (1, 2),
        "no system message where nothing is said in one"
    );
}

#[test]
fn a_missing_value_is_named() {
    let program = program("task.fab", TASK);
    let error = rendered(&program, 1, &Known::default()).unwrap_err();
    assert_eq!(
        error,
        RenderError::MissingFact {
            name: "center".to_owned()
        }
    );
    assert_eq!(error.to_string(), "`center` is not known here");
}

#[test]
fn typed_placeholders_cover_every_variable() {
    let program = program("task.fab", TASK);
    let mut all = String::new();
    for template in &program.templates {
        all += &render::plain_text(&program, &template.name, Values::Typed)
            .unwrap()
            .unwrap();
    }
    assert!(
        all.contains("- Corners: <corners: points (x, y), …>"),
        "{all}"
    );
    assert!(
        all.contains("- Instruction: <instruction: the answer of stage describe>"),
        "{all}"
    );
}

#[test]
fn indentation_and_line_ends_are_the_authors() {
    let block = |body: &str| said(&format!("\"\"\"{body}\"\"\"")).unwrap();
    assert_eq!(block("\n    a\n      b\n\n    c\n    "), "a\n  b\n\nc");
    assert_eq!(block("\r\n\ta\r\n\t\tb\r\n"), "a\n\tb");
    assert_eq!(block("one line"), "one line");
    assert_eq!(block("\n  a  \n b\n"), " a  \nb");
    assert_eq!(
        block("\n\n  a\n\n"),
        "\na\n",
        "only the first and the last line break belong to the quotes"
    );
    assert_eq!(block("\n  {{ center }}\n  x\n"), "(5, 6)\nx");
    assert_eq!(
        block("\n  a \"quoted\" word\n  # no comment\n"),
        "a \"quoted\" word\n# no comment"
    );
    assert_eq!(said(r#""a \"b\" \\ c""#).unwrap(), r#"a "b" \ c"#);
}

#[test]
fn braces_of_jinja_are_literal() {
    for text in [
        "{",
        "}}",
        "{%",
        "{# a #}",
        "{% if x %}",
        "{\"a\": {\"b\": 1}}",
        "%}",
        "{ {",
        "{%- raw -%}",
        "#}",
    ] {
        assert_eq!(said(&format!("\"\"\"{text}\"\"\"")).unwrap(), text);
    }
    assert_eq!(said("\"\"\"{{{ center }}}\"\"\"").unwrap(), "{(5, 6)}");
    assert_eq!(
        said("\"\"\"{{ \"{{\" }} and {{ \"{%\" }}\"\"\"").unwrap(),
        "{{ and {%"
    );
}

/// Returns the rendered text of a stage that says this text.
fn said(text: &str) -> Option<String> {
    let program = with_text(text)?;
    let messages = rendered(&program, 0, &known()).unwrap();
    Some(messages[0].content.text.clone())
}

fn with_text(text: &str) -> Option<Program> {
    common::compile(
        "task.fab",
        &TASK.replace("\"What is folded? Instructions: ...\"", text),
    )
    .programs
    .pop()
}

/// Texts that are hard for templates: braces, quotes, blanks, line ends, with placeholders between.
fn hard_texts() -> impl Strategy<Value = String> {
    let piece = prop::sample::select(vec![
        "{",
        "}",
        "%",
        "#",
        "{%",
        "%}",
        "{#",
        "#}",
        "-",
        " ",
        "\n",
        "\n    ",
        "\t",
        "a",
        "é",
        "\\",
        "\"",
        "'",
        "{{ center }}",
        "{{ corners }}",
        "{{ \"{{\" }}",
        "{{ actions.format }}",
        "raw",
        "endraw",
        "~",
        "|",
        "0",
    ]);
    prop::collection::vec(piece, 0..30).prop_map(|pieces| pieces.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_accepted_text_can_be_rendered(text in hard_texts()) {
        let quoted = format!("\"\"\"{text}\"\"\"");
        if let Some(program) = with_text(&quoted) {
            prop_assert!(rendered(&program, 0, &known()).is_ok());
        }
    }
}

#[test]
#[ignore = "needs Python with jinja2 3.1.6"]
fn peer_python_renders_every_template_alike() {
    let mut runner = TestRunner::deterministic();
    let mut templates = Vec::new();
    while templates.len() < 2000 {
        let text = hard_texts().new_tree(&mut runner).unwrap().current();
        if let Some(program) = with_text(&format!("\"\"\"{text}\"\"\"")) {
            let rendered = rendered(&program, 0, &known()).unwrap()[0]
                .content
                .text
                .clone();
            templates.push((
                program.template("describe.say").unwrap().text.clone(),
                rendered,
            ));
        }
    }
    let values = serde_json::json!({
        "corners": "(1, 2), (-3, 4)",
        "center": "(5, 6)",
        "instruction": "fold {{ it }} & <b>",
        "actions_format": "Pick Point = (x, y)\nPlace Point = (x, y)",
    });
    let asked: Vec<_> = templates
        .iter()
        .map(|(text, _)| serde_json::json!([text, values]))
        .collect();
    let answers = common::jinja2::rendered(&asked);
    for ((template, ours), theirs) in templates.iter().zip(&answers) {
        assert_eq!(ours, theirs, "{template:?}");
    }
}
