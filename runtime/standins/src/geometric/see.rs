//! Describes a step that pictures show: stage one of a fold.
//!
//! In: a conversation with pictures, of which the last turn's first shows the cloth before a step with the arrow drawn on
//! it. Out: a sentence of `super::instruction`, or what is missing. Colours are not known in advance: the table's are
//! taken from the pictures' borders, cloth is everything else, and the arrow is black.

use super::frame::Frame;
use super::instruction::Instruction;
use super::pictures;
use fab_model::{Message, Speaker};
use fab_picture::arrow;
use fab_picture::camera::center_of;
use fab_picture::hull::{self, Point};
use fab_picture::{Mask, png, regions};
use fab_program::PixelPoint;
use image::RgbImage;
use std::f64::consts::FRAC_PI_4;
use std::path::Path;

/// Least visible cloth, as a fraction of the picture.
const LEAST_CLOTH: f64 = 0.003;

/// How far the ring's centre may be off the cloth's outline, pixels of a 224 px picture: the ring's outer radius of 4,
/// and as much again for an arrow drawn by hand.
const TAIL_SLACK_PX: f64 = 8.0;

/// How far inside the outline a corner is taken, as a fraction of its distance from the middle.
const INWARD: f64 = 0.03;

/// Corners of the rectangle that the cloth misses by this fraction of the short side are mentioned.
const BARE_FROM: f64 = 0.3;

/// How far a point may be from the middle of the picture, where the cloth's center lay at first, and still count as the
/// center, as a fraction of the long side. Folds towards the center may end a tenth of their length early.
const CENTER_WITHIN: f64 = 0.1;

/// Describes the pictures of the last turn that has any; `None` if there are no pictures at all.
pub fn describe(messages: &[Message]) -> Option<String> {
    let users = messages.iter().filter(|it| it.speaker == Speaker::User);
    let shown = users.map(pictures).rfind(|pictures| !pictures.is_empty())?;
    Some(match instruction(&shown) {
        Ok(instruction) => format!(
            "Instructions: {instruction}.\nExplanation: This is where the black arrow on the first picture begins and \
             ends, in the rectangle around the cloth."
        ),
        Err(why) => format!("I cannot describe this step: {why}."),
    })
}

/// Recognises a step from its pictures; points are `[right, up]` from the first one's bottom left corner, pixels.
fn instruction(pictures: &[&[u8]]) -> Result<Instruction, String> {
    let pictures = pictures.iter().map(|bytes| decode(bytes));
    let pictures = pictures.collect::<Result<Vec<_>, _>>()?;
    let first = &pictures[0];
    let [width, height] = [first.width(), first.height()].map(f64::from);
    // Smaller pictures have arrows of the same size, for legibility.
    let scale = (width.max(height) / 224.0).max(1.0);
    let drawn = arrow::find(first, scale);
    let drawn = drawn.map_err(|number| format!("I see {number} on the first picture"))?;
    let table = regions::border_colours(&pictures.iter().collect::<Vec<_>>());
    let cloth = cloth(first, &table, &drawn.stroke)?;
    let up = |[column, row]: Point| [column, height - row];
    // A pixel reaches half a pixel beyond its middle.
    let middles = hull::around(cloth.pixels().map(center_of)).into_iter();
    let corners = middles.flat_map(|[column, row]| {
        let off = [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]];
        off.map(|[right, down]| [column + right, row + down])
    });
    let bare = hull::around(corners.map(up));
    // The ring hides the corner below it, so the arrow's ends count as cloth if they are close to it.
    let is_near = |point: &Point| {
        hull::is_inside(&bare, *point)
            || hull::distance_to_outline(&bare, *point) <= TAIL_SLACK_PX * scale
    };
    let ends = [up(drawn.tail), up(drawn.tip)];
    if !is_near(&ends[0]) {
        return Err("the arrow on the first picture does not start on the cloth".to_owned());
    }
    let outline = hull::around(bare.iter().copied().chain(ends.into_iter().filter(is_near)));
    let fitted = Frame::fit(&outline).ok_or("the cloth has no area")?;
    // The names of headings begin with the one below the picture's right.
    let steps = (fitted.angle() / FRAC_PI_4).round() as i32 + 1;
    let (heading, frame) = match steps.rem_euclid(8) as usize {
        heading @ 0..4 => (heading, fitted),
        behind => (behind - 4, fitted.turned(2)),
    };
    let [pick, place] = ends.map(|point| {
        let off = hull::distance(point, [width / 2.0, height / 2.0]);
        let eighths = |share: f64| (share * 8.0).round().clamp(0.0, 8.0) as u8;
        let is_center = off <= CENTER_WITHIN * frame.long_side();
        (!is_center).then(|| frame.share_of(point).map(eighths))
    });
    if pick == place {
        return Err("the arrow is too short to tell its two ends apart".to_owned());
    }
    Ok(Instruction {
        pick,
        place,
        heading,
        is_long: frame.has_long_sides(),
        bare: frame.corner_gaps(&outline).map(|gap| gap >= BARE_FROM),
    })
}

/// Returns points a little inside the corners of the cloth's convex outline in a picture; fails with the reason.
pub fn corners(picture: &[u8]) -> Result<Vec<PixelPoint>, String> {
    let seen = decode(picture)?;
    let nothing = Mask::from_pixels(seen.width(), seen.height(), &[]);
    let cloth = cloth(&seen, &regions::border_colours(&[&seen]), &nothing)?;
    let outline = hull::around(cloth.pixels().map(center_of));
    let middle = hull::mean(outline.iter().copied());
    let inward = |corner: &Point| {
        [0, 1].map(|axis| (corner[axis] + INWARD * (middle[axis] - corner[axis])) as i32)
    };
    Ok(outline.iter().map(inward).map(PixelPoint::from).collect())
}

fn decode(bytes: &[u8]) -> Result<RgbImage, String> {
    let picture = png::opened(bytes, Path::new("the picture"));
    picture.map_err(|_| "a picture cannot be read".to_owned())
}

/// The pixels of the cloth: the largest patch that is not table, minus the arrow drawn over it.
fn cloth(picture: &RgbImage, table: &[[f64; 3]], stroke: &Mask) -> Result<Mask, String> {
    let (width, height) = picture.dimensions();
    // Include the stroke here, or an arrow across the cloth would cut it in two.
    let patch = Mask::from_fn(width, height, |column, row| {
        stroke.contains_at(column, row)
            || !regions::is_table(picture.get_pixel(column, row).0, table)
    });
    let patches = regions::components(&patch).into_iter();
    let mut largest = patches.max_by_key(Vec::len).unwrap_or_default();
    // A stroke softened by scaling has grey rims that are neither table nor cloth.
    largest.retain(|at| !stroke.is_within(1, at.u as u32, at.v as u32));
    if (largest.len() as f64) < LEAST_CLOTH * f64::from(width) * f64::from(height) {
        return Err("I see no cloth on the picture".to_owned());
    }
    Ok(Mask::from_pixels(width, height, &largest))
}
