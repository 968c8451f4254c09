//! Tests with scripted models that see the dots well and answer in their own convention.

use super::reading::pairs;
use super::*;
use crate::catalogue::{Accepted, Catalogue, MaxTokensField};
use fab_model::calls::{Budget, Ledger};
use fab_model::{ModelKind, Reply};
use proptest::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Finds the dots in the picture by their colours and names them in a fixed convention, whatever it is asked for.
struct Seeing {
    /// The lowering used in questions.
    told: Lowering,
    /// The convention of its answers, relative to the picture that it got.
    says: Lowering,
    /// Formats an answer from two numbers.
    form: fn(&str, [f64; 2]) -> String,
}

impl Seeing {
    /// Converts a position, given as fractions of the picture's sides, to its own convention.
    fn numbers(&self, part: [f64; 2], got: [u32; 2]) -> [f64; 2] {
        let looked_at = |side: u32| match self.says.multiples_of_px {
            Some(of_px) => {
                let of = f64::from(of_px.get());
                (f64::from(side) / of).round() * of
            }
            None => f64::from(side),
        };
        let [x, y] = [0, 1].map(|axis| match self.says.unit {
            CoordinateUnit::Pixels => part[axis] * looked_at(got[axis]) - 0.5,
            CoordinateUnit::Fraction => part[axis],
            CoordinateUnit::Percent => part[axis] * 100.0,
            CoordinateUnit::PerMille => part[axis] * 1000.0,
        });
        match self.says.order {
            Order::Xy => [x, y],
            Order::Yx => [y, x],
        }
    }
}

