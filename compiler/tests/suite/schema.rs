//! The JSON Schema of an answer accepts exactly the offered values.

use crate::common;
use crate::pointing;
use crate::spaces;
use fab_program::pointing::{CoordinateUnit, Frame, Notation, Order, Pointing};
use fab_program::reply;
use fab_program::space;
use fab_program::{PixelPoint, Program, Value};
use serde_json::{Map, Value as Json, json};

/// Returns whether an answer fits a schema; panics on an unknown keyword.
fn fits(schema: &Json, answer: &Json) -> bool {
    schema
        .as_object()
        .unwrap()
        .iter()
        .all(|(keyword, wanted)| match &**keyword {
            "description" => true,
            "type" => match wanted.as_str().unwrap() {
                "object" => answer.is_object(),
                "string" => answer.is_string(),
                other => panic!("no type `{other}`"),
            },
            "enum" => wanted.as_array().unwrap().contains(answer),
            "maxLength" => {
                let length = answer.as_str().unwrap_or("").chars().count();
                length as u64 <= wanted.as_u64().unwrap()
            }
            "pattern" => {
                let pattern: Vec<char> = wanted.as_str().unwrap().chars().collect();
                let text: Vec<char> = answer.as_str().unwrap_or("").chars().collect();
                let pattern = pattern
                    .strip_prefix(&['^'])
                    .unwrap()
                    .strip_suffix(&['$'])
                    .unwrap();
                ends(pattern, &text).contains(&text.len())
            }
            "properties" => wanted
                .as_object()
                .unwrap()
                .iter()
                .all(|(name, schema)| answer.get(name).is_none_or(|value| fits(schema, value))),
            "required" => {
                let names = wanted.as_array().unwrap();
                names
                    .iter()
                    .all(|name| answer.get(name.as_str().unwrap()).is_some())
            }
            "additionalProperties" => {
                assert_eq!(*wanted, false);
                let known = &schema["properties"];
                answer
                    .as_object()
                    .is_none_or(|it| it.keys().all(|name| known.get(name).is_some()))
            }
            other => panic!("no keyword `{other}`"),
        })
}

/// Returns the possible lengths of a match of one piece of a pattern at the start of a text.
type Step<'p> = Box<dyn Fn(&[char]) -> Vec<usize> + 'p>;

/// Returns the possible lengths of a match of a pattern at the start of a text: characters, `\x`, `[a-b]`, `(a|b)`,
/// each with `?` or `{m,n}`.
fn ends(pattern: &[char], text: &[char]) -> Vec<usize> {
    let mut depth = 0;
    for (at, character) in pattern.iter().enumerate() {
        match character {
            '(' | ')' if at > 0 && pattern[at - 1] == '\\' => {}
            '(' => depth += 1,
            ')' => depth -= 1,
            '|' if depth == 0 => {
                return [ends(&pattern[..at], text), ends(&pattern[at + 1..], text)].concat();
            }
            _ => {}
        }
    }
    let Some(first) = pattern.first() else {
        return vec![0];
    };
    let closing = |open: usize| {
        let mut depth = 0;
        (open..pattern.len())
            .find(|at| {
                match pattern[*at] {
                    '(' if pattern[*at - usize::from(*at > 0)] != '\\' => depth += 1,
                    ')' if pattern[*at - 1] != '\\' => depth -= 1,
                    _ => {}
                }
                depth == 0
            })
            .unwrap()
    };
    let (length, once): (usize, Step<'_>) = match first {
        '(' => {
            let close = closing(0);
            (
                close + 1,
                Box::new(move |text| ends(&pattern[1..close], text)),
            )
        }
        '[' => {
            let (from, to) = (pattern[1], pattern[3]);
            let is_in =
                move |text: &[char]| text.first().is_some_and(|it| (from..=to).contains(it));
            (
                5,
                Box::new(move |text| if is_in(text) { vec![1] } else { vec![] }),
            )
        }
        '\\' => {
            let wanted = pattern[1];
            (
                2,
                Box::new(move |text| {
                    if text.first() == Some(&wanted) {
                        vec![1]
                    } else {
                        vec![]
                    }
                }),
            )
        }
        wanted => {
            let wanted = *wanted;
            (
                1,
                Box::new(move |text| {
                    if text.first() == Some(&wanted) {
                        vec![1]
                    } else {
                        vec![]
                    }
                }),
            )
        }
    };
    let rest = &pattern[length..];
    let (least, most, rest) = match rest.first() {
        Some('?') => (0, 1, &rest[1..]),
        Some('{') => {
            let close = rest.iter().position(|it| *it == '}').unwrap();
            let bounds: String = rest[1..close].iter().collect();
            let (least, most) = bounds.split_once(',').unwrap();
            (
                least.parse().unwrap(),
                most.parse().unwrap(),
                &rest[close + 1..],
            )
        }
        _ => (1, 1, rest),
    };
    let mut reached = vec![0];
    let mut all = Vec::new();
    for times in 0..=most {
        if times >= least {
            for at in &reached {
                all.extend(ends(rest, &text[*at..]).iter().map(|end| at + end));
            }
        }
        let next = |at: usize| once(&text[at..]).into_iter().map(move |end| at + end);
        reached = reached.into_iter().flat_map(next).collect();
    }
    all
}

