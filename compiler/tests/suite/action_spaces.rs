//! Action spaces: one that compiles is read as prompts write it, and the sampler draws what is offered.

use crate::common::{self, Known, TASK};
use crate::spaces;
use fab_program::pointing::Notation;
use fab_program::reply::{self, SAME_DEG};
use fab_program::scene::SceneView;
use fab_program::space;
use fab_program::verify::{self, Verdict};
use fab_program::{ActionField, Choices, PixelPoint, Program, Proposal, Value};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::cell::Cell;

/// Returns the program of these fields and `pick`.
fn with(lines: &[&str]) -> Program {
    let lines = ["pick points corners"].iter().chain(lines);
    spaces::program(lines.map(|line| spaces::field(line)).collect())
}

// ---- what is read --------------------------------------------------------------------------------

/// Returns a scene whose points share digits and lie on the edges.
fn scene() -> Known {
    let point = |[u, v]: [i32; 2]| PixelPoint::new(u, v);
    let corners = [
        [1, 11],
        [11, 1],
        [1, 1],
        [111, 1],
        [12, 34],
        [0, 223],
        [223, 0],
    ];
    Known {
        points: vec![
            ("corners", corners.map(point).to_vec()),
            ("center", vec![point([112, 100])]),
        ],
        regions: vec![("cloth", [0, 0, 223, 223])],
        ..Known::default()
    }
}

/// Returns whether answers state every offered value, and no other; otherwise the answer that shows it.
fn reads_as_written(program: &Program) -> Result<(), String> {
    let scene = scene();
    let offered: Vec<(String, Vec<Value>)> = program
        .actions
        .iter()
        .map(|field| {
            let values = match &field.choices {
                Choices::Region { .. } => vec![Value::Point(PixelPoint::new(7, 9))],
                _ => space::choices(field, &scene),
            };
            (field.name.clone(), values)
        })
        .collect();
    let schema = reply::schema_in(program, &Notation::pixels(), &offered);
    let most = offered.iter().map(|(_, values)| values.len()).max();
    for index in 0..most.unwrap_or(0) {
        let fields = offered
            .iter()
            .map(|(name, values)| (name.clone(), values[index % values.len()].clone()))
            .collect();
        let stated = Proposal { fields };
        let asked = answer(program, &stated, None);
        let reading = reply::read_action(program, &asked).map_err(|it| it.message)?;
        if reading.value != stated || !reading.repairs.is_empty() {
            return Err(format!("{asked}\nis read as {reading:?}"));
        }
        if refused(program, &scene, &reading.value).is_some() {
            return Err(format!("{asked}\nis offered, and refused"));
        }
        let texts = texts(program, &stated).into_iter();
        let texts: serde_json::Map<_, _> = texts.map(|(name, text)| (name, text.into())).collect();
        for (name, text) in &texts {
            let listed = &schema["properties"][name]["enum"];
            if listed
                .as_array()
                .is_some_and(|listed| !listed.contains(text))
            {
                return Err(format!("the schema does not list {text} for {name}"));
            }
        }
        let object = serde_json::Value::Object(texts).to_string();
        let reading = reply::read_action(program, &object).map_err(|it| it.message)?;
        if reading.value != stated {
            return Err(format!("{object}\nis read as {reading:?}"));
        }
    }
    others_are_refused(program, &scene, &offered)
}

/// Returns whether values between and beside the offered ones are refused, in the name of their field.
fn others_are_refused(
    program: &Program,
    scene: &Known,
    offered: &[(String, Vec<Value>)],
) -> Result<(), String> {
    let first = |(name, values): &(String, Vec<Value>)| (name.clone(), values[0].clone());
    let stated = Proposal {
        fields: offered.iter().map(first).collect(),
    };
    for (field, (_, values)) in program.actions.iter().zip(offered) {
        for text in others(field, values) {
            let answer = answer(program, &stated, Some((&field.name, &text)));
            let name = match reply::read_action(program, &answer) {
                Err(malformed) => Some(malformed.field),
                Ok(reading) => refused(program, scene, &reading.value),
            };
            if name.as_deref() != Some(&field.name) {
                return Err(format!(
                    "{answer}\nis refused for {name:?}, not for {}",
                    field.name
                ));
            }
        }
    }
    Ok(())
}

