//! Drafts a fold from pictures: the cloth, and for each step the arrow and the fold that leads from one picture to the
//! next.
//!
//! In: pictures of a cloth on a plain table, flat at first and then after each step; a world to try folds in. Out: a
//! [`Draft`] that states for each step how well it explains the pictures and what the best alternative is. Arrows drawn
//! in the pictures are detected. If there is none, folds between named points are tried from the cloth's state after
//! the previous steps, and the one whose outline matches the picture is proposed. Writing the task's text is done
//! elsewhere.

mod fault;
mod fold_search;
mod measures;
mod outline;
mod symmetry;

pub use fault::DraftError;
pub use measures::StatedMeasures;
pub use symmetry::symmetric;

#[cfg(test)]
mod tests;

use crate::subgoals::ArrowPx;
use fab_base::interrupt::Interrupt;
use fab_program::{self as program, Cloth, Fold};
use fab_world::start::Start;
use fab_world::{World, WorldError};
use fold_search::{State, StepSearch};
use image::RgbImage;
use outline::{PictureParts, Pose};
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
    /// The share of the rectangle around the first outline that the cloth covers.
    pub rectangular: f64,
    /// One less than there are pictures.
    pub steps: Vec<DraftStep>,
    /// Mean distance between the particles of an untouched cloth and of the final state, metres.
    pub untouched_m: f64,
}

/// One step.
#[derive(Clone, Debug, PartialEq)]
pub struct DraftStep {
    /// The detected or proposed arrow; pixels of the pictures.
    pub arrow: ArrowPx,
    /// Whether it was drawn or proposed.
    pub origin: ArrowOrigin,
    /// The fold between named points; `None` if a drawn arrow joins no named points.
    pub fold: Option<Fold>,
    /// Overlap of the simulated outline and the next picture's: intersection over union, 0 to 1.
    pub overlap: f64,
    /// The best other fold tried, with its overlap.
    pub next_best: Option<(Fold, f64)>,
}

/// The origin of a step's arrow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrowOrigin {
    /// The picture shows it.
    Drawn,
    /// It was derived from the pictures before and after the step.
    Proposed,
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
        self.fold.as_ref().filter(|_| self.overlap >= FOUND)
    }

    /// Returns whether the fold explains the pictures, and no other does nearly as well.
    pub fn is_sure(&self) -> bool {
        let leads = self
            .next_best
            .as_ref()
            .is_none_or(|(_, overlap)| self.overlap - overlap >= LEAD);
        self.fold.is_some() && self.overlap >= SURE && (leads || self.origin == ArrowOrigin::Drawn)
    }
}

/// Makes a fresh world with a camera.
pub type MakeWorld<'a> = dyn Fn(&program::Camera) -> Result<Box<dyn World>, WorldError> + Sync + 'a;

/// Drafts a fold.
///
/// - `stated`: what the user knows about the camera and the cloth.
/// - `announce`: told before each round how many folds are tried for which step, both from 1.
///
/// The same pictures give the same draft.
pub fn draft(
    pictures: &[NamedPicture],
    stated: &StatedMeasures,
    make_world: &MakeWorld<'_>,
    interrupt: &Interrupt,
    announce: &(dyn Fn(usize, usize) + Sync),
) -> Result<Draft, DraftError> {
    if !(2..=MAX_STEPS + 1).contains(&pictures.len()) {
        return Err(DraftError::Count {
            found: pictures.len(),
        });
    }
    let side_px = common_side(pictures)?;
    let shown: Vec<PictureParts> = pictures
        .iter()
        .map(PictureParts::of)
        .collect::<Result<_, _>>()?;
    let pose = Pose::of(&shown[0], &pictures[0].name)?;
    let (camera, cloth) = measures::of(pose.sides_px, side_px, stated)?;
    let compared = program::Camera {
        image_px: COMPARED_PX,
        ..camera
    };
    let outlines: Vec<_> = shown.iter().map(|shown| pose.straight(shown)).collect();
    let start = Start::flat(&cloth);
    let mut state = State::at(&start);
    let mut steps = Vec::with_capacity(pictures.len() - 1);
    let first_of_steps = shown.iter().take(pictures.len() - 1);
    for (number, now) in first_of_steps.enumerate() {
        let [before, after] = [number, number + 1].map(|index| &outlines[index]);
        let names = [number, number + 1].map(|index| pictures[index].name.clone());
        let unchanged = before.overlap(after);
        check_change(before.area(), after.area(), unchanged, &names)?;
        let search = StepSearch {
            start: &start,
            before,
            after,
            arrow: now.arrow.map(|arrow| arrow.map(|at| pose.straighten(at))),
            make_world: &|| make_world(&compared),
            camera: &compared,
            interrupt,
            announce: &|tries| announce(number + 1, tries),
        };
        let Some(found) = search.explain(&state)? else {
            let [before, after] = names;
            return Err(DraftError::NoFold { before, after });
        };
        steps.push(DraftStep {
            arrow: match now.arrow {
                Some(arrow) => arrow,
                None => found.arrow.map(|at| pose.as_shown(at)),
            },
            origin: match now.arrow {
                Some(_) => ArrowOrigin::Drawn,
                None => ArrowOrigin::Proposed,
            },
            fold: found.fold,
            overlap: found.overlap,
            next_best: found.next_best,
        });
        state = found.state;
    }
    Ok(Draft {
        turned_rad: pose.turned_rad,
        rectangular: pose.rectangular,
        untouched_m: state.distance_m(&start),
        camera,
        cloth,
        steps,
    })
}

fn common_side(pictures: &[NamedPicture]) -> Result<u32, DraftError> {
    let first = &pictures[0];
    for NamedPicture { name, picture } in pictures {
        let size_px: [u32; 2] = picture.dimensions().into();
        if size_px[0] != size_px[1] || !SIDE_PX.contains(&size_px[0]) {
            let name = name.clone();
            return Err(DraftError::Size { name, size_px });
        }
        if picture.width() != first.picture.width() {
            return Err(DraftError::SizesDiffer {
                name: name.clone(),
                side_px: picture.width(),
                first: first.name.clone(),
                first_px: first.picture.width(),
            });
        }
    }
    Ok(first.picture.width())
}

fn check_change(
    area_before: usize,
    area_after: usize,
    overlap: f64,
    [before, after]: &[String; 2],
) -> Result<(), DraftError> {
    let (before, after) = (before.clone(), after.clone());
    let growth = area_after as f64 / area_before.max(1) as f64;
    if growth > GROWTH {
        return Err(DraftError::Grown {
            before,
            after,
            growth,
        });
    }
    if overlap > ALIKE {
        return Err(DraftError::Unchanged {
            before,
            after,
            overlap,
        });
    }
    Ok(())
}
