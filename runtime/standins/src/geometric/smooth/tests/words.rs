//! Tests that the answer follows the words.

use super::*;
use fab_program::exact::vector_of;
use fab_program::pointing::Notation;
use fab_program::{ActionField, Choices, Direction, LengthChoice, LengthUnit, Value, reply};

#[test]
fn only_listed_corners_are_picked() {
    let mut asked = narrowed();
    let (first, _, _) = pull_of(&asked.answer());
    asked.corners.retain(|&corner| corner != first);
    let (second, _, _) = pull_of(&asked.answer());
    assert!(
        second != first && asked.corners.contains(&second),
        "{second:?}"
    );
}

/// The fields that the question asks for.
fn fields() -> Vec<ActionField> {
    let direction = |deg: f64| Direction {
        deg,
        vector: vector_of(deg),
    };
    let length = |value: f64| LengthChoice { value, m: value };
    let choices = [
        Choices::Points {
            keypoints: vec!["corners".to_owned()],
        },
        Choices::Directions {
            choices: (0..8).map(|at| direction(f64::from(at) * 45.0)).collect(),
        },
        Choices::Lengths {
            unit: LengthUnit::EDGE,
            choices: [0.1, 0.25, 0.5, 0.75, 1.0].map(length).into(),
        },
    ];
    let names = ["pick", "direction", "distance"].into_iter();
    let field = |(name, choices): (&str, Choices)| ActionField {
        name: name.to_owned(),
        choices,
    };
    names.zip(choices).map(field).collect()
}

#[test]
fn the_reader_of_answers_reads_the_answer_as_it_is_written() {
    let answer = narrowed().answer();
    let (_, explanation) = answer.rsplit_once("corner looks ").unwrap();
    let (looks, _) = explanation.split_once(", and").unwrap();
    for other in ["like one of the cloth's own", "the most promising"] {
        let answer = answer.replace(looks, other);
        let read = reply::read_fields(&fields(), 1.0, &Notation::pixels(), &answer).unwrap();
        let (pick, deg, length) = pull_of(&answer);
        let values = [
            Value::Point(pick.into()),
            Value::Direction { deg },
            Value::Length { length },
        ];
        assert!(
            read.value.fields.iter().map(|(_, it)| it).eq(&values),
            "{answer}"
        );
        assert_eq!(read.repairs, [] as [String; 0], "{answer}");
    }
}

#[test]
fn points_that_the_words_name_are_kept_away_from() {
    let mut asked = narrowed();
    let ([u, v], _, _) = pull_of(&asked.answer());
    let mirror = [2 * 170 - u, 2 * 178 - v];
    asked.more = format!(
        "The red rings are points to avoid. Pick a corner that is more than 30 px away from both of them, ({u}, {v}) and ({}, {}).",
        mirror[0], mirror[1]
    );
    let ([pu, pv], _, _) = pull_of(&asked.answer());
    for [au, av] in [[u, v], mirror] {
        let apart = f64::from(pu - au).hypot(f64::from(pv - av));
        assert!(apart > 30.0, "({pu}, {pv}) is {apart} px from ({au}, {av})");
    }
}

#[test]
fn no_corner_is_placed_farther_out_than_the_words_allow() {
    for (share, words) in [(0.75, "0.75"), (0.95, "0.95")] {
        let mut asked = narrowed();
        asked.more = format!(
            "A corner must not be placed farther than {:.1} px from the middle of the picture, (180, 180).",
            EDGE_PX * share
        );
        let ([u, v], direction, distance) = pull_of(&asked.answer());
        let (sin, cos) = direction.to_radians().sin_cos();
        let to = [
            f64::from(u) + distance * EDGE_PX * cos,
            f64::from(v) - distance * EDGE_PX * sin,
        ];
        let out = (to[0] - 180.0).hypot(to[1] - 180.0);
        assert!(out <= EDGE_PX * share, "{words}: {out}");
    }
}

#[test]
fn only_offered_directions_and_distances_are_answered() {
    let words = narrowed().words().replace(
        "Distance = 0.1 edge | 0.25 edge | 0.5 edge | 0.75 edge | 1 edge",
        "Distance = 0.15 edge | 0.3 edge",
    );
    let words = words.replace(
        "Direction = 0 deg | 45 deg | 90 deg | 135 deg",
        "Direction = 30 deg | 120 deg",
    );
    let turn = Message {
        speaker: Speaker::User,
        parts: vec![Part::Text(words), narrowed().turn().parts.remove(1)],
    };
    let (_, direction, distance) = pull_of(&asked(vec![turn]));
    assert!(
        [30.0, 120.0, 180.0, 225.0, 270.0, 315.0].contains(&direction),
        "{direction}"
    );
    assert!([0.15, 0.3].contains(&distance), "{distance}");
}