/// Returns values that a field does not offer, as an answer would state them.
fn others(field: &ActionField, offered: &[Value]) -> Vec<String> {
    let mut others = vec![String::new(), "9".repeat(400)];
    let mut numbers = Vec::new();
    for value in offered {
        match value {
            Value::Point(point) => {
                let below = PixelPoint::new(point.u, point.v + 1);
                let is_offered = offered.contains(&Value::Point(below));
                let is_region = matches!(field.choices, Choices::Region { .. });
                others.extend((!is_offered && !is_region).then(|| below.to_string()));
            }
            // An offered word inside a phrase is read.
            Value::Word(word) if word.contains(|letter: char| !letter.is_alphanumeric()) => {}
            Value::Word(word) => {
                let longer = format!("{word}z");
                let is_offered = offered.contains(&Value::Word(longer.clone()));
                others.extend((!is_offered).then_some(longer));
            }
            Value::Direction { deg: number } | Value::Length { length: number } => {
                numbers.push(*number);
            }
        }
    }
    numbers.sort_by(f64::total_cmp);
    let apart = numbers
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > 2.5 * SAME_DEG);
    others.extend(apart.map(|pair| {
        let number = (pair[0] + pair[1]) / 2.0;
        let value = match offered[0] {
            Value::Direction { .. } => Value::Direction { deg: number },
            _ => Value::Length { length: number },
        };
        space::text(field, &value)
    }));
    others
}

/// Writes every field and its value.
fn texts(program: &Program, stated: &Proposal) -> Vec<(String, String)> {
    let fields = program.actions.iter().zip(&stated.fields);
    fields
        .map(|(field, (name, value))| (name.clone(), space::text(field, value)))
        .collect()
}

