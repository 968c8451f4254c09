//! Entry of calibration points, one at a time: a person types them, or jogs the arm to them.
//!
//! In: lines of text, and with an arm, its tool's position at each line. Out: a message per line with the error of the
//! new point against the earlier ones, so that a mistake shows while the arm is still there. Reading and writing lines
//! is left to the caller.

use super::accuracy::{check_point, check_terms};
use super::fit::{error, fit, sightings};
use super::points::typed_pair;
use super::{MAX_PAIRS, Pair, SeenTags, Terms, Window};

/// Returns the tool's position with the arm at rest, metres, base frame, or says why there is none.
pub type ToolReader<'a> = dyn FnMut() -> Result<[f64; 3], String> + 'a;

/// The fewest points whose fit can predict the next one.
const MIN_FITTED: usize = 5;

/// The points entered so far.
pub struct Session<'a> {
    terms: &'a Terms,
    seen: SeenTags<'a>,
    tool: Option<Box<ToolReader<'a>>>,
    pairs: Vec<Pair>,
}

/// What a line did.
#[derive(Clone, Debug, PartialEq)]
pub enum LineOutcome {
    /// A point was added; how it fits the earlier points, or why that is still unknown.
    Added(String),
    /// The last point was removed.
    Undone(String),
    /// Nothing changed: an empty line, or a list of the points.
    Unchanged(String),
    /// The line is invalid, or the arm's position could not be read.
    Invalid(String),
    /// The person is done.
    Finished,
}

impl<'a> Session<'a> {
    /// Starts with existing points.
    ///
    /// With `tool`, a line is `u,v`, and the tool's position is read when the line is entered; without it, a line is
    /// `u,v,x,y,z`. One of the tags that are `seen` in the camera's picture may stand in place of `u,v`.
    pub fn new(
        terms: &'a Terms,
        pairs: Vec<Pair>,
        seen: SeenTags<'a>,
        tool: Option<Box<ToolReader<'a>>>,
    ) -> Self {
        Session {
            terms,
            seen,
            tool,
            pairs,
        }
    }

    /// Returns the points so far.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// Returns the expected format of a line.
    pub fn form(&self) -> &'static str {
        match self.tool {
            Some(_) => "`u,v`, or `tag7`, with the fingertips on that point",
            None => "`u,v,x,y,z`: the pixel, or `tag7`, then the tool in metres",
        }
    }

    /// Handles a line: a point, `undo`, `list`, or `done`.
    pub fn line(&mut self, text: &str) -> LineOutcome {
        match text.trim() {
            "" => LineOutcome::Unchanged(String::new()),
            "done" => LineOutcome::Finished,
            "list" => LineOutcome::Unchanged(self.list()),
            "undo" => match self.pairs.pop() {
                Some(_) => {
                    LineOutcome::Undone(format!("point {} is taken back", self.pairs.len() + 1))
                }
                None => LineOutcome::Invalid("there is no point to undo".to_owned()),
            },
            point => match self.point(point) {
                Ok(pair) => {
                    let fit = self.describe_fit(&pair);
                    self.pairs.push(pair);
                    LineOutcome::Added(format!("point {}: {fit}", self.pairs.len()))
                }
                Err(why) => LineOutcome::Invalid(why),
            },
        }
    }

    fn point(&mut self, text: &str) -> Result<Pair, String> {
        let pair = typed_pair(text, self.seen, self.tool.as_deref_mut())?;
        if self.pairs.len() >= MAX_PAIRS {
            return Err(format!("there are {MAX_PAIRS} points already; type `done`"));
        }
        check_point(self.terms, self.pairs.len() + 1, &pair)?;
        Ok(pair)
    }

    /// Describes how a new point fits the earlier ones.
    fn describe_fit(&self, pair: &Pair) -> String {
        let n = self.pairs.len();
        if n < MIN_FITTED {
            return format!(
                "added; from {} points on, the fit of each new one is shown",
                MIN_FITTED + 1
            );
        }
        let off_mm = || {
            let lens = check_terms(self.terms).ok()?;
            let lens = lens.as_ref();
            let before = fit(lens, &sightings(lens, &self.pairs).ok()?)?;
            let point = *sightings(lens, &[*pair]).ok()?.first()?;
            Some(error(&before, &point)?.norm() * 1000.0)
        };
        match off_mm() {
            Some(off_mm) => {
                format!("{off_mm:.1} mm from where the {n} before it put it (`undo` removes it)")
            }
            None => {
                format!("added; the {n} points before it do not yet determine where it should be")
            }
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

/// Returns the pixels of a grid over the window, row by row: the best places to touch.
///
/// The outermost are a tenth of the side from the border, so that the fingertips around them are visible.
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
