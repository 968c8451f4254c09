//! A model that answers in another frame is asked in that frame, and acts like one that answers in pixels.

use super::support::{self, Scripted, Trial, words_of};
use fab_agent::action::Action;
use fab_agent::outcome::Outcome;
use fab_agent::rollout::Event;
use fab_model::Models;
use fab_model::calls::Calls;
use fab_model::lowering::Points;
use fab_model::{Lowering, Model, ModelError, ModelKind, Part, Png, Reply, Request};
use fab_program::pointing::{CoordinateUnit, Order};
use fab_standins::Geometric;
use fab_world::Look;
use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::sync::Mutex;

/// Side of the small task's camera picture, pixels.
const SIDE: f64 = 224.0;

/// The frame in which [`Foreign`] answers.
#[derive(Clone, Copy, PartialEq)]
enum Answers {
    AsAsked,
    /// In pixels of the camera's picture, whatever frame the question asks for.
    InPixels,
}

/// A model that is asked in its own frame. It converts the prompt into pixels with a few lines of its own, asks
/// `geometric`, and converts the answer back.
struct Foreign {
    lowering: Lowering,
    answers: Answers,
    asked: Mutex<Vec<Request>>,
}

impl Foreign {
    fn new(lowering: Lowering, answers: Answers) -> Foreign {
        Foreign {
            lowering,
            answers,
            asked: Mutex::default(),
        }
    }

    /// Returns the pixel for two numbers of a prompt, in their order in the prompt.
    fn pixel(&self, first: f64, second: f64) -> (i64, i64) {
        let (x, y) = match self.lowering.order {
            Order::Xy => (first, second),
            Order::Yx => (second, first),
        };
        let sent = f64::from(self.lowering.sent([SIDE as u32; 2])[0]);
        let pixel = |value: f64| match self.lowering.unit {
            CoordinateUnit::Pixels => ((value + 0.5) * SIDE / sent).floor() as i64,
            CoordinateUnit::Fraction => (value * SIDE).floor() as i64,
            CoordinateUnit::Percent => (value * SIDE / 100.0).floor() as i64,
            CoordinateUnit::PerMille => (value * SIDE / 1000.0).floor() as i64,
        };
        (pixel(x), pixel(y))
    }

    /// Converts a text into pixels; records the original notation of each point.
    fn in_pixels(&self, text: &str, known: &mut BTreeMap<String, String>) -> String {
        let (open, close) = match self.lowering.order {
            Order::Xy => ('(', ')'),
            Order::Yx => ('[', ']'),
        };
        let mut translated = String::new();
        let mut rest = text;
        while let Some(at) = rest.find(open) {
            let (before, behind) = rest.split_at(at);
            translated.push_str(before);
            let inside = behind[1..].split_once(close).map(|(inside, _)| inside);
            let numbers = inside.and_then(|inside| inside.split_once(", "));
            let numbers = numbers.and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
            let (Some(inside), Some((first, second))) = (inside, numbers) else {
                translated.push(open);
                rest = &behind[1..];
                continue;
            };
            let (u, v) = self.pixel(first, second);
            let pixel = format!("({u}, {v})");
            let mut stood = behind[..inside.len() + 2].to_owned();
            if self.lowering.points == Points::Marks
                && let Some(numbered) = translated.strip_suffix(" at ")
            {
                let number = numbered.rsplit([' ', '\n']).next().unwrap().to_owned();
                translated.truncate(numbered.len() - number.len());
                stood = number;
            }
            known.insert(pixel.clone(), stood);
            translated.push_str(&pixel);
            rest = &behind[inside.len() + 2..];
        }
        translated.push_str(rest);
        let form = if self.lowering.points == Points::Marks {
            "= number"
        } else {
            "= [y, x]"
        };
        translated.replace(form, "= (x, y)")
    }
}

