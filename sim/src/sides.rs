//! The cloth kept twice: by rows, as its grid is numbered, and by columns.
//!
//! Springs along rows run by columns. Sweeps take turns in where they begin and end, so that positions need to
//! change sides only once a sweep; whoever works on positions between two sweeps takes the side that is current.

use crate::layout::Layout;
use crate::planes::Planes;

/// What a sweep reads and writes, by the slots of one layout.
#[derive(Clone, Debug)]
pub(crate) struct Side {
    pub positions: Planes,
    /// Positions when the substep began.
    pub began: Planes,
    /// 1 for a free particle, 0 for a held one and where none is.
    pub inverse_mass: Vec<f32>,
}

/// Both sides of one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Sides {
    pub rows: Side,
    pub columns: Side,
    by_rows: Layout,
    by_columns: Layout,
    /// Slot by columns of every slot by rows.
    turned: Vec<u32>,
}

impl Sides {
    /// Makes both sides of a cloth of which no particle is held, with the given positions by rows.
    pub fn new(layout: &Layout, positions: Planes) -> Sides {
        let across = layout.transposed();
        let mut turned = vec![0; layout.len()];
        for (&slot, &other) in layout.slots().iter().zip(across.slots()) {
            turned[slot as usize] = other;
        }
        let n = across.len();
        Sides {
            rows: Side {
                began: positions.clone(),
                positions,
                inverse_mass: layout.free(),
            },
            columns: Side {
                began: Planes::zeros(n),
                positions: Planes::zeros(n),
                inverse_mass: across.free(),
            },
            by_rows: layout.clone(),
            by_columns: across,
            turned,
        }
    }

    /// Fixes particles, and frees all others.
    ///
    /// - `held`: their slots by rows.
    pub fn hold(&mut self, held: &[usize]) {
        self.rows.inverse_mass = self.by_rows.free();
        self.columns.inverse_mass = self.by_columns.free();
        for &slot in held {
            self.rows.inverse_mass[slot] = 0.0;
            self.columns.inverse_mass[self.turned[slot] as usize] = 0.0;
        }
    }

    /// Returns the slot by columns of a slot by rows.
    pub fn turned(&self, slot: u32) -> u32 {
        self.turned[slot as usize]
    }

    /// Notes by rows, and by columns, that a substep begins.
    pub fn begin(&mut self) {
        self.rows.began.clone_from(&self.rows.positions);
        turn(&self.by_rows, &self.rows.began, &mut self.columns.began);
    }

    /// Notes by rows alone that a substep begins.
    pub fn begin_rows(&mut self) {
        self.rows.began.clone_from(&self.rows.positions);
    }

    /// Brings the positions by columns up to date.
    pub fn turn_to_columns(&mut self) {
        let to = &mut self.columns.positions;
        turn(&self.by_rows, &self.rows.positions, to);
    }

    /// Brings the positions by rows up to date.
    pub fn turn_to_rows(&mut self) {
        let to = &mut self.rows.positions;
        turn(&self.by_columns, &self.columns.positions, to);
    }
}

fn turn(layout: &Layout, from: &Planes, to: &mut Planes) {
    layout.transpose(&from.x, &mut to.x);
    layout.transpose(&from.y, &mut to.y);
    layout.transpose(&from.z, &mut to.z);
}
