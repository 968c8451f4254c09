//! Drafts a fold from pictures: the cloth, and for each step the arrow and the fold that leads from one picture to the
//! next.
//!
//! In: pictures of a cloth on a plain table, flat at first and then after each step; a world to try folds in. Out: a
//! [`Draft`] that says of each step how well it explains the pictures and what else might. Arrows that are drawn
//! in the pictures are found. Where there is none, the folds between named points of the cloth are tried from the
//! cloth as the steps before left it, and the one is proposed whose outline is the picture's. What follows for a task's
//! text is decided elsewhere.

mod shown;
mod symmetry;
mod tries;

pub use symmetry::symmetric;

#[cfg(test)]
mod tests;

use crate::camera::Camera;
use crate::expert::MakeWorld;
use crate::interrupt::Interrupt;
use crate::start::Start;
use crate::subgoals::ArrowPx;
use crate::vision::VisionError;
use crate::world::WorldError;
use compiler::program::{self, Cloth, ClothStart, Fold, ImageUp};
use image::RgbImage;
use shown::{Pose, Shown};
use std::ops::RangeInclusive;
use tries::{State, Step};

/// Pixels that a picture's sides may have.
pub const SIDE_PX: RangeInclusive<u32> = 32..=2048;

/// The most steps.
pub const MAX_STEPS: usize = 100;

/// Side of the pictures in which outlines are compared, pixels: the shipped folding tasks' own.
const COMPARED_PX: u32 = 224;

/// Particles are this far apart, metres, as in every task.
const SPACING_M: f64 = 0.00625;

/// By how much an outline in whole pixels is larger than the cloth, pixels: those that it covers in part count.
const RIM_PX: f64 = 0.7;

/// Growth of the cloth's outline that no fold explains, as a factor; the recorded pictures grow by 1 % at most.
const GROWTH: f64 = 1.08;

/// Overlap of two outlines in a row above which nothing was folded.
const ALIKE: f64 = 0.985;

/// A picture and what messages call it.
#[derive(Clone, Debug)]
pub struct Named {
    /// Its file, as the user named it.
    pub name: String,
    /// The picture.
    pub picture: RgbImage,
}

/// What the pictures were found to show.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The camera that is taken to have taken them: the shipped folding tasks', with the pictures' own side.
    pub camera: program::Camera,
    /// The cloth, flat and straight.
    pub cloth: Cloth,
    /// How far the cloth is turned in the pictures, radians, clockwise, -pi/4 to pi/4.
    pub turned_rad: f64,
    /// The share of the rectangle around the first outline that the cloth covers.
    pub rectangular: f64,
    /// One less than there are pictures.
    pub steps: Vec<DraftStep>,
    /// How far an untouched cloth is from where the folds end, mean over its particles, metres.
    pub untouched_m: f64,
}

/// One step.
#[derive(Clone, Debug, PartialEq)]
pub struct DraftStep {
    /// Where the arrow was found, or would be right; pixels of the pictures.
    pub arrow: ArrowPx,
    /// Whether the picture carries it.
    pub origin: ArrowOrigin,
    /// The fold between points of the cloth; none where a drawn arrow joins no points that have names.
    pub fold: Option<Fold>,
    /// Area of both the simulated outline and the next picture's over the area of either, 0 to 1.
    pub overlap: f64,
    /// The best other fold that was tried, with its overlap.
    pub next_best: Option<(Fold, f64)>,
    /// How much the step changes: the overlap of the outlines before and after it.
    pub unchanged: f64,
}

/// Where a step's arrow comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrowOrigin {
    /// The picture shows it.
    Drawn,
    /// It was worked out from the pictures around the step.
    Proposed,
}

/// Least overlap of a step that is not doubted.
const SURE: f64 = 0.93;
/// Least lead over the next best fold likewise.
const LEAD: f64 = 0.015;

impl DraftStep {
    /// Returns whether the fold explains the pictures, and no other does nearly as well.
    pub fn is_sure(&self) -> bool {
        let leads = self
            .next_best
            .as_ref()
            .is_none_or(|(_, overlap)| self.overlap - overlap >= LEAD);
        self.fold.is_some() && self.overlap >= SURE && (leads || self.origin == ArrowOrigin::Drawn)
    }
}

