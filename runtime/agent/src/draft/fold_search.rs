//! Tries folds between named points of the cloth, and takes the one with the result closest to the next picture.
//!
//! In: the cloth after the previous steps, and the outlines before and after one step. Out: a [`FoldMatch`]. Reflecting the
//! outline would be faster but often wrong: a cloth held down by another corner does not fold along the line between
//! the two points, so each fold is simulated.

use super::outline::Outline;
use super::{DraftError, FOUND};
use crate::subgoals::ArrowPx;
use fab_picture::camera::Camera;
use fab_picture::depth_mask;
use fab_world::expert;
use fab_world::expert::MakeWorld;
use fab_world::start::{RESTING_HEIGHT_M, Start};

use fab_base::interrupt::Interrupt;
use fab_base::parallel;
use fab_program::{self as program, ClothPoint, Fold};
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

/// The positions of the cloth's particles.
pub struct State {
    positions: Vec<[f32; 3]>,
}

impl State {
    /// Makes the state of a start.
    pub fn at(start: &Start) -> State {
        State {
            positions: start.positions.clone(),
        }
    }

    /// Returns the mean distance of the particles from their positions in a start, metres.
    pub fn distance_m(&self, start: &Start) -> f64 {
        let distance = |(a, b): (&[f32; 3], &[f32; 3])| {
            let squared = (0..3).map(|axis| f64::from(a[axis] - b[axis]).powi(2));
            squared.sum::<f64>().sqrt()
        };
        let pairs = self.positions.iter().zip(&start.positions);
        pairs.map(distance).sum::<f64>() / self.positions.len().max(1) as f64
    }
}

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
    /// Told how many folds are tried.
    pub announce: &'s (dyn Fn(usize) + Sync),
}

/// A fold and its result.
pub struct FoldMatch {
    /// The fold's ends in the straightened picture.
    pub arrow: ArrowPx,
    /// The fold between named points; `None` if a drawn arrow joins no named points.
    pub fold: Option<Fold>,
    /// Overlap of its outline with the next picture's.
    pub overlap: f64,
    /// The best fold that differs from it.
    pub next_best: Option<(Fold, f64)>,
    /// The cloth after it.
    pub state: State,
}

/// A fold to be tried.
struct Candidate {
    fold: Option<Fold>,
    grip: Grip,
    arrow: ArrowPx,
}

/// The result of a tried fold.
struct TriedFold {
    candidate: usize,
    overlap: f64,
    /// The overlap, less any handicap.
    merit: f64,
    state: State,
}

