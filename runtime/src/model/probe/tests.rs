//! Scripted models that see the dots well and answer in a frame of their own.

use super::*;
use crate::calls::Unkept;
use crate::model::{Nature, Reply};

/// Finds the dots in the picture by their colours and names them in one habit, whatever it is asked for.
struct Seeing {
    habit: Habit,
    /// What it says of the place, from two numbers.
    form: fn(&str, [f64; 2]) -> String,
}

impl Model for Seeing {
    fn name(&self) -> &str {
        "seeing"
    }

    fn nature(&self) -> Nature {
        Nature::StandIn
    }

    fn ask(&self, request: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let Some(Part::Image(png)) = request.messages[0].parts.last() else {
            panic!("the question shows a picture");
        };
        let shown = picture::decode(png.bytes(), std::path::Path::new("shown")).expect("a picture");
        let lines = DOTS.map(|(name, colour)| {
            let (mut sum, mut count) = ([0.0, 0.0], 0.0);
            for (x, y, _) in shown
                .enumerate_pixels()
                .filter(|(_, _, pixel)| pixel.0 == colour)
            {
                sum = [sum[0] + f64::from(x), sum[1] + f64::from(y)];
                count += 1.0;
            }
            let at = sum.map(|sum| sum / count);
            (self.form)(name, self.habit.numbers_for(at, shown.dimensions().into()))
        });
        Ok(Reply {
            text: lines.join("\n"),
            usage: Some(Usage {
                input_tokens: 100,
                cached_input_tokens: 0,
                output_tokens: 10,
            }),
            cost: None,
        })
    }
}

fn plain(name: &str, [one, other]: [f64; 2]) -> String {
    format!("{name}: ({one:.3}, {other:.3})")
}

fn seen(habit: Habit, asked: Habit) -> Probe {
    let model = Seeing { habit, form: plain };
    probe(&model, asked, 7, &mut Unkept).expect("it answers")
}

#[test]
fn the_habit_of_a_model_is_found_whichever_was_asked_for() {
    let mut resized = Habit::PIXELS;
    resized.multiples_of_px = Some(28);
    for habit in all_habits(resized) {
        for asked in [Habit::PIXELS, habit] {
            let found = seen(habit, asked);
            assert_eq!(found.best(), Some(habit), "asked for {asked}");
            assert!(
                found.habits[0].error.max < 1.0,
                "{habit}: {:?}",
                found.habits[0].error
            );
            assert_eq!(found.agrees(), habit == asked, "{habit}, asked for {asked}");
            assert_eq!((found.read, found.dots), (12, 12));
        }
    }
}

#[test]
fn a_wrong_habit_is_seen_by_its_error() {
    let per_mille = Habit {
        unit: Unit::PerMille,
        ..Habit::PIXELS
    };
    let found = seen(per_mille, Habit::PIXELS);
    let error = found.error.expect("it was read");
    assert!(error.median > 50.0 && error.mean <= error.max, "{error:?}");
    assert_eq!(found.usage.expect("it was told").input_tokens, 200);
    assert_eq!(found.cost, None, "an unknown cost stays unknown");
}

#[test]
fn an_answer_that_names_no_place_fits_no_habit() {
    let model = Seeing {
        habit: Habit::PIXELS,
        form: |name, _| format!("I see a {name} dot"),
    };
    let found = probe(&model, Habit::PIXELS, 7, &mut Unkept).expect("it answers");
    assert_eq!((found.best(), found.error, found.read), (None, None, 0));
    assert!(!found.agrees());
}

#[test]
fn a_dot_that_is_not_named_does_not_agree() {
    let model = Seeing {
        habit: Habit::PIXELS,
        form: |name, at| {
            if name == "blue" {
                String::new()
            } else {
                plain(name, at)
            }
        },
    };
    let found = probe(&model, Habit::PIXELS, 7, &mut Unkept).expect("it answers");
    assert_eq!((found.best(), found.read), (Some(Habit::PIXELS), 10));
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
fn the_same_seed_asks_the_same_and_another_asks_otherwise() {
    let places = |seed| seen_dots(seed);
    assert_eq!(places(3), places(3));
    assert_ne!(places(3), places(4));
}

fn seen_dots(seed: u64) -> Vec<[u32; 2]> {
    let model = Seeing {
        habit: Habit::PIXELS,
        form: plain,
    };
    let found = probe(&model, Habit::PIXELS, seed, &mut Unkept).expect("it answers");
    found
        .pictures
        .iter()
        .flat_map(|picture| &picture.dots)
        .map(|dot| dot.at)
        .collect()
}
