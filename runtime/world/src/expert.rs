//! Executes declared folds by the cloth's own particles, and caches the resulting states.
//!
//! In: a program's fold sequences, a start, a world. Out: end states to score against. These folds
//! read particle positions that no camera shows (protocol, section 6), so they only score rollouts.

use crate::start::{Grid, RESTING_HEIGHT_M, Start};
use crate::{Grip, World, WorldError, WorldPoint};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_base::parallel::in_parallel;
use fab_program::{ClothPoint, Fold, Manner, Sequence};
use std::thread;

/// Makes a fresh world, equal to every other one that it makes.
pub type MakeWorld<'a> = dyn Fn() -> Result<Box<dyn World>, WorldError> + Sync + 'a;

/// Fold sequences, and how the gripper goes about each fold.
#[derive(Clone, Copy, Debug)]
pub struct Sequences<'a> {
    /// In the program's order.
    pub folds: &'a [Sequence],
    /// What the task states.
    pub manner: Manner,
}

/// The end state of one sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpertEnd {
    /// Index of the sequence in the program.
    pub sequence: usize,
    /// `[dimy * dimx]` positions, world frame, metres.
    pub positions: Vec<[f32; 3]>,
}

/// End states, and how they were had.
#[derive(Clone, Debug)]
pub struct ExpertEnds {
    /// In the program's order.
    pub ends: Vec<ExpertEnd>,
    /// Name of the world that they come from.
    pub world: String,
    /// How many had to be simulated; the others came from the cache.
    pub simulated: usize,
    /// Why a result could not be kept, where that happened.
    pub not_kept: Option<String>,
}

/// Returns the end state of every sequence, from the cache or by simulating it on all cores.
///
/// `announce` is told how many must be simulated, before it begins.
pub fn ends(
    sequences: Sequences<'_>,
    start: &Start,
    make_world: &MakeWorld<'_>,
    cache: &Cache,
    interrupt: &Interrupt,
    announce: &mut dyn FnMut(usize),
) -> Result<ExpertEnds, WorldError> {
    let world = make_world()?;
    let keys: Vec<String> = sequences
        .folds
        .iter()
        .map(|sequence| key(sequence, sequences.manner, start, world.as_ref()))
        .collect();
    let mut known: Vec<Option<Vec<[f32; 3]>>> = keys
        .iter()
        .map(|key| cache.positions(key, start.positions.len()))
        .collect();
    let missing: Vec<usize> = (0..known.len())
        .filter(|&index| known[index].is_none())
        .collect();
    let mut not_kept = None;
    if !missing.is_empty() {
        announce(missing.len());
        let threads = thread::available_parallelism().map_or(1, usize::from);
        let simulated = in_parallel::<_, WorldError>(
            missing.len(),
            threads,
            |index| {
                let number = missing[index];
                let (folds, manner) = (&sequences.folds[number], sequences.manner);
                let positions = end_of(folds, manner, start, make_world, interrupt)?;
                // Kept at once, so that a stop loses at most what is under way.
                let lost = cache.put_positions(&keys[number], &positions).err();
                Ok(Some((positions, lost)))
            },
            |_| {},
        )?;
        for (&index, (positions, lost)) in missing.iter().zip(simulated.into_iter().flatten()) {
            not_kept = lost.or(not_kept);
            known[index] = Some(positions);
        }
    }
    let ends = known.into_iter().enumerate();
    let ends = ends
        .filter_map(|(sequence, positions)| {
            Some(ExpertEnd {
                sequence,
                positions: positions?,
            })
        })
        .collect();
    Ok(ExpertEnds {
        ends,
        world: world.name().to_owned(),
        simulated: missing.len(),
        not_kept,
    })
}

fn end_of(
    sequence: &Sequence,
    manner: Manner,
    start: &Start,
    make_world: &MakeWorld<'_>,
    interrupt: &Interrupt,
) -> Result<Vec<[f32; 3]>, WorldError> {
    let mut world = make_world()?;
    world.reset(start)?;
    for fold in &sequence.folds {
        let grip = grip(fold, start, world.as_ref())?;
        world.act(&grip.with_manner(manner).into(), interrupt)?;
    }
    world.particles().ok_or_else(no_particles)
}

/// Returns where a fold picks and places in a world, in the world's own manner; fails in one that does not know its particles.
pub fn grip(fold: &Fold, start: &Start, world: &dyn World) -> Result<Grip, WorldError> {
    let particles = world.particles().ok_or_else(no_particles)?;
    grip_of(fold, start, &particles).ok_or_else(no_particles)
}

/// Returns where a fold picks and places, given where the cloth's particles are now; none where one is missing.
///
/// `place = pick + fraction * (target - pick)`; the centre is that of the start, on the table.
pub fn grip_of(fold: &Fold, start: &Start, particles: &[[f32; 3]]) -> Option<Grip> {
    let locate = |point: &ClothPoint| match *point {
        ClothPoint::Particle { right, front } => {
            let [x, y, z] = *particles.get(particle_index(start.grid, right, front))?;
            Some(WorldPoint::new(f64::from(x), f64::from(y), f64::from(z)))
        }
        ClothPoint::Center => {
            let [x, y] = start.center_m();
            Some(WorldPoint::new(x, y, RESTING_HEIGHT_M))
        }
    };
    let pick = locate(&fold.pick)?;
    let target = locate(&fold.place)?;
    Some(Grip::new(pick, pick + (target - pick) * fold.fraction))
}

/// Returns the index of the particle at a place in the flat cloth; edge middles round down, as in
/// the recorded demonstrations.
fn particle_index(grid: Grid, right: f64, front: f64) -> usize {
    let along = |fraction: f64, count: u32| {
        (fraction.clamp(0.0, 1.0) * f64::from(count - 1)).floor() as usize
    };
    along(front, grid.dimy) * grid.dimx as usize + along(right, grid.dimx)
}

fn no_particles() -> WorldError {
    WorldError::Motion {
        why: "this world does not know where the cloth's particles are".to_owned(),
    }
}

/// Covers everything that an end state depends on, the code that computes it included.
fn key(sequence: &Sequence, manner: Manner, start: &Start, world: &dyn World) -> String {
    Cache::key([
        "expert end state, format 1",
        &world.parameters(),
        &world.code(),
        &start.digest(),
        &serde_json::to_string(&(sequence, manner)).expect("a sequence holds finite numbers"),
        include_str!("expert.rs"),
        include_str!("start/mod.rs"),
        include_str!("simulated.rs"),
    ])
}

#[cfg(test)]
#[path = "tests/expert.rs"]
mod tests;