fn offered(program: &Program, points: &[(i32, i32)]) -> Vec<(String, Vec<Value>)> {
    let points = || {
        points
            .iter()
            .map(|(u, v)| Value::Point(PixelPoint::new(*u, *v)))
            .collect()
    };
    let of = |field: &fab_program::ActionField| match space::declared(field) {
        values if values.is_empty() => points(),
        values => values,
    };
    let fields = program.actions.iter();
    fields
        .map(|field| (field.name.clone(), of(field)))
        .collect()
}

#[test]
fn every_offered_value_fits_and_others_do_not() {
    for name in ["points", "paper", "grip"] {
        let program = spaces::space(name);
        let offered = offered(&program, &[(10, 20), (0, 223), (-3, 4)]);
        let schemas = [
            reply::schema_in(&program, &Notation::pixels(), &offered),
            reply::static_schema(&program),
        ];
        let first: Map<String, Json> = program
            .actions
            .iter()
            .zip(&offered)
            .map(|(field, (_, values))| (field.name.clone(), json!(space::text(field, &values[0]))))
            .collect();
        let stating = |name: &str, text: &str| {
            let mut answer = first.clone();
            answer.insert(name.to_owned(), json!(text));
            Json::Object(answer)
        };
        for schema in &schemas {
            for (field, (name, values)) in program.actions.iter().zip(&offered) {
                for value in values {
                    let text = space::text(field, value);
                    assert!(fits(schema, &stating(name, &text)), "{name} {text}");
                    for other in [
                        format!("{text} "),
                        text.to_uppercase(),
                        text.replace(' ', ""),
                    ] {
                        assert!(
                            other == text || !fits(schema, &stating(name, &other)),
                            "{other}"
                        );
                    }
                }
                for other in [
                    "", "(1,2)", "(01, 2)", "(-0, 2)", "(1, 2", "(1.5, 2)", "44 deg", "hard",
                ] {
                    assert!(!fits(schema, &stating(name, other)), "{name} {other}");
                }
                let mut lacking = first.clone();
                lacking.shift_remove(name);
                assert!(!fits(schema, &Json::Object(lacking)));
            }
            assert!(!fits(schema, &stating("else", "x")));
            assert!(!fits(schema, &json!("(10, 20)")));
        }
        // The points are known only in a scene.
        let elsewhere = stating("pick", "(11, 20)");
        assert!(!fits(&schemas[0], &elsewhere) && fits(&schemas[1], &elsewhere));
    }
}

#[test]
fn a_field_without_values_accepts_nothing() {
    let program = spaces::space("paper");
    let schema = reply::schema_in(&program, &Notation::pixels(), &[]);
    assert_eq!(schema["properties"]["pick"]["enum"], json!([]));
    assert_eq!(schema["properties"]["direction"]["enum"][1], "45 deg");
    assert_eq!(schema["required"], json!(["pick", "direction", "distance"]));
}

/// What a schema accepts for one property: each choice, or points that fit the pattern.
fn instances(property: &Json) -> Vec<Json> {
    match property["enum"].as_array() {
        Some(choices) => choices.clone(),
        None if property["pattern"].is_string() => {
            let points =
                ["(0, 0)", "(-1, 223)", "(999999, -999999)", "(41, 167)"].map(|point| json!(point));
            assert!(points.iter().all(|point| fits(property, point)));
            points.into()
        }
        None => vec![json!(
            "The corner is free, so 90 deg and (1, 2) are no good."
        )],
    }
}

#[test]
fn schema_and_reader_admit_the_same_actions() {
    let mut programs: Vec<Program> = ["points", "paper", "region", "grip", "manner"]
        .map(spaces::space)
        .into();
    programs.push(common::program("task.fab", &asking_for_reasons()));
    for program in &programs {
        let offered = offered(program, &[(10, 20), (0, 223), (-3, 4)]);
        for schema in [
            reply::schema_in(program, &Notation::pixels(), &offered),
            reply::static_schema(program),
        ] {
            assert_reads_all_instances(program, &Notation::pixels(), &schema);
        }
    }
}

