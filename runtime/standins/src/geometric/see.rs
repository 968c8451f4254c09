//! Analyses a step's pictures: the cloth's outline, and the arrow on the first one.
//!
//! In: encoded pictures, of which the first shows the cloth before a step with the arrow drawn on it. Out: a
//! [`Sighting`], or what is missing. Colours are not known in advance: the table's are taken from the pictures' borders,
//! cloth is everything else, and the arrow is black. `super::words` puts folds into words.

use fab_picture::arrow::{self, Arrow, ArrowFault};
use fab_picture::hull::{self, Point};
use fab_picture::{Mask, png, regions};
use image::RgbImage;
use std::path::Path;

/// The contents of the first picture. Points are `[right, up]` from the picture's bottom
/// left corner, pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Sighting {
    /// The cloth's convex outline, counter-clockwise.
    pub outline: Vec<Point>,
    /// The arrow's ring: the point that is picked.
    pub tail: Point,
    /// The arrow's head: the point that it is placed on.
    pub tip: Point,
    /// The picture's middle.
    pub middle: Point,
}

const SIDE_PX: std::ops::RangeInclusive<u32> = 32..=4096;

/// Least visible cloth, as a fraction of the picture.
const LEAST_CLOTH: f64 = 0.003;

/// How far the ring's centre may be off the cloth's outline, pixels of a 224 px picture: the ring's outer radius of 4,
/// and as much again for an arrow drawn by hand.
const TAIL_SLACK_PX: f64 = 8.0;

/// Recognises a step from its pictures; the first one shows the arrow. Fails with what is missing.
pub fn see(pictures: &[&[u8]]) -> Result<Sighting, String> {
    let pictures = pictures.iter().map(|bytes| decode(bytes));
    let pictures = pictures.collect::<Result<Vec<_>, _>>()?;
    let first = pictures.first().ok_or("there is no picture")?;
    // Smaller pictures have arrows of the same size, for legibility.
    let scale = (f64::from(first.width().max(first.height())) / 224.0).max(1.0);
    let drawn = arrow::find(&arrow::near_black(first), scale).map_err(|fault| match fault {
        ArrowFault::Many => "I see more than one arrow on the first picture",
        ArrowFault::None => "I see no arrow on the first picture",
    })?;
    let table = regions::border_colours(&pictures.iter().collect::<Vec<_>>());
    let cloth = cloth(first, &table, &drawn.stroke)?;
    let up = |[column, row]: [f64; 2]| [column, f64::from(first.height()) - row];
    Ok(Sighting {
        outline: outline_with_arrow(&cloth, &drawn, scale)?,
        tail: up(drawn.tail),
        tip: up(drawn.tip),
        middle: [first.width(), first.height()].map(|side| f64::from(side) / 2.0),
    })
}

/// Returns the corners of the cloth's convex outline in a picture, `[column, row]`, pixels; fails with the reason.
pub fn outline(picture: &[u8]) -> Result<Vec<Point>, String> {
    let seen = decode(picture)?;
    let nothing = Mask::from_pixels(seen.width(), seen.height(), &[]);
    let cloth = cloth(&seen, &regions::border_colours(&[&seen]), &nothing)?;
    let middles = cloth.pixels().map(fab_picture::camera::center_of);
    Ok(hull::around(middles))
}

fn decode(bytes: &[u8]) -> Result<RgbImage, String> {
    let picture = png::decode(bytes, Path::new("the picture"));
    let picture = picture.map_err(|_| "a picture cannot be read")?;
    if SIDE_PX.contains(&picture.width()) && SIDE_PX.contains(&picture.height()) {
        Ok(picture)
    } else {
        Err("a side of a picture is shorter than 32 pixels or longer than 4096".to_owned())
    }
}

/// The pixels of the cloth: the largest patch that is not table, minus the arrow drawn over it.
fn cloth(picture: &RgbImage, table: &[[f64; 3]], stroke: &Mask) -> Result<Mask, String> {
    let unseen = "I see no cloth on the picture";
    // Include the stroke here, or an arrow across the cloth would cut it in two.
    let patch = Mask::from_fn(picture.width(), picture.height(), |column, row| {
        stroke.contains_at(column, row)
            || !regions::is_table(picture.get_pixel(column, row).0, table)
    });
    let mut largest = regions::components(&patch)
        .into_iter()
        .max_by_key(Vec::len)
        .ok_or(unseen)?;
    // A stroke softened by scaling has grey rims that are neither table nor cloth.
    largest.retain(|&(column, row)| !stroke.touches(column, row));
    let least = LEAST_CLOTH * f64::from(picture.width()) * f64::from(picture.height());
    if (largest.len() as f64) < least {
        return Err(unseen.to_owned());
    }
    Ok(Mask::from_pixels(
        picture.width(),
        picture.height(),
        &largest,
    ))
}

/// The cloth's hull. The ring hides the corner below it, so the arrow's ends count as cloth if they are close to it.
fn outline_with_arrow(cloth: &Mask, arrow: &Arrow, scale: f64) -> Result<Vec<Point>, String> {
    let height = f64::from(cloth.height());
    let up = |[column, row]: [f64; 2]| [column, height - row];
    let rims = (0..cloth.height()).flat_map(|row| {
        let columns = (0..cloth.width()).filter(move |&column| cloth.contains_at(column, row));
        let (least, most) = columns.fold((u32::MAX, 0), |(l, m), c| (l.min(c), m.max(c + 1)));
        [(least, row), (least, row + 1), (most, row), (most, row + 1)]
            .into_iter()
            .filter(move |_| least < most)
    });
    let rim_points = rims.map(|(column, row)| up([f64::from(column), f64::from(row)]));
    let bare = hull::around(rim_points);
    let is_near = |point: Point| {
        hull::is_inside(&bare, point)
            || hull::distance_to_outline(&bare, point) <= TAIL_SLACK_PX * scale
    };
    let (tail, tip) = (up(arrow.tail), up(arrow.tip));
    if !is_near(tail) {
        return Err("the arrow on the first picture does not start on the cloth".to_owned());
    }
    let ends = [Some(tail), Some(tip).filter(|&tip| is_near(tip))];
    Ok(hull::around(
        bare.iter().copied().chain(ends.into_iter().flatten()),
    ))
}
