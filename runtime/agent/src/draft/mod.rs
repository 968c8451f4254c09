//! Drafts a fold from pictures: the cloth, and for each step the fold that leads from one picture to the next.
//!
//! In: pictures of a cloth on a plain table, flat at first and then after each step; a world to try folds in. Out: a
//! [`Draft`] that states for each step how well it explains the pictures and what the best alternative is. Folds between
//! named points are tried from the cloth's state after the previous steps, and the one whose outline matches the picture
//! is proposed. Writing the task's text is done elsewhere.

mod fold_search;
mod measures;
mod outline;

#[cfg(test)]
mod tests;

use crate::error::RunError;
use crate::subgoals::ArrowPx;
use fab_base::interrupt::Interrupt;
use fab_picture::Mask;
use fab_program::{self as program, Cloth, Fold};
use fab_world::metrics::mean_particle_distance_m;
use fab_world::start::Start;
use fab_world::{World, WorldError};
use fold_search::StepSearch;
use image::RgbImage;
use outline::{Outline, Pose, cloth_of};
use std::ops::RangeInclusive;

/// Permitted sides of a picture, pixels.
pub const SIDE_PX: RangeInclusive<u32> = 32..=2048;

/// The most steps.
pub const MAX_STEPS: usize = 100;

/// Side of the pictures in which outlines are compared, pixels: that of the shipped folding tasks.
const COMPARED_PX: u32 = 224;

/// Growth of the cloth's outline that no fold explains, as a factor; the recorded pictures grow by 1 % at most.
const GROWTH: f64 = 1.08;

/// Overlap of two consecutive outlines above which nothing was folded.
const ALIKE: f64 = 0.985;

/// A picture and its name in messages.
#[derive(Clone, Debug)]
pub struct NamedPicture {
    /// Its file, as the user named it.
    pub name: String,
    /// The picture.
    pub picture: RgbImage,
}

/// What was detected in the pictures.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The camera assumed to have taken them.
    pub camera: program::Camera,
    /// The cloth, flat and straight.
    pub cloth: Cloth,
    /// How far the cloth is turned in the pictures, radians, clockwise, -pi/4 to pi/4.
    pub turned_rad: f64,
    /// One less than there are pictures.
    pub steps: Vec<DraftStep>,
    /// Mean distance between the particles of an untouched cloth and of the final state, metres.
    pub untouched_m: f64,
}

/// One step.
#[derive(Clone, Debug, PartialEq)]
pub struct DraftStep {
    /// The arrow of the fold; pixels of the pictures.
    pub arrow: ArrowPx,
    /// The fold between named points.
    pub fold: Fold,
    /// Overlap of the simulated outline and the next picture's: intersection over union, 0 to 1.
    pub overlap: f64,
    /// The best other fold tried, with its overlap.
    pub next_best: Option<(Fold, f64)>,
}

/// Least overlap of a step whose fold counts as found.
const FOUND: f64 = 0.7;
/// Least overlap of a step that counts as certain.
const SURE: f64 = 0.93;
/// Least lead over the next best fold for a step that counts as certain.
const LEAD: f64 = 0.015;

impl DraftStep {
    /// Returns the fold if it explains the pictures; otherwise [`DraftStep::fold`] is only the best guess.
    pub fn found(&self) -> Option<&Fold> {
        (self.overlap >= FOUND).then_some(&self.fold)
    }

    /// Returns whether the fold explains the pictures, and no other does nearly as well.
    pub fn is_sure(&self) -> bool {
        let next = self.next_best.as_ref().map_or(0.0, |(_, overlap)| *overlap);
        self.overlap >= SURE && self.overlap - next >= LEAD
    }
}

/// Makes a fresh world with a camera.
pub type MakeWorld<'a> = dyn Fn(&program::Camera) -> Result<Box<dyn World>, WorldError> + Sync + 'a;

/// Drafts a fold.
///
/// - `longer_m`: the flat cloth's longer side, metres, if the user stated it.
/// - `announce`: told each step before folds are tried for it, from 1.
///
/// The same pictures give the same draft.
pub fn draft(
    pictures: &[NamedPicture],
    longer_m: Option<f64>,
    make_world: &MakeWorld<'_>,
    interrupt: &Interrupt,
    announce: &dyn Fn(usize),
) -> Result<Draft, RunError> {
    if !(2..=MAX_STEPS + 1).contains(&pictures.len()) {
        let count = fab_base::wording::counted(pictures.len(), "picture");
        let most = MAX_STEPS + 1;
        return Err(RunError::Unfit(format!(
            "{count} given; there must be 2 to {most}, the flat cloth first and then one after each step"
        )));
    }
    let side_px = common_side(pictures)?;
    let shown = pictures.iter().map(cloth_of);
    let shown: Vec<Mask> = shown.collect::<Result<_, _>>()?;
    let pose = Pose::of(&shown[0], &pictures[0].name)?;
    let (camera, cloth) = measures::of(pose.sides_px, side_px, longer_m)?;
    let compared = program::Camera {
        image_px: COMPARED_PX,
        ..camera
    };
    let outlines: Vec<_> = shown.iter().map(|shown| pose.straight(shown)).collect();
    let start = Start::flat(&cloth);
    let mut positions = start.positions.clone();
    let mut steps = Vec::with_capacity(pictures.len() - 1);
    for (number, outlines) in outlines.windows(2).enumerate() {
        let [before, after] = [&outlines[0], &outlines[1]];
        let names = [number, number + 1].map(|index| pictures[index].name.as_str());
        check_change(before, after, names)?;
        announce(number + 1);
        let search = StepSearch {
            start: &start,
            before,
            after,
            make_world: &|| make_world(&compared),
            camera: &compared,
            interrupt,
        };
        let Some((found, folded)) = search.explain(&positions)? else {
            let [before, after] = names;
            return Err(RunError::Failed(format!(
                "no fold leads from `{before}` to `{after}`: the part that is gone holds no corner, side middle or \
                 quarter point of the cloth"
            )));
        };
        let arrow = found.arrow.map(|at| pose.as_shown(at));
        steps.push(DraftStep { arrow, ..found });
        positions = folded;
    }
    Ok(Draft {
        turned_rad: pose.turned_rad,
        untouched_m: mean_particle_distance_m(&positions, &start.positions).unwrap_or(0.0),
        camera,
        cloth,
        steps,
    })
}

fn common_side(pictures: &[NamedPicture]) -> Result<u32, RunError> {
    let side_px = pictures[0].picture.width();
    for NamedPicture { name, picture } in pictures {
        let (width, height) = picture.dimensions();
        if [width, height] != [side_px; 2] || !SIDE_PX.contains(&side_px) {
            return Err(RunError::Failed(format!(
                "`{name}` has {width} x {height} px; it must be a square of {} to {} px a side, as large as the others",
                SIDE_PX.start(),
                SIDE_PX.end()
            )));
        }
    }
    Ok(side_px)
}

/// Makes sure that something was folded, and nothing unfolded.
fn check_change(before: &Outline, after: &Outline, [from, to]: [&str; 2]) -> Result<(), RunError> {
    let [before_px, after_px] = [before, after].map(|outline| outline.0.area_px() as f64);
    let growth = after_px / before_px.max(1.0);
    let overlap = before.overlap(after);
    if growth > GROWTH || overlap > ALIKE {
        return Err(RunError::Failed(format!(
            "`{to}` shows {:.0} % of the cloth of `{from}` (their outlines overlap by {overlap:.3}), but a fold must show \
             less; give the flat cloth first and then one picture after each fold, in their order",
            growth * 100.0
        )));
    }
    Ok(())
}
