//! The table `[vary]` of a suite: the axes along which its worlds vary, and the values that are drawn.
//!
//! In: bounds by axis, and a seed. Out: a [`Variation`] for each axis by itself and one for all of them, which draws
//! the [`AxisValues`] of each start.
//!
//! A draw depends on the seed, the axis and the number of the start alone. So methods, repeats, shards and other tasks
//! meet equal worlds, and neither another axis nor another start changes a draw. Ten starts in a row, from a multiple of
//! ten on, draw one value in each tenth of the range, so that few starts fill it too.

use fab_base::chance::Chance;
use fab_base::wording::quoted;
use fab_program::nearest::nearest;
use fab_world::vary::{AXES, Axis, AxisValues};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use toml::Value;

/// The starts in a row that have one value in each equal part of a range.
const BLOCK: usize = 10;

/// The name of the variation along all axes at once.
pub const ALL: &str = "all";

/// The axes along which a suite's worlds vary; at least one, in the order of [`AXES`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Table", into = "Table")]
pub struct Vary {
    /// The seed of all draws.
    pub seed: u64,
    /// The bounds, each axis once.
    pub ranges: Vec<AxisRange>,
}

/// An axis with the bounds of its draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisRange {
    /// The axis.
    pub axis: &'static Axis,
    /// The least value.
    pub low: f64,
    /// The greatest value, not below `low`.
    pub high: f64,
}

/// The table as a suite writes it.
#[derive(Serialize, Deserialize)]
struct Table {
    #[serde(default)]
    seed: u64,
    #[serde(flatten)]
    axes: BTreeMap<String, Value>,
}

/// Why a table `[vary]` cannot be used.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum VaryError {
    /// It has no axis.
    #[error(
        "`[vary]` names no axis; state at least one, such as `friction = [0.5, 1.2]`, or leave the table out"
    )]
    Empty,
    /// It names an unknown axis.
    #[error("`[vary]` has no axis `{name}`; {hint}")]
    Unknown {
        /// The name.
        name: String,
        /// What was probably meant, or what there is.
        hint: String,
    },
    /// The bounds are no pair of numbers.
    #[error(
        "`vary.{axis}` is `{value}`; it takes two numbers, the lowest and the highest value, such as `[{low}, {high}]`"
    )]
    Shape {
        /// The axis.
        axis: &'static str,
        /// What it has.
        value: String,
        /// The least value of the axis.
        low: f64,
        /// Its greatest value.
        high: f64,
    },
    /// The lower bound is above the upper one.
    #[error("`vary.{axis}`: {low} is greater than {high}; the lowest value comes first")]
    Reversed {
        /// The axis.
        axis: &'static str,
        /// The first number.
        low: f64,
        /// The second number.
        high: f64,
    },
    /// A bound is outside the axis.
    #[error("`vary.{}`: {value} is not from {} to {} ({})", axis.name, axis.low, axis.high, axis.unit)]
    Outside {
        /// The axis.
        axis: &'static Axis,
        /// The bound.
        value: f64,
    },
}

impl TryFrom<Table> for Vary {
    type Error = VaryError;

    fn try_from(table: Table) -> Result<Vary, VaryError> {
        if let Some(name) = table.axes.keys().find(|name| Axis::find(name).is_none()) {
            return Err(VaryError::Unknown {
                name: name.clone(),
                hint: hint(name),
            });
        }
        let ranges = AXES.iter().filter_map(|axis| {
            let bounds = table.axes.get(axis.name)?;
            Some(AxisRange::read(axis, bounds))
        });
        let ranges = ranges.collect::<Result<Vec<AxisRange>, VaryError>>()?;
        match ranges.is_empty() {
            true => Err(VaryError::Empty),
            false => Ok(Vary {
                seed: table.seed,
                ranges,
            }),
        }
    }
}