/// Writes an answer as prompts ask for it, with another text for one field.
fn answer(program: &Program, stated: &Proposal, other: Option<(&str, &str)>) -> String {
    let lines = program.actions.iter().zip(texts(program, stated));
    let lines = lines.map(|(field, (name, text))| match other {
        Some((changed, other)) if changed == name => space::statement(field, other),
        _ => space::statement(field, &text),
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Returns the field whose value the verifier refuses as not offered.
fn refused(program: &Program, scene: &Known, proposal: &Proposal) -> Option<String> {
    match verify::unoffered(program, scene, proposal, &Notation::pixels) {
        Ok(Some(Verdict::Reject { values, .. })) => values.into_iter().next().map(|(name, _)| name),
        _ => None,
    }
}

#[test]
fn the_spaces_of_the_fixtures_are_read_as_they_are_written() {
    for name in ["points", "paper", "grip", "region"] {
        assert_eq!(reads_as_written(&spaces::space(name)), Ok(()), "{name}");
    }
}

#[test]
fn directions_a_tenth_of_a_degree_apart_are_consistent() {
    for line in [
        "direction directions 6.1 6.2",
        "direction directions 0 84.5 152.2 219.9",
        "direction directions 0 0.1 240.1 295.4",
    ] {
        assert_eq!(reads_as_written(&with(&[line])), Ok(()), "{line}");
    }
}

#[test]
fn every_word_that_the_reader_knows_can_be_a_choice() {
    let words: std::collections::BTreeSet<String> = std::fs::read_dir("program/src/reply")
        .unwrap()
        .map(|file| file.unwrap().path())
        .filter(|path| path.is_file())
        .flat_map(|path| {
            let source = std::fs::read_to_string(path).unwrap();
            let words = source.split(|letter: char| !letter.is_ascii_lowercase());
            words.map(str::to_owned).collect::<Vec<_>>()
        })
        .filter(|word| !word.is_empty())
        .collect();
    assert!(words.contains("none") && words.contains("instead"));
    for word in words {
        let grip = ActionField {
            name: "gripping_force".to_owned(),
            choices: Choices::Words {
                choices: vec![word, "zzz".to_owned()],
            },
        };
        let read = reads_as_written(&spaces::program(vec![grip]));
        assert_eq!(read, Ok(()));
    }
}

/// Each of these is an error (F0706), and none could be read.
#[test]
fn names_and_choices_that_are_refused_could_not_be_read() {
    for line in [
        "gripForce words soft | firm",
        "grip_2 words soft | firm",
        "pick_point words left | right",
        "turn directions 0 359.99999",
        "turn directions 10 33.33331 33.33332",
        "size lengths edge 0.33333 0.33334",
        "grip words soft | Soft",
        "grip words very soft | very_soft",
    ] {
        let read = reads_as_written(&with(&[line]));
        assert!(read.is_err(), "{line} is read");
    }
}

// ---- drawn spaces --------------------------------------------------------------------------------

/// How many spaces are drawn.
const N_SPACES: u32 = 512;

/// Draws the choices of a field, as a task states them.
fn choices() -> impl Strategy<Value = String> {
    let listed = |texts: Vec<String>| format!("one of {}", texts.join(", "));
    let numbers = |unit: &'static str, most: u32, parts: f64| {
        let set = prop::collection::btree_set(1..most, 1..12);
        set.prop_map(move |set| {
            set.into_iter()
                .map(|number| format!("{}{unit}", f64::from(number) / parts))
                .collect::<Vec<_>>()
        })
    };
    let words = |form: &'static str| {
        prop::collection::btree_set(form, 1..8).prop_map(|set| {
            set.into_iter()
                .map(|word| format!("\"{word}\""))
                .collect::<Vec<_>>()
        })
    };
    prop_oneof![
        1 => Just("one of corners, center".to_owned()),
        1 => Just("any of cloth".to_owned()),
        2 => numbers("deg", 3600, 10.0).prop_map(listed),
        1 => numbers("deg", 3_600_000, 10_000.0).prop_map(listed),
        2 => numbers("mm", 5000, 10.0).prop_map(listed),
        1 => numbers("edge", 10_000, 10_000.0).prop_map(listed),
        1 => numbers("cm", 300, 7.0).prop_map(listed),
        4 => words("[a-zé][a-z0-9é]{1,8}( [a-z]{1,6})?").prop_map(listed),
        1 => words("[a-z]{1,3}[a-z0-9/&+%.@_ -]{0,4}[a-z0-9]").prop_map(listed),
    ]
}

/// Draws the `actions` of a task.
fn actions() -> impl Strategy<Value = String> {
    let name = prop_oneof![
        4 => prop::sample::select(vec!["grip", "layer", "tip_angle", "force", "hand_side", "n"])
            .prop_map(str::to_owned),
        1 => "[a-z]{2,6}(_[a-z]{1,4})?[0-9]?",
        1 => prop::sample::select(vec!["pick_point", "Pick", "gripForce", "grip_2", "_grip", "pick_x", "grip_", "grip__on"])
            .prop_map(str::to_owned),
    ];
    let further = prop::collection::btree_map(name, choices(), 0..4);
    let moves = prop_oneof![
        Just("place: one of corners, center"),
        Just("place: any of cloth"),
        Just("direction: one of 0deg, 90deg, 180deg, 270deg  distance: one of 0.1edge, 0.25edge"),
    ];
    (moves, further).prop_map(|(moves, further)| {
        let further = further
            .iter()
            .map(|(name, choices)| format!("\n        {name}: {choices}"));
        format!(
            "pick: one of corners\n        {moves}{}",
            further.collect::<String>()
        )
    })
}

#[test]
fn every_space_that_compiles_is_read_as_it_is_written() {
    let config = Config {
        cases: N_SPACES,
        failure_persistence: None,
        ..Config::default()
    };
    let n_compiled = Cell::new(0);
    let (before, after) = TASK.split_once("pick:  one of corners").unwrap();
    let (_, after) = after.split_once("place: one of corners, center").unwrap();
    let drawn = TestRunner::new(config).run(&actions(), |actions| {
        let compiled = common::compile("task.fab", &format!("{before}{actions}{after}"));
        for program in &compiled.programs {
            n_compiled.set(n_compiled.get() + 1);
            reads_as_written(program).map_err(TestCaseError::fail)?;
        }
        Ok(())
    });
    assert!(drawn.is_ok(), "{}", drawn.unwrap_err());
    let n_compiled = n_compiled.get();
    assert!(
        n_compiled * 4 > N_SPACES * 3,
        "only {n_compiled} of {N_SPACES} compile"
    );
}

// ---- sampling ------------------------------------------------------------------------------------

/// A scene of three points, or of none.
struct Points(Vec<PixelPoint>);

impl SceneView for Points {
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
        (keypoint == "corners").then(|| self.0.clone())
    }
    fn distance_px(&self, _: &str, _: PixelPoint) -> Option<f64> {
        None
    }
    fn area_px(&self, _: &str) -> Option<f64> {
        None
    }
}

