//! Tries many motions from one state of a simulated cloth, each on a copy.
//!
//! In: worlds at some state, and motions. Out: for each motion the state and the report that [`World::act`] would have
//! given, bit for bit. Motions that pick at the same point in the same manner share everything up to the lift, which is
//! half of the steps of a pull.

use super::{SimulatedWorld, executed, in_metres, stopped};
use crate::start::Start;
use crate::{Executed, Grip, World, WorldError};
use fab_base::interrupt::Interrupt;
use fab_base::parallel::in_parallel;
pub use fab_sim::Snapshot;
use fab_sim::{Manner, SimError};
use std::collections::BTreeMap;
use std::io;

/// What one motion led to.
#[derive(Clone, Debug, PartialEq)]
pub struct TrialEnd {
    /// What was really done.
    pub executed: Executed,
    /// The cloth afterwards; [`SimulatedWorld::go_to`] goes on from it.
    pub state: Snapshot,
}

/// A motion of the simulator's one gripper, to be tried from the state of a world.
#[derive(Clone, Copy)]
pub struct Trial<'w> {
    /// The world; it stays as it is.
    pub from: &'w SimulatedWorld,
    /// What to do there.
    pub grip: Grip,
}

impl SimulatedWorld {
    /// Returns the cloth's whole state between two actions.
    pub fn state(&self) -> Result<Snapshot, WorldError> {
        Ok(self.cloth()?.snapshot())
    }

    /// Lays a start's cloth in a state that [`SimulatedWorld::state`] or a trial returned for it.
    pub fn go_to(&mut self, start: &Start, state: &Snapshot) -> Result<(), WorldError> {
        self.reset(start)?;
        let cloth = self.cloth.as_mut().ok_or(WorldError::NotReset)?;
        cloth.restore(state).map_err(stopped)
    }
}

