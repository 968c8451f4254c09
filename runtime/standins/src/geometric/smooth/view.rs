//! Segments an annotated picture of a cloth: which pixels are table, and which face the others show.
//!
//! In: an encoded picture. Out: a [`View`]. The table's colours are taken from the picture's border. Of the rest,
//! pixels with more green than blue are the orange face, those with less the pink one. Dots, rings and boxes drawn over
//! it take the face of their neighbours. A face is darker the steeper it stands.

use fab_picture::hull::Point;
use fab_picture::{Mask, png, regions};
use image::RgbImage;
use std::path::Path;

/// The content of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// No cloth.
    Table,
    /// The orange face.
    Top,
    /// The pink face.
    Under,
}

/// The pixels of a picture; points are `[column, row]` with pixel centres at halves.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    width: usize,
    height: usize,
    faces: Vec<Face>,
    /// Brightness of each pixel; 0 for the table and below drawings.
    levels: Vec<u8>,
    /// Brightness of the upper face and the underside when flat, at least 1.
    flat: [u8; 2],
}

const SIDE_PX: std::ops::RangeInclusive<u32> = 32..=4096;

/// Least excess of red over green or blue in a pixel of the cloth, 8-bit levels; the table is grey.
const LEAST_TINT: i32 = 40;

/// Channels below `DRAWN_LOW` and red from `DRAWN_RED` mark drawings: black, blue, and pure red.
const DRAWN_LOW: i32 = 40;
const DRAWN_RED: i32 = 200;

/// How often drawings are shrunk by a pixel on all sides; the widest dot needs five times.
const MAX_SHRINKS: usize = 12;

impl View {
    /// Decodes a picture; fails with the reason if it cannot be read, or shows no cloth.
    pub fn decode(bytes: &[u8]) -> Result<View, String> {
        let picture = png::decode(bytes, Path::new("the picture"));
        let picture = picture.map_err(|_| "the picture cannot be read")?;
        if !SIDE_PX.contains(&picture.width()) || !SIDE_PX.contains(&picture.height()) {
            return Err(
                "a side of the picture is shorter than 32 or longer than 4096 px".to_owned(),
            );
        }
        View::of(&picture).ok_or_else(|| {
            "I see no cloth in the picture: I find faces with more red than green or blue"
                .to_owned()
        })
    }

    fn of(picture: &RgbImage) -> Option<View> {
        let table = regions::border_colours(&[picture]);
        let seen: Vec<Option<Face>> = picture
            .pixels()
            .map(|pixel| face_of(pixel.0, &table))
            .collect();
        let [width, height] = [picture.width(), picture.height()].map(|side| side as usize);
        let seen = without_edges_of_drawings(&seen, width);
        let (levels, flat) = light(picture, &seen);
        let faces = without_drawings(seen, width);
        let is_seen = faces.iter().any(|&face| face != Face::Table);
        is_seen.then_some(View {
            width,
            height,
            faces,
            levels,
            flat,
        })
    }

    /// Returns the content of a point; outside the picture there is table.
    pub fn at(&self, point: Point) -> Face {
        self.index(point).map_or(Face::Table, |at| self.faces[at])
    }

    /// Returns the pixels of cloth: column and row of their centres, and their face.
    pub fn cloth(&self) -> impl Iterator<Item = (Point, Face)> {
        let pixels = self.faces.iter().enumerate();
        let cloth = pixels.filter(|(_, face)| **face != Face::Table);
        cloth.map(|(at, &face)| {
            let [column, row] = [at % self.width, at / self.width];
            ([column as f64 + 0.5, row as f64 + 0.5], face)
        })
    }

    /// Returns a cloth point's brightness relative to its flat face; `None` if not visible.
    pub fn light(&self, point: Point) -> Option<f64> {
        let at = self.index(point)?;
        let flat = match self.faces[at] {
            Face::Top => self.flat[0],
            Face::Under => self.flat[1],
            Face::Table => return None,
        };
        let level = self.levels[at];
        (level > 0).then(|| (f64::from(level) / f64::from(flat)).min(1.0))
    }

