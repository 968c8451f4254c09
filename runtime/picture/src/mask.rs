//! Sets of pixels of a picture, e.g. those that show cloth.
//!
//! In: a depth image and a depth limit. Out: a [`Mask`], and its centre. An empty mask is an answer, not an error.

use super::{DepthImage, SubpixelPoint};
use fab_program::PixelPoint;
use image::{GrayImage, Luma};

/// A set of pixels of one picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    width: u32,
    height: u32,
    /// Row by row, `width * height` of them.
    inside: Vec<bool>,
}

impl Mask {
    /// Collects the pixels for which `is_inside(column, row)` holds.
    pub fn from_fn(width: u32, height: u32, mut is_inside: impl FnMut(u32, u32) -> bool) -> Self {
        let mut inside = Vec::with_capacity(width as usize * height as usize);
        for row in 0..height {
            inside.extend((0..width).map(|column| is_inside(column, row)));
        }
        Mask {
            width,
            height,
            inside,
        }
    }

    /// Collects these pixels; those outside the picture are ignored.
    pub fn from_pixels(width: u32, height: u32, pixels: &[PixelPoint]) -> Self {
        let mut mask = Mask::from_fn(width, height, |_, _| false);
        for pixel in pixels {
            if let Some(index) = mask.index(*pixel) {
                mask.inside[index] = true;
            }
        }
        mask
    }

    /// Returns the place of a pixel in a list of all, row by row; `None` outside the picture.
    pub(crate) fn index(&self, point: PixelPoint) -> Option<usize> {
        let (column, row) = (u32::try_from(point.u).ok()?, u32::try_from(point.v).ok()?);
        let is_inside = column < self.width && row < self.height;
        is_inside.then_some(row as usize * self.width as usize + column as usize)
    }

    /// Returns the picture's width, pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the picture's height, pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns whether a pixel belongs to the set; pixels outside the picture never do.
    pub fn contains(&self, point: PixelPoint) -> bool {
        self.index(point).is_some_and(|index| self.inside[index])
    }

    /// Returns whether the pixel of a column and a row belongs to the set; pixels outside the picture never do.
    pub fn contains_at(&self, column: u32, row: u32) -> bool {
        self.contains(PixelPoint::new(column as i32, row as i32))
    }

    /// Returns whether a pixel of the set lies in the square around a pixel that reaches this far to each side.
    pub fn is_within(&self, reach_px: u32, column: u32, row: u32) -> bool {
        let near = |at: u32| at.saturating_sub(reach_px)..=at.saturating_add(reach_px);
        near(row).any(|row| near(column).any(|column| self.contains_at(column, row)))
    }

    /// Returns the sides of the picture that the set reaches: a hundredth of the side, so that no stray pixel counts.
    pub fn reached_borders(&self) -> Vec<&'static str> {
        let [right, bottom] = [self.width, self.height].map(|side| side.saturating_sub(1));
        let rows = |column| (0..self.height).filter(move |row| self.contains_at(column, *row));
        let columns = |row| (0..self.width).filter(move |column| self.contains_at(*column, row));
        let sides = [
            ("left", self.height, rows(0).count()),
            ("top", self.width, columns(0).count()),
            ("right", self.height, rows(right).count()),
            ("bottom", self.width, columns(bottom).count()),
        ];
        let reached = sides
            .into_iter()
            .filter(|(_, length, inside)| *inside > 0 && inside * 100 >= *length as usize);
        reached.map(|(name, ..)| name).collect()
    }

    /// Returns whether the set has no pixels.
    pub fn is_empty(&self) -> bool {
        !self.inside.contains(&true)
    }

    /// Returns the number of pixels in the set.
    pub fn area_px(&self) -> usize {
        self.inside.iter().filter(|&&pixel| pixel).count()
    }

    /// Returns the pixel of the set that is nearest to a point, by Euclidean distance.
    ///
    /// Ties go to the topmost pixel, then the leftmost. `None` if the set is empty.
    pub fn nearest(&self, point: PixelPoint) -> Option<PixelPoint> {
        if self.contains(point) {
            return Some(point);
        }
        let off_px = |pixel: &PixelPoint| point.distance_px(*pixel);
        self.pixels().min_by(|a, b| off_px(a).total_cmp(&off_px(b)))
    }

    /// Returns the Euclidean distance from a point to the nearest pixel of the set, pixels.
    ///
    /// Zero on the set, infinite if the set is empty.
    pub fn distance_px(&self, point: PixelPoint) -> f64 {
        self.nearest(point)
            .map_or(f64::INFINITY, |nearest| point.distance_px(nearest))
    }

    /// Returns the pixels of the set, row by row from the top, each row from the left.
    pub fn pixels(&self) -> impl Iterator<Item = PixelPoint> {
        let rows = (0..).zip(self.inside.chunks(self.width.max(1) as usize));
        rows.flat_map(|(row, pixels)| {
            let columns = (0..).zip(pixels).filter(|(_, inside)| **inside);
            columns.map(move |(column, _)| PixelPoint::new(column, row))
        })
    }
}

/// Collects the pixels closer to the camera than `below_m`, metres, exclusive.
///
/// Pixels without a reading are background.
pub fn depth_mask(depth: &DepthImage, below_m: f64) -> Mask {
    Mask::from_fn(depth.width(), depth.height(), |column, row| {
        let reading = depth.get_pixel(column, row).0[0];
        has_reading(reading) && f64::from(reading) < below_m
    })
}

/// Returns the overlap of two sets, the number of places in both over that in either, 0 to 1; 0 if none is in both.
///
/// - `places`: of each place, whether it is in the one set and in the other.
pub fn overlap(places: impl Iterator<Item = (bool, bool)>) -> f64 {
    let (mut both, mut either) = (0_u32, 0_u32);
    for (in_one, in_other) in places {
        both += u32::from(in_one && in_other);
        either += u32::from(in_one || in_other);
    }
    f64::from(both) / f64::from(either.max(1))
}

/// Draws a mask in white (255) on black.
pub fn mask_picture(mask: &Mask) -> GrayImage {
    GrayImage::from_fn(mask.width(), mask.height(), |column, row| {
        Luma([u8::from(mask.contains_at(column, row)) * 255])
    })
}

/// Returns whether a depth is a reading, not one of the values that depth cameras write for "nothing seen".
pub fn has_reading(depth_m: f32) -> bool {
    depth_m.is_finite() && depth_m > 0.0
}

/// Returns the mean of a mask's pixels; `None` if it is empty.
///
/// The pixel is truncated, as in the paper's code (protocol, section 6), so it lies half a pixel up and left of the
/// mean; the exact point is the mean itself.
pub fn centroid(mask: &Mask) -> Option<SubpixelPoint> {
    let sums = mask.pixels().fold([0_u64; 2], |[columns, rows], pixel| {
        [columns + pixel.u as u64, rows + pixel.v as u64]
    });
    let area_px = mask.area_px() as u64;
    (area_px > 0).then(|| SubpixelPoint {
        pixel: PixelPoint::from(sums.map(|sum| (sum / area_px) as i32)),
        at: sums.map(|sum| sum as f64 / area_px as f64 + 0.5),
    })
}
