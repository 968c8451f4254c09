//! One frame of coordinates: what the numbers count, their order, and the picture they refer to.

use crate::data::camera::PixelPoint;
use crate::exact;
use serde::{Deserialize, Serialize};

/// How far beyond the end of a pixel a position may be to still belong to it, pixels. It covers rounding in binary.
const ROUNDED: f64 = 1e-6;

/// What coordinates count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CoordinateUnit {
    /// Pixels of the picture that the model works on.
    Pixels,
    /// Parts of the picture's sides, 0 to 1.
    Fraction,
    /// The same, 0 to 100.
    Percent,
    /// The same, 0 to 1000.
    PerMille,
}

impl CoordinateUnit {
    /// Every unit.
    pub const ALL: [CoordinateUnit; 4] = [
        CoordinateUnit::Pixels,
        CoordinateUnit::Fraction,
        CoordinateUnit::Percent,
        CoordinateUnit::PerMille,
    ];

    /// Returns how many digits after the decimal point a coordinate has.
    pub fn decimals(self) -> u32 {
        match self {
            CoordinateUnit::Pixels | CoordinateUnit::PerMille => 0,
            CoordinateUnit::Percent => 1,
            CoordinateUnit::Fraction => 3,
        }
    }
}

/// Which coordinate comes first. Each order has its own brackets, so the two cannot be confused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Order {
    /// `(x, y)`
    Xy,
    /// `[y, x]`
    Yx,
}

impl Order {
    /// Both orders.
    pub const ALL: [Order; 2] = [Order::Xy, Order::Yx];
}

/// A frame of coordinates; sizes are `[width, height]`, pixels, and a side of 0 counts as 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Frame {
    /// What coordinates count.
    pub unit: CoordinateUnit,
    /// Which comes first.
    pub order: Order,
    /// The size of the picture in whose pixels every [`PixelPoint`] is given: the camera's.
    pub size: [u32; 2],
    /// The size of the picture that the model works on: the same, or resized.
    pub sent: [u32; 2],
}

impl Frame {
    /// Returns `(x, y)` in pixels of the camera's picture.
    pub fn pixels(size: [u32; 2]) -> Frame {
        Frame {
            unit: CoordinateUnit::Pixels,
            order: Order::Xy,
            size,
            sent: size,
        }
    }

    /// Returns whether coordinates are pixels of the camera's picture, x first.
    pub fn is_native(&self) -> bool {
        self.order == Order::Xy && self.counts_own_pixels()
    }

    /// Writes a pixel, e.g. `(41, 167)`, `(0.185, 0.748)` or `[748, 185]`.
    pub fn write(&self, point: PixelPoint) -> String {
        self.write_to(point, self.unit.decimals())
    }

    /// Returns the position that coordinates mean: `[column, row]` of the camera's picture, pixels. The centre of
    /// pixel `(u, v)` is `[u + 0.5, v + 0.5]`.
    pub fn read(&self, x: f64, y: f64) -> [f64; 2] {
        [self.along(x, 0), self.along(y, 1)]
    }

    /// Returns the pixel that coordinates mean.
    pub fn pixel(&self, x: f64, y: f64) -> PixelPoint {
        if self.counts_own_pixels() {
            return PixelPoint::new(x.round() as i32, y.round() as i32);
        }
        let [u, v] = [(x, 0), (y, 1)].map(|(value, axis)| {
            // The far edge still belongs to the picture.
            let is_edge = self.unit != CoordinateUnit::Pixels && value == self.full(axis) as f64;
            let pixel = (self.along(value, axis) + ROUNDED).floor() as i32;
            if is_edge { pixel - 1 } else { pixel }
        });
        PixelPoint::new(u, v)
    }

    /// Returns the position of a pixel's centre in the sent picture: `[column, row]`, edges counted as in
    /// [`Frame::read`].
    pub fn in_sent_picture(&self, point: PixelPoint) -> [f64; 2] {
        let place = |pixel: i32, axis: usize| {
            let scale = f64::from(self.sent[axis].max(1)) / f64::from(self.size[axis].max(1));
            (f64::from(pixel) + 0.5) * scale
        };
        [place(point.u, 0), place(point.v, 1)]
    }

