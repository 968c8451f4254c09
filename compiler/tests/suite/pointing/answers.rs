//! Answers as models write them, in their frame and in a wrong one.

use super::{frame, in_frame, known, program};
use fab_program::PixelPoint;
use fab_program::pointing::{CoordinateUnit, Frame, Order, Pointing};
use fab_program::reply;
use fab_program::verify::{self, OFFERED, Strictness, Verdict};

/// The expected reading of an answer's pick: a pixel, or a part of the complaint.
type Row = (&'static str, Result<[i32; 2], &'static str>);

const HERE: Result<[i32; 2], &str> = Ok([41, 167]);

const PIXELS: &[Row] = &[
    ("Pick Point = x=41, y=167", HERE),
    ("pick: {\"point\": [41, 167]}", HERE),
    ("Pick Point = <point x=\"41\" y=\"167\">", HERE),
];

const THOUSANDTHS: &[Row] = &[
    ("Pick Point = (185, 748)", HERE),
    ("Pick Point = [185, 748]", HERE),
    ("Pick Point = {\"point_2d\": [185, 748]}", HERE),
    (
        "[{\"point_2d\": [185, 748], \"label\": \"pick point\"}]",
        HERE,
    ),
    (
        "{\"name\": \"fold\", \"arguments\": \"{\\\"pick\\\": [185, 748]}\"}",
        HERE,
    ),
    ("[{\"pick\": {\"x\": 185, \"y\": 748}}]", HERE),
    ("Pick Point = (41 px, 167 px)", Err("cannot be read")),
    ("Pick Point = (185)", Err("cannot be read")),
    ("Pick Point = (18.5%, 74.8%)", Err("cannot be read")),
];

const THOUSANDTHS_Y_FIRST: &[Row] = &[
    ("Pick Point = [748, 185]", HERE),
    ("pick: {\"point\": [748, 185]}", HERE),
    (
        "```json\n[{\"point\": [748, 185], \"label\": \"pick\"}]\n```",
        HERE,
    ),
    ("Pick Point: x=185, y=748", HERE),
    ("Pick Point = (y: 748, x: 185)", HERE),
    ("Pick Point = (748, 185)", Err("cannot be read")),
    ("Pick Point = 748, 185", Err("cannot be read")),
    ("Pick Point = [y: 748, 185]", Err("cannot be read")),
];

const PERCENT: &[Row] = &[
    ("Pick Point = <point x=\"18.5\" y=\"74.8\">", HERE),
    (
        "Pick Point = <point x=\"18.5\" y=\"74.8\" alt=\"a corner\">a corner</point>",
        HERE,
    ),
    ("Pick Point = (18.5%, 74.8%)", HERE),
    (
        "<point x=\"18.5\" y=\"74.8\" alt=\"pick point\">pick point</point>",
        HERE,
    ),
];

const FRACTIONS: &[Row] = &[
    ("Pick Point = x=0.185, y=0.748", HERE),
    ("Pick Point: x = 0.185 and y = 0.748.", HERE),
    ("Pick Point = (.185, 0.748)", HERE),
    ("Pick Point = y=0.748, x=0.185", HERE),
    ("Pick Point = x=0.185, x=0.748", Err("cannot be read")),
];

const MARKS: &[Row] = &[
    ("Pick Point = 1", HERE),
    ("Pick Point = point 2", Ok([167, 41])),
    ("Pick Point = #3", Ok([57, 58])),
    ("Pick Point = (3)", Ok([57, 58])),
    ("**Pick Point:** 3 - the folded corner", Ok([57, 58])),
    ("\"pick\": \"3\",", Ok([57, 58])),
    ("\"pick\": {\"number\": 3}", Ok([57, 58])),
    ("The pick point is number 3.", Ok([57, 58])),
    ("Pick Point = 1 at (41, 167)", HERE),
    ("Pick Point = 1: (41, 167)", HERE),
    ("Pick Point = 1 at (57, 58)", Err("cannot be read")),
    ("Pick Point = (41, 167)", Err("cannot be read")),
    ("Pick Point = 41, 167", Err("cannot be read")),
    ("Pick Point = 6", Err("cannot be read")),
    ("Pick Point = 0", Err("cannot be read")),
    ("Pick Point = 99999999999999999999", Err("cannot be read")),
    ("Pick Point = 3.5", Err("cannot be read")),
    ("Pick Point = 1 or 2", Err("cannot be read")),
    ("Pick Point = 1/2", Err("cannot be read")),
    ("Pick Point:\n1. Look at it.", Err("states no pick point")),
    ("Pick Point = number", Err("states no pick point")),
    ("Let us pick 3.", Err("states no pick point")),
];

#[test]
fn the_forms_that_models_use_are_read_in_their_frame() {
    let of = |unit, order| Pointing::Frame(frame(unit, order, 224, 224));
    let tables = [
        (Pointing::pixels([224; 2]), PIXELS),
        (of(CoordinateUnit::PerMille, Order::Xy), THOUSANDTHS),
        (of(CoordinateUnit::PerMille, Order::Yx), THOUSANDTHS_Y_FIRST),
        (of(CoordinateUnit::Percent, Order::Xy), PERCENT),
        (of(CoordinateUnit::Fraction, Order::Xy), FRACTIONS),
        (Pointing::Marks(Frame::pixels([224; 2])), MARKS),
    ];
    for (pointing, rows) in tables {
        for (reply, expected) in rows {
            check(pointing, reply, expected);
        }
    }
}

fn check(pointing: Pointing, reply: &str, expected: &Result<[i32; 2], &str>) {
    let known = known();
    let notation = in_frame(&known, pointing).notation(program());
    let place = notation.stated(PixelPoint::new(112, 112));
    let whole = format!("{reply}\nPlace Point = {place}");
    match (
        reply::read_action_in(program(), &notation, &whole),
        expected,
    ) {
        (Ok(reading), Ok(pixel)) => {
            let pick = reading.value.point("pick");
            assert_eq!(pick, Some((*pixel).into()), "{pointing:?} {reply}");
        }
        (Err(malformed), Err(part)) => {
            let message = malformed.message;
            let form = pointing.form();
            let format = format!("Pick Point = {form}\nPlace Point = {form}");
            assert!(message.contains(part), "{reply}: {message}");
            assert!(message.ends_with(&format), "{message}");
        }
        (found, _) => panic!("{pointing:?} {reply}: {found:?}"),
    }
}

#[test]
fn pixels_where_another_frame_is_asked_for_are_refused_and_never_moved() {
    let known = known();
    for unit in [
        CoordinateUnit::Fraction,
        CoordinateUnit::Percent,
        CoordinateUnit::PerMille,
    ] {
        let facts = in_frame(&known, Pointing::Frame(frame(unit, Order::Xy, 224, 224)));
        let notation = facts.notation(program());
        for point in known.points.iter().flat_map(|(_, points)| points) {
            let answer = format!("Pick Point = {point}\nPlace Point = {point}");
            let read = reply::read_action_in(program(), &notation, &answer).unwrap();
            let verdict = verify::verdict(program(), facts, &read.value, Strictness::Full);
            let Verdict::Reject { check, message, .. } = verdict.unwrap() else {
                panic!("{unit:?}: {answer} was taken for {read:?}");
            };
            assert_eq!(check, OFFERED);
            let offered = notation.written(PixelPoint::new(41, 167));
            assert!(message.contains(&offered), "{message}");
        }
    }
}