impl Model for Seeing {
    fn name(&self) -> &str {
        "seeing"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn lowering(&self) -> Lowering {
        self.told
    }

    fn ask(&self, request: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let Some(Part::Image(png)) = request.messages[0].parts.last() else {
            panic!("the question shows a picture");
        };
        let shown = png::opened(png.bytes(), std::path::Path::new("shown")).expect("a picture");
        let mut seen = [([0.0, 0.0], 0.0); DOTS.len()];
        for (x, y, pixel) in shown.enumerate_pixels() {
            let Some(dot) = DOTS.iter().position(|(_, colour)| pixel.0 == *colour) else {
                continue;
            };
            let (sum, count) = &mut seen[dot];
            *sum = [sum[0] + f64::from(x), sum[1] + f64::from(y)];
            *count += 1.0;
        }
        let lines: Vec<String> = DOTS
            .iter()
            .zip(seen)
            .map(|((name, _), (sum, count))| {
                let got = [shown.width(), shown.height()];
                let part = [0, 1].map(|axis| (sum[axis] / count + 0.5) / f64::from(got[axis]));
                (self.form)(name, self.numbers(part, got))
            })
            .collect();
        Ok(Reply::text(lines.join("\n")))
    }
}

fn plain(name: &str, [one, other]: [f64; 2]) -> String {
    format!("{name}: ({one:.3}, {other:.3})")
}

fn lowering(unit: CoordinateUnit, order: Order, multiples_of_px: Option<NonZeroU32>) -> Lowering {
    Lowering {
        unit,
        order,
        multiples_of_px,
        ..Lowering::PIXELS
    }
}

fn found(told: Lowering, says: Lowering) -> Dots {
    let form = plain;
    dots(
        &Seeing { told, says, form },
        7,
        None,
        &mut Ledger::unwritten(&Budget::default()),
    )
    .expect("it answers")
}

#[test]
#[ignore = "long"]
fn the_way_in_which_a_model_answers_is_found_whichever_was_asked_for() {
    let [pixels, y_first] =
        Order::ALL.map(|order| lowering(CoordinateUnit::Pixels, order, Some(MULTIPLES_OF_PX)));
    let of_sides = lowerings(Lowering::PIXELS);
    assert_eq!(of_sides.len(), 10);
    assert!(of_sides.contains(&pixels) && of_sides.contains(&y_first));
    for says in of_sides {
        for told in [Lowering::PIXELS, says] {
            let found = found(told, says);
            assert_eq!(found.best(), Some(says), "asked for {told}");
            let error = found.tried[0].error_px;
            assert!(error < 0.5, "{says}: {error}");
            assert_eq!(found.agrees(), says == told, "{says}, asked for {told}");
            assert_eq!((found.read, found.drawn), (12, 12));
        }
    }
}

#[test]
fn a_model_that_gets_pictures_in_its_size_has_no_reason_to_resize_them() {
    let told = lowering(CoordinateUnit::Pixels, Order::Xy, Some(MULTIPLES_OF_PX));
    let found = found(told, Lowering::PIXELS);
    assert!(found.agrees(), "{:?}", found.tried);
    assert!(found.tried[0].error_px < 0.5, "{:?}", found.tried[0]);
    assert_eq!(found.tried.len(), 8, "no way is tried twice");
}

#[test]
fn a_question_has_the_words_of_rollouts_and_a_picture_in_their_size() {
    for (told, words, sent) in [
        (Lowering::PIXELS, "(x, y) in pixels: x grows", [720; 2]),
        (
            lowering(CoordinateUnit::Pixels, Order::Yx, Some(MULTIPLES_OF_PX)),
            "[y, x] in pixels of a picture 728 wide and 728 high: x grows",
            [728; 2],
        ),
        (
            lowering(CoordinateUnit::PerMille, Order::Xy, None),
            "(x, y) in thousandths of the picture's width and height: x grows",
            [720; 2],
        ),
    ] {
        let asked = question(720, &[[100, 100]; 6], told);
        let [Part::Text(text), Part::Image(png)] = &asked.messages[0].parts[..] else {
            panic!("a text and a picture");
        };
        assert!(text.contains(words), "{text}");
        let sentence = told.pointing([720; 2]).sentence();
        assert!(text.contains(&sentence), "{text}");
        let form = told.pointing([720; 2]).form();
        assert!(text.contains(&format!("\nmagenta: {form}")), "{text}");
        let shown = png::opened(png.bytes(), std::path::Path::new("shown"));
        assert_eq!(
            <[u32; 2]>::from(shown.expect("a picture").dimensions()),
            sent
        );
    }
}

#[test]
fn errors_count_pixels_of_the_cameras_picture_whatever_was_sent() {
    let of_px = NonZeroU32::new(360).expect("not 0");
    let told = lowering(CoordinateUnit::Pixels, Order::Xy, Some(of_px));
    let form = |name: &str, [x, y]: [f64; 2]| plain(name, [x + 1.0, y]);
    let says = Lowering::PIXELS;
    let found = dots(
        &Seeing { told, says, form },
        7,
        None,
        &mut Ledger::unwritten(&Budget::default()),
    )
    .expect("it answers");
    let error = found.tried[0].error_px;
    // One pixel of the large picture, which is sent unchanged, and of the small one, which is enlarged from 224 to 360.
    let expected = (1.0 + 224.0 / 360.0) / 2.0;
    assert!((error - expected).abs() < 0.2, "{error}");
}

#[test]
fn coordinates_are_asked_for_where_rollouts_ask_for_numbers() {
    let told = Lowering {
        points: Points::Marks,
        ..Lowering::PIXELS
    };
    let found = found(told, Lowering::PIXELS);
    assert!(found.agrees() && found.asked == Lowering::PIXELS);
}

fn in_pixels(form: fn(&str, [f64; 2]) -> String, seed: u64) -> Dots {
    let [told, says] = [Lowering::PIXELS; 2];
    dots(
        &Seeing { told, says, form },
        seed,
        None,
        &mut Ledger::unwritten(&Budget::default()),
    )
    .expect("it answers")
}

#[test]
fn an_answer_that_names_no_place_fits_no_frame() {
    let found = in_pixels(|name, _| format!("I see a {name} dot"), 7);
    assert_eq!((found.best(), found.read), (None, 0));
    assert!(!found.agrees() && found.coordinates().is_none());
}

#[test]
fn a_dot_that_is_not_named_does_not_agree() {
    let all_but_blue = |name: &str, at| match name {
        "blue" => String::new(),
        _ => plain(name, at),
    };
    let found = in_pixels(all_but_blue, 7);
    assert_eq!((found.best(), found.read), (Some(Lowering::PIXELS), 10));
    assert!(!found.agrees());
}

#[test]
fn dots_lie_apart_and_inside_whatever_the_seed() {
    for seed in 0..200 {
        let mut chance = Chance::seeded(seed);
        for side in SIDES_PX {
            let radius = f64::from(side / 45).max(4.0);
            let places = places(side, &mut chance);
            for (number, one) in places.iter().enumerate() {
                let inside = one
                    .map(|at| f64::from(at) >= radius && f64::from(at) + radius < f64::from(side));
                assert_eq!(inside, [true, true], "seed {seed}: {one:?} of {side}");
                for other in &places[..number] {
                    let [dx, dy] = [0, 1].map(|axis| f64::from(one[axis]) - f64::from(other[axis]));
                    assert!(
                        dx.hypot(dy) > 3.0 * radius,
                        "seed {seed}: {one:?} {other:?} of {side}"
                    );
                }
            }
        }
    }
}

#[test]
#[ignore = "long"]
fn the_same_seed_asks_the_same_and_another_asks_otherwise() {
    let replies = |seed| in_pixels(plain, seed).replies;
    assert_eq!(replies(3), replies(3));
    assert_ne!(replies(3), replies(4));
}

/// How a character takes a JSON Schema.
#[derive(Clone, Copy, PartialEq)]
enum Schema {
    Follows,
    Ignores,
    Refuses,
}

/// A model of a certain character, with the interface before it.
#[derive(Clone)]
struct Character {
    says: Lowering,
    thought: &'static str,
    temperature: Option<Accepted>,
    schema: Schema,
    sees: bool,
    limit: MaxTokensField,
    /// The fault of every answer.
    fault: Option<Fault>,
    asked: Arc<AtomicU64>,
}

/// A character under assumed facts.
struct Assumed {
    character: Character,
    facts: Facts,
}

impl Model for Assumed {
    fn name(&self) -> &str {
        "character"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::Model
    }

