//! By how much readings may be off.
//!
//! In: the name of a reading and what a cloth should show, or a warning. Out: the range that the reading keeps. Found by
//! trial: `tests/suite/textile/declarable.rs` draws materials from all ranges, and finds each reading within its range or
//! named by a warning.

use crate::material::MaterialWarning;

/// By how much readings may be off what a cloth should show, for any material that a task may declare.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    /// How the names of the readings begin.
    pub readings: &'static str,
    /// Of which of them it holds; nothing for all.
    pub of: &'static str,
    /// The same, by the expected value in the reading's unit and by the gap between layers, metres.
    holds: fn(f64, f32) -> bool,
    /// As a share of the expected value.
    pub share: f64,
    /// In the reading's own unit.
    pub plain: f64,
}

/// Distance between particles at which the bounds hold, metres.
pub const BOUNDS_SPACING_M: f32 = 0.00625;

/// The bounds; of those that hold for a reading, the first counts. `docs/materials.md` shows them.
pub const BOUNDS: [Bound; 14] = [
    share("bending length, bias", "", |_, _| true, 0.1),
    share("bending length", "from 15 mm on", |mm, _| mm >= 15.0, 0.05),
    share("bending length", "below 15 mm", |_, _| true, 0.1),
    share("depth of a", "", |_, _| true, 0.1),
    share("height of a free fold", "", |_, _| true, 0.1),
    share("gap between layers", "", |_, _| true, 0.1),
    plain(
        "crease recovery",
        "layers up to 2 mm apart",
        |_, gap_m| gap_m <= 0.002,
        16.0,
    ),
    plain("crease recovery", "layers farther apart", |_, _| true, 21.0),
    share("stretch, bias", "", |_, _| true, 0.12),
    share("stretch", "", |_, _| true, 0.01),
    plain("friction on the table", "", |_, _| true, 0.015),
    share(
        "friction on itself",
        "from 0.2 to 1",
        |friction, _| (0.2..=1.0).contains(&friction),
        0.08,
    ),
    share("friction on itself", "outside", |_, _| true, 0.2),
    plain("change of momentum", "", |_, _| true, 0.005),
];

const fn share(
    readings: &'static str,
    of: &'static str,
    holds: fn(f64, f32) -> bool,
    share: f64,
) -> Bound {
    Bound {
        readings,
        of,
        holds,
        share,
        plain: 0.0,
    }
}

const fn plain(
    readings: &'static str,
    of: &'static str,
    holds: fn(f64, f32) -> bool,
    plain: f64,
) -> Bound {
    Bound {
        readings,
        of,
        holds,
        share: 0.0,
        plain,
    }
}

impl Bound {
    /// Returns the bound of a reading; `None` for what has no bound.
    ///
    /// - `expected`: in the reading's unit.
    pub fn of(reading: &str, expected: f64, gap_m: f32) -> Option<Bound> {
        let holds =
            |bound: &Bound| reading.starts_with(bound.readings) && (bound.holds)(expected, gap_m);
        BOUNDS.into_iter().find(holds)
    }

    /// Returns the least and the greatest value that a reading shows.
    pub fn range(&self, expected: f64) -> [f64; 2] {
        let off = self.share * expected + self.plain;
        [(expected - off).max(0.0), expected + off]
    }
}

/// What a warning says of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Promise {
    /// Nothing is promised.
    Nothing,
    /// It shows from the first to the second of these shares of what is expected.
    Shares([f32; 2]),
}

/// Returns what a warning promises of a reading instead of its bound; `None` where the bound stays.
pub fn promised(warning: &MaterialWarning, reading: &str) -> Option<Promise> {
    let names = |names: &[&str]| names.iter().any(|name| reading.contains(name));
    let nothing = |named: &[&str]| names(named).then_some(Promise::Nothing);
    const FOLDS: [&str; 3] = ["loop", "fold", "gap between layers"];
    match warning {
        MaterialWarning::Coarse { .. } => nothing(&["bending length"]),
        MaterialWarning::Sharp { .. } => nothing(&FOLDS).or(nothing(&["crease"])),
        MaterialWarning::Unsteady { is_light: true, .. } => {
            nothing(&["momentum", "fold", "gap between layers"])
        }
        MaterialWarning::Unsteady { .. } => nothing(&["momentum"]),
        MaterialWarning::Curls { bias_m, least_m } => match names(&["bending length, bias"]) {
            true => Some(Promise::Shares([least_m / bias_m, 1.1])),
            false => nothing(&FOLDS),
        },
        MaterialWarning::Shear { .. } => {
            names(&["stretch, bias"]).then_some(Promise::Shares([0.88, 1.2]))
        }
        MaterialWarning::SlackThreads { more } => {
            names(&["stretch, bias"]).then_some(Promise::Shares([0.88, 1.12 + more]))
        }
        // The table expects what these say.
        MaterialWarning::Gap { .. }
        | MaterialWarning::Crease { .. }
        | MaterialWarning::SoftBias { .. } => None,
    }
}

/// Returns the least and the greatest value that a reading shows of a material with these warnings; `None` where nothing is
/// promised.
///
/// - `expected`: in the reading's unit.
pub fn within(
    reading: &str,
    expected: f64,
    gap_m: f32,
    warnings: &[MaterialWarning],
) -> Option<[f64; 2]> {
    let mut range = Bound::of(reading, expected, gap_m)?.range(expected);
    for promise in warnings.iter().filter_map(|it| promised(it, reading)) {
        let Promise::Shares([least, most]) = promise else {
            return None;
        };
        range[0] = range[0].min(f64::from(least) * expected);
        range[1] = range[1].max(f64::from(most) * expected);
    }
    Some(range)
}