    /// Builds row sums of the cloth, for queries over any half of the picture.
    pub fn counts(&self) -> Counts {
        let mut sums = Vec::with_capacity(self.height * (self.width + 1));
        for row in self.faces.chunks(self.width) {
            let mut sum = 0;
            sums.push(sum);
            sums.extend(row.iter().map(|face| {
                sum += u32::from(*face != Face::Table);
                sum
            }));
        }
        Counts {
            width: self.width,
            sums,
        }
    }

    /// Returns for each pixel the size of its connected patch of one face; 0 for the table.
    pub fn patches(&self) -> Patches {
        let mut sizes = vec![0; self.faces.len()];
        for wanted in [Face::Top, Face::Under] {
            let shows = |column: u32, row: u32| {
                self.faces[row as usize * self.width + column as usize] == wanted
            };
            let set = Mask::from_fn(self.width as u32, self.height as u32, shows);
            for patch in regions::components(&set) {
                for &(column, row) in &patch {
                    sizes[row as usize * self.width + column as usize] = patch.len() as u32;
                }
            }
        }
        Patches(sizes)
    }

    /// Returns the size of the patch at a point; 0 beside the cloth.
    pub fn patch_px(&self, patches: &Patches, point: Point) -> u32 {
        self.index(point).map_or(0, |at| patches.0[at])
    }

    fn index(&self, [column, row]: Point) -> Option<usize> {
        let is_inside =
            (0.0..self.width as f64).contains(&column) && (0.0..self.height as f64).contains(&row);
        is_inside.then(|| row as usize * self.width + column as usize)
    }

    /// Returns the first and last cloth pixel of each row that has any; their convex hull is the cloth's.
    pub fn rim(&self) -> Vec<Point> {
        let is_cloth = |face: &Face| *face != Face::Table;
        let rows = self.faces.chunks(self.width).enumerate();
        let ends = rows.filter_map(|(row, faces)| {
            let first = faces.iter().position(is_cloth)?;
            let last = faces.iter().rposition(is_cloth)?;
            Some([first, last].map(|column| [column as f64 + 0.5, row as f64 + 0.5]))
        });
        ends.flatten().collect()
    }

    /// Returns the middle of the cloth's pixels, and their number, at least one.
    pub fn middle(&self) -> (Point, f64) {
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        for ([column, row], _) in self.cloth() {
            sum = [sum[0] + column, sum[1] + row];
            count += 1.0;
        }
        (sum.map(|total| total / count), count)
    }
}

/// The patch size of each pixel, pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Patches(Vec<u32>);

/// For each pixel, the number of cloth pixels to its left in its row.
#[derive(Clone, Debug, PartialEq)]
pub struct Counts {
    width: usize,
    /// Each row has one more entry than pixels.
    sums: Vec<u32>,
}

impl Counts {
    /// Returns the number of cloth pixels beyond a point; `angle` in radians, clockwise from the picture's right.
    pub fn beyond_px(&self, from: Point, angle: f64) -> f64 {
        let (sin, cos) = angle.sin_cos();
        let width = self.width as f64;
        let rows = self.sums.chunks(self.width + 1).enumerate();
        let beyond = rows.map(|(row, sums)| {
            let down = (row as f64 + 0.5 - from[1]) * sin;
            let total = sums[self.width];
            if cos.abs() < 1e-9 {
                return if down > 0.0 { total } else { 0 };
            }
            // Pixel centres are at halves.
            let limit = from[0] - down / cos - 0.5;
            if cos > 0.0 {
                total - sums[(limit.floor() + 1.0).clamp(0.0, width) as usize]
            } else {
                sums[limit.ceil().clamp(0.0, width) as usize]
            }
        });
        beyond.map(f64::from).sum()
    }
}

