//! Materials all over what a task may declare: what one reads is within its bound, or a warning names it.

use super::*;
use fab_sim::MaterialWarning;
use fab_sim::measure::textile_table;

/// Returns the lines of the textile table that a warning names, each with the least that it still promises.
fn named(warning: &MaterialWarning) -> Vec<(&'static str, f32)> {
    let within = |names: &[&'static str]| {
        names
            .iter()
            .map(|name| (*name, f32::NEG_INFINITY))
            .collect()
    };
    match warning {
        MaterialWarning::Coarse { .. } => within(&["bending length"]),
        MaterialWarning::Sharp { .. } => within(&["loop", "fold", "gap between layers", "crease"]),
        MaterialWarning::Unsteady { .. } => within(&["momentum", "fold", "gap between layers"]),
        MaterialWarning::Curls { least_m, .. } => vec![
            ("bending length, bias", 1000.0 * least_m),
            ("loop", f32::NEG_INFINITY),
            ("fold", f32::NEG_INFINITY),
            ("gap between layers", f32::NEG_INFINITY),
        ],
        MaterialWarning::Threads { declared, least } => vec![("stretch", 0.98 * least / declared)],
        // The table expects what these say.
        MaterialWarning::Gap { .. }
        | MaterialWarning::Crease { .. }
        | MaterialWarning::Shear { .. }
        | MaterialWarning::SoftBias { .. } => Vec::new(),
    }
}

/// Returns by how much a line of the table may be off: as a share, and in its own unit.
fn bound(what: &str, expected: f64, gap_m: f32) -> [f64; 2] {
    match what {
        "bending length, bias" => [0.1, 0.0],
        _ if what.starts_with("bending") && expected >= 15.0 => [0.05, 0.0],
        "crease recovery, warp" | "crease recovery, weft" => {
            [0.0, if gap_m > 0.002 { 21.0 } else { 16.0 }]
        }
        "stretch, bias" => [0.1, 0.0],
        _ if what.starts_with("stretch") => [0.01, 0.0],
        "friction on the table" => [0.0, 0.015],
        "friction on itself" if (0.2..=1.0).contains(&expected) => [0.08, 0.0],
        "friction on itself" => [0.2, 0.0],
        "change of momentum" => [0.0, 0.005],
        _ => [0.1, 0.0],
    }
}

/// Numbers that differ from each other and are the same in each run, from 0 to 1.
fn draws(mut state: u64) -> impl FnMut() -> f32 {
    move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 40) as f32 / (1u64 << 24) as f32
    }
}

/// Draws a material within the ranges of the language, `lang/materials` in the compiler.
fn draw(next: &mut impl FnMut() -> f32) -> Material {
    let mut between = |low: f32, high: f32| low * (high / low).powf(next());
    let warp = between(5.0, 100.0);
    // As cloths have it, weft and bias are near; and far, as a task may declare it.
    let far = between(1.05, 4.0);
    let [weft, bias] = [between(1.0 / far, far), between(1.0 / far, far)].map(|by| warp * by);
    Material {
        weight_kg_m2: between(0.01, 2.0),
        thickness_m: between(5e-5, 0.02),
        bending_length_m: Directions {
            warp: 0.001 * warp,
            weft: 0.001 * weft.clamp(5.0, 100.0),
            bias: 0.001 * bias.clamp(5.0, 100.0),
        },
        crease_recovery_deg: between(1.0, 181.0) - 1.0,
        stretch: Directions {
            warp: between(0.002, 0.5),
            weft: between(0.002, 0.5),
            bias: between(0.002, 0.5),
        },
        table_friction: between(0.05, 3.0),
        self_friction: between(0.05, 3.0),
    }
}

/// Returns the lines of a material's table that are off and not warned of, and whether it can be simulated.
fn silent_faults(material: &Material) -> Option<Vec<String>> {
    let warnings = material.check(SPACING_M).ok()?;
    let warned: Vec<_> = warnings.iter().flat_map(named).collect();
    let readings =
        textile_table(material, SPACING_M).unwrap_or_else(|error| panic!("{error}: {material:?}"));
    let silent = readings.iter().filter_map(|reading| {
        let expected = reading.expected?;
        let [share, plain] = bound(reading.what, expected, material.gap_m());
        let is_right = (reading.measured - expected).abs() <= share * expected + plain;
        let is_warned = warned.iter().any(|(name, least)| {
            // A share where it is said of both threads.
            let least = f64::from(*least) * if *name == "stretch" { expected } else { 1.0 };
            let is_there = reading.measured.is_finite();
            reading.what.contains(name) && !(is_there && reading.measured < least)
        });
        (!is_right && !is_warned)
            .then(|| format!("{}: {} of {expected}", reading.what, reading.measured))
    });
    Some(silent.collect())
}

fn judge(materials: impl Iterator<Item = Material>) {
    let faults = materials.filter_map(|material| {
        let silent = silent_faults(&material)?;
        (!silent.is_empty()).then(|| format!("{silent:?}\n    of {material:?}"))
    });
    let faults: Vec<String> = faults.collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn a_material_shows_what_it_declares_or_is_warned_of() {
    let threads = [
        [0.03, 0.015, 0.02],
        [0.011, 0.013, 0.012],
        [0.066, 0.06, 0.06],
    ];
    let materials = threads.map(|[warp, weft, bias]| Material {
        bending_length_m: Directions { warp, weft, bias },
        ..of_length(20.0)
    });
    judge(materials.into_iter());
}

#[test]
#[ignore = "long"]
fn materials_from_all_ranges_show_what_they_declare_or_are_warned_of() {
    let mut next = draws(2);
    let drawn = std::iter::repeat_with(|| draw(&mut next));
    judge(drawn.filter(|it| it.check(SPACING_M).is_ok()).take(60));
}
