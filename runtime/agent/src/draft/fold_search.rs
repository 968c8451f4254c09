//! Tries folds between named points of the cloth, and takes the one with the result closest to the next picture.
//!
//! In: the cloth after the previous steps, and the outlines before and after one step. Out: a [`DraftStep`]. Reflecting the
//! outline would be faster but often wrong: a cloth held down by another corner does not fold along the line between
//! the two points, so each fold is simulated.

use super::outline::Outline;
use super::{DraftError, DraftStep};
use crate::subgoals::ArrowPx;
use fab_base::interrupt::Interrupt;
use fab_base::parallel;
use fab_picture::SubpixelPoint;
use fab_picture::camera::Camera;
use fab_picture::depth_mask;
use fab_picture::hull::distance;
use fab_program::{self as program, ClothPoint, Fold};
use fab_world::expert;
use fab_world::expert::MakeWorld;
use fab_world::start::{RESTING_HEIGHT_M, Start};
use fab_world::{Grip, World, WorldError};
use std::thread;

/// How far a picked point may appear from the part that disappeared, pixels.
const GONE_PX: f64 = 5.0;
/// How far a place point may appear from the next outline, pixels.
const BESIDE_PX: f64 = 8.0;
/// How far candidate points may appear from the ends of a drawn arrow, pixels.
const DRAWN_PX: f64 = 12.0;
/// The shortest fold, pixels; tasks refuse shorter ones.
const SHORTEST_PX: f64 = 10.0;
/// Points closer together than this are one point, named by the first, pixels. In the recorded pictures, a corner
/// folded to the center is this far from it.
const SAME_PX: f64 = 8.0;
/// How much better a fold to or from a quarter point must fit than one between main points. In the recorded pictures
/// the right fold is worse by up to 0.01.
const HANDICAP: f64 = 0.03;
/// Folds whose ends are closer than this count as the same alternative, pixels.
const ALIKE_PX: f64 = 10.0;
/// Least distance of a picked point from the next outline, as a share of the largest such distance.
const FAR: f64 = 0.75;
/// The most folds between main points tried for a step without an arrow.
const MOST_MAIN: usize = 16;
/// The most folds to or from quarter points tried for a step without an arrow.
const MOST_QUARTERS: usize = 6;
/// Height above the table from which something counts as cloth, metres; a flat cloth lies at 5 mm.
const CLOTH_M: f64 = 0.004;

/// The positions of the cloth's particles, metres.
pub type Positions = Vec<[f32; 3]>;

/// The search for the fold that explains one step.
pub struct StepSearch<'s> {
    /// The flat cloth.
    pub start: &'s Start,
    /// The outline before the step.
    pub before: &'s Outline,
    /// The outline after it.
    pub after: &'s Outline,
    /// The arrow in the picture, in straightened coordinates.
    pub arrow: Option<ArrowPx>,
    /// Makes worlds for trying folds.
    pub make_world: &'s MakeWorld<'s>,
    /// Those worlds' camera.
    pub camera: &'s program::Camera,
    /// Stops the search.
    pub interrupt: &'s Interrupt,
}

/// A fold to be tried.
struct Candidate {
    fold: Option<Fold>,
    grip: Grip,
    arrow: ArrowPx,
}

impl Candidate {
    /// Returns whether both ends are close to those of another one.
    fn is_near(&self, arrow: &ArrowPx, within_px: f64) -> bool {
        (0..2).all(|end| distance(self.arrow[end], arrow[end]) <= within_px)
    }

    fn handicap(&self) -> f64 {
        let is_quarter = |point: ClothPoint| !main_points().contains(&point);
        let fold = self.fold.as_ref();
        if fold.is_some_and(|fold| is_quarter(fold.pick) || is_quarter(fold.place)) {
            HANDICAP
        } else {
            0.0
        }
    }
}

/// The result of a tried fold.
struct TriedFold<'c> {
    candidate: &'c Candidate,
    overlap: f64,
    positions: Positions,
}

