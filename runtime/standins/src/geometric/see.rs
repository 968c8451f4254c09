//! Analyses two subgoal pictures: the cloth's outline and the arrow of the step between them.
//!
//! In: two encoded pictures, the cloth before a step with the arrow drawn on it and the cloth after it. Out: a
//! [`Sighting`], or an [`Unrecognised`] that says what is missing. Colours are not known in advance: the table's are taken
//! from the pictures' borders, cloth is everything else, and the arrow is black. `super::words` puts folds into words.

use fab_picture::arrow::{self, Arrow, ArrowFault};
use fab_picture::hull::{self, Point};
use fab_picture::png::{self, PictureError};
use fab_picture::{Mask, regions};
use image::RgbImage;
use std::path::Path;

/// The contents of the first picture, checked against the second. Points are `[right, up]` from the picture's bottom
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

/// Why a step cannot be recognised in the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unrecognised {
    /// There are not two pictures.
    #[error(
        "I need two pictures, the cloth before the step and after it, and I was given {n_pictures}"
    )]
    Count {
        /// How many there are.
        n_pictures: usize,
    },
    /// A picture is damaged or of an unknown format.
    #[error("the {0} picture cannot be read")]
    Unreadable(PictureOf),
    /// A picture is too small or too large.
    #[error("a side of the {0} picture is shorter than 32 pixels or longer than 4096")]
    Size(PictureOf),
    /// The pictures have different sizes, so they cannot be compared.
    #[error("the two pictures have different sizes")]
    SizesDiffer,
    /// Everything has the border's colours.
    #[error("I see no cloth on the {0} picture")]
    Cloth(PictureOf),
    /// The first picture has no arrow.
    #[error("I see no arrow on the first picture")]
    Arrow,
    /// The arrow is on the second picture instead.
    #[error("I see no arrow on the first picture but one on the second, as if they were swapped")]
    ArrowOnSecond,
    /// There are several arrows.
    #[error("I see more than one arrow on the first picture")]
    Arrows,
    /// The arrow starts off the cloth.
    #[error("the arrow on the first picture does not start on the cloth")]
    TailBesideCloth,
    /// The second picture shows the cloth unchanged.
    #[error("the second picture shows no change of the cloth")]
    NoChange,
    /// The change contradicts the arrow.
    #[error("the change between the pictures does not fit the arrow, as if they were swapped")]
    Backwards,
}

/// One of the two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureOf {
    /// The cloth before the step.
    First,
    /// The cloth after the step.
    Second,
}

impl std::fmt::Display for PictureOf {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            PictureOf::First => "first",
            PictureOf::Second => "second",
        })
    }
}

const SIDE_PX: std::ops::RangeInclusive<u32> = 32..=4096;

/// Least visible cloth, as a fraction of the picture.
const LEAST_CLOTH: f64 = 0.003;

/// How far the ring's centre may be off the cloth's outline, pixels of a 224 px picture: the ring's outer radius of 4,
/// and as much again for an arrow drawn by hand.
const TAIL_SLACK_PX: f64 = 8.0;

/// Growth of the cloth's visible area that still counts as none; folding never increases it.
const GROWTH: f64 = 1.05;

/// How far a cloth may slide as a whole while a corner of it is folded, pixels of a 224 px picture. What it uncovers
/// along its outline by sliding says nothing about the fold.
const SLIDE_PX: f64 = 3.0;

/// Least fraction of the cloth's area that a step uncovers.
const LEAST_CHANGE: f64 = 0.005;

/// Recognises a step from exactly two pictures.
pub fn see(pictures: &[&[u8]]) -> Result<Sighting, Unrecognised> {
    let [first, second] = pictures else {
        return Err(Unrecognised::Count {
            n_pictures: pictures.len(),
        });
    };
    let first = decode(first, PictureOf::First)?;
    let second = decode(second, PictureOf::Second)?;
    if first.dimensions() != second.dimensions() {
        return Err(Unrecognised::SizesDiffer);
    }
    // Smaller pictures have arrows of the same size, for legibility.
    let scale = (f64::from(first.width().max(first.height())) / 224.0).max(1.0);
    let ink = arrow::near_black(&first);
    let drawn = arrow::find(&ink, scale).map_err(|fault| match fault {
        ArrowFault::Many => Unrecognised::Arrows,
        ArrowFault::None => match arrow::find(&arrow::near_black(&second), scale) {
            Ok(_) => Unrecognised::ArrowOnSecond,
            Err(_) => Unrecognised::Arrow,
        },
    })?;
    let table = regions::border_colours(&[&first, &second]);
    let before =
        cloth(&first, &table, &drawn.stroke).ok_or(Unrecognised::Cloth(PictureOf::First))?;
    let nothing = Mask::from_pixels(second.width(), second.height(), &[]);
    let after = cloth(&second, &table, &nothing).ok_or(Unrecognised::Cloth(PictureOf::Second))?;
    let outline = outline_with_arrow(&before, &drawn, scale)?;
    check_change(&before, &after, &drawn, SLIDE_PX * scale)?;
    let up = |[column, row]: [f64; 2]| [column, f64::from(first.height()) - row];
    Ok(Sighting {
        outline,
        tail: up(drawn.tail),
        tip: up(drawn.tip),
        middle: [first.width(), first.height()].map(|side| f64::from(side) / 2.0),
    })
}

