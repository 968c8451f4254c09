//! Tests with scripted models that see the dots well and answer in their own convention.

use super::*;
use crate::catalogue::{Accepted, Catalogue, Facts, MaxTokensField, PositionFormat, Wire};
use fab_model::calls::{Fault, Unrecorded};
use fab_model::{ModelKind, Reply};
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
        let looked_at = |side: u32| match self.says.resize {
            Resize::Multiples { of_px } => {
                let of = f64::from(of_px.get());
                (f64::from(side) / of).round() * of
            }
            _ => f64::from(side),
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
        let shown = png::decode(png.bytes(), std::path::Path::new("shown")).expect("a picture");
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
        Ok(Reply {
            text: lines.join("\n"),
            usage: Some(Usage {
                input_tokens: 100,
                cached_input_tokens: 0,
                output_tokens: 10,
                ..Usage::default()
            }),
            cost: None,
        })
    }
}

fn plain(name: &str, [one, other]: [f64; 2]) -> String {
    format!("{name}: ({one:.3}, {other:.3})")
}

fn lowering(unit: CoordinateUnit, order: Order, resize: Resize) -> Lowering {
    Lowering {
        unit,
        order,
        resize,
        ..Lowering::PIXELS
    }
}

fn multiples() -> Resize {
    Resize::Multiples {
        of_px: MULTIPLES_OF_PX,
    }
}

fn found(told: Lowering, says: Lowering) -> Probe {
    let form = plain;
    probe(&Seeing { told, says, form }, 7, None, &mut Unrecorded).expect("it answers")
}

#[test]
#[ignore = "long"]
fn the_way_in_which_a_model_answers_is_found_whichever_was_asked_for() {
    let [pixels, y_first] =
        Order::ALL.map(|order| lowering(CoordinateUnit::Pixels, order, multiples()));
    let of_sides = lowerings(Lowering::PIXELS);
    assert_eq!(of_sides.len(), 10);
    assert!(of_sides.contains(&pixels) && of_sides.contains(&y_first));
    for says in of_sides {
        for told in [Lowering::PIXELS, says] {
            let found = found(told, says);
            assert_eq!(found.best(), Some(says), "asked for {told}");
            let error = found.tried[0].error;
            assert!(error.max < 1.0, "{says}: {error:?}");
            assert_eq!(found.agrees(), says == told, "{says}, asked for {told}");
            assert_eq!((found.read, found.dots), (12, 12));
        }
    }
}

#[test]
fn a_model_that_gets_pictures_in_its_size_has_no_reason_to_resize_them() {
    let told = lowering(CoordinateUnit::Pixels, Order::Xy, multiples());
    let found = found(told, Lowering::PIXELS);
    assert!(found.agrees(), "{:?}", found.tried);
    assert!(found.tried[0].error.max < 1.0, "{:?}", found.tried[0]);
    assert_eq!(found.tried.len(), 8, "no way is tried twice");
}

#[test]
fn what_a_model_resizes_is_the_picture_that_it_was_sent() {
    let side_px = NonZeroU32::new(360).expect("not 0");
    let told = lowering(
        CoordinateUnit::Pixels,
        Order::Xy,
        Resize::Within { side_px },
    );
    let says = lowering(CoordinateUnit::Pixels, Order::Xy, multiples());
    let found = found(told, says);
    assert_eq!(found.best(), Some(says));
    assert!(found.tried[0].error.max < 1.0, "{:?}", found.tried[0]);
}