impl StepSearch<'_> {
    /// Finds the fold whose result is closest to the next picture, with its ends in the straightened picture, and the cloth
    /// after it; `None` if no pick or place is possible.
    pub fn explain(
        &self,
        positions: &[[f32; 3]],
    ) -> Result<Option<(DraftStep, Positions)>, DraftError> {
        let world = self.lay(positions)?;
        let candidates = match self.arrow {
            Some(arrow) => self.drawn(arrow, world.as_ref())?,
            None => self.likely(world.as_ref())?,
        };
        let tried = self.try_all(&candidates, positions)?;
        let merit = |tried: &TriedFold| tried.overlap - tried.candidate.handicap();
        let Some(taken) = best(&tried, merit) else {
            return Ok(None);
        };
        let Candidate { fold, arrow, .. } = taken.candidate;
        let others = tried
            .iter()
            .filter(|other| !other.candidate.is_near(arrow, ALIKE_PX));
        let next_best = best(others, |other| other.overlap)
            .and_then(|other| Some((other.candidate.fold.clone()?, other.overlap)));
        let step = DraftStep {
            arrow: *arrow,
            is_drawn: self.arrow.is_some(),
            fold: fold.clone(),
            overlap: taken.overlap,
            next_best,
        };
        Ok(Some((step, taken.positions.clone())))
    }

    fn lens(&self) -> Camera {
        let camera = self.camera;
        Camera::top_down(camera.height_m, camera.fov_rad, camera.image_px, camera.up)
    }

    fn lay(&self, positions: &[[f32; 3]]) -> Result<Box<dyn World>, WorldError> {
        let mut world = (self.make_world)()?;
        world.reset(&Start {
            positions: positions.to_vec(),
            ..self.start.clone()
        })?;
        Ok(world)
    }

    /// Collects the folds that might explain what disappeared.
    ///
    /// Picks are the points farthest from the cloth's new outline; places are covered by the new outline. A stiff-paper
    /// model discards the least likely of the rest.
    fn likely(&self, world: &dyn World) -> Result<Vec<Candidate>, DraftError> {
        let gone = self.before.without(self.after);
        let fits = |[tail, tip]: &ArrowPx| {
            gone.distance_px(SubpixelPoint::at(*tail).pixel) <= GONE_PX
                && self.after.distance_px(*tip) <= BESIDE_PX
                && distance(*tail, *tip) > SHORTEST_PX
        };
        let places = [main_points(), quarter_points()].concat();
        let mut candidates = self.folds(&main_points(), &places, world, &fits)?;
        if candidates.is_empty() {
            candidates = self.folds(&quarter_points(), &places, world, &fits)?;
        }
        let away = |candidate: &Candidate| self.after.distance_px(candidate.arrow[0]);
        let farthest = candidates.iter().map(away).fold(0.0, f64::max);
        candidates.retain(|candidate| away(candidate) >= FAR * farthest);
        let (quarters, main): (Vec<_>, Vec<_>) = candidates
            .into_iter()
            .partition(|candidate| candidate.handicap() > 0.0);
        let likely = [(main, MOST_MAIN), (quarters, MOST_QUARTERS)];
        let likely = likely.map(|(candidates, most)| self.likeliest(candidates, most));
        Ok(likely.into_iter().flatten().collect())
    }

    /// Keeps the candidates for which stiff paper comes closest to the next outline, best first.
    fn likeliest(&self, mut candidates: Vec<Candidate>, most: usize) -> Vec<Candidate> {
        // The sort is stable, so equal folds stay in the order of their points and simple names come first.
        candidates.sort_by_cached_key(|candidate| {
            let share = self.before.folded(candidate.arrow).overlap(self.after);
            // Positive numbers are ordered as their bits.
            std::cmp::Reverse(share.to_bits())
        });
        candidates.truncate(most);
        candidates
    }

    /// Collects the folds that a drawn arrow may mean; the arrow itself if it joins no named points.
    fn drawn(&self, arrow: ArrowPx, world: &dyn World) -> Result<Vec<Candidate>, DraftError> {
        let is_meant = |candidate: &ArrowPx| {
            (0..2).all(|end| distance(candidate[end], arrow[end]) <= DRAWN_PX)
        };
        let points = [main_points(), quarter_points()].concat();
        let named = self.folds(&points, &points, world, &is_meant)?;
        if !named.is_empty() {
            return Ok(named);
        }
        let depth_m = self.camera.height_m - RESTING_HEIGHT_M;
        let lens = self.lens();
        let [pick, place] = arrow.map(|at| lens.world_from_pixel(at, depth_m));
        let unnamed = pick.zip(place).map(|(pick, place)| Candidate {
            fold: None,
            grip: Grip::new(pick, place),
            arrow,
        });
        Ok(unnamed.into_iter().collect())
    }

    /// Collects the folds between points that fit; of those that look the same, the first.
    fn folds(
        &self,
        picks: &[ClothPoint],
        places: &[ClothPoint],
        world: &dyn World,
        fits: &dyn Fn(&ArrowPx) -> bool,
    ) -> Result<Vec<Candidate>, DraftError> {
        let mut candidates: Vec<Candidate> = Vec::new();
        let lens = self.lens();
        let particles = picks.iter().filter(|pick| **pick != ClothPoint::Center);
        for (&pick, &place) in particles.flat_map(|pick| places.iter().map(move |to| (pick, to))) {
            let fold = Fold {
                pick,
                place,
                fraction: 1.0,
            };
            let grip = expert::grip(&fold, self.start, world)?;
            let seen = [grip.pick, grip.place].map(|at| lens.pixel_from_world(at));
            let [Some(tail), Some(tip)] = seen else {
                continue;
            };
            let arrow = [tail, tip];
            let is_known = |other: &Candidate| other.is_near(&arrow, SAME_PX);
            if fits(&arrow) && !candidates.iter().any(is_known) {
                let fold = Some(fold);
                candidates.push(Candidate { fold, grip, arrow });
            }
        }
        Ok(candidates)
    }

    /// Simulates the candidates, each from the same state; those that fail are omitted.
    fn try_all<'c>(
        &self,
        candidates: &'c [Candidate],
        positions: &[[f32; 3]],
    ) -> Result<Vec<TriedFold<'c>>, DraftError> {
        let threads = thread::available_parallelism().map_or(1, usize::from);
        let one = |number: usize| -> Result<Option<Option<TriedFold<'c>>>, DraftError> {
            let candidate = &candidates[number];
            let mut world = self.lay(positions)?;
            match world.act(&candidate.grip.into(), self.interrupt) {
                Ok(_) => {}
                Err(WorldError::Motion { .. }) => return Ok(Some(None)),
                Err(error) => return Err(error.into()),
            }
            let seen = world.observe()?;
            let below_m = self.camera.height_m - CLOTH_M;
            let outline = Outline::whole(depth_mask(&seen.depth_m, below_m));
            let overlap = outline.overlap(self.after);
            Ok(Some(world.particles().map(|positions| TriedFold {
                candidate,
                overlap,
                positions,
            })))
        };
        let tried = parallel::in_parallel(candidates.len(), threads, one, |_| {})?;
        Ok(tried.into_iter().flatten().flatten().collect())
    }
}

