//! The materials of `tasks/lib/materials.fab`, read from there: what is tested and timed is what is shipped.
//!
//! Only its numbers are read, and only as the file is laid out: one line for each property. The language itself belongs
//! to the compiler.

use fab_sim::{Directions, Material};

const TEXT: &str = include_str!("../../../tasks/lib/materials.fab");

/// Returns a shipped material; `None` if the file has none of that name, or not with all properties.
pub fn material(name: &str) -> Option<Material> {
    let (_, rest) = TEXT.split_once(&format!("\nmaterial {name} {{"))?;
    let (block, _) = rest.split_once("\n}")?;
    let value = |property: &str, part: &str| {
        let mut lines = block.lines().map(str::trim_start);
        let line = lines.find_map(|line| line.strip_prefix(property)?.strip_prefix(' '))?;
        let (values, _source) = line.split_once(" from ")?;
        let mut parts = values.split(',').map(str::trim);
        si(parts.find_map(|it| it.strip_prefix(part))?)
    };
    let directions = |property: &str| {
        Some(Directions {
            warp: value(property, "warp:")?,
            weft: value(property, "weft:")?,
            bias: value(property, "bias:")?,
        })
    };
    Some(Material {
        weight_kg_m2: value("weight", "")?,
        thickness_m: value("thickness", "")?,
        bending_length_m: directions("bending")?,
        crease_recovery_deg: value("recovery", "")?,
        stretch: directions("stretch")?,
        table_friction: value("friction", "table:")?,
        self_friction: value("friction", "itself:")?,
    })
}

/// Reads a number with the unit behind it; angles stay in degrees.
fn si(text: &str) -> Option<f32> {
    let text = text.trim();
    let end = text.find(|c: char| c.is_ascii_alphabetic());
    let (number, unit) = text.split_at(end.unwrap_or(text.len()));
    let factor = match unit {
        "" | "deg" => 1.0,
        "mm" | "g/m2" => 0.001,
        _ => return None,
    };
    Some((number.parse::<f64>().ok()? * factor) as f32)
}