/// Why pictures cannot be drafted from.
#[derive(Debug, thiserror::Error)]
pub enum DraftError {
    /// There are too few or too many.
    #[error(
        "{found} pictures do not show a fold: right are 2 to {}, the flat cloth first and then one after each step",
        MAX_STEPS + 1
    )]
    Count {
        /// How many there are.
        found: usize,
    },
    /// A picture has a form that no camera of a task has.
    #[error(
        "`{name}` has {} x {} px; right is a square of {} to {} px a side, cut around the cloth or with table added",
        size_px[0], size_px[1], SIDE_PX.start(), SIDE_PX.end()
    )]
    Size {
        /// The picture.
        name: String,
        /// Its width and height, pixels.
        size_px: [u32; 2],
    },
    /// Two pictures have different sizes.
    #[error(
        "`{name}` has {side_px} px a side and `{first}` has {first_px}; right is one size for all, from one place"
    )]
    SizesDiffer {
        /// The picture.
        name: String,
        /// Its side, pixels.
        side_px: u32,
        /// The first picture.
        first: String,
        /// Its side, pixels.
        first_px: u32,
    },
    /// Nothing differs from the table.
    #[error(
        "no cloth is seen on `{name}`: {found_px} of its {all_px} px hang together and differ from the colours at its \
         border; right is a plain table that is seen all round the whole cloth, in a colour unlike the cloth's"
    )]
    NoCloth {
        /// The picture.
        name: String,
        /// Pixels of the largest patch that is no table.
        found_px: usize,
        /// All pixels.
        all_px: usize,
    },
    /// The cloth cannot be what it seems.
    #[error(
        "the cloth on `{name}` measures {:.0} x {:.0} of {side_px} px; right is one that fills an eighth of the \
         picture's side or more, with table all round", sides_px[0], sides_px[1]
    )]
    ClothSize {
        /// The picture.
        name: String,
        /// Both sides, pixels.
        sides_px: [f64; 2],
        /// The picture's side, pixels.
        side_px: u32,
    },
    /// Nothing is folded.
    #[error(
        "`{after}` shows the cloth as `{before}` does (their outlines overlap by {overlap:.3}); right is one picture \
         after each fold"
    )]
    Unchanged {
        /// The picture before.
        before: String,
        /// The picture after.
        after: String,
        /// The overlap of their outlines.
        overlap: f64,
    },
    /// Something is unfolded.
    #[error(
        "`{after}` shows {:.0} % more cloth than `{before}`, and a fold shows less; right is the flat cloth first and \
         then the pictures in the order of the steps", (growth - 1.0) * 100.0
    )]
    Grown {
        /// The picture before.
        before: String,
        /// The picture after.
        after: String,
        /// The factor by which the outline's area grew.
        growth: f64,
    },
    /// No fold between named points is possible there.
    #[error(
        "no fold leads from `{before}` to `{after}`: the part that is gone holds no corner, side middle or quarter \
         point of the cloth; an arrow drawn on `{before}` would say what is meant"
    )]
    NoFold {
        /// The picture before.
        before: String,
        /// The picture after.
        after: String,
    },
    /// A picture cannot be worked on.
    #[error(transparent)]
    Vision(#[from] VisionError),
    /// Folds cannot be tried.
    #[error("folds cannot be tried: {0}")]
    World(#[from] WorldError),
    /// Folds cannot be tried side by side.
    #[error("folds cannot be tried: {0}")]
    Threads(#[from] std::io::Error),
}

/// Returns the camera that pictures of this side are taken to come from.
pub fn camera(side_px: u32) -> program::Camera {
    program::Camera {
        height_m: 0.65,
        fov_rad: std::f64::consts::FRAC_PI_4,
        image_px: side_px,
        up: ImageUp::Y,
    }
}

/// Drafts a fold.
///
/// - `make_world`: makes worlds whose camera is [`compared_camera`].
/// - `announce`: told how many folds are tried for which step, both from 1, before each round.
///
/// The same pictures give the same draft.
pub fn draft(
    pictures: &[Named],
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
    let shown: Vec<Shown> = pictures.iter().map(Shown::of).collect::<Result<_, _>>()?;
    let pose = Pose::of(&shown[0], &pictures[0].name)?;
    let camera = camera(side_px);
    let cloth = cloth_of(&pose, &camera);
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
        let step = Step {
            start: &start,
            before,
            after,
            arrow: now.arrow.map(|arrow| arrow.map(|at| pose.straighten(at))),
            make_world,
            interrupt,
            announce: &|tries| announce(number + 1, tries),
        };
        let Some(found) = step.explain(&state)? else {
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
            unchanged,
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

/// Returns the camera of the worlds in which folds are tried; one size serves pictures of any.
pub fn compared_camera() -> program::Camera {
    camera(COMPARED_PX)
}

fn lens() -> Camera {
    let camera = compared_camera();
    Camera::top_down(camera.height_m, camera.fov_rad, camera.image_px, camera.up)
}

fn common_side(pictures: &[Named]) -> Result<u32, DraftError> {
    let first = &pictures[0];
    for Named { name, picture } in pictures {
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

/// Measures the flat cloth by the camera that is taken for granted.
fn cloth_of(pose: &Pose, camera: &program::Camera) -> Cloth {
    let depth_m = camera.height_m - crate::start::RESTING_HEIGHT_M;
    let px_per_m = camera.px_per_m() * camera.height_m / depth_m;
    let [dimx, dimy] = pose.sides_px.map(|side| {
        let particles = ((side - RIM_PX) / px_per_m / SPACING_M).round() + 1.0;
        particles.clamp(2.0, 200.0) as u32
    });
    Cloth {
        dimx,
        dimy,
        spacing_m: SPACING_M,
        start: ClothStart::Flat,
    }
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
