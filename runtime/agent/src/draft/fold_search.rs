//! Finds the fold that leads from one picture to the next, by folding.
//!
//! In: the cloth after the previous steps, and the outlines before and after one step. Out: a [`DraftStep`]. Folds between
//! named points that may explain what disappeared are simulated, and the one whose outline is closest to the next picture's
//! is taken. Reflecting the outline alone would often be wrong: a cloth held down by another corner does not fold along the
//! line between the two points.

use super::DraftStep;
use super::outline::Outline;
use crate::error::RunError;
use crate::subgoals::ArrowPx;
use fab_base::interrupt::Interrupt;
use fab_base::parallel;
use fab_picture::camera::Camera;
use fab_picture::depth_mask;
use fab_picture::hull::distance;
use fab_program::{self as program, ClothPoint, Fold};
use fab_world::expert;
use fab_world::expert::MakeWorld;
use fab_world::start::Start;
use fab_world::{Grip, World, WorldError};
use std::cmp::Reverse;
use std::thread;

/// How far a picked point may appear from the part that disappeared, pixels.
const GONE_PX: f64 = 5.0;
/// How far a place point may appear from the next outline, pixels.
const BESIDE_PX: f64 = 8.0;
/// The shortest fold, pixels; tasks refuse shorter ones.
const SHORTEST_PX: f64 = 10.0;
/// Folds whose ends are closer together than this are one fold, named by the first, pixels. In the recorded pictures, a
/// corner folded to the center is this far from it.
const SAME_PX: f64 = 8.0;
/// Folds whose ends are closer together than this are no alternatives to each other, pixels.
const ALIKE_PX: f64 = 10.0;
/// How much better a fold to or from a quarter point must fit than one between points that people name. In the recorded
/// pictures the right fold is worse by up to 0.01.
const HANDICAP: f64 = 0.03;
/// Least distance of a picked point from the next outline, as a share of the largest such distance.
const FAR: f64 = 0.75;
/// The most folds that are simulated for a step.
const MOST: usize = 22;
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
    /// Makes worlds for trying folds.
    pub make_world: &'s MakeWorld<'s>,
    /// Those worlds' camera.
    pub camera: &'s program::Camera,
    /// Stops the search.
    pub interrupt: &'s Interrupt,
}

/// A fold to be tried.
#[derive(Clone)]
struct Candidate {
    fold: Fold,
    grip: Grip,
    arrow: ArrowPx,
}

/// The result of a tried fold.
struct TriedFold {
    candidate: Candidate,
    overlap: f64,
    positions: Positions,
}

