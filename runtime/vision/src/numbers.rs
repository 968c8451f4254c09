//! Small legible numbers beside points, placed so that they cover no point.
//!
//! In: a picture and places in it. Out: the same picture with the number of each place beside it, from 1. Digits are
//! white with a black rim, to be legible on cloth and table alike; they grow with the picture.

use image::{Rgb, RgbImage};

/// Rows of a digit, five bits each, the leftmost first.
const DIGITS: [[u8; 7]; 10] = [
    [0x0E, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0E],
    [0x04, 0x0C, 0x04, 0x04, 0x04, 0x04, 0x0E],
    [0x0E, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1F],
    [0x0E, 0x11, 0x01, 0x06, 0x01, 0x11, 0x0E],
    [0x02, 0x06, 0x0A, 0x12, 0x1F, 0x02, 0x02],
    [0x1F, 0x10, 0x1E, 0x01, 0x01, 0x11, 0x0E],
    [0x06, 0x08, 0x10, 0x1E, 0x11, 0x11, 0x0E],
    [0x1F, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08],
    [0x0E, 0x11, 0x11, 0x0E, 0x11, 0x11, 0x0E],
    [0x0E, 0x11, 0x11, 0x0F, 0x01, 0x02, 0x0C],
];

/// Columns and rows of a digit.
const SIZE: [i64; 2] = [5, 7];

/// Pictures of at least this side get digits twice as large, pixels; from twice this side, three times.
const LARGER_FROM_PX: u32 = 400;

/// Width of a digit's black rim; a wider one would close the digits.
const RIM_PX: i64 = 1;

/// How far a number stays from every point, pixels at the smallest digit size.
const CLEAR_PX: i64 = 4;

/// How many rings of places around a point are tried for its number.
const RINGS: i64 = 8;

/// Draws the number of each place, `[column, row]`, beside it; the first is 1.
///
/// A place that is not finite or outside the picture gets no number. If there is no free room, a number may overlap
/// other numbers; it covers no place as long as there is room within `RINGS` rings.
pub fn draw_numbers(picture: &mut RgbImage, places: &[[f64; 2]]) {
    let longest = picture.width().max(picture.height());
    let scale = i64::from((longest / LARGER_FROM_PX).clamp(0, 2) + 1);
    let points: Vec<Option<[i64; 2]>> =
        places.iter().map(|place| inside(*place, picture)).collect();
    let mut drawn: Vec<Area> = Vec::with_capacity(places.len());
    for (point, number) in points.iter().zip(1_usize..) {
        let Some(point) = point else {
            continue;
        };
        let text = number.to_string();
        let area = room(picture, *point, &text, scale, &points, &drawn);
        write(picture, &text, area, scale);
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
    fn around([column, row]: [i64; 2], scale: i64) -> Area {
        let clear = CLEAR_PX * scale;
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
    text: &str,
    scale: i64,
    points: &[Option<[i64; 2]>],
    drawn: &[Area],
) -> Area {
    let n_digits = text.len() as i64;
    // One step of rim around, and one step between two digits.
    let size = [
        (n_digits * (SIZE[0] + 1) + 1) * scale,
        (SIZE[1] + 2) * scale,
    ];
    let covers_none = |area: &Area| {
        let mut known = points.iter().flatten();
        known.all(|point| !area.overlaps(&Area::around(*point, scale)))
    };
    let candidates = || {
        (0..RINGS).flat_map(move |ring| {
            let away = CLEAR_PX * scale + 1 + ring * 3 * scale;
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
        })
    };
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
    let fits = |area: &Area| area.lies_in(picture) && covers_none(area);
    let free_and_clear =
        || candidates().find(|area| fits(area) && is_free(area) && is_nearest_own(area));
    let free = || candidates().find(|area| fits(area) && is_free(area));
    let uncovering = || candidates().find(fits);
    let nearest = || candidates().find(|area| area.lies_in(picture));
    free_and_clear()
        .or_else(free)
        .or_else(uncovering)
        .or_else(nearest)
        .unwrap_or(Area {
            from: [0, 0],
            to: size,
        })
}

fn write(picture: &mut RgbImage, text: &str, area: Area, scale: i64) {
    let [left, top] = area.from;
    // Rims first, so that no digit's rim covers its neighbour.
    for (color, rim) in [(Rgb([0, 0, 0]), RIM_PX), (Rgb([255, 255, 255]), 0)] {
        for (letter, at) in text.bytes().zip(0_i64..) {
            let rows = DIGITS[usize::from(letter - b'0') % DIGITS.len()];
            for (bits, row) in rows.iter().zip(0_i64..) {
                for column in (0..SIZE[0]).filter(|column| bits >> (SIZE[0] - 1 - column) & 1 == 1)
                {
                    let x = left + (1 + at * (SIZE[0] + 1) + column) * scale;
                    let y = top + (1 + row) * scale;
                    fill(
                        picture,
                        [x - rim, y - rim],
                        [x + scale + rim, y + scale + rim],
                        color,
                    );
                }
            }
        }
    }
}

fn fill(picture: &mut RgbImage, from: [i64; 2], to: [i64; 2], color: Rgb<u8>) {
    for y in from[1]..to[1] {
        for x in from[0]..to[0] {
            let at = u32::try_from(x).ok().zip(u32::try_from(y).ok());
            if let Some(pixel) = at.and_then(|(x, y)| picture.get_pixel_mut_checked(x, y)) {
                *pixel = color;
            }
        }
    }
}