#[test]
fn a_question_has_the_words_of_rollouts_and_a_picture_in_their_size() {
    for (told, words, sent) in [
        (Lowering::PIXELS, "(x, y) in pixels: x grows", [720; 2]),
        (
            lowering(CoordinateUnit::Pixels, Order::Yx, multiples()),
            "[y, x] in pixels of a picture 728 wide and 728 high: x grows",
            [728; 2],
        ),
        (
            lowering(CoordinateUnit::PerMille, Order::Xy, Resize::Never),
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
        let shown = png::decode(png.bytes(), std::path::Path::new("shown"));
        assert_eq!(
            <[u32; 2]>::from(shown.expect("a picture").dimensions()),
            sent
        );
    }
}

#[test]
fn errors_count_pixels_of_the_cameras_picture_whatever_was_sent() {
    let side_px = NonZeroU32::new(360).expect("not 0");
    let told = lowering(
        CoordinateUnit::Pixels,
        Order::Xy,
        Resize::Within { side_px },
    );
    let form = |name: &str, [x, y]: [f64; 2]| plain(name, [x + 1.0, y]);
    let says = Lowering::PIXELS;
    let found = probe(&Seeing { told, says, form }, 7, None, &mut Unrecorded).expect("it answers");
    let error = found.error.expect("it was read");
    // One pixel of the small picture, which is sent unchanged, and of the large one, which is sent at half its size.
    assert!((error.mean - 1.5).abs() < 0.2, "{error:?}");
    assert!((error.max - 2.0).abs() < 0.5, "{error:?}");
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

#[test]
fn an_answer_in_another_frame_is_seen_by_its_error() {
    let per_mille = lowering(CoordinateUnit::PerMille, Order::Xy, Resize::Never);
    let found = found(Lowering::PIXELS, per_mille);
    let error = found.error.expect("it was read");
    assert!(error.median > 50.0 && error.mean <= error.max, "{error:?}");
    assert_eq!(found.usage.expect("it was told").input_tokens, 200);
    assert_eq!(found.cost, None, "an unknown cost stays unknown");
}

fn in_pixels(form: fn(&str, [f64; 2]) -> String, seed: u64) -> Probe {
    let [told, says] = [Lowering::PIXELS; 2];
    probe(&Seeing { told, says, form }, seed, None, &mut Unrecorded).expect("it answers")
}

#[test]
fn an_answer_that_names_no_place_fits_no_frame() {
    let found = in_pixels(|name, _| format!("I see a {name} dot"), 7);
    assert_eq!((found.best(), found.error, found.read), (None, None, 0));
    assert!(!found.agrees());
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
    let places = |seed| {
        let found = in_pixels(plain, seed);
        let dots = found.pictures.into_iter().flat_map(|picture| picture.dots);
        dots.map(|dot| dot.at).collect::<Vec<_>>()
    };
    assert_eq!(places(3), places(3));
    assert_ne!(places(3), places(4));
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
    hidden_tokens: u64,
    temperature: Option<Accepted>,
    schema: Schema,
    pictures: usize,
    limit: MaxTokensField,
    known: Facts,
}

/// A character under assumed facts.
struct Assumed {
    character: Character,
    facts: Facts,
}

impl Subject for Character {
    fn known(&self) -> &Facts {
        &self.known
    }

    fn wire(&self) -> Wire {
        Wire::OpenaiChat
    }

    fn under(&self, facts: &Facts) -> Result<Arc<dyn Model>, ModelError> {
        Ok(Arc::new(Assumed {
            character: self.clone(),
            facts: facts.clone(),
        }))
    }
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
        let pictures = request.messages[0].parts.iter();
        let pictures = pictures
            .filter(|part| matches!(part, Part::Image(_)))
            .count();
        let sends_schema = self.facts.structured_output == Some(true) && request.schema.is_some();
        let field = self
            .facts
            .max_tokens_field
            .unwrap_or(MaxTokensField::MaxTokens);
        let takes = |value: f64| {
            character
                .temperature
                .as_ref()
                .is_none_or(|it| it.takes(value))
        };
        let is_refused = field != character.limit
            || pictures > character.pictures
            || !request.temperature.is_none_or(takes)
            || sends_schema && character.schema == Schema::Refuses;
        if is_refused {
            return Err(ModelError::Failed {
                model: "character".to_owned(),
                fault: Fault::BadRequest,
                why: "HTTP 400\nno".to_owned(),
            });
        }
        let Part::Text(words) = &request.messages[0].parts[0] else {
            panic!("a question begins with words");
        };
        let text = match (words, pictures) {
            (words, _) if words.contains("the word yes") => "yes".to_owned(),
            (words, _) if words.contains("tree") => match sends_schema {
                true if character.schema == Schema::Follows => {
                    r#"{"reason":"a tree","at":"(0, 0)","colour":"green"}"#.to_owned()
                }
                _ => "Oak".to_owned(),
            },
            (_, 2) => "first: red\nsecond: blue".to_owned(),
            (words, _) if words.contains("two pictures") => "first: red\nsecond: red".to_owned(),
            _ => {
                let told = self.lowering();
                let seeing = Seeing {
                    told,
                    says: character.says,
                    form: plain,
                };
                seeing.ask(request, calls)?.text
            }
        };
        let text = format!("{}{text}", character.thought);
        let output_tokens = crate::catalogue::tokens::of_text(&text) + character.hidden_tokens;
        Ok(Reply {
            usage: Some(Usage {
                input_tokens: 10,
                cached_input_tokens: 0,
                output_tokens,
                reasoning_tokens: None,
            }),
            cost: Some(Usd::from_nano(1)),
            text,
        })
    }
}

/// A model of 2026 that takes everything, and answers in pixels.
fn easy() -> Character {
    Character {
        says: Lowering::PIXELS,
        thought: "",
        hidden_tokens: 0,
        temperature: None,
        schema: Schema::Follows,
        pictures: 2,
        limit: MaxTokensField::MaxTokens,
        known: Facts::default(),
    }
}

fn habit(unit: CoordinateUnit, order: Order, multiples_of_px: Option<u32>) -> PositionFormat {
    PositionFormat {
        unit,
        order,
        multiples_of_px,
    }
}

#[test]
#[ignore = "long"]
fn every_character_is_found_out_and_its_entry_is_used_when_pasted() {
    use CoordinateUnit::{Fraction, PerMille, Percent, Pixels};
    let easy_facts = Facts {
        vision: Some(true),
        several_pictures: Some(true),
        structured_output: Some(true),
        max_tokens_field: Some(MaxTokensField::MaxTokens),
        coordinates: Some(habit(Pixels, Order::Xy, None)),
        ..Facts::default()
    };
    let saying = |unit, order, resize| Character {
        says: lowering(unit, order, resize),
        ..easy()
    };
    let in_frame = |unit, order, multiples| Facts {
        coordinates: Some(habit(unit, order, multiples)),
        ..easy_facts.clone()
    };
    let thought = "<think>red: (5, 5)\ngreen: (6, 6). Hm, red: (7, 7)?</think>\n";
    let cases = [
        ("easy", easy(), easy_facts.clone(), Some(false)),
        (
            "pixels of the resized picture",
            saying(Pixels, Order::Xy, multiples()),
            in_frame(Pixels, Order::Xy, Some(28)),
            Some(false),
        ),
        (
            "thousandths",
            saying(PerMille, Order::Xy, Resize::Never),
            in_frame(PerMille, Order::Xy, None),
            Some(false),
        ),
        (
            "y first",
            saying(PerMille, Order::Yx, Resize::Never),
            in_frame(PerMille, Order::Yx, None),
            Some(false),
        ),
        (
            "percent",
            saying(Percent, Order::Xy, Resize::Never),
            in_frame(Percent, Order::Xy, None),
            Some(false),
        ),
        (
            "fraction",
            saying(Fraction, Order::Xy, Resize::Never),
            in_frame(Fraction, Order::Xy, None),
            Some(false),
        ),
        (
            "thinks in the content",
            Character { thought, ..easy() },
            easy_facts.clone(),
            Some(true),
        ),
        (
            "thinks unseen",
            Character {
                hidden_tokens: 300,
                ..easy()
            },
            easy_facts.clone(),
            Some(true),
        ),
        (
            "fixed sampling",
            Character {
                temperature: Some(Accepted::Only(vec![1.0])),
                ..easy()
            },
            Facts {
                temperature: Some(Accepted::Only(vec![1.0])),
                ..easy_facts.clone()
            },
            Some(false),
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
            Some(false),
        ),
        (
            "ignores schemas",
            Character {
                schema: Schema::Ignores,
                ..easy()
            },
            Facts {
                structured_output: Some(false),
                ..easy_facts.clone()
            },
            Some(false),
        ),
        (
            "refuses schemas",
            Character {
                schema: Schema::Refuses,
                ..easy()
            },
            Facts {
                structured_output: Some(false),
                ..easy_facts.clone()
            },
            Some(false),
        ),
        (
            "one picture",
            Character {
                pictures: 1,
                ..easy()
            },
            Facts {
                several_pictures: Some(false),
                ..easy_facts.clone()
            },
            Some(false),
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
            Some(false),
        ),
        (
            "no pictures",
            Character {
                pictures: 0,
                ..easy()
            },
            Facts {
                vision: Some(false),
                several_pictures: None,
                coordinates: None,
                ..easy_facts.clone()
            },
            Some(false),
        ),
    ];
    for (name, character, expected, reasons) in cases {
        let calls = &mut Unrecorded;
        let able = abilities(&character, calls).expect(name);
        let sees = able.facts.vision != Some(false);
        let known = Facts {
            max_tokens_field: able.facts.max_tokens_field,
            ..Facts::default()
        };
        let model = character.under(&known).expect(name);
        let dots = sees.then(|| probe(model.as_ref(), 7, None, calls).expect(name));
        let facts = entry::facts(dots.as_ref(), &able);
        assert_eq!(facts, expected, "{name}: {:?}", able.notes);
        assert_eq!(able.reasons, reasons, "{name}");
        let today = "2026-11-24".parse().expect("a date");
        let id = "my \"model\"";
        let toml = entry::toml(
            "vllm",
            id,
            &facts,
            &["a remark\nvision = false".to_owned()],
            today,
        );
        let catalogue = Catalogue::builtin().overlaid(&toml, "pasted.toml");
        let catalogue = catalogue.unwrap_or_else(|error| panic!("{name}: {error}\n{toml}"));
        let found = catalogue.find(&format!("vllm:{id}")).expect("pasted");
        assert_eq!(found.facts, expected, "{name}:\n{toml}");
        assert_eq!(found.sources[0].source, "fabc probe");
        assert_eq!(found.sources[0].as_of, today);
    }
}

/// Counts the questions that are put to a character.
struct Counted {
    character: Character,
    asked: Arc<AtomicU64>,
}

impl Subject for Counted {
    fn known(&self) -> &Facts {
        &self.character.known
    }

    fn wire(&self) -> Wire {
        Wire::OpenaiChat
    }

    fn under(&self, facts: &Facts) -> Result<Arc<dyn Model>, ModelError> {
        Ok(Arc::new(Counting {
            model: self.character.under(facts)?,
            asked: Arc::clone(&self.asked),
        }))
    }
}

struct Counting {
    model: Arc<dyn Model>,
    asked: Arc<AtomicU64>,
}

impl Model for Counting {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn nature(&self) -> ModelKind {
        self.model.nature()
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        self.asked.fetch_add(1, Ordering::SeqCst);
        self.model.ask(request, calls)
    }
}

#[test]
fn a_probe_asks_no_more_than_it_says() {
    let stubborn = Character {
        limit: MaxTokensField::MaxCompletionTokens,
        temperature: Some(Accepted::Refused),
        pictures: 0,
        schema: Schema::Refuses,
        ..easy()
    };
    // Two for the limit, two for the temperature, one each for `top_p` and the schema, two for pictures.
    for (character, expected) in [(stubborn, 8), (easy(), 5)] {
        let asked = Arc::new(AtomicU64::new(0));
        let subject = Counted {
            character,
            asked: Arc::clone(&asked),
        };
        abilities(&subject, &mut Unrecorded).expect("it answers");
        assert_eq!(asked.load(Ordering::SeqCst), expected);
        assert!(
            expected < MOST_QUESTIONS,
            "a refused `top_p` asks once more"
        );
    }
}

/// Gives no answer, for one reason.
struct Failing {
    known: Facts,
    fault: Fault,
    asked: Arc<AtomicU64>,
}

impl Subject for Failing {
    fn known(&self) -> &Facts {
        &self.known
    }

    fn wire(&self) -> Wire {
        Wire::OpenaiChat
    }

    fn under(&self, _: &Facts) -> Result<Arc<dyn Model>, ModelError> {
        Ok(Arc::new(FailingModel {
            fault: self.fault,
            asked: Arc::clone(&self.asked),
        }))
    }
}

struct FailingModel {
    fault: Fault,
    asked: Arc<AtomicU64>,
}

impl Model for FailingModel {
    fn name(&self) -> &str {
        "failing"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::Model
    }

    fn ask(&self, _: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        self.asked.fetch_add(1, Ordering::SeqCst);
        Err(ModelError::Failed {
            model: "failing".to_owned(),
            fault: self.fault,
            why: "it broke".to_owned(),
        })
    }
}

#[test]
fn a_server_that_fails_at_the_first_question_is_asked_no_further() {
    for (fault, questions) in [
        (Fault::ServerFailed, 1),
        (Fault::InvalidReply, 1),
        (Fault::Unreachable, 1),
        // Models may decline a question, or think too long about it, and answer others.
        (Fault::Refused, 5),
        (Fault::Truncated, 5),
    ] {
        let subject = Failing {
            known: Facts::default(),
            fault,
            asked: Arc::default(),
        };
        let found = abilities(&subject, &mut Unrecorded);
        assert_eq!(subject.asked.load(Ordering::SeqCst), questions, "{fault}");
        match (found, questions) {
            (
                Err(ModelError::Failed {
                    fault: told, why, ..
                }),
                1,
            ) => {
                assert_eq!((told, why.as_str()), (fault, "it broke"));
            }
            (Ok(found), 5) => assert!(found.notes[0].contains("it broke")),
            (found, _) => panic!("{fault}: {found:?}"),
        }
    }
}