#[test]
fn the_sampler_draws_every_offered_value_equally_often() {
    let program = with(&["direction directions 0 45 90", "grip words soft | firm"]);
    let point = |u| PixelPoint::new(u, 7);
    // A point that is found twice is offered once.
    let scene = Points(vec![point(1), point(2), point(1), point(3)]);
    let mut drawn = std::collections::BTreeMap::new();
    for index in 0..18 {
        let mut rest = index;
        let mut below = |n: u64| {
            let digit = rest % n;
            rest /= n;
            digit
        };
        let proposal = space::sample(&program, &scene, &mut below).unwrap();
        *drawn.entry(format!("{proposal:?}")).or_insert(0) += 1;
    }
    assert_eq!(drawn.len(), 3 * 3 * 2);
    assert!(drawn.values().all(|times| *times == 1));
    let too_large = space::sample(&program, &scene, &mut |_| u64::MAX).unwrap();
    assert!(space::choices(&program.actions[0], &scene).contains(&too_large.fields[0].1));
    let nothing = space::sample(&program, &Points(Vec::new()), &mut |_| 0);
    assert_eq!(nothing, None);
}

/// A scene in which every mask is four pixels.
struct Four;

impl SceneView for Four {
    fn points(&self, _: &str) -> Option<Vec<PixelPoint>> {
        None
    }
    fn distance_px(&self, _: &str, point: PixelPoint) -> Option<f64> {
        Some(if point.u == 5 && (0..4).contains(&point.v) {
            0.0
        } else {
            1.0
        })
    }
    fn area_px(&self, _: &str) -> Option<f64> {
        Some(4.0)
    }
    fn region_pixel(&self, _: &str, number: u64) -> Option<PixelPoint> {
        (number < 4).then(|| PixelPoint::new(5, number as i32))
    }
}

#[test]
fn of_a_region_every_pixel_is_offered_and_drawn_equally_often() {
    let program = spaces::program(vec![spaces::field("pick region cloth")]);
    let field = &program.actions[0];
    let mut drawn: Vec<Value> = Vec::new();
    for index in 0..4 {
        let proposal = space::sample(&program, &Four, &mut |n| index % n).unwrap();
        drawn.push(proposal.fields[0].1.clone());
    }
    let expected: Vec<Value> = (0..4)
        .map(|v| Value::Point(PixelPoint::new(5, v)))
        .collect();
    assert_eq!(drawn, expected);
    assert!(
        drawn
            .iter()
            .all(|value| space::is_offered(field, value, &Four))
    );
    let beside = Value::Point(PixelPoint::new(6, 0));
    assert!(!space::is_offered(field, &beside, &Four));
    let none = space::sample(&program, &Points(Vec::new()), &mut |_| 0);
    assert_eq!(none, None, "an unknown region offers nothing");
}
