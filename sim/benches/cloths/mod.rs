//! The cloths that are timed: the recorded scene's, and the materials of `tasks/lib/materials.fab`.

use fab_sim::{Directions, Material, Params};

/// Names that [`params`] knows.
pub const CLOTHS: [&str; 5] = ["pyflex", "cotton", "denim", "silk", "towel"];

/// Returns the parameters of a cloth; `None` for a name that is not in [`CLOTHS`].
pub fn params(cloth: &str) -> Option<Params> {
    // Weight, thickness, recovery, friction on the table and on itself; then warp, weft and bias of bending and of stretch.
    #[rustfmt::skip] // a table, one material a line
    let (plain, bending, stretch) = match cloth {
        "pyflex" => return Some(Params::default()),
        "cotton" => ([0.167, 0.000_35, 75.0, 0.45, 0.6], [0.018, 0.016, 0.016], [0.015, 0.025, 0.06]),
        "denim" => ([0.324, 0.0007, 100.0, 0.35, 0.6], [0.0272, 0.0312, 0.0285], [0.01, 0.03, 0.03]),
        "silk" => ([0.035, 0.0001, 125.0, 0.2, 0.3], [0.013, 0.012, 0.011], [0.01, 0.02, 0.08]),
        "towel" => ([0.42, 0.0021, 110.0, 0.4, 0.9], [0.021, 0.018, 0.019], [0.03, 0.04, 0.1]),
        _ => return None,
    };
    let directions = |[warp, weft, bias]: [f32; 3]| Directions { warp, weft, bias };
    let [
        weight_kg_m2,
        thickness_m,
        crease_recovery_deg,
        table_friction,
        self_friction,
    ] = plain;
    Some(Params {
        material: Some(Material {
            weight_kg_m2,
            thickness_m,
            bending_length_m: directions(bending),
            crease_recovery_deg,
            stretch: directions(stretch),
            table_friction,
            self_friction,
        }),
        ..Params::default()
    })
}