#[test]
fn what_a_side_measures_is_read_from_the_words() {
    // A cloth that fills a side of 104 px is almost flat, and a heap of one of 240 px.
    let mut asked = question(
        &[([128, 128, 232, 232], ORANGE)],
        &[[128, 128], [231, 128], [231, 231], [128, 231]],
        [179, 179],
    );
    let flat = pull_of(&asked.answer()).2;
    asked.edge_px = 240.0;
    let heap = pull_of(&asked.answer()).2;
    assert!(heap > flat, "{heap} and {flat}");
}

/// The question in other words, with its picture.
fn reworded(words: String) -> Message {
    Message {
        speaker: Speaker::User,
        parts: vec![Part::Text(words), narrowed().turn().parts.remove(1)],
    }
}

#[test]
fn what_is_missing_in_the_words_is_told() {
    let whole = narrowed().words();
    let reply = asked(vec![reworded(whole.replace("is 110 px", "is long"))]);
    assert!(reply.contains("how many px an edge is"), "{reply}");
    let parts = vec![Part::Text(whole)];
    let reply = asked(vec![Message {
        speaker: Speaker::User,
        parts,
    }]);
    assert!(reply.contains("there is no picture"), "{reply}");
}

#[test]
fn without_a_list_it_picks_where_the_outline_bends() {
    let words = narrowed().words();
    let unlisted: Vec<&str> = words
        .lines()
        .filter(|line| !line.starts_with("The corners are"))
        .collect();
    let reply = asked(vec![reworded(unlisted.join("\n"))]);
    let ([u, v], ..) = pull_of(&reply);
    let corners = [[130, 121], [211, 121], [211, 199], [179, 234], [130, 234]];
    let is_near = |[x, y]: &[i32; 2]| (u - x).abs() <= 4 && (v - y).abs() <= 4;
    assert!(corners.iter().any(is_near), "{reply}");
}

#[test]
fn without_a_list_a_sharp_corner_is_found_beside_a_round_rim() {
    // A disc with a corner on its right; along its round rim no point bends more than another.
    let mut question = narrowed();
    question.picture = RgbImage::from_fn(SIDE, SIDE, |column, row| {
        let [x, y] = [f64::from(column) - 160.0, f64::from(row) - 180.0];
        let is_disc = x.hypot(y) < 60.0;
        let is_corner = x > 0.0 && x + y.abs() < 84.0;
        if is_disc || is_corner {
            Rgb(ORANGE)
        } else {
            Rgb([213, 213, 216])
        }
    });
    let bytes = question.turn().parts.remove(1);
    let Part::Image(png) = &bytes else {
        panic!("the second part is the picture")
    };
    let view = super::super::view::View::decode(png.bytes()).unwrap();
    let found = super::super::rim::corners(&view, 110.0);
    let tip = &found[0];
    assert!(
        (tip.u - 240).abs() <= 4 && (tip.v - 180).abs() <= 3,
        "{found:?}"
    );
    assert!(found.len() > 4, "{found:?}");
    let [column, row] = super::super::rim::center(&view);
    assert!(
        (column - 172.0).abs() < 1.0 && (row - 180.0).abs() < 1.0,
        "({column}, {row})"
    );
}

#[test]
fn lengths_that_no_picture_has_are_not_taken() {
    for wrong in ["1e-300", "1e300", "0", "-5", "nan"] {
        let words = narrowed()
            .words()
            .replace("is 110 px", &format!("is {wrong} px"));
        let reply = asked(vec![reworded(words)]);
        assert!(reply.contains("how many px an edge is"), "{wrong}: {reply}");
    }
}

#[test]
fn rules_that_allow_no_pull_are_not_called_a_refusal() {
    let words = narrowed()
        .words()
        .replace("farther than 104.5 px", "farther than 1 px");
    let reply = asked(vec![reworded(words)]);
    assert!(reply.contains("no pull leads outward"), "{reply}");
}

#[test]
#[ignore = "long"]
fn a_large_picture_with_many_choices_is_answered() {
    let mut question = narrowed();
    question.picture = RgbImage::from_fn(2048, 2048, |column, row| {
        let is_cloth = (500..1500).contains(&column) && (500..1500).contains(&row);
        if is_cloth {
            Rgb(ORANGE)
        } else {
            Rgb([213, 213, 216])
        }
    });
    question.corners = (0..100).map(|at| [500 + 10 * at, 501]).collect();
    question.center = [1000, 1000];
    question.edge_px = 1000.0;
    let listed = |values: Vec<String>| values.join(" | ");
    let directions = listed(
        (0..64)
            .map(|at| format!("{} deg", 60.0 + f64::from(at)))
            .collect(),
    );
    let distances = listed(
        (0..64)
            .map(|at| format!("{} edge", 0.01 * f64::from(at + 1)))
            .collect(),
    );
    question.more = format!("Direction = {directions}\nDistance = {distances}\n");
    let reply = question.answer();
    assert!(prompt::answered("pick", &reply).is_some(), "{reply}");
}