impl StepSearch<'_> {
    /// Finds the fold whose result is closest to the next picture; `None` if no pick or place is possible.
    pub fn explain(&self, state: &State) -> Result<Option<FoldMatch>, DraftError> {
        let world = self.lay(state)?;
        let candidates = match self.arrow {
            Some(arrow) => self.drawn(arrow, world.as_ref())?,
            None => self.likely(world.as_ref())?,
        };
        let tried = self.try_all(&candidates, state)?;
        let Some(taken) = best(&tried, |tried| tried.merit) else {
            return Ok(None);
        };
        // If the best-rated fold explains nothing, ignore the handicap.
        let taken = match taken.overlap < FOUND {
            true => best(&tried, |tried| tried.overlap).unwrap_or(taken),
            false => taken,
        };
        let Candidate { fold, arrow, .. } = &candidates[taken.candidate];
        let others = tried.iter().filter(|other| {
            let other = &candidates[other.candidate].arrow;
            (0..2).any(|end| distance(other[end], arrow[end]) > ALIKE_PX)
        });
        let next_best = best(others, |other| other.overlap).and_then(|other| {
            let fold = candidates[other.candidate].fold.clone()?;
            Some((fold, other.overlap))
        });
        Ok(Some(FoldMatch {
            arrow: *arrow,
            fold: fold.clone(),
            overlap: taken.overlap,
            next_best,
            state: State {
                positions: taken.state.positions.clone(),
            },
        }))
    }

    fn lens(&self) -> Camera {
        let camera = self.camera;
        Camera::top_down(camera.height_m, camera.fov_rad, camera.image_px, camera.up)
    }

    fn lay(&self, state: &State) -> Result<Box<dyn World>, WorldError> {
        let mut world = (self.make_world)()?;
        world.reset(&Start {
            positions: state.positions.clone(),
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
        let is_gone = |[u, v]: [f64; 2]| {
            let pixel = [u, v].map(|at| at.floor() as i32);
            gone.distance_px(pixel.into()) <= GONE_PX
        };
        let fits = |arrow: &ArrowPx| {
            is_gone(arrow[0])
                && self.after.distance_px(arrow[1]) <= BESIDE_PX
                && distance(arrow[0], arrow[1]) > SHORTEST_PX
        };
        let places = [main_points(), quarter_points()].concat();
        let mut candidates = self.folds(&main_points(), &places, world, &fits)?;
        if candidates.is_empty() {
            candidates = self.folds(&quarter_points(), &places, world, &fits)?;
        }
        let away = |candidate: &Candidate| self.after.distance_px(candidate.arrow[0]);
        let farthest = candidates.iter().map(away).fold(0.0, f64::max);
        candidates.retain(|candidate| away(candidate) >= FAR * farthest);
        let (quarters, main) = candidates
            .into_iter()
            .partition(|candidate| handicap(candidate) > 0.0);
        let mut likely = self.likeliest(main, MOST_MAIN);
        likely.extend(self.likeliest(quarters, MOST_QUARTERS));
        Ok(likely)
    }

    /// Keeps the candidates for which stiff paper comes closest to the next outline, best first.
    fn likeliest(&self, candidates: Vec<Candidate>, most: usize) -> Vec<Candidate> {
        let rate = |candidate: Candidate| {
            let paper = self.before.folded(candidate.arrow);
            (paper.overlap(self.after), candidate)
        };
        let mut rated: Vec<(f64, Candidate)> = candidates.into_iter().map(rate).collect();
        // The sort is stable, so equal folds stay in the order of their points and simple names come first.
        rated.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        rated.truncate(most);
        rated.into_iter().map(|(_, candidate)| candidate).collect()
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
        let grip = pick.zip(place).map(|(pick, place)| Grip::new(pick, place));
        let unnamed = grip.map(|grip| Candidate {
            fold: None,
            grip,
            arrow,
        });
        Ok(unnamed.into_iter().collect())
    }

    fn folds(
        &self,
        picks: &[ClothPoint],
        places: &[ClothPoint],
        world: &dyn World,
        fits: &dyn Fn(&ArrowPx) -> bool,
    ) -> Result<Vec<Candidate>, DraftError> {
        let mut candidates = Vec::new();
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
            if fits(&arrow) {
                let fold = Some(fold);
                add(&mut candidates, Candidate { fold, grip, arrow });
            }
        }
        Ok(candidates)
    }

    /// Simulates the candidates, each from the same state; those that fail are omitted.
    fn try_all(
        &self,
        candidates: &[Candidate],
        state: &State,
    ) -> Result<Vec<TriedFold>, DraftError> {
        let count = candidates.len();
        if count == 0 {
            return Ok(Vec::new());
        }
        (self.announce)(count);
        let threads = thread::available_parallelism().map_or(1, usize::from);
        let one = |candidate: usize| -> Result<Option<Option<TriedFold>>, DraftError> {
            let mut world = self.lay(state)?;
            match world.act(&candidates[candidate].grip.into(), self.interrupt) {
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
                merit: overlap - handicap(&candidates[candidate]),
                state: State { positions },
            })))
        };
        let tried = parallel::in_parallel(count, threads, one, |_| {})?;
        Ok(tried.into_iter().flatten().flatten().collect())
    }
}

/// Returns the highest-rated one, the first of equals.
fn best<'t>(
    tried: impl IntoIterator<Item = &'t TriedFold>,
    rate: impl Fn(&TriedFold) -> f64,
) -> Option<&'t TriedFold> {
    tried
        .into_iter()
        .reduce(|best, next| match rate(next) > rate(best) {
            true => next,
            false => best,
        })
}

fn handicap(candidate: &Candidate) -> f64 {
    let is_quarter = |point: ClothPoint| !main_points().contains(&point);
    let fold = candidate.fold.as_ref();
    match fold.is_some_and(|fold| is_quarter(fold.pick) || is_quarter(fold.place)) {
        true => HANDICAP,
        false => 0.0,
    }
}

/// Adds a fold unless one that looks the same is already there.
fn add(candidates: &mut Vec<Candidate>, candidate: Candidate) {
    let is_same = |other: &Candidate| {
        (0..2).all(|end| distance(other.arrow[end], candidate.arrow[end]) <= SAME_PX)
    };
    if !candidates.iter().any(is_same) {
        candidates.push(candidate);
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
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