    /// Writes a length of the camera's picture relative to its width; `None` if it stays in pixels.
    pub fn length(&self, px: f64) -> Option<String> {
        let part = px / f64::from(self.size[0].max(1));
        let written = |value: f64, decimals: u32| exact::written(value, decimals as usize);
        let decimals = self.unit.decimals();
        Some(match self.unit {
            CoordinateUnit::Pixels if self.size == self.sent => return None,
            CoordinateUnit::Pixels => format!("{} px", written(part * self.full(0) as f64, 1)),
            CoordinateUnit::Fraction => {
                format!("{} of the picture's width", written(part, decimals))
            }
            CoordinateUnit::Percent => {
                let percent = written(part * 100.0, decimals);
                format!("{percent}% of the picture's width")
            }
            CoordinateUnit::PerMille => {
                let thousandths = written(part * 1000.0, decimals);
                format!("{thousandths} thousandths of the picture's width")
            }
        })
    }

    /// Returns `(x, y)` or `[y, x]`.
    pub(super) fn form(&self) -> &'static str {
        match self.order {
            Order::Xy => "(x, y)",
            Order::Yx => "[y, x]",
        }
    }

    /// Describes what the coordinates count and which comes first.
    pub(super) fn phrase(&self) -> String {
        let form = self.form();
        let sides = match self.order {
            Order::Xy => "the picture's width and height",
            Order::Yx => "the picture's height and width",
        };
        match self.unit {
            CoordinateUnit::Pixels if self.size == self.sent => format!("{form} in pixels"),
            CoordinateUnit::Pixels => {
                let [width, height] = self.sent;
                format!("{form} in pixels of a picture {width} wide and {height} high")
            }
            CoordinateUnit::Fraction => format!("{form} in parts of {sides}, from 0 to 1"),
            CoordinateUnit::Percent => format!("{form} in percent of {sides}"),
            CoordinateUnit::PerMille => format!("{form} in thousandths of {sides}"),
        }
    }

    pub(super) fn counts_own_pixels(&self) -> bool {
        self.unit == CoordinateUnit::Pixels && self.size == self.sent
    }

    /// Writes a pixel with this many digits after the decimal point.
    pub(super) fn write_to(&self, point: PixelPoint, decimals: u32) -> String {
        let [x, y] = self
            .scaled(point, decimals)
            .map(|value| digits(value, decimals));
        match self.order {
            Order::Xy => format!("({x}, {y})"),
            Order::Yx => format!("[{y}, {x}]"),
        }
    }

    /// Returns the coordinates x and y of a pixel, times ten to the power of `decimals`, rounded.
    pub(super) fn scaled(&self, point: PixelPoint, decimals: u32) -> [i128; 2] {
        [(point.u, 0), (point.v, 1)].map(|(pixel, axis)| {
            let (side, full) = (i128::from(self.size[axis].max(1)), self.full(axis));
            let scale = 10_i128.pow(decimals);
            // A pixel is written as its number, which is half less than the position of its centre.
            let half = i128::from(self.unit == CoordinateUnit::Pixels);
            let doubled = (2 * i128::from(pixel) + 1) * full * scale - half * scale * side;
            // Halves go down. With as many steps as pixels, each pixel then has its own step.
            ceil_div(doubled - side, 2 * side)
        })
    }

    /// Returns the coordinate of the picture's far edge.
    fn full(&self, axis: usize) -> i128 {
        match self.unit {
            CoordinateUnit::Pixels => i128::from(self.sent[axis].max(1)),
            CoordinateUnit::Fraction => 1,
            CoordinateUnit::Percent => 100,
            CoordinateUnit::PerMille => 1000,
        }
    }

    fn along(&self, value: f64, axis: usize) -> f64 {
        let half = if self.unit == CoordinateUnit::Pixels {
            0.5
        } else {
            0.0
        };
        (value + half) * f64::from(self.size[axis].max(1)) / self.full(axis) as f64
    }
}

fn ceil_div(number: i128, by: i128) -> i128 {
    -(-number).div_euclid(by)
}

/// Writes a number given times ten to the power of `decimals`.
fn digits(scaled: i128, decimals: u32) -> String {
    let sign = if scaled < 0 { "-" } else { "" };
    let (scale, scaled) = (10_u128.pow(decimals), scaled.unsigned_abs());
    let whole = scaled / scale;
    if decimals == 0 {
        return format!("{sign}{whole}");
    }
    let behind = scaled % scale;
    let width = decimals as usize;
    format!("{sign}{whole}.{behind:0width$}")
}
