//! Prompts, schemas and rejections in each frame.

use super::{common, frame, in_frame, known, points, program};
use fab_program::Proposal;
use fab_program::pointing::{CoordinateUnit, Frame, Notation, Order, Pointing, PointingError};
use fab_program::render::{self, RenderError, Values};
use fab_program::reply;
use fab_program::space;
use fab_program::verify::{self, Strictness, Verdict};
use fab_program::{PixelPoint, Value};

fn marks() -> Pointing {
    Pointing::Marks(Frame::pixels([224; 2]))
}

/// Returns the question of the second stage, and the schema of its pick.
fn said(pointing: Pointing) -> (String, serde_json::Value) {
    let known = known();
    let facts = in_frame(&known, pointing);
    let asked = |values| {
        let messages = render::messages(program(), &program().stages[1], values).unwrap();
        messages.last().unwrap().content.text.clone()
    };
    let text = asked(Values::Known(facts));
    let elsewhere = in_frame(&known, Pointing::pixels([9; 2]));
    for values in [Values::Known(elsewhere), Values::Partly(elsewhere)] {
        assert_eq!(asked(values.with_pointing(pointing)), text);
    }
    let fields = program().actions.iter();
    let offered: Vec<(String, Vec<Value>)> = fields
        .map(|field| (field.name.clone(), space::choices(field, &known)))
        .collect();
    let schema = reply::schema_in(program(), &facts.notation(program()), &offered);
    (text, schema["properties"]["pick"].clone())
}

fn assert_has(text: &str, part: &str) {
    assert!(text.contains(part), "{part}\nis not in\n{text}");
}

#[test]
fn in_pixels_nothing_is_added() {
    let (text, schema) = said(Pointing::pixels([224; 2]));
    assert_has(&text, "Corners: (41, 167), (167, 41), (57, 58), (0, 223)\n");
    assert!(
        text.ends_with("\nPick Point = (x, y)\nPlace Point = (x, y)"),
        "{text}"
    );
    assert_eq!(schema["description"], "the pick point (x, y), pixels");
}

#[test]
fn with_y_first_prompt_and_schema_say_so() {
    let pointing = Pointing::Frame(frame(CoordinateUnit::PerMille, Order::Yx, 224, 224));
    let (text, schema) = said(pointing);
    assert_has(
        &text,
        "Corners: [748, 185], [185, 748], [261, 257], [998, 2]\n",
    );
    assert_has(&text, "\nPick Point = [y, x]\nPlace Point = [y, x]\n");
    // The task's own words do not say how a point is written.
    let sentence = "A point is written [y, x] in thousandths of the picture's height and width: x grows to the \
        right, y grows downwards, and [0, 0] is the top left of the picture.";
    assert!(text.ends_with(sentence), "{text}");
    assert_eq!(schema["enum"][0], "[748, 185]");
    assert_eq!(
        schema["description"],
        "the pick point [y, x] in thousandths of the picture's height and width"
    );
}

#[test]
fn numbered_points_have_one_numbering_for_all_fields() {
    let (text, schema) = said(marks());
    assert_has(
        &text,
        "Corners: 1 at (41, 167), 2 at (167, 41), 3 at (57, 58), 4 at (0, 223)\n",
    );
    assert_has(&text, "Center: 5 at (112, 112)");
    assert_has(&text, "\nPick Point = number\nPlace Point = number\n");
    assert_eq!(schema["enum"], serde_json::json!(["1", "2", "3", "4"]));
}

