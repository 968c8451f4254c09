//! Small legible numbers beside points, placed so that they cover no point.
//!
//! In: a picture and places in it. Out: the same picture with the number of each place beside it, from 1. Digits have a
//! rim of the opposite brightness, to be legible on cloth and table alike; they grow with the picture.

use super::color::gray_level;
use super::raster::Font;
use image::RgbImage;

const WHITE: [u8; 3] = [255; 3];

/// The longer side of a picture as a multiple of its digits' height, as far as the font has that height.
const SIDE_PER_DIGIT: u32 = 49;

/// Width of a digit's rim, pixels; a wider one would close the digits.
const RIM_PX: i64 = 1;

/// How many rings of places around a point are tried for its number.
const RINGS: i64 = 8;

/// The most numbers; more would cover the picture and take long to place.
const MAX_NUMBERS: usize = 500;

/// Draws the number of each place, `[column, row]`, beside it, white with a black rim; the first is 1.
///
/// A place that is not finite or outside the picture gets no number, nor does any after the 500th. If there is no free
/// room, a number may overlap other numbers; it covers no place as long as there is room within `RINGS` rings.
pub fn draw_numbers(picture: &mut RgbImage, places: &[[f64; 2]]) {
    write_numbers(picture, places, WHITE);
}

/// Draws numbers as [`draw_numbers`] does, in another colour.
pub(super) fn write_numbers(picture: &mut RgbImage, places: &[[f64; 2]], rgb: [u8; 3]) {
    let rim = if gray_level(rgb) < 128 { WHITE } else { [0; 3] };
    let font = Font::of(picture.width().max(picture.height()) / SIDE_PER_DIGIT);
    let points: Vec<Option<[i64; 2]>> = places
        .iter()
        .take(MAX_NUMBERS)
        .map(|place| inside(*place, picture))
        .collect();
    let mut drawn: Vec<Area> = Vec::with_capacity(places.len());
    for (point, number) in points.iter().zip(1_usize..) {
        let Some(point) = point else {
            continue;
        };
        let text = number.to_string();
        let size = [font.width_px(&text), font.capital_px()].map(|side| side + 2 * RIM_PX);
        let area = room(picture, *point, size, &points, &drawn);
        let at = [area.from[0] + RIM_PX, area.to[1] - RIM_PX - 1];
        for (right, down) in
            (-RIM_PX..=RIM_PX).flat_map(|right| (-RIM_PX..=RIM_PX).map(move |down| (right, down)))
        {
            font.write(picture, &text, [at[0] + right, at[1] + down], rim);
        }
        font.write(picture, &text, at, rgb);
        drawn.push(area);
    }
}

/// A rectangle: left, top, and exclusive right and bottom.
#[derive(Clone, Copy)]
struct Area {
    from: [i64; 2],
    to: [i64; 2],
}

impl Area {
    fn overlaps(&self, other: &Area) -> bool {
        (0..2).all(|axis| self.from[axis] < other.to[axis] && other.from[axis] < self.to[axis])
    }

    fn lies_in(&self, picture: &RgbImage) -> bool {
        let size = [picture.width(), picture.height()].map(i64::from);
        (0..2).all(|axis| self.from[axis] >= 0 && self.to[axis] <= size[axis])
    }

    /// Returns the square around a point that no number may touch.
    fn around([column, row]: [i64; 2], clear: i64) -> Area {
        Area {
            from: [column - clear, row - clear],
            to: [column + clear + 1, row + clear + 1],
        }
    }
}

fn inside([column, row]: [f64; 2], picture: &RgbImage) -> Option<[i64; 2]> {
    let (width, height) = (f64::from(picture.width()), f64::from(picture.height()));
    let is_inside = (0.0..width).contains(&column) && (0.0..height).contains(&row);
    is_inside.then_some([column as i64, row as i64])
}

/// Finds room for a number near its point: inside the picture, clear of all points and other numbers, and nearer to its
/// point than to any other, as far as possible.
fn room(
    picture: &RgbImage,
    point: [i64; 2],
    size: [i64; 2],
    points: &[Option<[i64; 2]>],
    drawn: &[Area],
) -> Area {
    let clear = size[1] / 2;
    let covers_none = |area: &Area| {
        let mut known = points.iter().flatten();
        known.all(|point| !area.overlaps(&Area::around(*point, clear)))
    };
    let candidates = (0..RINGS).flat_map(|ring| {
        let away = clear + 1 + ring * size[1] / 4;
        let middle = [point[0] - size[0] / 2, point[1] - size[1] / 2];
        let (right, left) = (point[0] + away, point[0] - away - size[0] + 1);
        let (below, above) = (point[1] + away, point[1] - away - size[1] + 1);
        [
            [right, above],
            [right, below],
            [left, above],
            [left, below],
            [right, middle[1]],
            [left, middle[1]],
            [middle[0], above],
            [middle[0], below],
        ]
        .map(|from| Area {
            from,
            to: [from[0] + size[0], from[1] + size[1]],
        })
    });
    // Twice the distance, squared; the factor keeps it an integer.
    let apart = |area: &Area, point: &[i64; 2]| -> i64 {
        let along = |axis: usize| area.from[axis] + area.to[axis] - 2 * point[axis];
        along(0) * along(0) + along(1) * along(1)
    };
    let is_nearest_own = |area: &Area| {
        let mut others = points.iter().flatten().filter(|other| **other != point);
        others.all(|other| apart(area, &point) < apart(area, other))
    };
    let is_free = |area: &Area| drawn.iter().all(|other| !area.overlaps(other));
    // The worst fault first; of equally good places, the first.
    let faults = |area: &Area| [!covers_none(area), !is_free(area), !is_nearest_own(area)];
    candidates
        .filter(|area| area.lies_in(picture))
        .min_by_key(faults)
        .unwrap_or(Area {
            from: [0, 0],
            to: size,
        })
}