/// Returns the highest-rated one, the first of equals.
fn best<'t, 'c: 't>(
    tried: impl IntoIterator<Item = &'t TriedFold<'c>>,
    rate: impl Fn(&TriedFold<'c>) -> f64,
) -> Option<&'t TriedFold<'c>> {
    tried
        .into_iter()
        .reduce(|best, next| if rate(next) > rate(best) { next } else { best })
}

fn particle([right, front]: [f64; 2]) -> ClothPoint {
    ClothPoint::Particle { right, front }
}

/// The main points, which people name: the center, corners, the middles of sides; earlier ones are preferred.
fn main_points() -> Vec<ClothPoint> {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let middles = [[0.0, 0.5], [1.0, 0.5], [0.5, 0.0], [0.5, 1.0]];
    let particles = corners.into_iter().chain(middles).map(particle);
    [ClothPoint::Center].into_iter().chain(particles).collect()
}

/// The other points whose fractions are quarters.
fn quarter_points() -> Vec<ClothPoint> {
    let quarters = [0.0, 0.25, 0.5, 0.75, 1.0];
    let points = quarters
        .iter()
        .flat_map(|right| quarters.map(|front| [*right, front]));
    let is_other = |at: &[f64; 2]| at.iter().any(|part| [0.25, 0.75].contains(part));
    points.filter(is_other).map(particle).collect()
}