#[test]
fn a_message_of_a_check_is_in_the_frame_of_the_answer() {
    let known = known();
    let corner = Value::Point(PixelPoint::new(41, 167));
    let fields = ["pick", "place"].map(|name| (name.to_owned(), corner.clone()));
    let proposal = Proposal {
        fields: fields.into(),
    };
    let y_first = Pointing::Frame(frame(CoordinateUnit::Percent, Order::Yx, 224, 224));
    let rows = [
        (Pointing::pixels([224; 2]), "(41, 167)"),
        (y_first, "[74.8, 18.5]"),
        (marks(), "1 at (41, 167)"),
    ];
    for (pointing, point) in rows {
        let facts = in_frame(&known, pointing);
        match verify::verdict(program(), facts, &proposal, Strictness::Full).unwrap() {
            Verdict::Reject { message, .. } => {
                assert_eq!(message, format!("{point} and {point} are too near."));
            }
            Verdict::Accept => panic!("it moves nothing"),
        }
    }
}

#[test]
fn a_point_that_is_not_offered_is_refused_in_the_frame_of_the_answer() {
    let known = known();
    let values = [[1, 2], [41, 167]].map(|point| Value::Point(point.into()));
    let fields = ["pick".to_owned(), "place".to_owned()].into_iter();
    let proposal = Proposal {
        fields: fields.zip(values).collect(),
    };
    let y_first = Pointing::Frame(frame(CoordinateUnit::Percent, Order::Yx, 224, 224));
    for (pointing, point) in [(y_first, "[1.1, 0.7]"), (marks(), "(1, 2)")] {
        let facts = in_frame(&known, pointing);
        let verdict = verify::verdict(program(), facts, &proposal, Strictness::Full).unwrap();
        let Verdict::Reject { message, .. } = verdict else {
            panic!("{pointing:?}: it is not offered");
        };
        let listed = facts.notation(program()).written(PixelPoint::new(41, 167));
        let begins = format!(
            "The pick point {point} is not one of the offered points. Choose one of these: {listed}, "
        );
        assert!(message.starts_with(&begins), "{message}");
    }
}

#[test]
fn the_placeholder_says_how_points_are_written_and_keeps_the_sentence_away() {
    let text = common::TASK
        .replace(
            "You fold cloth.",
            "A point is written {{ actions.points }}. {{ big in px }} is far.",
        )
        .replacen("cloth grid", "const big = 56px\n    cloth grid", 1);
    let program = common::program("task.fab", &text);
    let known = known();
    let of = |unit, order, sent| Pointing::Frame(frame(unit, order, 224, sent));
    let rows = [
        (Pointing::pixels([224; 2]), "(x, y) in pixels. 56 px"),
        (
            of(CoordinateUnit::Pixels, Order::Xy, 448),
            "(x, y) in pixels of a picture 448 wide and 448 high. 112 px",
        ),
        (
            of(CoordinateUnit::PerMille, Order::Xy, 224),
            "(x, y) in thousandths of the picture's width and height. 250 thousandths of the picture's width",
        ),
        (
            of(CoordinateUnit::Percent, Order::Yx, 224),
            "[y, x] in percent of the picture's height and width. 25% of the picture's width",
        ),
        (
            of(CoordinateUnit::Fraction, Order::Xy, 224),
            "(x, y) in parts of the picture's width and height, from 0 to 1. 0.25 of the picture's width",
        ),
        (
            marks(),
            "as its number and its place, (x, y) in pixels. 56 px",
        ),
    ];
    for (pointing, said) in rows {
        let values = Values::Known(in_frame(&known, pointing));
        let messages = render::messages(&program, &program.stages[1], values).unwrap();
        let expected = format!("A point is written {said} is far.");
        assert_eq!(messages[0].content.text, expected);
        assert!(!messages[1].content.text.contains("A point is written"));
        let is_open = |stage| render::leaves_frame_open(&program, stage, &pointing);
        assert!(!program.stages.iter().any(is_open), "{said}");
    }
}

#[test]
fn a_place_that_is_said_only_sometimes_does_not_keep_the_sentence_away() {
    let text = common::TASK
        .replace("component role \"\"\"", "component role when last \"\"\"")
        .replace(
            "You fold cloth.",
            "A point is written {{ actions.points }}.",
        );
    let program = common::program("task.fab", &text);
    let thousandths = Pointing::Frame(frame(CoordinateUnit::PerMille, Order::Xy, 224, 224));
    assert!(render::leaves_frame_open(
        &program,
        &program.stages[1],
        &thousandths
    ));
}

