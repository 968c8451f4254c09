//! Which particles of a grid a cloth is made of: a hole, or the outline of a T-shirt.
//!
//! In: a predicate, or an outline drawn in rows of `#` and `.`. Out: a
//! [`Mask`] whose particles hang together. Positions keep the whole grid's
//! order and length; those of missing particles are never read.

use crate::grid::{Grid, GridError, MAX_DIM};
use std::fmt;
use std::sync::Arc;

/// The particles of a [`Grid`] that exist.
///
/// Every one is a corner of a full cell, that is, of a square of four particles; and full cells hang together
/// by whole edges. Clones share their memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    grid: Grid,
    // `None` is a full grid, so that the usual cloth costs nothing and equals itself however it was made.
    present: Option<Arc<[bool]>>,
    count: usize,
}

/// Says why an outline is none of a cloth. Rows and columns count from 1 at the back left.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MaskError {
    /// The outline's size or spacing is no grid's.
    #[error("an outline of this size is no cloth: {0}")]
    Grid(#[from] GridError),
    /// A letter means nothing here.
    #[error(
        "row {row}, column {column} of the outline holds `{}`; a particle is `#`, none is `.`",
        .found.escape_debug()
    )]
    Letter {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The letter found.
        found: char,
    },
    /// Rows differ in length.
    #[error(
        "row {row} of the outline has {got} columns and row 1 has {expected}; fill rows with `.` to equal length"
    )]
    Uneven {
        /// The first row that differs, from 1.
        row: usize,
        /// Columns of row 1.
        expected: usize,
        /// Columns of this row.
        got: usize,
    },
    /// There is no cell at all.
    #[error("the outline has {count} particles; a cloth needs at least 4, in a square")]
    TooFew {
        /// Particles present.
        count: usize,
    },
    /// A particle would hang by a thread.
    #[error(
        "the particle in row {row}, column {column} of the outline is in no square of four; \
         remove it, or add the particles beside it"
    )]
    Thread {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
    },
    /// The cloth is in parts.
    #[error(
        "the outline is in parts: row {}, column {} is not joined to row {}, column {}; \
         parts that meet must share two neighbouring particles", .part[0], .part[1], .rest[0], .rest[1]
    )]
    Parts {
        /// Row and column of one part's first particle, from 1.
        part: [usize; 2],
        /// Row and column of the first particle of all, from 1.
        rest: [usize; 2],
    },
}

impl Mask {
    /// Keeps every particle.
    pub fn full(grid: Grid) -> Mask {
        Mask {
            grid,
            present: None,
            count: grid.particle_count(),
        }
    }

    /// Keeps the particles of which `inside` says so.
    ///
    /// - `inside`: called once for every `ix` (along +X) and `iy` (along -Y), both from 0.
    ///
    /// A round outline may leave single particles at its ends, which are refused with their place.
    pub fn from_fn(
        grid: Grid,
        mut inside: impl FnMut(usize, usize) -> bool,
    ) -> Result<Mask, MaskError> {
        let present: Vec<bool> = (0..grid.particle_count())
            .map(|index| inside(index % grid.dimx, index / grid.dimx))
            .collect();
        Mask::checked(grid, present)
    }

    /// Reads an outline as it is seen from above: `#` is a particle, `.` is none.
    ///
    /// The first row is the cloth's back edge (`iy` = 0); the numbers of rows and columns are the grid's.
    /// Blanks at the end of a row and empty rows at the end of the text are passed over.
    ///
    /// - `spacing_m`: distance between neighbours, metres.
    pub fn parse(text: &str, spacing_m: f32) -> Result<Mask, MaskError> {
        let rows = || text.trim_end().lines().map(str::trim_end);
        let dimx = rows().next().unwrap_or_default().chars().count();
        // A huge text is refused before any of it is kept.
        let dimy = rows().take(MAX_DIM + 1).count();
        let grid = Grid::new(dimx, dimy, spacing_m)?;
        let mut present = Vec::with_capacity(grid.particle_count());
        for (iy, row) in rows().enumerate() {
            for (ix, letter) in row.chars().enumerate() {
                if !matches!(letter, '#' | '.') {
                    return Err(MaskError::Letter {
                        row: iy + 1,
                        column: ix + 1,
                        found: letter,
                    });
                }
            }
            // Every letter is one byte from here on.
            if row.len() != dimx {
                return Err(MaskError::Uneven {
                    row: iy + 1,
                    expected: dimx,
                    got: row.len(),
                });
            }
            present.extend(row.chars().map(|letter| letter == '#'));
        }
        Mask::checked(grid, present)
    }

