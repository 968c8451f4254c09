//! Folds a square cloth along its diagonal, or only begins to. scripts/count-instructions.sh counts its instructions.
//!
//! `cargo run --example fold -- SIZE [STEPS [CLOTH]]` prints the computed steps; `all` STEPS, as without them, are the whole
//! fold. CLOTH is a name from `benches/cloths/mod.rs`; without it, that of the recorded scene.

#[path = "../benches/cloths/mod.rs"]
mod cloths;

use fab_sim::{Grid, SimError, diagonal_fold};
use std::cell::Cell;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let usage = || {
        format!(
            "usage: fold SIZE [STEPS|all [{}]]",
            cloths::CLOTHS.join("|")
        )
    };
    let (size, most, cloth) = match arguments.as_slice() {
        [size] => (size, "all", "pyflex"),
        [size, steps] => (size, steps.as_str(), "pyflex"),
        [size, steps, cloth] => (size, steps.as_str(), cloth.as_str()),
        _ => return Err(usage().into()),
    };
    let size = size.parse()?;
    let most = if most == "all" {
        u32::MAX
    } else {
        most.parse()?
    };
    let params = cloths::params(cloth).ok_or_else(usage)?;
    let asked = Cell::new(0);
    let enough = || asked.replace(asked.get() + 1) >= most;
    let grid = Grid::new(size, size, 0.00625)?;
    let steps = match diagonal_fold(grid, &params, &enough) {
        Ok(cloth) => cloth.steps(),
        Err(SimError::Interrupted { steps }) => u64::from(steps),
        Err(error) => return Err(error.into()),
    };
    println!("{steps}");
    Ok(())
}
