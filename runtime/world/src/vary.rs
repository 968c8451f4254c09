//! The axes along which a simulated world may differ from a task's own.
//!
//! In: a value for some axes, [`AxisValues`]. Out: a changed [`Setup`], which
//! [`SimulatedWorld::varied`](crate::SimulatedWorld::varied) takes on, and a [`Placement`] for those who lay starts. A
//! row of [`AXES`] holds everything about an axis. Which values are taken is left to others.

use crate::simulated::{Look, Params};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// A row of [`AXES`].
pub struct Axis {
    /// Its name in suites, records and tables.
    pub name: &'static str,
    /// The unit of its values.
    pub unit: &'static str,
    /// The least value.
    pub low: f64,
    /// The greatest value.
    pub high: f64,
    /// What a value changes, in one line.
    pub about: &'static str,
    /// Changes a setup to a value.
    change: fn(&mut Setup, f64),
}

/// Every axis, in the order of tables.
pub const AXES: &[Axis] = &[
    Axis {
        name: "size",
        unit: "factor",
        low: 0.5,
        high: 2.0,
        about: "both sides of the cloth, by the distance between its particles",
        change: |setup, factor| setup.placement.size = factor,
    },
    Axis {
        name: "friction",
        unit: "coefficient",
        low: 0.0,
        high: 10.0,
        about: "Coulomb friction of table and picker; 0.75 without a material",
        change: |Setup { parameters, .. }, coefficient| match &mut parameters.material {
            Some(material) => material.table_friction = coefficient as f32,
            None => parameters.table_friction = coefficient as f32,
        },
    },
    Axis {
        name: "self_friction",
        unit: "coefficient",
        low: 0.0,
        high: 10.0,
        about: "Coulomb friction between layers of the cloth; 1 without a material",
        change: |Setup { parameters, .. }, coefficient| match &mut parameters.material {
            Some(material) => material.self_friction = coefficient as f32,
            None => parameters.self_friction = coefficient as f32,
        },
    },
    Axis {
        name: "turn_deg",
        unit: "degrees",
        low: -180.0,
        high: 180.0,
        about: "further turn of the laid cloth about the table's centre, counter-clockwise as seen from above",
        change: |setup, deg| setup.placement.turn_rad = deg.to_radians(),
    },
    Axis {
        name: "shift_x_mm",
        unit: "mm",
        low: -500.0,
        high: 500.0,
        about: "shift of the laid cloth along the world's x",
        change: |setup, mm| setup.placement.shift_m[0] = mm / 1000.0,
    },
    Axis {
        name: "shift_y_mm",
        unit: "mm",
        low: -500.0,
        high: 500.0,
        about: "shift of the laid cloth along the world's y",
        change: |setup, mm| setup.placement.shift_m[1] = mm / 1000.0,
    },
    Axis {
        name: "camera_height_mm",
        unit: "mm",
        low: 100.0,
        high: 5000.0,
        about: "height of the camera above the table, in place of the task's; its pictures know it",
        change: |setup, mm| setup.camera_height_m = Some(mm / 1000.0),
    },
    Axis {
        name: "hue_deg",
        unit: "degrees",
        low: -180.0,
        high: 180.0,
        about: "turn of the hue of both faces of the cloth; grey ones keep their colour",
        change: |setup, deg| {
            let look = &mut setup.look;
            look.top = with_turned_hue(look.top, deg);
            look.underside = with_turned_hue(look.underside, deg);
        },
    },
    Axis {
        name: "brightness",
        unit: "factor",
        low: 0.05,
        high: 2.0,
        about: "light on cloth and table: all colours, at most white",
        change: |setup, factor| {
            let look = &mut setup.look;
            let [first, second] = &mut look.tiles;
            for colour in [&mut look.top, &mut look.underside, first, second] {
                *colour = colour.map(|channel| (f64::from(channel) * factor).round() as u8);
            }
        },
    },
];

impl Axis {
    /// Finds the axis of a name.
    pub fn find(name: &str) -> Option<&'static Axis> {
        AXES.iter().find(|axis| axis.name == name)
    }
}

impl PartialEq for Axis {
    fn eq(&self, other: &Axis) -> bool {
        self.name == other.name
    }
}

impl fmt::Debug for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// The parts of a simulated world that axes change; the default is a world's own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Setup {
    /// The physics and the picker.
    pub parameters: Params,
    /// The colours.
    pub look: Look,
    /// Height of the camera above the table, metres; `None`: the task's.
    pub camera_height_m: Option<f64>,
    /// How starts are laid.
    pub placement: Placement,
}

/// How a start is laid, relative to what it says itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Factor of the distance between particles.
    pub size: f64,
    /// Turn about the table's centre, counter-clockwise as seen from above, radians.
    pub turn_rad: f64,
    /// Shift along the world's x and y after the turn, metres.
    pub shift_m: [f64; 2],
}

impl Default for Placement {
    fn default() -> Placement {
        Placement {
            size: 1.0,
            turn_rad: 0.0,
            shift_m: [0.0; 2],
        }
    }
}

/// Values by the names of their axes, in the unit of the axis; none if a world is the task's own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct AxisValues(pub BTreeMap<String, f64>);

impl AxisValues {
    /// Returns whether the world is the task's own.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Changes a setup to these values.
    pub fn apply(&self, setup: &mut Setup) {
        for axis in AXES {
            if let Some(value) = self.0.get(axis.name) {
                (axis.change)(setup, *value);
            }
        }
    }

    /// Returns how these values lay a start.
    pub fn placement(&self) -> Placement {
        let mut setup = Setup::default();
        self.apply(&mut setup);
        setup.placement
    }
}

/// Turns a colour's hue (HSV); saturation and value stay.
fn with_turned_hue(rgb: [u8; 3], deg: f64) -> [u8; 3] {
    let [red, green, blue] = rgb.map(f64::from);
    let most = red.max(green).max(blue);
    let chroma = most - red.min(green).min(blue);
    if chroma == 0.0 {
        return rgb;
    }
    // In sextants of the circle, from red.
    let hue = match most {
        most if most == red => (green - blue) / chroma,
        most if most == green => 2.0 + (blue - red) / chroma,
        _ => 4.0 + (red - green) / chroma,
    };
    let channel = |offset: f64| {
        let sextant = (offset + hue + deg / 60.0).rem_euclid(6.0);
        (most - chroma * sextant.min(4.0 - sextant).clamp(0.0, 1.0)).round() as u8
    };
    [5.0, 3.0, 1.0].map(channel)
}

#[cfg(test)]
#[path = "tests/vary.rs"]
mod tests;
