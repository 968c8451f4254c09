//! The axes along which a simulated world may differ from a task's own.
//!
//! In: a value for some axes, [`AxisValues`]. Out: a [`Setup`], of which a
//! [`SimulatedWorld`](crate::SimulatedWorld) is made and by which starts are laid. A row of [`AXES`] holds everything
//! about an axis. Which values are taken is left to others.

use crate::simulated::{Look, Params};
use fab_program::{Camera, Picker};
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
        about: "Coulomb friction of table and picker; 0.75 by default",
        change: |setup, coefficient| setup.parameters.table_friction = coefficient as f32,
    },
    Axis {
        name: "self_friction",
        unit: "coefficient",
        low: 0.0,
        high: 10.0,
        about: "Coulomb friction between layers of the cloth; 1 by default",
        change: |setup, coefficient| setup.parameters.self_friction = coefficient as f32,
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
        change: |setup, mm| setup.camera.height_m = mm / 1000.0,
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

/// A simulated world before it is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// The physics and the picker.
    pub parameters: Params,
    /// The colours.
    pub look: Look,
    /// The camera.
    pub camera: Camera,
    /// How its starts are laid.
    pub placement: Placement,
    /// The values that differ from the task's own.
    pub values: AxisValues,
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

impl Setup {
    /// Returns a task's own world: its camera and picker, with the default physics and colours.
    pub fn new(camera: &Camera, picker: Picker) -> Setup {
        Setup {
            parameters: match picker {
                Picker::PutDown => Params::default(),
                Picker::Drop => Params::with_dropping_picker(),
            },
            look: Look::default(),
            camera: camera.clone(),
            placement: Placement::default(),
            values: AxisValues::default(),
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

    /// Returns the world that has these values and is otherwise the task's own.
    pub fn setup(&self, camera: &Camera, picker: Picker) -> Setup {
        let mut setup = Setup::new(camera, picker);
        for axis in AXES {
            if let Some(value) = self.0.get(axis.name) {
                (axis.change)(&mut setup, *value);
            }
        }
        setup.values = self.clone();
        setup
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
mod tests {
    use super::*;
    use fab_program::ImageUp;

    fn camera() -> Camera {
        Camera {
            height_m: 0.65,
            fov_rad: 0.785,
            image_px: 64,
            up: ImageUp::Y,
        }
    }

    fn setup(axis: &Axis, value: f64) -> Setup {
        let values = AxisValues(BTreeMap::from([(axis.name.to_owned(), value)]));
        values.setup(&camera(), Picker::PutDown)
    }

    #[test]
    fn each_axis_changes_its_own_part_of_the_world_and_no_other() {
        let own = Setup::new(&camera(), Picker::PutDown);
        let parts = |it: &Setup| {
            let Placement {
                size,
                turn_rad,
                shift_m,
            } = it.placement;
            [
                format!("{size}"),
                format!("{}", it.parameters.table_friction),
                format!("{}", it.parameters.self_friction),
                format!("{turn_rad}"),
                format!("{}", shift_m[0]),
                format!("{}", shift_m[1]),
                format!("{}", it.camera.height_m),
                format!("{:?}", [it.look.top, it.look.underside]),
                format!("{:?}", it.look.tiles),
            ]
        };
        for (index, axis) in AXES.iter().enumerate() {
            for value in [axis.low, axis.high] {
                let changed = setup(axis, value);
                let differ: Vec<usize> = (0..9)
                    .filter(|at| parts(&changed)[*at] != parts(&own)[*at])
                    .collect();
                let wanted = match axis.name {
                    "brightness" => vec![7, 8],
                    _ => vec![index],
                };
                assert_eq!(differ, wanted, "{axis:?} {value}");
            }
        }
    }

    #[test]
    fn hues_turn_round_the_circle_and_back() {
        // The corners of the circle, from CSS Color 4's table of hues.
        let red = [255, 0, 0];
        for (deg, wanted) in [
            (0.0, red),
            (60.0, [255, 255, 0]),
            (120.0, [0, 255, 0]),
            (-120.0, [0, 0, 255]),
            (360.0, red),
        ] {
            assert_eq!(with_turned_hue(red, deg), wanted, "{deg}");
        }
        // Python: colorsys.hsv_to_rgb(h + 1 / 8, s, v) of the default cloth's faces.
        assert_eq!(with_turned_hue([255, 113, 0], 45.0), [206, 255, 0]);
        assert_eq!(with_turned_hue([248, 145, 201], 45.0), [248, 166, 145]);
        assert_eq!(with_turned_hue([77, 77, 77], 100.0), [77, 77, 77]);
    }
}
