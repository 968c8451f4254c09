//! How one model gets points of a picture: its coordinates, and the size of its pictures.
//!
//! In: the model's properties, as data. Out: the [`Pointing`] of prompts, schema and reader for a camera's picture, and
//! pictures in the size that is sent. `fab_program::pointing` converts coordinates; `fab_vision` draws numbers.

use super::Models;
use fab_program::Program;
use fab_program::pointing::{CoordinateUnit, Frame, Order, Pointing, PointingError};
use image::RgbImage;
use image::imageops::{self, FilterType};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;
use std::num::NonZeroU32;

/// The longest side of a picture that is sent, pixels.
const MAX_SENT_PX: u32 = 8192;

/// How one model gets points of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lowering {
    /// How a point is written.
    pub points: Points,
    /// The unit of coordinates.
    pub unit: CoordinateUnit,
    /// Which coordinate comes first.
    pub order: Order,
    /// Each side of a picture is rounded to the nearest multiple of this before it is sent, as Qwen2.5-VL does with every
    /// picture, so the model works on exactly the pixels that were sent; `None`: it is sent as it is.
    pub multiples_of_px: Option<NonZeroU32>,
}

/// How a point is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Points {
    /// As its coordinates.
    Coordinates,
    /// As a number: the offered points are numbered in prompts and on pictures of the scene.
    Marks,
}

impl Lowering {
    /// The convention of tasks: `(x, y)` in pixels of the camera's picture.
    pub const PIXELS: Lowering = Lowering {
        points: Points::Coordinates,
        unit: CoordinateUnit::Pixels,
        order: Order::Xy,
        multiples_of_px: None,
    };

    /// Returns the size in which a picture is sent; both `[width, height]`, pixels.
    pub fn sent(&self, size: [u32; 2]) -> [u32; 2] {
        let Some(of_px) = self.multiples_of_px else {
            return size;
        };
        let of = of_px.get().min(MAX_SENT_PX);
        size.map(|side| {
            let nearest = (side.min(MAX_SENT_PX) + of / 2) / of * of;
            nearest.clamp(of, MAX_SENT_PX)
        })
    }

    /// Resizes a picture for sending.
    pub fn resized<'p>(&self, picture: &'p RgbImage) -> Cow<'p, RgbImage> {
        let size: [u32; 2] = picture.dimensions().into();
        let [width, height] = self.sent(size);
        if [width, height] == size {
            return Cow::Borrowed(picture);
        }
        let filter = FilterType::Triangle;
        Cow::Owned(imageops::resize(picture, width, height, filter))
    }

    /// Returns how points are written for a camera's picture of this size, `[width, height]`.
    pub fn pointing(&self, size: [u32; 2]) -> Pointing {
        let frame = Frame {
            unit: self.unit,
            order: self.order,
            size,
            sent: self.sent(size),
        };
        match self.points {
            Points::Coordinates => Pointing::Frame(frame),
            Points::Marks => Pointing::Marks(frame),
        }
    }
}

impl Default for Lowering {
    fn default() -> Self {
        Lowering::PIXELS
    }
}

impl fmt::Display for Lowering {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.points {
            Points::Coordinates => {}
            Points::Marks => f.write_str("numbers at ")?,
        }
        f.write_str(match self.order {
            Order::Xy => "x y",
            Order::Yx => "y x",
        })?;
        f.write_str(match self.unit {
            CoordinateUnit::Pixels => ", pixels",
            CoordinateUnit::Fraction => ", 0-1",
            CoordinateUnit::Percent => ", 0-100",
            CoordinateUnit::PerMille => ", 0-1000",
        })?;
        match self.multiples_of_px {
            None => Ok(()),
            Some(of_px) => write!(f, " in multiples of {of_px}"),
        }
    }
}

/// Returns why a task cannot be given to these models, before anything is sent.
pub fn check(program: &Program, models: Models<'_>) -> Result<(), PointingError> {
    program.stages.iter().try_for_each(|stage| {
        let lowering = models.of(stage.model).lowering();
        let pointing = lowering.pointing([program.camera.image_px; 2]);
        pointing.check(program, stage)
    })
}

#[cfg(test)]
#[path = "tests/lowering.rs"]
mod tests;
