//! Which particles of a start's grid there are, as a description says it.
//!
//! In: rows of `#` (there) and `.` (missing). Out: an answer for each particle. Whether such particles hang
//! together as a cloth is the world's to judge.

use super::Grid;
use serde::{Deserialize, Serialize};

/// The rows of an outline, seen from above; the first one is the cloth's back edge.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Outline(Vec<String>);

impl Outline {
    /// Takes rows of text apart; blanks at the end of a row and empty rows at the end are passed over.
    pub fn new(text: &str) -> Outline {
        let rows = text.trim_end().lines().map(str::trim_end);
        Outline(rows.map(str::to_owned).collect())
    }

    /// Returns the rows as a text, each ended by a line break.
    pub fn text(&self) -> String {
        self.0.iter().flat_map(|row| [row, "\n"]).collect()
    }

    /// Tells whether a particle of the grid exists; none outside the rows does.
    ///
    /// - `index`: `iy * dimx + ix`, with `dimx` at least 1.
    pub fn has(&self, grid: &Grid, index: usize) -> bool {
        let dimx = grid.dimx as usize;
        let row = self.0.get(index / dimx).map(String::as_bytes);
        row.and_then(|row| row.get(index % dimx)) == Some(&b'#')
    }

    /// Fails if the rows do not fit the grid: names their number, or the first row of another length.
    pub(super) fn check(&self, grid: &Grid) -> Result<(), String> {
        let Grid { dimx, dimy, .. } = *grid;
        if self.0.len() as u64 != u64::from(dimy) {
            return Err(format!(
                "its `outline` has {} rows; right would be {dimy}, as its grid",
                self.0.len()
            ));
        }
        let letters = |row: &String| row.chars().count();
        match self.0.iter().position(|row| letters(row) != dimx as usize) {
            Some(row) => Err(format!(
                "row {} of its `outline` has {} letters; right would be {dimx}, as its grid",
                row + 1,
                letters(&self.0[row])
            )),
            None => Ok(()),
        }
    }
}