/// Tries motions on `threads` threads; results are in the trials' order, and do not depend on the number of threads.
///
/// - `judge`: called with the index of each trial and what came of it, from any thread.
///
/// A raised `interrupt` leaves the trials that had not ended as `None`. Fails with the first motion that the simulator
/// cannot execute, or the first failure of `judge`.
pub fn try_motions<T: Send, E: Send + From<WorldError> + From<io::Error>>(
    trials: &[Trial<'_>],
    threads: usize,
    interrupt: &Interrupt,
    judge: impl Fn(usize, TrialEnd) -> Result<T, E> + Sync,
) -> Result<Vec<Option<T>>, E> {
    let groups = groups(trials, threads);
    let done = in_parallel(
        groups.len(),
        threads,
        |group| try_group(trials, &groups[group], interrupt, &judge),
        |_| {},
    )?;
    let mut all: Vec<Option<T>> = trials.iter().map(|_| None).collect();
    for (index, judged) in done.into_iter().flatten().flatten() {
        all[index] = Some(judged);
    }
    Ok(all)
}

/// Returns the indices of trials that share a lift; no group is so large that other threads would wait for it, and the
/// largest come first, so that threads end at about the same time.
fn groups(trials: &[Trial<'_>], threads: usize) -> Vec<Vec<usize>> {
    let most = trials.len().div_ceil(threads.max(1));
    let mut groups: Vec<Vec<usize>> = Vec::new();
    // The last group of each lift.
    let mut last = BTreeMap::new();
    for (index, trial) in trials.iter().enumerate() {
        let group = last.entry(lift_of(trial)).or_insert(groups.len());
        if groups.get(*group).is_some_and(|group| group.len() >= most) {
            *group = groups.len();
        }
        match groups.get_mut(*group) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    groups
}

/// Tells the lift of a trial by its world and the bits of all that the simulator is told of it.
fn lift_of(trial: &Trial<'_>) -> (*const SimulatedWorld, [u32; 2], [Option<u32>; 4]) {
    let (manner, [pick, _]) = in_metres(&trial.grip);
    let Manner {
        lift_m,
        speed_m_s,
        release_height_m,
        press_m,
    } = manner;
    let manner = [lift_m, speed_m_s, release_height_m, press_m];
    (
        std::ptr::from_ref(trial.from),
        pick.map(f32::to_bits),
        manner.map(|value| value.map(f32::to_bits)),
    )
}

/// Tries the motions of one lift; an interrupt keeps those that had ended, and `None` means that none had.
fn try_group<T, E: From<WorldError>>(
    trials: &[Trial<'_>],
    group: &[usize],
    interrupt: &Interrupt,
    judge: &(impl Fn(usize, TrialEnd) -> Result<T, E> + Sync),
) -> Result<Option<Vec<(usize, T)>>, E> {
    let interrupted = || interrupt.is_raised();
    let first = &trials[group[0]];
    let (manner, [pick, _]) = in_metres(&first.grip);
    let lifted = match first.from.cloth()?.lift(&manner, pick, &interrupted) {
        Err(SimError::Interrupted { .. }) => return Ok(None),
        lifted => lifted.map_err(stopped)?,
    };
    let mut all = Vec::with_capacity(group.len());
    for &index in group {
        let grip = trials[index].grip;
        let (_, [_, place]) = in_metres(&grip);
        let (cloth, done) = match lifted.place(place, &interrupted) {
            Err(SimError::Interrupted { .. }) => break,
            placed => placed.map_err(stopped)?,
        };
        let end = TrialEnd {
            executed: executed(grip, &done),
            state: cloth.snapshot(),
        };
        all.push((index, judge(index, end)?));
    }
    Ok(Some(all))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{WorldPoint, conformance};
    use fab_program::{Cloth, ClothStart, Picker};

    /// A world with a cloth that was pulled once.
    fn pulled() -> (SimulatedWorld, Start) {
        let start = Start::flat(&Cloth {
            dimx: 10,
            dimy: 10,
            spacing_m: 0.00625,
            start: ClothStart::Flat,
            material: None,
        });
        let mut world = fresh();
        world.reset(&start).unwrap();
        let first = grip([-0.028, -0.028], [0.0, 0.01]);
        world.act(&first.into(), &Interrupt::default()).unwrap();
        (world, start)
    }

    fn fresh() -> SimulatedWorld {
        SimulatedWorld::new(&conformance::camera(), Picker::Drop).unwrap()
    }

    fn grip(pick: [f64; 2], place: [f64; 2]) -> Grip {
        let [pick, place] = [pick, place].map(|[x, y]| WorldPoint::new(x, y, 0.005));
        Grip::new(pick, place)
    }

    #[test]
    fn trials_end_as_the_worlds_own_actions_do_on_any_number_of_threads() {
        let (world, start) = pulled();
        let state = world.state().unwrap();
        let grips = [
            grip([0.028, 0.028], [0.06, 0.05]),
            grip([0.028, -0.028], [0.0, 0.0]),
            grip([0.028, 0.028], [0.0, 0.03]),
        ];
        let expected: Vec<TrialEnd> = grips
            .iter()
            .map(|grip| {
                let mut again = fresh();
                again.go_to(&start, &state).unwrap();
                let executed = again.act(&(*grip).into(), &Interrupt::default()).unwrap();
                let state = again.state().unwrap();
                TrialEnd { executed, state }
            })
            .collect();
        let trials = grips.map(|grip| Trial { from: &world, grip });
        for threads in [1, 3] {
            let done = try_motions(&trials, threads, &Interrupt::default(), |_, end| {
                Ok::<_, Failed>(end)
            });
            let done: Vec<TrialEnd> = done.unwrap().into_iter().flatten().collect();
            assert_eq!(done, expected);
        }
        assert_eq!(world.state().unwrap(), state);
        let stopped = Interrupt::default();
        stopped.raise();
        let none = try_motions(&trials, 1, &stopped, |_, _| Ok::<_, Failed>(()));
        assert_eq!(none.unwrap(), [None; 3]);
    }

    #[test]
    fn one_lift_serves_all_trials_that_share_it_up_to_a_threads_part() {
        let (world, _) = pulled();
        let pick = |x| Trial {
            from: &world,
            grip: grip([x, 0.028], [0.06, 0.05]),
        };
        let slow = Trial {
            grip: pick(0.028).grip.with_manner(fab_program::Manner {
                speed_m_s: Some(0.1),
                ..Default::default()
            }),
            ..pick(0.028)
        };
        let trials = [pick(-0.028), pick(0.028), slow, pick(0.028), pick(0.028)];
        assert_eq!(groups(&trials, 1), [vec![1, 3, 4], vec![0], vec![2]]);
        // Of five trials, no thread of three gets more than two.
        assert_eq!(groups(&trials, 3), [vec![1, 3], vec![0], vec![2], vec![4]]);
    }

    #[derive(Debug, thiserror::Error)]
    enum Failed {
        #[error(transparent)]
        World(#[from] WorldError),
        #[error(transparent)]
        Threads(#[from] io::Error),
    }
}
