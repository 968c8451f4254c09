//! Folds a square cloth along its diagonal, or only begins to. scripts/count-instructions.sh counts its instructions.
//!
//! `cargo run --example fold -- SIZE [STEPS]` prints the computed steps; without STEPS, the whole fold.

use fab_sim::{Grid, Params, SimError, diagonal_fold};
use std::cell::Cell;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (size, most) = match arguments.as_slice() {
        [size] => (size, u32::MAX),
        [size, steps] => (size, steps.parse()?),
        _ => return Err("usage: fold SIZE [STEPS]".into()),
    };
    let size = size.parse()?;
    let asked = Cell::new(0);
    let enough = || asked.replace(asked.get() + 1) >= most;
    let grid = Grid::new(size, size, 0.00625)?;
    let steps = match diagonal_fold(grid, &Params::default(), &enough) {
        Ok(cloth) => cloth.steps(),
        Err(SimError::Interrupted { steps }) => u64::from(steps),
        Err(error) => return Err(error.into()),
    };
    println!("{steps}");
    Ok(())
}