impl StepSearch<'_> {
    /// Finds the fold whose result is closest to the next picture, with its ends in the straightened picture, and the cloth
    /// after it; `None` if no pick or place is possible.
    pub fn explain(
        &self,
        positions: &[[f32; 3]],
    ) -> Result<Option<(DraftStep, Positions)>, RunError> {
        let candidates = self.likely(self.lay(positions)?.as_ref())?;
        let mut tried = self.try_all(&candidates, positions)?;
        // The sort is stable: of equals, the simplest name comes first.
        let merit = |it: &TriedFold| it.overlap - handicap(&it.candidate);
        tried.sort_by(|a, b| merit(b).total_cmp(&merit(a)));
        let mut tried = tried.into_iter();
        let Some(taken) = tried.next() else {
            return Ok(None);
        };
        let Candidate { fold, arrow, .. } = taken.candidate;
        let next = tried.find(|other| !are_near(&other.candidate.arrow, &arrow, ALIKE_PX));
        let step = DraftStep {
            arrow,
            fold,
            overlap: taken.overlap,
            next_best: next.map(|next| (next.candidate.fold, next.overlap)),
        };
        Ok(Some((step, taken.positions)))
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
    /// Picks are the points farthest from the cloth's new outline; places are covered by it. Of too many, those stay for
    /// which stiff paper comes closest to the new outline.
    fn likely(&self, world: &dyn World) -> Result<Vec<Candidate>, RunError> {
        let gone = self.before.without(self.after);
        let camera = self.camera;
        let lens = Camera::top_down(camera.height_m, camera.fov_rad, camera.image_px, camera.up);
        let mut candidates: Vec<Candidate> = Vec::new();
        let points = named_points();
        let picks = points.iter().filter(|pick| **pick != ClothPoint::Center);
        for (&pick, &place) in picks.flat_map(|pick| points.iter().map(move |to| (pick, to))) {
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
            let fits = gone.distance_px(tail) <= GONE_PX
                && self.after.distance_px(tip) <= BESIDE_PX
                && distance(tail, tip) > SHORTEST_PX;
            // Of folds that look the same, the first.
            let is_known = |other: &Candidate| are_near(&other.arrow, &arrow, SAME_PX);
            if fits && !candidates.iter().any(is_known) {
                candidates.push(Candidate { fold, grip, arrow });
            }
        }
        // People pick corners and middles; a quarter point is one only where none of these has moved.
        if candidates.iter().any(|it| is_main(it.fold.pick)) {
            candidates.retain(|it| is_main(it.fold.pick));
        }
        let away = |candidate: &Candidate| self.after.distance_px(candidate.arrow[0]);
        let farthest = candidates.iter().map(away).fold(0.0, f64::max);
        candidates.retain(|candidate| away(candidate) >= FAR * farthest);
        candidates.sort_by_cached_key(|candidate| {
            let paper = self.before.folded(candidate.arrow).overlap(self.after);
            // Numbers from 1 on are ordered as their bits.
            Reverse((2.0 + paper - handicap(candidate)).to_bits())
        });
        candidates.truncate(MOST);
        Ok(candidates)
    }

    /// Simulates the candidates, each from the same state; those that fail are omitted.
    fn try_all(
        &self,
        candidates: &[Candidate],
        positions: &[[f32; 3]],
    ) -> Result<Vec<TriedFold>, RunError> {
        let threads = thread::available_parallelism().map_or(1, usize::from);
        let one = |number: usize| -> Result<_, RunError> {
            let candidate = candidates[number].clone();
            let mut world = self.lay(positions)?;
            match world.act(&candidate.grip.into(), self.interrupt) {
                Ok(_) => {}
                Err(WorldError::Motion { .. }) => return Ok(Some(None)),
                Err(error) => return Err(error.into()),
            }
            let seen = world.observe()?;
            let below_m = self.camera.height_m - CLOTH_M;
            let outline = Outline(depth_mask(&seen.depth_m, below_m));
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

/// Returns whether both ends of two arrows are close to each other.
fn are_near(one: &ArrowPx, other: &ArrowPx, within_px: f64) -> bool {
    (0..2).all(|end| distance(one[end], other[end]) <= within_px)
}

fn handicap(candidate: &Candidate) -> f64 {
    let Fold { pick, place, .. } = candidate.fold;
    let is_named = is_main(pick) && is_main(place);
    if is_named { 0.0 } else { HANDICAP }
}

/// Returns whether people have a name for a point: the center, a corner, the middle of a side.
fn is_main(point: ClothPoint) -> bool {
    match point {
        ClothPoint::Center => true,
        ClothPoint::Particle { right, front } => [right, front].iter().all(|at| at % 0.5 == 0.0),
    }
}

/// The points whose fractions are quarters; those with simple names come first, and are preferred.
fn named_points() -> Vec<ClothPoint> {
    let quarters = [0.0, 0.25, 0.5, 0.75, 1.0];
    let grid = quarters.iter().flat_map(|front| {
        quarters.map(|right| ClothPoint::Particle {
            right,
            front: *front,
        })
    });
    let middle = ClothPoint::Particle {
        right: 0.5,
        front: 0.5,
    };
    let grid = grid.filter(|point| *point != middle);
    let mut points: Vec<ClothPoint> = [ClothPoint::Center].into_iter().chain(grid).collect();
    points.sort_by_key(|point| !is_main(*point));
    points
}
