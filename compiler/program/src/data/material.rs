//! What a cloth is made of, as textile laboratories measure it, and the colours of its faces.

use crate::words::words;
use serde::{Deserialize, Serialize};

/// The name of the recorded scene's cloth, which is no measured textile. A cloth without a material is this one.
pub const RECORDED: &str = "pyflex";

/// A measured textile. Each value is what a laboratory reports, in SI units; tests and standards are those of
/// `docs/materials.md`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Its name in the task.
    pub name: String,
    /// Mass per area, kg/m^2 (ISO 3801).
    pub weight_kg_m2: f64,
    /// Thickness of one layer, metres (ISO 5084).
    pub thickness_m: f64,
    /// Bending length, metres (Peirce 1930; ASTM D1388, option A).
    pub bending_length_m: Directions,
    /// Angle to which a fold that was pressed flat opens again, degrees: 180 is flat, 0 stays folded (ISO 2313).
    pub crease_recovery_deg: f64,
    /// How much longer it gets under the loads of FAST, as a share of its length: along its threads under 98.1 N/m
    /// (E100), along their diagonal under 4.9 N/m (EB5).
    pub stretch: Directions,
    /// Coulomb friction on the table.
    pub table_friction: f64,
    /// Coulomb friction between layers.
    pub self_friction: f64,
    /// The face that is up when the cloth lies flat at the start.
    pub upper: Colour,
    /// The other face.
    pub under: Colour,
    /// Where the values come from, one for each line of the declaration. No part of a program's identity.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<Source>,
}

/// The thinnest and the thickest gap between layers that the simulator keeps, metres. A test in `fab-world` compares
/// them with the simulator's own.
const GAP_M: [f64; 2] = [0.001, 0.003];

impl Material {
    /// Returns the distance between the middles of two layers in the simulator, metres: the thickness, within what
    /// contacts of particles can keep.
    pub fn gap_m(&self) -> f64 {
        self.thickness_m.clamp(GAP_M[0], GAP_M[1])
    }

    /// Returns the material without the sources of its values, which change no result.
    pub fn without_sources(&self) -> Material {
        Material {
            sources: Vec::new(),
            ..self.clone()
        }
    }
}

/// Where the values of one property come from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// The property, such as `weight`.
    pub property: String,
    /// A publication, or how it was measured.
    pub from: String,
}

/// A value along each direction of a woven cloth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Directions {
    /// Along the warp: from left to right in the grid.
    pub warp: f64,
    /// Along the weft: from back to front in the grid.
    pub weft: f64,
    /// At 45 degrees to both.
    pub bias: f64,
}

/// The colour of a face.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Colour {
    /// What people call it; prompts say this.
    pub name: String,
    /// Red, green and blue, sRGB.
    pub rgb: [u8; 3],
}

/// A face of the cloth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Face {
    /// The one that is up when the cloth lies flat at the start.
    Upper,
    /// The other one.
    Under,
}

words! { Face {
    "upper" => Upper, "the face that is up when the cloth lies flat at the start";
    "under" => Under, "the other face";
} }

/// The recorded images' colours: those of SoftGym's cloth.
const RECORDED_FACES: [(&str, [u8; 3]); 2] = [("orange", [255, 113, 0]), ("pink", [248, 145, 201])];

/// The hue, saturation and value by which the paper's smoothing finds the recorded cloth's under face (protocol,
/// section 6).
const RECORDED_UNDER: [[f64; 2]; 3] = [[280.0, 340.0], [0.2, 1.0], [0.3, 1.0]];

/// How far a pixel's hue may be from its face's, degrees. Neighbours among the twelve main hues are 30 degrees apart.
const HUE_MARGIN_DEG: f64 = 30.0;

/// Colours of a smaller saturation are greys: their hue says nothing.
const GREY: f64 = 0.15;

impl Colour {
    /// Returns the colour of a face of the recorded cloth.
    pub fn recorded(face: Face) -> Colour {
        let (name, rgb) = RECORDED_FACES[face as usize];
        Colour {
            name: name.to_owned(),
            rgb,
        }
    }

    /// Returns the hue, saturation and value that its pixels may have in a picture, each as a range, in degrees and
    /// fractions of 1. A hue that ends below its beginning passes through 360.
    ///
    /// Shade makes a face darker and light paler, so the ranges are wide. That a table or the other face has another
    /// colour is not checked.
    pub fn in_picture(&self) -> [[f64; 2]; 3] {
        if *self == Colour::recorded(Face::Under) {
            return RECORDED_UNDER;
        }
        let [hue_deg, saturation, value] = hsv(self.rgb);
        let rounded = |number: f64| (number * 100.0).round() / 100.0;
        // A third of the light is lost on a slope.
        let darkest = rounded(value * 0.6);
        if saturation < GREY {
            let brightest = rounded((value * 1.2).min(1.0));
            return [[0.0, 360.0], [0.0, 2.0 * GREY], [darkest, brightest]];
        }
        let at = |offset_deg: f64| (hue_deg.round() + offset_deg + 360.0) % 360.0;
        [
            [at(-HUE_MARGIN_DEG), at(HUE_MARGIN_DEG)],
            [rounded(saturation / 2.0), 1.0],
            [darkest, 1.0],
        ]
    }
}

/// Returns a colour's hue in degrees, `0 <= hue < 360`, and its saturation and value, 0 to 1; a grey has hue 0.
///
/// Each is one division of whole numbers, so it equals a decimal limit wherever the true ratio does.
pub fn hsv([red, green, blue]: [u8; 3]) -> [f64; 3] {
    let [r, g, b] = [red, green, blue].map(i32::from);
    let most = r.max(g).max(b);
    let spread = most - r.min(g).min(b);
    let value = f64::from(most) / 255.0;
    if spread == 0 {
        return [0.0, 0.0, value];
    }
    // In sixths of the circle times `spread`.
    let turned = if most == r {
        g - b
    } else if most == g {
        b - r + 2 * spread
    } else {
        r - g + 4 * spread
    };
    let hue = f64::from(60 * turned.rem_euclid(6 * spread)) / f64::from(spread);
    [hue, f64::from(spread) / f64::from(most), value]
}
