//! Templates render to the text that the author wrote, in Rust and in Python alike.

use crate::common;
use crate::common::{Known, TASK, pixels, program};
use fab_program::render::{self, PromptMessage, PromptSpeaker, RenderError, Values};
use fab_program::scene::Unreachable;
use fab_program::{PixelPoint, Program};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use std::collections::BTreeMap;

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
fn a_measure_is_written_in_the_unit_of_its_placeholder() {
    let text = TASK
        .replacen(
            "center  =",
            "tip     = rightmost(corners)\n        center  =",
            1,
        )
        .replace(
            "place: one of corners, center",
            "direction: one of 90deg, 0deg, 180deg\n        distance: one of 10mm, 20mm",
        )
        .replace("distance(pick, place)", "distance(pick, center)")
        .replace("{{ place }}", "{{ center }}");
    // The tip is 10 px right of the center and 10 px above it.
    let known = Known {
        points: vec![("center", pixels(&[(5, 6)])), ("tip", pixels(&[(15, -4)]))],
        ..Known::default()
    };
    for (placeholder, written) in [
        ("angle_between(from center to tip, 0deg)", "45 deg"),
        ("angle_between(from center to tip, 30deg)", "15 deg"),
        ("angle_between(from tip to center, 30deg)", "165 deg"),
        (
            "angle_between(from center to tip, 0deg) in rad",
            "0.785 rad",
        ),
        (
            "angle_between(from center to tip, 270deg) in turn",
            "0.375 turn",
        ),
        ("distance(center, tip)", "14.1 px"),
        ("chebyshev(center, tip)", "10 px"),
        ("y(tip)", "-4 px"),
        ("mirror(tip, center)", "(-5, 16)"),
        ("nearest(direction, 10deg)", "0 deg"),
        ("nearest(direction, from tip to center)", "180 deg"),
        // Equally near to 90 and to 0 degrees.
        ("nearest(direction, from center to tip)", "90 deg"),
    ] {
        let shown = text.replace("What is folded?", &format!("{{{{ {placeholder} }}}};"));
        let program = program("task.fab", &shown);
        let messages = rendered(&program, 0, &known).unwrap();
        let expected = format!("{written}; Instructions: ...");
        assert_eq!(messages[0].content.text, expected, "{placeholder}");
    }
}

#[test]
fn points_out_of_reach_are_told_once() {
    let remark = "\n\nSome points cannot be reached, and nothing can be done there. They are not among those listed: (9, 9): too far.";
    let far = Unreachable {
        point: PixelPoint::new(9, 9),
        why: "too far".to_owned(),
    };
    let guarded = TASK.replacen(
        "    stage describe",
        "    component far when unreachable \"Mind the edge.\"\n\n    stage describe",
        1,
    );
    let said = "\"What is folded? Instructions: ...\"";
    for (say, unreachable, expected) in [
        ("\"{{ center }}\"", vec![], "(5, 6)".to_owned()),
        (
            "\"{{ center }}\"",
            vec![far.clone()],
            format!("(5, 6){remark}"),
        ),
        (
            "\"Not {{ unreachable }}.\"",
            vec![far.clone()],
            "Not (9, 9): too far.".to_owned(),
        ),
        ("\"Which one?\"", vec![far.clone()], "Which one?".to_owned()),
        ("\"Where?\", far", vec![], "Where?".to_owned()),
        (
            "\"Where?\", far",
            vec![far],
            "Where?\n\nMind the edge.".to_owned(),
        ),
    ] {
        let known = Known {
            unreachable,
            ..known()
        };
        let program = program("task.fab", &guarded.replace(said, say));
        let messages = rendered(&program, 0, &known).unwrap();
        assert_eq!(messages[0].content.text, expected, "{say}");
    }
}

#[test]
fn each_check_has_its_correction() {
    let program = program("task.fab", TASK);
    let told = render::corrections(&program, Values::Typed).unwrap();
    let told: Vec<(&str, &str)> = told
        .iter()
        .map(|(name, content)| (name.as_str(), content.text.as_str()))
        .collect();
    let [pick, place] = ["pick", "place"].map(|field| format!("<{field}: the proposed value>"));
    let expected = [
        ("on_cloth", format!("{pick} is off the cloth.")),
        ("moves", format!("{pick} and {place} are too near.")),
    ];
    let expected: Vec<(&str, &str)> = expected
        .iter()
        .map(|(name, text)| (*name, text.as_str()))
        .collect();
    assert_eq!(told, expected);
}

#[test]
fn a_text_has_a_longest_length() {
    for (n_bytes, fits) in [(1 << 20, true), ((1 << 20) + 1, false)] {
        let filled = render::fill(&"a".repeat(n_bytes), &BTreeMap::new());
        assert_eq!(filled.is_ok(), fits, "{n_bytes}");
    }
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