impl From<Vary> for Table {
    fn from(vary: Vary) -> Table {
        let bounds = |range: &AxisRange| {
            let AxisRange { axis, low, high } = *range;
            (axis.name.to_owned(), Value::from(vec![low, high]))
        };
        Table {
            seed: vary.seed,
            axes: vary.ranges.iter().map(bounds).collect(),
        }
    }
}

impl AxisRange {
    fn read(axis: &'static Axis, bounds: &Value) -> Result<AxisRange, VaryError> {
        let number = |bound: &Value| match bound {
            Value::Integer(whole) => Some(*whole as f64),
            bound => bound.as_float().filter(|number| !number.is_nan()),
        };
        let numbers = bounds.as_array().into_iter().flatten().map(number);
        let numbers = numbers.collect::<Option<Vec<f64>>>();
        let Some([low, high]) = numbers.as_deref() else {
            return Err(VaryError::Shape {
                axis: axis.name,
                value: bounds.to_string(),
                low: axis.low,
                high: axis.high,
            });
        };
        let (low, high) = (*low, *high);
        for value in [low, high] {
            if !(axis.low..=axis.high).contains(&value) {
                return Err(VaryError::Outside { axis, value });
            }
        }
        match low > high {
            true => Err(VaryError::Reversed {
                axis: axis.name,
                low,
                high,
            }),
            false => Ok(AxisRange { axis, low, high }),
        }
    }

    /// Draws the value of a start.
    fn draw(&self, seed: u64, start: u64) -> f64 {
        let (block, place) = (start / BLOCK as u64, (start % BLOCK as u64) as usize);
        let mut chance = Chance::of(&format!("vary {seed} {} {block}", self.axis.name));
        let mut parts: [usize; BLOCK] = std::array::from_fn(|part| part);
        for last in (1..BLOCK).rev() {
            parts.swap(last, chance.below(last + 1));
        }
        let within: [f64; BLOCK] = std::array::from_fn(|_| chance.fraction());
        let share = (parts[place] as f64 + within[place]) / BLOCK as f64;
        let drawn = self.low + (self.high - self.low) * share;
        // Records stay readable, and what is drawn is what is written.
        ((drawn * 1e6).round() / 1e6).clamp(self.low, self.high)
    }
}

/// Names the axis that was probably meant, or all of them.
fn hint(name: &str) -> String {
    let names = || AXES.iter().map(|axis| axis.name);
    // `camera_height` lacks only the unit.
    let longer = names().find(|axis| axis.starts_with(name) && name.len() > 2);
    match longer.or_else(|| nearest(name, names())) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("there are {}", quoted(names())),
    }
}

/// How the worlds of some rollouts differ from their task's own; the default is not at all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Variation {
    name: Option<&'static str>,
    seed: u64,
    ranges: Vec<AxisRange>,
}

impl Vary {
    /// Returns a variation along each axis by itself, and one along all of them if there are several.
    pub fn variations(&self) -> Vec<Variation> {
        let variation = |name, ranges: &[AxisRange]| Variation {
            name: Some(name),
            seed: self.seed,
            ranges: ranges.to_vec(),
        };
        let single = self
            .ranges
            .iter()
            .map(|range| variation(range.axis.name, std::slice::from_ref(range)));
        let all = (self.ranges.len() > 1).then(|| variation(ALL, &self.ranges));
        single.chain(all).collect()
    }
}

impl Variation {
    /// Returns the name of its axis, or [`ALL`]; `None` if nothing varies.
    pub fn name(&self) -> Option<&'static str> {
        self.name
    }

    /// Draws the values of a start, given its number.
    pub fn values(&self, start: u64) -> AxisValues {
        let values = self.ranges.iter().map(|range| {
            let value = range.draw(self.seed, start);
            (range.axis.name.to_owned(), value)
        });
        AxisValues(values.collect())
    }
}

#[cfg(test)]
#[path = "tests/vary.rs"]
mod tests;
