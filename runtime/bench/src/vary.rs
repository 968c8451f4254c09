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

impl TryFrom<Table> for Vary {
    type Error = String;

    fn try_from(table: Table) -> Result<Vary, String> {
        if let Some(name) = table.axes.keys().find(|name| Axis::find(name).is_none()) {
            return Err(format!("`[vary]` has no axis `{name}`; {}", hint(name)));
        }
        let ranges = AXES.iter().filter_map(|axis| {
            let bounds = table.axes.get(axis.name)?;
            Some(AxisRange::read(axis, bounds))
        });
        let ranges = ranges.collect::<Result<Vec<AxisRange>, String>>()?;
        if ranges.is_empty() {
            let why = "`[vary]` names no axis; state at least one, such as `friction = [0.5, 1.2]`, or leave the table out";
            return Err(why.to_owned());
        }
        Ok(Vary {
            seed: table.seed,
            ranges,
        })
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
    fn read(axis: &'static Axis, bounds: &Value) -> Result<AxisRange, String> {
        let Axis {
            name, low, high, ..
        } = axis;
        let numbers = bounds.clone().try_into::<[f64; 2]>().ok();
        let Some([from, to]) = numbers.filter(|it| !it.iter().any(|bound| bound.is_nan())) else {
            return Err(format!(
                "`vary.{name}` is `{bounds}`; it takes two numbers, the lowest and the highest value, such as `[{low}, {high}]`"
            ));
        };
        if let Some(value) = [from, to].iter().find(|it| !(*low..=*high).contains(it)) {
            return Err(format!(
                "`vary.{name}`: {value} is not from {low} to {high} ({})",
                axis.unit
            ));
        }
        if from > to {
            return Err(format!(
                "`vary.{name}`: {from} is greater than {to}; the lowest value comes first"
            ));
        }
        Ok(AxisRange {
            axis,
            low: from,
            high: to,
        })
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