#[test]
fn schema_and_reader_admit_the_same_actions_in_every_notation() {
    let known = pointing::known();
    let size = [224; 2];
    let units = [
        CoordinateUnit::Pixels,
        CoordinateUnit::Fraction,
        CoordinateUnit::Percent,
        CoordinateUnit::PerMille,
    ];
    let frames = units.into_iter().flat_map(|unit| {
        [Order::Xy, Order::Yx].map(|order| Frame {
            unit,
            order,
            size,
            sent: [448; 2],
        })
    });
    let marks = Pointing::Marks(Frame::pixels(size));
    for pointing in frames.map(Pointing::Frame).chain([marks]) {
        for name in ["points", "paper", "grip", "manner"] {
            let program = spaces::space(name);
            let notation = Notation::of(pointing, &program.actions, &known);
            let fields = program.actions.iter();
            let offered: Vec<_> = fields
                .map(|field| (field.name.clone(), space::choices(field, &known)))
                .collect();
            let schema = reply::schema_in(&program, &notation, &offered);
            assert_reads_all_instances(&program, &notation, &schema);
        }
    }
}

/// Reads an instance of a schema with each choice of each property: what is read is what the schema states.
fn assert_reads_all_instances(program: &Program, notation: &Notation, schema: &Json) {
    let properties = schema["properties"].as_object().unwrap();
    let counts = properties.values().map(|it| instances(it).len());
    for index in 0..counts.max().unwrap() {
        let chosen = properties.iter().map(|(name, property)| {
            let all = instances(property);
            (name.clone(), all[index % all.len()].clone())
        });
        let answer = Json::Object(chosen.collect());
        assert!(fits(schema, &answer), "{answer}");
        let read = reply::read_action_in(program, notation, &answer.to_string())
            .unwrap_or_else(|refused| panic!("{answer}: {}", refused.message));
        for (field, (_, value)) in program.actions.iter().zip(&read.value.fields) {
            let stated = json!(notation.stated_value(field, value));
            assert_eq!(answer[&field.name], stated, "{answer}");
        }
    }
}

/// Returns the small task, whose prompt asks for reasons.
fn asking_for_reasons() -> String {
    let format = "{{ actions.format }}";
    common::TASK.replace(format, &format!("{format} Then give your reasons."))
}

#[test]
fn an_action_from_any_form_of_answer_is_one_that_the_schema_can_state() {
    let folder = common::workspace().join("compiler/program/tests/answers");
    let entries = std::fs::read_dir(folder).unwrap();
    let mut n_read = 0;
    for file in entries.map(|entry| entry.unwrap().path()) {
        let text = std::fs::read_to_string(&file).unwrap();
        for case in text.split("\n=== ").skip(1) {
            let (head, answer) = case.split_once("\n---\n").unwrap();
            let mut lines = head.lines().skip(1);
            let Some(name) = lines.next().unwrap().strip_prefix("action in ") else {
                continue;
            };
            let program = spaces::space(name);
            let Ok(read) = reply::read_action(&program, answer) else {
                continue;
            };
            let fields = program.actions.iter().zip(&read.value.fields);
            let is_offered = fields.clone().all(|(field, (_, value))| {
                let declared = space::declared(field);
                declared.is_empty() || declared.contains(value)
            });
            let stated = fields
                .map(|(field, (name, value))| (name.clone(), json!(space::text(field, value))));
            let stated = Json::Object(stated.collect());
            // The verifier refuses what is not offered, and so does the schema.
            assert_eq!(
                fits(&reply::static_schema(&program), &stated),
                is_offered,
                "{answer}"
            );
            n_read += 1;
        }
    }
    assert!(n_read > 300, "{n_read}");
}

#[test]
fn the_schema_offers_each_field_its_own_points() {
    let program = spaces::space("points");
    let offered = vec![Value::Point(PixelPoint::new(1, 2))];
    let schema = reply::schema_in(
        &program,
        &Notation::pixels(),
        &[("pick".to_owned(), offered)],
    );
    assert_eq!(schema["properties"]["pick"]["enum"], json!(["(1, 2)"]));
    assert_eq!(schema["properties"]["place"]["enum"], json!([]));
    assert_eq!(schema["required"], json!(["pick", "place"]));
    assert_eq!(schema["additionalProperties"], false);
}

#[test]
fn a_prompt_that_asks_for_reasons_has_a_place_for_them() {
    let text = common::TASK;
    let asks = |text: &str| {
        let program = common::program("task.fab", text);
        reply::static_schema(&program)["required"]
            .as_array()
            .unwrap()
            .contains(&json!("reason"))
    };
    assert!(!asks(text));
    assert!(asks(&asking_for_reasons()));
    // Before the fields, so that a model without hidden reasoning thinks first.
    let program = common::program("task.fab", &asking_for_reasons());
    for schema in [
        reply::static_schema(&program),
        reply::schema_in(&program, &Notation::pixels(), &[]),
    ] {
        let properties = schema["properties"].as_object().unwrap();
        assert_eq!(properties.keys().next().unwrap(), "reason");
        assert_eq!(properties["reason"]["maxLength"], 600);
    }
}