impl Model for Foreign {
    fn name(&self) -> &str {
        "foreign"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn lowering(&self) -> Lowering {
        self.lowering
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        self.asked.lock().unwrap().push(request.clone());
        let mut known = BTreeMap::new();
        let mut translated = request.clone();
        for part in translated.messages.iter_mut().flat_map(|it| &mut it.parts) {
            if let Part::Text(text) = part {
                *text = self.in_pixels(text, &mut known);
            }
        }
        let mut reply = Geometric.ask(&translated, calls)?;
        if self.answers == Answers::AsAsked {
            for (pixel, stood) in &known {
                reply.text = reply
                    .text
                    .replace(&format!("= {pixel}"), &format!("= {stood}"));
            }
        }
        Ok(reply)
    }
}

/// The result of a rollout.
struct Played {
    outcome: Outcome,
    actions: Vec<Action>,
    refusals: BTreeMap<String, u32>,
    notes: Vec<String>,
}

fn play(model: &dyn Model) -> Played {
    let folder = tempfile::tempdir().unwrap();
    let program = support::small_task();
    let trial = Trial::new(&program, folder.path(), Look::default());
    let models = Models {
        vision: model,
        text: model,
    };
    let (mut actions, mut notes) = (Vec::new(), Vec::new());
    let report = trial.run(
        models,
        &folder.path().join("run"),
        &mut |event| match event {
            Event::Motion { line, .. } => actions.extend(line.action.into_iter().flatten()),
            Event::Note { note } => notes.push(note),
            _ => {}
        },
    );
    Played {
        outcome: report.outcome,
        actions,
        refusals: report.report.refusals,
        notes,
    }
}

fn coordinates(unit: CoordinateUnit, order: Order) -> Lowering {
    Lowering {
        unit,
        order,
        ..Lowering::PIXELS
    }
}

/// Sent at twice the size.
fn doubled(points: Points) -> Lowering {
    Lowering {
        points,
        multiples_of_px: NonZeroU32::new(448),
        ..Lowering::PIXELS
    }
}

fn marks() -> Lowering {
    Lowering {
        points: Points::Marks,
        ..Lowering::PIXELS
    }
}

#[test]
#[ignore = "long"]
fn a_rollout_is_the_same_in_every_frame_and_by_numbers() {
    let expected = play(&Geometric).actions;
    assert_eq!(expected.len(), 2);
    let mut lowerings = vec![
        marks(),
        doubled(Points::Marks),
        doubled(Points::Coordinates),
    ];
    for unit in CoordinateUnit::ALL {
        lowerings.extend(Order::ALL.map(|order| coordinates(unit, order)));
    }
    for lowering in lowerings {
        let played = play(&Foreign::new(lowering, Answers::AsAsked));
        assert_eq!(played.outcome, Outcome::HorizonReached, "{lowering:?}");
        assert_eq!(played.actions, expected, "{lowering:?}");
        assert!(played.refusals.is_empty(), "{:?}", played.refusals);
        assert!(played.notes.is_empty(), "{:?}", played.notes);
    }
}

#[test]
#[ignore = "long"]
fn a_model_that_answers_in_pixels_when_asked_for_another_frame_moves_nothing() {
    for unit in [
        CoordinateUnit::Fraction,
        CoordinateUnit::Percent,
        CoordinateUnit::PerMille,
    ] {
        let model = Foreign::new(coordinates(unit, Order::Xy), Answers::InPixels);
        let played = play(&model);
        assert_eq!(played.outcome, Outcome::AttemptsExhausted, "{unit:?}");
        assert!(played.actions.is_empty(), "{:?}", played.actions);
        let names: Vec<&String> = played.refusals.keys().collect();
        assert_eq!(names, ["offered"]);
    }
    // Round brackets do not show which number is x; a mark's number is not a position.
    for lowering in [coordinates(CoordinateUnit::PerMille, Order::Yx), marks()] {
        let played = play(&Foreign::new(lowering, Answers::InPixels));
        assert_eq!(played.outcome, Outcome::MalformedReply, "{lowering:?}");
        assert!(played.actions.is_empty());
    }
}

/// Asks every stage of a task's first step, and returns the last request.
fn asked(task: &str, lowering: Lowering) -> Request {
    let folder = tempfile::tempdir().unwrap();
    let program = support::task(task);
    let trial = Trial {
        horizon: Some(1),
        ..Trial::new(&program, &support::root().join("tasks"), Look::default())
    };
    let replies = ["Instructions: Fold the left edge onto the right one.\nExplanation: So it is."];
    let model = Silent(
        Scripted::new(&replies[..program.stages.len() - 1]),
        lowering,
    );
    let models = Models {
        vision: &model,
        text: &model,
    };
    trial.run(models, &folder.path().join("run"), &mut |_| {});
    model.0.asked.into_inner().unwrap().pop().unwrap()
}

/// A scripted model with a lowering; its script ends before the action.
pub struct Silent(pub Scripted, pub Lowering);

impl Model for Silent {
    fn name(&self) -> &str {
        "silent"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn lowering(&self) -> Lowering {
        self.1
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        self.0.ask(request, calls)
    }
}

fn shown(task: &str) -> String {
    let rows = [
        ("pixels", Lowering::PIXELS),
        (
            "pixels of the doubled picture",
            doubled(Points::Coordinates),
        ),
        (
            "fractions",
            coordinates(CoordinateUnit::Fraction, Order::Xy),
        ),
        ("percent", coordinates(CoordinateUnit::Percent, Order::Xy)),
        (
            "thousandths, y first",
            coordinates(CoordinateUnit::PerMille, Order::Yx),
        ),
        ("marks", marks()),
    ];
    let mut all = String::new();
    for (name, lowering) in rows {
        let request = asked(task, lowering);
        let schema = request.schema.as_ref().unwrap();
        let pick = &schema["properties"]["pick"];
        all += &format!("=== {name}\n{}\npick: {pick}\n", words_of(&request));
    }
    all
}

#[test]
#[ignore = "long"]
fn the_question_for_points_is_pinned_in_every_frame() {
    insta::assert_snapshot!(shown("double_straight"));
}

#[test]
#[ignore = "long"]
fn the_question_for_a_pull_is_pinned_in_every_frame() {
    insta::assert_snapshot!(shown("smoothing"));
}

fn pictures(request: &Request) -> Vec<&Png> {
    let parts = request.messages.iter().flat_map(|message| &message.parts);
    parts
        .filter_map(|part| match part {
            Part::Image(png) => Some(png),
            Part::Text(_) => None,
        })
        .collect()
}

#[test]
fn pictures_are_sent_in_the_size_that_coordinates_count() {
    let plain = asked("smoothing", Lowering::PIXELS);
    let multiples = Lowering {
        multiples_of_px: NonZeroU32::new(28),
        ..Lowering::PIXELS
    };
    let size = |request: &Request| {
        let pictures = pictures(request);
        assert_eq!(pictures.len(), 1);
        let picture = image::load_from_memory(pictures[0].bytes()).unwrap();
        (picture.width(), picture.height())
    };
    assert_eq!(size(&plain), (720, 720));
    let request = asked("smoothing", multiples);
    assert_eq!(size(&request), (728, 728));
    let says = "(x, y) in pixels of a picture 728 wide and 728 high";
    assert!(words_of(&request).contains(says), "{}", words_of(&request));
}

/// Returns the points after `The corners are` in a prompt with numbers.
fn listed(request: &Request) -> Vec<(i64, i64)> {
    let words = words_of(request);
    let (_, listed) = words.split_once("The corners are ").unwrap();
    let listed = listed.lines().next().unwrap();
    assert!(listed.starts_with("1 at ("), "{listed}");
    let points = listed.split('(').skip(1);
    points
        .map(|point| {
            let (u, v) = point.split_once(')').unwrap().0.split_once(", ").unwrap();
            (u.parse().unwrap(), v.parse().unwrap())
        })
        .collect()
}

#[test]
#[ignore = "long"]
fn numbers_stand_on_the_picture_of_the_scene_beside_the_listed_points() {
    let said = "The numbers in the picture of the scene are those of the listed points.";
    let sizes = [
        (Lowering::PIXELS, marks()),
        (doubled(Points::Coordinates), doubled(Points::Marks)),
    ];
    for (without, with) in sizes {
        let (plain, marked) = (asked("smoothing", without), asked("smoothing", with));
        assert!(words_of(&marked).contains(said) && !words_of(&plain).contains(said));
        let [plain, drawn] = [&plain, &marked].map(|request| {
            let picture = image::load_from_memory(pictures(request)[0].bytes());
            picture.unwrap().into_rgb8()
        });
        let listed = listed(&marked);
        assert_eq!(listed.len(), 4);
        for (u, v) in listed {
            let n_changed = |reach: i64| {
                let square =
                    (-reach..=reach).flat_map(|du| (-reach..=reach).map(move |dv| (du, dv)));
                let pixels = square.map(|(du, dv)| ((u + du) as u32, (v + dv) as u32));
                let differs = |(column, row): &(u32, u32)| {
                    plain.get_pixel(*column, *row) != drawn.get_pixel(*column, *row)
                };
                pixels.filter(differs).count()
            };
            assert_eq!(n_changed(4), 0, "({u}, {v}) is covered");
            assert!(n_changed(30) > 20, "no number at ({u}, {v})");
        }
    }
}