    fn lowering(&self) -> Lowering {
        self.facts.lowering()
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        let character = &self.character;
        character.asked.fetch_add(1, Ordering::SeqCst);
        let shows = request.messages[0].parts.len() > 1;
        let sends_schema = self.facts.structured_output == Some(true) && request.schema.is_some();
        let field = self
            .facts
            .max_tokens_field
            .unwrap_or(MaxTokensField::MaxTokens);
        let takes = |value: f64| {
            let accepted = character.temperature.as_ref();
            accepted.is_none_or(|it| it.takes(value))
        };
        let is_refused = field != character.limit
            || shows && !character.sees
            || !request.temperature.is_none_or(takes)
            || sends_schema && character.schema == Schema::Refuses;
        let refusal = is_refused.then_some(Fault::BadRequest);
        if let Some(fault) = character.fault.or(refusal) {
            return Err(ModelError::Failed {
                model: "character".to_owned(),
                fault,
                why: "HTTP 400\nno".to_owned(),
            });
        }
        let text = if shows {
            let seeing = Seeing {
                told: self.lowering(),
                says: character.says,
                form: plain,
            };
            seeing.ask(request, calls)?.text
        } else if sends_schema && character.schema == Schema::Follows {
            r#"{"reason":"a tree","at":"(0, 0)","colour":"green"}"#.to_owned()
        } else {
            "Oak".to_owned()
        };
        Ok(Reply::text(format!("{}{text}", character.thought)))
    }
}

/// A model of 2026 that takes everything, and answers in pixels.
fn easy() -> Character {
    Character {
        says: Lowering::PIXELS,
        thought: "",
        temperature: None,
        schema: Schema::Follows,
        sees: true,
        limit: MaxTokensField::MaxTokens,
        fault: None,
        asked: Arc::default(),
    }
}

/// Probes a character as `vllm:my "model"`.
fn probed(character: &Character) -> (Profile, Result<Findings, ModelError>) {
    let profile = Catalogue::builtin().find("vllm:my \"model\"");
    let profile = profile.expect("a known provider");
    let under = |facts: &Facts| {
        Ok(Box::new(Assumed {
            character: character.clone(),
            facts: facts.clone(),
        }) as Box<dyn Model>)
    };
    let findings = probe(
        &profile,
        &under,
        7,
        None,
        &mut Ledger::unwritten(&Budget::default()),
    );
    (profile, findings)
}

#[test]
#[ignore = "long"]
fn every_character_is_found_out_and_its_entry_is_used_when_pasted() {
    use CoordinateUnit::{Fraction, PerMille, Percent, Pixels};
    let habit = |unit, order, multiples_of_px| PositionFormat {
        unit,
        order,
        multiples_of_px,
    };
    let easy_facts = Facts {
        vision: Some(true),
        structured_output: Some(true),
        max_tokens_field: Some(MaxTokensField::MaxTokens),
        coordinates: Some(habit(Pixels, Order::Xy, None)),
        ..Facts::default()
    };
    let only_one = Some(Accepted::Only(vec![1.0]));
    let mut cases = vec![
        ("easy", easy(), easy_facts.clone()),
        (
            "thinks in the content",
            Character {
                thought: "<think>red: (5, 5)\ngreen: (6, 6). Hm, red: (7, 7)?</think>\n",
                ..easy()
            },
            easy_facts.clone(),
        ),
        (
            "fixed sampling",
            Character {
                temperature: only_one.clone(),
                ..easy()
            },
            Facts {
                temperature: only_one,
                ..easy_facts.clone()
            },
        ),
        (
            "no temperature",
            Character {
                temperature: Some(Accepted::Refused),
                ..easy()
            },
            Facts {
                temperature: Some(Accepted::Refused),
                ..easy_facts.clone()
            },
        ),
        (
            "the other limit",
            Character {
                limit: MaxTokensField::MaxCompletionTokens,
                ..easy()
            },
            Facts {
                max_tokens_field: Some(MaxTokensField::MaxCompletionTokens),
                ..easy_facts.clone()
            },
        ),
        (
            "no pictures",
            Character {
                sees: false,
                ..easy()
            },
            Facts {
                vision: Some(false),
                coordinates: None,
                ..easy_facts.clone()
            },
        ),
    ];
    for schema in [Schema::Ignores, Schema::Refuses] {
        let character = Character { schema, ..easy() };
        let expected = Facts {
            structured_output: Some(false),
            ..easy_facts.clone()
        };
        cases.push(("no schema", character, expected));
    }
    for (unit, order, multiples_of_px) in [
        (Pixels, Order::Xy, Some(MULTIPLES_OF_PX)),
        (PerMille, Order::Xy, None),
        (PerMille, Order::Yx, None),
        (Percent, Order::Xy, None),
        (Fraction, Order::Xy, None),
    ] {
        let character = Character {
            says: lowering(unit, order, multiples_of_px),
            ..easy()
        };
        let expected = Facts {
            coordinates: Some(habit(unit, order, multiples_of_px)),
            ..easy_facts.clone()
        };
        cases.push(("another frame", character, expected));
    }
    for (name, character, expected) in cases {
        let (profile, found) = probed(&character);
        let mut found = found.expect(name);
        assert_eq!(found.facts, expected, "{name}: {:?}", found.notes);
        found.notes.push("a note\nvision = false".to_owned());
        let toml = found.toml(
            &profile,
            Date::try_from("2026-11-24".to_owned()).expect("a date"),
        );
        let catalogue = Catalogue::builtin().overlaid(&toml, "pasted.toml");
        let catalogue = catalogue.unwrap_or_else(|error| panic!("{name}: {error}\n{toml}"));
        let pasted = catalogue.find(&profile.title()).expect("pasted");
        assert_eq!(pasted.facts, expected, "{name}:\n{toml}");
        let vllm = catalogue.provider("vllm").expect("known");
        let listed = catalogue.listed(Some(vllm));
        let source = &listed.first().expect("pasted").sources[0];
        assert_eq!(source.source.as_deref(), Some("fabc probe"));
    }
}

#[test]
fn a_probe_asks_no_more_than_it_says() {
    let stubborn = Character {
        limit: MaxTokensField::MaxCompletionTokens,
        temperature: Some(Accepted::Refused),
        sees: false,
        schema: Schema::Refuses,
        ..easy()
    };
    // Two each for the limit and the temperature, one each for `top_p`, the schema and the dots.
    for (character, expected) in [(stubborn, 7), (easy(), 6)] {
        probed(&character).1.expect("it answers");
        assert_eq!(character.asked.load(Ordering::SeqCst), expected);
        assert!(
            expected < MOST_QUESTIONS,
            "a refused `top_p` asks once more, and there are two pictures"
        );
    }
}

#[test]
fn a_server_that_answers_nothing_is_asked_no_further() {
    for (fault, questions) in [
        (Fault::ServerFailed, 1),
        (Fault::InvalidReply, 1),
        (Fault::Truncated, 1),
        (Fault::BadRequest, 2),
    ] {
        let character = Character {
            fault: Some(fault),
            ..easy()
        };
        let (_, found) = probed(&character);
        assert_eq!(character.asked.load(Ordering::SeqCst), questions, "{fault}");
        let Err(ModelError::Failed { why, .. }) = found else {
            panic!("{fault}: {found:?}");
        };
        assert_eq!(why, "HTTP 400\nno");
    }
}

#[test]
fn pairs_are_read_in_the_forms_that_models_write() {
    let expected = [Some([12.0, 34.5]), Some([0.25, 1000.0])];
    for text in [
        "red: (12, 34.5)\nblue: (0.25, 1000)",
        "- **Red** dot: [12, 34.5]\n- Blue: 0.25 1000",
        "{\"red\": [12, 34.5], \"blue\": {\"x\": 0.25, \"y\": 1000}}",
        "```json\n[{\"point\": [12, 34.5], \"label\": \"red\"}, {\"point\": [0.25, 1000], \"label\": \"blue\"}]\n```",
        "<point x=\"12\" y=\"34.5\" alt=\"red\">red</point><point x1=\"0.25\" y1=\"1000\">blue</point>",
        "red: x=12, y=34.5; blue: x=0.25, y=1000. The red dot is left.",
    ] {
        assert_eq!(pairs(text, &["red", "blue"]), expected, "{text}");
    }
}

#[test]
fn what_names_no_pair_is_not_guessed_at() {
    for text in [
        "",
        "red: 12",
        "redder: (1, 2)",
        "I cannot see red or blue.",
        "12, 34",
        "red blue",
    ] {
        assert_eq!(pairs(text, &["red", "blue"]), [None, None], "{text}");
    }
    assert_eq!(pairs("red: (1, 2)\nred: (3, 4)", &["red"]), [None]);
    assert_eq!(
        pairs("red: (1, 2)\nred: (1, 2)", &["red"]),
        [Some([1.0, 2.0])]
    );
    assert_eq!(pairs("red: (-1, 2)", &["red"]), [Some([-1.0, 2.0])]);
}

#[test]
fn thoughts_and_quotations_are_not_read_and_a_correction_is_a_second_value() {
    for (text, expected) in [
        (
            "<think>red: (9, 9), or rather (8, 8)</think>\nred: (1, 2)",
            Some([1.0, 2.0]),
        ),
        ("> red: (9, 9)\nred: (1, 2)", Some([1.0, 2.0])),
        ("red: (9, 9)\nNo wait, correction:\nred: (1, 2)", None),
        ("<think>red: (1, 2)", None),
    ] {
        assert_eq!(pairs(text, &["red"]), [expected], "{text}");
    }
}

proptest! {
    #[test]
    fn no_answer_makes_it_panic(text in "\\PC*", more in "[0-9.,()red blue\\[\\]-]*") {
        pairs(&(text + &more), &["red", "blue"]);
    }
}
