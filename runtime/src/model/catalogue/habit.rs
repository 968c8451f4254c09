//! How models say where something is in a picture.
//!
//! In: two numbers of an answer, and the size of the picture that was sent. Out: pixels of that picture, and back.
//! Pixel 0 begins at 0, so that the middle of the first pixel is 0.5 of a pixel in each unit but `pixels`, whose
//! numbers name whole pixels. Writing and reading the points of a task is left to the compiler.

use serde::{Deserialize, Serialize};
use std::fmt;

/// How a model says where something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Habit {
    /// What its numbers count.
    pub unit: Unit,
    /// Which comes first.
    pub order: Order,
    /// The sides of the picture in whose pixels it answers are multiples of this, the nearest to those that were
    /// sent; None: it answers in pixels of the picture that was sent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub multiples_of_px: Option<u32>,
}

/// What a coordinate counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Pixels.
    Pixels,
    /// The picture's side is 1.
    Fraction,
    /// It is 100.
    Percent,
    /// It is 1000.
    PerMille,
}

/// Which coordinate comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Order {
    /// The column.
    Xy,
    /// The row.
    Yx,
}

impl Unit {
    /// Every unit.
    pub const ALL: [Unit; 4] = [Unit::Pixels, Unit::Fraction, Unit::Percent, Unit::PerMille];

    /// Returns what the picture's side counts; None: its pixels.
    fn side(self) -> Option<f64> {
        match self {
            Unit::Pixels => None,
            Unit::Fraction => Some(1.0),
            Unit::Percent => Some(100.0),
            Unit::PerMille => Some(1000.0),
        }
    }
}

impl Habit {
    /// Pixels of the picture that was sent, the column first.
    pub const PIXELS: Habit = Habit {
        unit: Unit::Pixels,
        order: Order::Xy,
        multiples_of_px: None,
    };

    /// Returns the pixel `[column, row]` of a picture of `size` (width, height) that two numbers stand for, in their order.
    pub fn pixel_from(self, numbers: [f64; 2], size: [u32; 2]) -> [f64; 2] {
        let [x, y] = self.ordered(numbers);
        let one = |number: f64, side: u32| match self.unit.side() {
            Some(whole) => number / whole * f64::from(side) - 0.5,
            None => (number + 0.5) * f64::from(side) / f64::from(self.seen(side)) - 0.5,
        };
        [one(x, size[0]), one(y, size[1])]
    }

    /// Returns the two numbers, in their order, for the pixel `[column, row]` of a picture of `size` (width, height).
    pub fn numbers_for(self, pixel: [f64; 2], size: [u32; 2]) -> [f64; 2] {
        let one = |pixel: f64, side: u32| match self.unit.side() {
            Some(whole) => (pixel + 0.5) / f64::from(side) * whole,
            None => (pixel + 0.5) * f64::from(self.seen(side)) / f64::from(side) - 0.5,
        };
        self.ordered([one(pixel[0], size[0]), one(pixel[1], size[1])])
    }

    /// Returns the side, pixels, of the picture in whose pixels the model answers.
    pub fn seen(self, side: u32) -> u32 {
        match self.multiples_of_px {
            Some(step) => ((side + step / 2) / step).max(1) * step,
            None => side,
        }
    }

    fn ordered(self, [first, second]: [f64; 2]) -> [f64; 2] {
        match self.order {
            Order::Xy => [first, second],
            Order::Yx => [second, first],
        }
    }
}

impl fmt::Display for Habit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let order = match self.order {
            Order::Xy => "x y",
            Order::Yx => "y x",
        };
        let unit = match self.unit {
            Unit::Pixels => "pixels",
            Unit::Fraction => "0-1",
            Unit::Percent => "0-100",
            Unit::PerMille => "0-1000",
        };
        write!(f, "{order}, {unit}")?;
        self.multiples_of_px
            .map_or(Ok(()), |step| write!(f, " in multiples of {step}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn habits() -> impl Strategy<Value = Habit> {
        let unit = prop::sample::select(Unit::ALL.to_vec());
        let order = prop::sample::select(vec![Order::Xy, Order::Yx]);
        (unit, order, prop::option::of(1u32..64)).prop_map(|(unit, order, multiples_of_px)| Habit {
            unit,
            order,
            multiples_of_px,
        })
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_back(
            habit in habits(),
            size in prop::array::uniform2(1u32..5000),
            at in prop::array::uniform2(0.0f64..1.0),
        ) {
            let pixel = [0, 1].map(|axis| at[axis] * f64::from(size[axis]));
            let back = habit.pixel_from(habit.numbers_for(pixel, size), size);
            for axis in 0..2 {
                prop_assert!((back[axis] - pixel[axis]).abs() < 1e-6, "{pixel:?} {back:?}");
            }
        }
    }

    #[test]
    fn the_same_place_has_the_numbers_that_each_habit_gives_it() {
        let at = [49.5, 24.5]; // the middle of the width, a quarter of the height
        let size = [100, 100];
        let numbers = |unit, order| {
            Habit {
                unit,
                order,
                multiples_of_px: None,
            }
            .numbers_for(at, size)
        };
        assert_eq!(numbers(Unit::Pixels, Order::Xy), [49.5, 24.5]);
        assert_eq!(numbers(Unit::Fraction, Order::Xy), [0.5, 0.25]);
        assert_eq!(numbers(Unit::Percent, Order::Yx), [25.0, 50.0]);
        assert_eq!(numbers(Unit::PerMille, Order::Yx), [250.0, 500.0]);
    }

    #[test]
    fn a_side_becomes_the_nearest_multiple() {
        let habit = Habit {
            multiples_of_px: Some(28),
            ..Habit::PIXELS
        };
        assert_eq!(
            [224, 720, 5, 41, 42].map(|side| habit.seen(side)),
            [224, 728, 28, 28, 56]
        );
        let [x, _] = habit.numbers_for([359.5, 0.0], [720, 720]);
        assert!((x - 363.5).abs() < 1e-9, "{x}");
    }
}