fn decode(bytes: &[u8], which: PictureOf) -> Result<RgbImage, Unrecognised> {
    let picture = png::decode(bytes, Path::new("the picture")).map_err(|error| match error {
        PictureError::TooLarge { .. } => Unrecognised::Size(which),
        _ => Unrecognised::Unreadable(which),
    })?;
    if SIDE_PX.contains(&picture.width()) && SIDE_PX.contains(&picture.height()) {
        Ok(picture)
    } else {
        Err(Unrecognised::Size(which))
    }
}

/// The pixels of the cloth: the largest patch that is not table, minus the arrow drawn over it.
fn cloth(picture: &RgbImage, table: &[[f64; 3]], stroke: &Mask) -> Option<Mask> {
    // Include the stroke here, or an arrow across the cloth would cut it in two.
    let patch = Mask::from_fn(picture.width(), picture.height(), |column, row| {
        stroke.contains_at(column, row)
            || !regions::is_table(picture.get_pixel(column, row).0, table)
    });
    let mut largest = regions::components(&patch)
        .into_iter()
        .max_by_key(Vec::len)?;
    // A stroke softened by scaling has grey rims that are neither table nor cloth.
    largest.retain(|&(column, row)| !stroke.touches(column, row));
    let least = LEAST_CLOTH * f64::from(picture.width()) * f64::from(picture.height());
    if (largest.len() as f64) < least {
        return None;
    }
    Some(Mask::from_pixels(
        picture.width(),
        picture.height(),
        &largest,
    ))
}

/// The cloth's hull. The ring hides the corner below it, so the arrow's ends count as cloth if they are close to it.
fn outline_with_arrow(cloth: &Mask, arrow: &Arrow, scale: f64) -> Result<Vec<Point>, Unrecognised> {
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
        return Err(Unrecognised::TailBesideCloth);
    }
    let ends = [Some(tail), Some(tip).filter(|&tip| is_near(tip))];
    Ok(hull::around(
        bare.iter().copied().chain(ends.into_iter().flatten()),
    ))
}

/// Rejects pairs in which the second picture does not follow from the first by the arrow.
///
/// - `slide_px`: how far the cloth may slide as a whole.
fn check_change(
    before: &Mask,
    after: &Mask,
    arrow: &Arrow,
    slide_px: f64,
) -> Result<(), Unrecognised> {
    let area = before.area_px() as f64;
    let left: Vec<(u32, u32)> = before
        .columns_and_rows()
        .filter(|&(column, row)| !after.contains_at(column, row))
        .collect();
    // The first picture's stroke hides cloth, which must not count as growth.
    let hidden = arrow
        .stroke
        .columns_and_rows()
        .filter(|&(column, row)| after.contains_at(column, row))
        .count();
    if after.area_px() as f64 > (area + 2.0 * hidden as f64) * GROWTH {
        return Err(Unrecognised::Backwards);
    }
    if (left.len() as f64) < area * LEAST_CHANGE {
        return Err(Unrecognised::NoChange);
    }
    let reach_px = slide_px.round() as u32;
    let is_far = |&&(column, row): &&(u32, u32)| !after.is_within(reach_px, column, row);
    let far: Vec<_> = left.iter().filter(is_far).collect();
    let uncovered = if far.is_empty() {
        left.iter().collect()
    } else {
        far
    };
    let n_uncovered = uncovered.len() as f64;
    let sum = uncovered.iter().fold([0.0, 0.0], |[x, y], (column, row)| {
        [x + f64::from(*column), y + f64::from(*row)]
    });
    let middle = sum.map(|it| it / n_uncovered);
    if hull::distance(middle, arrow.tail) < hull::distance(middle, arrow.tip) {
        Ok(())
    } else {
        Err(Unrecognised::Backwards)
    }
}