    /// Returns the grid that the particles are of.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Tells whether the particle exists; none outside the grid does.
    ///
    /// - `index`: `iy * dimx + ix`.
    pub fn has(&self, index: usize) -> bool {
        match &self.present {
            Some(present) => present.get(index).copied().unwrap_or(false),
            None => index < self.count,
        }
    }

    /// Returns the number of particles that exist.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Tells whether every particle of the grid exists.
    pub fn is_full(&self) -> bool {
        self.present.is_none()
    }

    fn checked(grid: Grid, present: Vec<bool>) -> Result<Mask, MaskError> {
        let count = present.iter().filter(|&&there| there).count();
        let mask = if count == present.len() {
            Mask::full(grid)
        } else {
            Mask {
                grid,
                present: Some(present.into()),
                count,
            }
        };
        mask.check_threads()?;
        mask.check_parts()?;
        Ok(mask)
    }

    /// Tells whether all four corners of a cell exist; `ix`, `iy` are its back left corner's.
    pub(crate) fn has_cell(&self, ix: usize, iy: usize) -> bool {
        let back_left = iy * self.grid.dimx + ix;
        ix + 1 < self.grid.dimx
            && iy + 1 < self.grid.dimy
            && [0, 1, self.grid.dimx, self.grid.dimx + 1]
                .into_iter()
                .all(|step| self.has(back_left + step))
    }

    fn place(&self, index: usize) -> [usize; 2] {
        [index / self.grid.dimx + 1, index % self.grid.dimx + 1]
    }

    fn check_threads(&self) -> Result<(), MaskError> {
        if self.count < 4 {
            return Err(MaskError::TooFew { count: self.count });
        }
        for index in (0..self.grid.particle_count()).filter(|&index| self.has(index)) {
            let (ix, iy) = (index % self.grid.dimx, index / self.grid.dimx);
            let in_cell = [0, 1].into_iter().any(|left| {
                [0, 1]
                    .into_iter()
                    .any(|back| ix >= left && iy >= back && self.has_cell(ix - left, iy - back))
            });
            if !in_cell {
                let [row, column] = self.place(index);
                return Err(MaskError::Thread { row, column });
            }
        }
        Ok(())
    }

    /// Walks from the first full cell over shared edges; a cell that is not reached is of another part.
    fn check_parts(&self) -> Result<(), MaskError> {
        let dimx = self.grid.dimx;
        let cells = || {
            (0..self.grid.particle_count()).filter(|cell| self.has_cell(cell % dimx, cell / dimx))
        };
        let mut reached = vec![false; self.grid.particle_count()];
        let mut waiting: Vec<usize> = cells().take(1).collect();
        while let Some(cell) = waiting.pop() {
            if std::mem::replace(&mut reached[cell], true) {
                continue;
            }
            let (ix, iy) = (cell % dimx, cell / dimx);
            let beside = [
                (ix.wrapping_sub(1), iy),
                (ix + 1, iy),
                (ix, iy.wrapping_sub(1)),
                (ix, iy + 1),
            ];
            for (ix, iy) in beside {
                if ix < dimx && iy < self.grid.dimy && self.has_cell(ix, iy) {
                    waiting.push(iy * dimx + ix);
                }
            }
        }
        match (cells().find(|&cell| !reached[cell]), cells().next()) {
            (Some(part), Some(rest)) => Err(MaskError::Parts {
                part: self.place(part),
                rest: self.place(rest),
            }),
            _ => Ok(()),
        }
    }
}

impl From<Grid> for Mask {
    fn from(grid: Grid) -> Mask {
        Mask::full(grid)
    }
}

impl From<&Mask> for Mask {
    fn from(mask: &Mask) -> Mask {
        mask.clone()
    }
}

/// Draws the outline as [`Mask::parse`] reads it, each row ended by a line break.
impl fmt::Display for Mask {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for iy in 0..self.grid.dimy {
            for ix in 0..self.grid.dimx {
                let letter = if self.has(iy * self.grid.dimx + ix) {
                    "#"
                } else {
                    "."
                };
                out.write_str(letter)?;
            }
            out.write_str("\n")?;
        }
        Ok(())
    }
}
