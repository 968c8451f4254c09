//! A suite's rollouts on an arm: one after the other, with a cloth laid for each.
//!
//! In: a bench with an arm. Out: finished rollouts, interrupted ones, and the rollout that failed because of the arm or
//! did not leave it at rest with an empty hand; after that one nothing more is started. An interrupted rollout is not
//! resumed, because the table has changed. Nothing here moves the arm; each rollout's world does that.

use super::lay_starts::LaidStarts;
use super::play::{self, JobEnd, Played, Progress, StopReason, Which};
use super::starts::StartPoint;
use super::suite::Suite;
use super::{Bench, BenchError, MakeRolloutWorld, record};
use fab_agent::outcome::Outcome;
use fab_arm::journal::{self, ARM_FILE};
use fab_program::Program;
use fab_world::start::Start;
use fab_world::{About, World, WorldError};
use std::path::{Path, PathBuf};

/// The arm that runs a suite.
pub struct OnArm<'a> {
    /// Its world's description.
    pub about: About,
    /// How cloths get onto its table.
    pub cloths: Cloths,
    /// Makes the world of a rollout; the folder is the run's, for the arm's journal.
    pub make_world: &'a MakeRolloutWorld<'a>,
    /// Makes a simulated world with the arm's reach, for questions before a rollout.
    pub make_look: &'a MakeLook<'a>,
}

/// Makes a world from a program alone.
pub type MakeLook<'a> = dyn Fn(&Program) -> Result<Box<dyn World>, WorldError> + Sync + 'a;

/// How cloths get onto an arm's table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cloths {
    /// The table is simulated, and accepts any start.
    Simulated,
    /// A person lays them, and their particles are unknown.
    ByHand,
}

/// The rollout after which the suite stopped, because of how it left the arm.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct ArmStop {
    /// The run folder.
    #[serde(rename = "run_dir")]
    pub folder: PathBuf,
    /// Whether the arm came to rest with an empty hand, so nobody needs to check it first.
    pub is_clear: bool,
    /// The rollout's last message.
    pub why: String,
}

/// The results of rollouts on an arm.
#[derive(Debug, Default)]
pub(super) struct Done {
    /// Finished rollouts, and whether they were already finished before.
    pub played: Vec<(Played, bool)>,
    /// The folders of interrupted rollouts.
    pub cut_off: Vec<PathBuf>,
    /// Why no further rollout was started, if so.
    pub stop: Option<StopReason>,
    /// The rollout that stopped the suite because of the arm.
    pub arm_stop: Option<ArmStop>,
}

impl Cloths {
    /// Fails if a suite measures something unknown for such cloths.
    pub fn check(self, suite: &Suite) -> Result<(), BenchError> {
        let mut metrics = suite.metrics.iter().map(|metric| metric.row());
        let unknown = match self {
            Cloths::Simulated => None,
            Cloths::ByHand if suite.metrics.iter().all(|it| it.needs_particles()) => metrics.next(),
            // Without a distance, its column would show the start's, as if nothing had been done.
            Cloths::ByHand => metrics.find(|row| row.fold_fraction.is_some()),
        };
        unknown.map_or(Ok(()), |row| Err(BenchError::NoParticles(row.name)))
    }
}

/// Returns the start that a person is asked to lay; its positions are placeholders, those of the flat cloth.
pub(super) fn by_hand(point: &StartPoint) -> Start {
    Start {
        name: point.in_words(),
        ..Start::flat(&point.cloth)
    }
}

/// Runs rollouts until all have ended, or one failed because of the arm or left it in an unclear state.
pub(super) fn play(
    bench: &Bench<'_>,
    laid: &LaidStarts,
    jobs: &[Which],
    progress: &Progress<'_>,
) -> Result<Done, BenchError> {
    let mut done = Done::default();
    for (number, which) in jobs.iter().enumerate() {
        let folder = play::folder_of(bench, *which);
        let (mut has_failed, mut is_new) = (false, true);
        match play::one(bench, laid, *which)? {
            JobEnd::Played(played, was_found) => {
                has_failed = !was_found && played.rollout.report.outcome == Outcome::WorldFailed;
                is_new = !was_found;
                done.played.push((*played, was_found));
            }
            JobEnd::CutOff => {
                is_new = false;
                done.cut_off.push(folder.clone());
            }
            JobEnd::Stopped(stop) => done.stop = Some(stop),
        }
        // How an earlier command left the arm is looked at before anything is moved.
        let is_clear = !is_new || journal::run_state(&folder)?.is_clear();
        // A moved camera or an unresponsive arm would make the next rollout fail as well.
        if has_failed || !is_clear {
            let why = record::last_words(&folder);
            let why = why.unwrap_or_else(|| "its journal does not say why".to_owned());
            done.arm_stop = Some(ArmStop {
                folder,
                is_clear,
                why,
            });
            done.stop.get_or_insert(StopReason::Arm);
        }
        if done.stop.is_some() {
            break;
        }
        progress("rollouts finished", number + 1, jobs.len());
    }
    Ok(done)
}

/// Returns whether a folder holds a started rollout that an arm could not start again in the same way.
pub(super) fn has_begun(folder: &Path) -> bool {
    let has_moved = std::fs::metadata(folder.join(ARM_FILE)).is_ok_and(|file| file.len() > 0);
    has_moved || record::has_steps(folder)
}
