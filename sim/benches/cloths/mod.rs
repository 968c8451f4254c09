//! The cloths that are timed: the recorded scene's, and the shipped materials.

mod shipped;

use fab_sim::Params;

/// Names that [`params`] knows.
pub const CLOTHS: [&str; 5] = ["pyflex", "cotton", "denim", "silk", "towel"];

/// Returns the parameters of a cloth; `None` for a name that is not in [`CLOTHS`].
pub fn params(cloth: &str) -> Option<Params> {
    let material = match cloth {
        "pyflex" => None,
        name => Some(shipped::material(name)?),
    };
    Some(Params {
        material,
        ..Params::default()
    })
}