/// The share of a face's pixels that may be brighter than flat cloth, one in this many.
const GLARE: usize = 20;

/// Returns the brightness of each cloth pixel, and that of its two faces when flat.
fn light(picture: &RgbImage, seen: &[Option<Face>]) -> (Vec<u8>, [u8; 2]) {
    let shown = || picture.pixels().zip(seen);
    let level = |rgb: [u8; 3]| rgb.into_iter().fold(0, u8::max);
    let flat = |wanted: Face| {
        let mut counts = [0_usize; 256];
        for (pixel, _) in shown().filter(|(_, face)| **face == Some(wanted)) {
            counts[usize::from(level(pixel.0))] += 1;
        }
        let mut brighter = counts.iter().sum::<usize>() / GLARE;
        let levels = (1..=255_u8).rev();
        let mut darker = levels.skip_while(|&level| {
            let here = counts[usize::from(level)];
            let is_glare = here <= brighter;
            brighter = brighter.saturating_sub(here);
            is_glare
        });
        darker.next().unwrap_or(1)
    };
    let levels = shown().map(|(pixel, face)| match face {
        Some(Face::Top | Face::Under) => level(pixel.0),
        Some(Face::Table) | None => 0,
    });
    (levels.collect(), [Face::Top, Face::Under].map(flat))
}

/// Classifies a colour; `None` for drawings.
fn face_of(rgb: [u8; 3], table: &[[f64; 3]]) -> Option<Face> {
    let [red, green, blue] = rgb.map(i32::from);
    let is_dark_or_blue = red < DRAWN_LOW && green < DRAWN_LOW;
    let is_red = red > DRAWN_RED && green < DRAWN_LOW && blue < DRAWN_LOW;
    if is_dark_or_blue || is_red {
        None
    } else if red - blue.min(green) > LEAST_TINT {
        Some(if blue > green { Face::Under } else { Face::Top })
    } else {
        regions::is_table(rgb, table).then_some(Face::Table)
    }
}

/// Counts a pixel beside a drawing as part of it: edges are smooth, and blue mixed with orange would pass for pink.
fn without_edges_of_drawings(seen: &[Option<Face>], width: usize) -> Vec<Option<Face>> {
    let drawn = Mask::from_fn(width as u32, (seen.len() / width) as u32, |column, row| {
        seen[row as usize * width + column as usize].is_none()
    });
    let edges = seen.iter().enumerate().map(|(at, face)| {
        let [column, row] = [at % width, at / width].map(|place| place as u32);
        face.filter(|_| !drawn.touches(column, row))
    });
    edges.collect()
}

/// Fills drawings from their neighbours' majority, from the rim inward.
fn without_drawings(mut seen: Vec<Option<Face>>, width: usize) -> Vec<Face> {
    const FACES: [Face; 3] = [Face::Table, Face::Top, Face::Under];
    for _ in 0..MAX_SHRINKS {
        let before = seen.clone();
        let drawn = (0..before.len()).filter(|&at| before[at].is_none());
        for at in drawn {
            let (column, row) = (at % width, at / width);
            let rows = row.saturating_sub(1)..=(row + 1).min(before.len() / width - 1);
            let columns = column.saturating_sub(1)..=(column + 1).min(width - 1);
            let beside =
                rows.flat_map(|row| columns.clone().map(move |column| row * width + column));
            let known: Vec<Face> = beside.filter_map(|near| before[near]).collect();
            let votes = |face: Face| known.iter().filter(|&&other| other == face).count();
            seen[at] = FACES
                .into_iter()
                .rev()
                .max_by_key(|&face| votes(face))
                .filter(|&face| votes(face) > 0);
        }
        if seen.iter().all(Option::is_some) {
            break;
        }
    }
    seen.into_iter()
        .map(|face| face.unwrap_or(Face::Table))
        .collect()
}
