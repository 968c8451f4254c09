//! The textile table: what a material declares, what a cloth of it should show, and what the simulated one shows.

use super::bounds::{self, BOUNDS_SPACING_M};
use super::{
    Crease, Cut, Fineness, HOLDING_FRICTION, Loop, MeasureError, cantilever, crease_recovery_deg,
    drape_coefficient, extension, fold_height, free_fold, hanging_loop, momentum_change,
    self_friction, table_friction,
};
use crate::material::{Directions, Material};
use std::borrow::Cow;

/// One line of the textile table.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Reading {
    /// What was measured.
    pub what: &'static str,
    /// How, by whose method.
    pub method: Cow<'static, str>,
    /// Unit of both values; nothing for a plain number.
    pub unit: &'static str,
    /// What the material declares; `None` for what it says nothing of.
    pub declared: Option<f64>,
    /// What a cloth should show that is as its material declares, within the bounds of the simulator; `None` for what has no
    /// theory.
    pub expected: Option<f64>,
    /// What the simulated cloth shows.
    pub measured: f64,
    /// The least and the greatest value that it is known to show; `None` for what has no bound, where a warning of the material
    /// names the reading, and at other spacings than [`BOUNDS_SPACING_M`].
    pub within: Option<[f64; 2]>,
}

impl Reading {
    /// Tells whether it shows what it is known to show; `None` where nothing is known.
    pub fn is_within(&self) -> Option<bool> {
        let [least, most] = self.within?;
        Some((least..=most).contains(&self.measured))
    }
}

/// Measures what a material declares and a specimen shows, and how its cloth loops, folds, drapes and keeps its momentum.
///
/// Takes some seconds of computing. Fails on a material that cannot be simulated at this spacing.
pub fn textile_table(
    material: &Material,
    at: impl Into<Fineness>,
) -> Result<Vec<Reading>, MeasureError> {
    let at = at.into();
    let Directions { warp, weft, bias } = material.bending_length_m;
    let c = f64::from(warp);
    let [heart, ring] = [Loop::Heart, Loop::Ring].map(|shape| {
        let [length_m, depth_m] = hanging_loop(material, shape, 6.0 * warp, at)?;
        Ok::<_, MeasureError>([c * shape.depth(length_m / c), depth_m])
    });
    let ([heart, heart_m], [ring, ring_m]) = (heart?, ring?);
    let fold = free_fold(material, at)?;
    let gap_m = material.gap_m();
    let fold_m = c * fold_height(f64::from(gap_m) / c);
    let bending = |cut| Ok::<_, MeasureError>(cantilever(material, cut, at)?.bending_length_m);
    let recovers = |cut| crease_recovery_deg(material, cut, Crease::Row, at);
    let gives = |cut| extension(material, cut, at);
    let stretch = material.stretch;
    let slack = stretch.bias.max(material.least_bias_stretch(at.spacing_m));
    let stiff = bias.max(material.least_bias_m());
    let recovery = material.crease_recovery_deg;
    let opens = recovery.max(material.least_recovery_deg(at.spacing_m));
    let [table, itself] = [material.table_friction, material.self_friction];
    let same = |value: f32| [Some(f64::from(value)); 2];
    let but =
        |declared: f32, expected: f32| [declared, expected].map(|value| Some(f64::from(value)));
    let only = |expected: f64| [None, Some(expected)];
    let fold_method = match table.min(itself) < HOLDING_FRICTION {
        true => "elastica, as if friction were 0.6",
        false => "elastica",
    };
    // What cannot be simulated fails above.
    let warnings = material.check(at.spacing_m).unwrap_or_default();
    let is_bounded = (at.spacing_m - BOUNDS_SPACING_M).abs() < 1e-6;
    #[rustfmt::skip] // a table, one reading a line
    let rows = [
        ("bending length, warp", "cantilever, ASTM D1388 A", "mm", same(warp), bending(Cut::Warp)?),
        ("bending length, weft", "cantilever, ASTM D1388 A", "mm", same(weft), bending(Cut::Weft)?),
        ("bending length, bias", "cantilever, ASTM D1388 A", "mm", but(bias, stiff), bending(Cut::Bias)?),
        ("depth of a heart loop", "elastica, Plaut 2015", "mm", only(heart), heart_m),
        ("depth of a ring loop", "elastica, Plaut 2015", "mm", only(ring), ring_m),
        ("height of a free fold", fold_method, "mm", only(fold_m), fold.height_m),
        ("gap between layers", "free fold", "mm", but(material.thickness_m, gap_m), fold.gap_m),
        ("crease recovery, warp", "ISO 2313", "deg", but(recovery, opens), recovers(Cut::Warp)?),
        ("crease recovery, weft", "ISO 2313", "deg", but(recovery, opens), recovers(Cut::Weft)?),
        ("stretch, warp", "hanging sheet, E100", "", same(stretch.warp), gives(Cut::Warp)?),
        ("stretch, weft", "hanging sheet, E100", "", same(stretch.weft), gives(Cut::Weft)?),
        ("stretch, bias", "sheared sheet, EB5", "", but(stretch.bias, slack), gives(Cut::Bias)?),
        ("friction on the table", "slope", "", same(table), table_friction(material, at)?),
        ("friction on itself", "slope", "", same(itself), self_friction(material, at)?),
        ("change of momentum", "tumbling for 0.4 s", "", only(0.0), momentum_change(material, at)?),
        ("drape coefficient", "Cusick, 30 cm on 18 cm", "", [None; 2], drape_coefficient(material, at)?),
    ];
    Ok(rows
        .into_iter()
        .map(|(what, method, unit, [declared, expected], measured)| {
            let scale = if unit == "mm" { 1000.0 } else { 1.0 };
            let expected = expected.map(|value| scale * value);
            let bounded = expected.filter(|_| is_bounded);
            Reading {
                what,
                method: method.into(),
                unit,
                declared: declared.map(|value| scale * value),
                expected,
                measured: scale * measured,
                within: bounded
                    .and_then(|expected| bounds::within(what, expected, gap_m, &warnings)),
            }
        })
        .collect())
}