#[test]
fn a_stage_that_reads_a_text_leaves_the_frame_open_if_it_shows_points() {
    let thousandths = Pointing::Frame(frame(CoordinateUnit::PerMille, Order::Xy, 224, 224));
    for (shown, is_open) in [
        ("no point", false),
        ("{{ corners }}", true),
        ("{{ center }}", true),
        ("{{ actions.format }}", true),
        ("{{ unreachable }}", true),
        ("{{ pick.choices }}", false),
        ("{{ count(corners) }}", false),
        ("{{ corners }}, {{ actions.points }}", false),
    ] {
        let text = common::TASK.replace("What is folded?", shown);
        let program = common::program("task.fab", &text);
        let found = render::leaves_frame_open(&program, &program.stages[0], &thousandths);
        assert_eq!(found, is_open, "{shown}");
    }
}

#[test]
fn points_that_cannot_be_numbered_are_an_error_with_words() {
    let text = common::TASK.replace("pick:  one of corners", "pick:  any of cloth");
    let program = common::program("task.fab", &text);
    let known = known();
    let asked = |pointing| {
        let values = Values::Known(in_frame(&known, pointing));
        render::messages(&program, &program.stages[1], values)
    };
    let Err(RenderError::Pointing(why)) = asked(marks()) else {
        panic!("points of a mask were numbered");
    };
    assert!(matches!(why, PointingError::UncountedPoints { .. }));
    assert_has(
        &why.to_string(),
        "the field `pick` may be any point of `cloth`",
    );
    let percent = Pointing::Frame(frame(CoordinateUnit::Percent, Order::Xy, 224, 224));
    assert!(asked(percent).is_ok());
}

#[test]
fn examples_in_the_authors_own_pixels_are_told_to_no_other_frame() {
    let example = "example { say \"Fold (1, 2).\" reply \"Pick Point = (1, 2), Place Point = (3, 4)\" }\n        read action";
    let program = common::program("task.fab", &common::TASK.replace("read action", example));
    let known = known();
    let asked = |pointing| {
        let values = Values::Known(in_frame(&known, pointing));
        render::messages(&program, &program.stages[1], values)
    };
    assert!(asked(Pointing::pixels([224; 2])).is_ok());
    for pointing in [
        marks(),
        Pointing::Frame(frame(CoordinateUnit::PerMille, Order::Xy, 224, 224)),
    ] {
        let Err(RenderError::Pointing(why)) = asked(pointing) else {
            panic!("{pointing:?}: pixels were told");
        };
        assert_has(
            &why.to_string(),
            "the examples of stage `plan` state points in pixels",
        );
    }
}

#[test]
fn a_text_with_points_in_pixels_is_retold() {
    let known = known();
    let listed = points(&[[41, 167], [112, 112]]);
    let rest = "(far), {} is in (the) middle, (1, 2) is not known (";
    let text = |one: &str, other: &str| format!("Here {one} is left {}", rest.replace("{}", other));
    let retold = |pointing| {
        let notation = in_frame(&known, pointing).notation(program());
        notation.retold(&text("(41, 167)", "(112, 112)"), &listed)
    };
    let y_first = Pointing::Frame(frame(CoordinateUnit::PerMille, Order::Yx, 224, 224));
    assert_eq!(
        retold(Pointing::pixels([224; 2])),
        text("(41, 167)", "(112, 112)")
    );
    assert_eq!(retold(y_first), text("[748, 185]", "[502, 502]"));
    assert_eq!(retold(marks()), text("1 at (41, 167)", "5 at (112, 112)"));
    assert!(Notation::pixels().marks().is_empty());
}
