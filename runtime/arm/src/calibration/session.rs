//! Points that a person types, or jogs the arm to, one after the other.
//!
//! In: lines of text, and where there is an arm, its tool's place at the moment of each line. Out: what to tell after
//! each: the error of the new point by those before it, so that a slip shows while the arm is still there. Reading and
//! writing lines is left to the caller.

use super::fit::Solver;
use super::pairs::{numbers, pair_of};
use super::slips::check_numbers_of;
use super::{MAX_PAIRS, Pair, Terms, Window};

/// Returns the tool's position with the arm at rest, metres, base frame, or says why there is none.
pub type ToolReader<'a> = dyn FnMut() -> Result<[f64; 3], String> + 'a;

/// The fewest points whose fit says something of the next one.
const TELLING: usize = 5;

/// Points on the way to a calibration.
pub struct Session<'a> {
    terms: &'a Terms,
    tool: Option<Box<ToolReader<'a>>>,
    pairs: Vec<Pair>,
}

/// What became of a line.
#[derive(Clone, Debug, PartialEq)]
pub enum Said {
    /// A point was added: how it fits those before it, or why that cannot be said yet.
    Added(String),
    /// The last point was taken back.
    TakenBack(String),
    /// Nothing changed: an empty line, or a list of the points.
    Nothing(String),
    /// The line was not understood, or the arm gave no place.
    Wrong(String),
    /// There will be no more points.
    Over,
}

impl<'a> Session<'a> {
    /// Begins with points that there are already.
    ///
    /// With `tool`, a line is `u,v` or `u,v,depth`, and the tool's place is read when it is entered; without, a line is
    /// `u,v,x,y,z` or `u,v,x,y,z,depth`.
    pub fn new(terms: &'a Terms, pairs: Vec<Pair>, tool: Option<Box<ToolReader<'a>>>) -> Self {
        Session { terms, tool, pairs }
    }

    /// Returns the points so far.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// Says what a line is to hold.
    pub fn form(&self) -> &'static str {
        match self.tool {
            Some(_) => "`u,v` or `u,v,depth` with the fingertips on that point",
            None => "`u,v,x,y,z` or `u,v,x,y,z,depth`: the pixel, then the tool in metres",
        }
    }

    /// Takes a line: a point, `undo`, `list`, or `done`.
    pub fn line(&mut self, text: &str) -> Said {
        match text.trim() {
            "" => Said::Nothing(String::new()),
            "done" => Said::Over,
            "list" => Said::Nothing(self.list()),
            "undo" => match self.pairs.pop() {
                Some(_) => Said::TakenBack(format!("point {} is taken back", self.pairs.len() + 1)),
                None => Said::Wrong("there is no point to take back".to_owned()),
            },
            point => match self.point(point) {
                Ok(pair) => {
                    let said = self.told(&pair);
                    self.pairs.push(pair);
                    Said::Added(format!("point {}: {said}", self.pairs.len()))
                }
                Err(why) => Said::Wrong(why),
            },
        }
    }

    fn point(&mut self, text: &str) -> Result<Pair, String> {
        let mut given = numbers(text)?;
        if let Some(tool) = &mut self.tool {
            if !matches!(given.len(), 2 | 3) {
                let n = given.len();
                return Err(format!("{n} numbers; type `u,v`, or `u,v,depth`"));
            }
            let place = tool()?;
            given.splice(2..2, place);
        }
        let pair = pair_of(&given)?;
        if self.pairs.len() >= MAX_PAIRS {
            return Err(format!("there are {MAX_PAIRS} points already; type `done`"));
        }
        match check_numbers_of(self.terms, self.pairs.len() + 1, &pair) {
            Some(fault) => Err(fault.to_string()),
            None => Ok(pair),
        }
    }

    /// Says how a new point fits those before it.
    fn told(&self, pair: &Pair) -> String {
        let n = self.pairs.len();
        if n < TELLING {
            return format!(
                "taken; from {} points on you are told how each fits",
                TELLING + 1
            );
        }
        let off_mm = || {
            let solver = Solver::of(self.terms).ok()?;
            let fit = solver.fit(&solver.sightings(&self.pairs).ok()?)?;
            Some(fit.error(&solver.sighting(pair)?)?.norm() * 1000.0)
        };
        match off_mm() {
            Some(off_mm) => {
                format!("{off_mm:.1} mm from where the {n} before it put it (`undo` takes it back)")
            }
            None => format!("taken; the {n} before it do not say yet where it should be"),
        }
    }

    fn list(&self) -> String {
        let lines = self.pairs.iter().zip(1..);
        let lines: Vec<String> = lines
            .map(|(pair, number)| format!("{number}: {}", super::csv_line(pair)))
            .collect();
        lines.join("\n")
    }
}

/// Returns the pixels of a grid over the window, row by row: where points are best touched.
///
/// The outermost are a tenth of the side from the rim, so that fingertips are seen around them.
pub fn grid(window: &Window, columns: u32, rows: u32) -> Vec<[f64; 2]> {
    let share = |index: u32, n: u32| match n {
        0 | 1 => 0.5,
        _ => 0.1 + 0.8 * f64::from(index) / f64::from(n - 1),
    };
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let pixel = |(column, row)| {
        let [u, v] = window.pixel_at([share(column, columns), share(row, rows)]);
        [u.round(), v.round()]
    };
    places.map(pixel).collect()
}
