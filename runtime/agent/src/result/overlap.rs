//! The overlap of two silhouettes after their cloths are aligned.

use fab_picture::Mask;
use fab_program::PixelPoint;
use fab_vision::{Rectangle, VisionError};

/// Rectangles whose sides differ by less than this factor count as squares.
///
/// The outlines of turned squares differ by up to 2 %; the paper's rectangles have sides of 5 to 4.
const SQUARE: f64 = 1.1;

/// Approximate number of samples along the picture's side; more would not change the overlap by a hundredth.
const SAMPLES: u32 = 128;

/// All transforms that bring the cloth of one picture onto the cloth of another by their rectangles.
///
/// A silhouette does not show which corner is which, so a step is right if any of these transforms says so.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    from: Rectangle,
    onto: Rectangle,
    ways: Vec<AxisMap>,
}

/// A symmetry of a rectangle: the axes of one rectangle in those of the other.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AxisMap {
    /// Whether the sides are swapped.
    sides: Sides,
    /// The signs of both axes.
    signs: [f64; 2],
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Sides {
    Kept,
    Exchanged,
}

impl Alignment {
    /// Aligns an unfolded cloth with the unfolded cloth of the subgoal pictures.
    ///
    /// `None` if either is empty. Fails if a mask is larger than a picture may be.
    pub fn of(cloth: &Mask, shown: &Mask) -> Result<Option<Alignment>, VisionError> {
        let (Some(from), Some(onto)) = (
            fab_vision::rectangle_around(cloth)?,
            fab_vision::rectangle_around(shown)?,
        ) else {
            return Ok(None);
        };
        let is_square = |rectangle: &Rectangle| rectangle.sides[0] < SQUARE * rectangle.sides[1];
        let sides: &[Sides] = if is_square(&from) && is_square(&onto) {
            &[Sides::Kept, Sides::Exchanged]
        } else {
            &[Sides::Kept]
        };
        let signs = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
        let ways = sides
            .iter()
            .flat_map(|&sides| signs.map(|signs| AxisMap { sides, signs }));
        Ok(Some(Alignment {
            from,
            onto,
            ways: ways.collect(),
        }))
    }

    /// Maps a point of the subgoal picture to the other one, both `[column, row]`, pixels.
    fn back(&self, way: AxisMap, [column, row]: [f64; 2]) -> [f64; 2] {
        let (from, onto) = (&self.from, &self.onto);
        let off = [column - onto.center[0], row - onto.center[1]];
        let across = |along: [f64; 2]| [-along[1], along[0]];
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let shares = [
            dot(off, onto.along) / onto.sides[0] * way.signs[0],
            dot(off, across(onto.along)) / onto.sides[1] * way.signs[1],
        ];
        let [along, beside] = match way.sides {
            Sides::Kept => shares,
            Sides::Exchanged => [shares[1], shares[0]],
        };
        let (s, t) = (along * from.sides[0], beside * from.sides[1]);
        let side = across(from.along);
        [
            from.center[0] + s * from.along[0] + t * side[0],
            from.center[1] + s * from.along[1] + t * side[1],
        ]
    }
}

/// Returns the intersection over union of two silhouettes, from 0 to 1.
///
/// - `after`: the cloth after a step; `goal`: the cloth of the next subgoal picture.
/// - `alignment`: of the unfolded cloths in the same two kinds of picture. The best of its transforms counts.
///
/// 0 if a silhouette is empty. The work is bounded for any picture size.
pub fn overlap(after: &Mask, goal: &Mask, alignment: &Alignment) -> f64 {
    let shares = alignment.ways.iter().map(|&way| {
        fab_picture::overlap(samples(goal).map(|at| {
            let in_after = after.contains(pixel_at(alignment.back(way, at)));
            (goal.contains(pixel_at(at)), in_after)
        }))
    });
    shares.fold(0.0, f64::max)
}

/// Points on a grid over a picture plus half its width around it, which a turned cloth may reach.
fn samples(picture: &Mask) -> impl Iterator<Item = [f64; 2]> {
    let (width, height) = (picture.width(), picture.height());
    let step = width.max(height).div_ceil(SAMPLES).max(1) as usize;
    let range = move |side: u32| (-i64::from(side / 2)..i64::from(side) * 3 / 2).step_by(step);
    let half = step as f64 / 2.0;
    range(height).flat_map(move |row| {
        range(width).map(move |column| [column as f64 + half, row as f64 + half])
    })
}

fn pixel_at([column, row]: [f64; 2]) -> PixelPoint {
    PixelPoint::new(column.floor() as i32, row.floor() as i32)
}
