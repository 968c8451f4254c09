//! Rollouts of a suite on an arm: one after the other, on cloths that are laid for each.
//!
//! In: a bench with an arm. Out: what has ended, what was cut off, and the rollout that failed for the
//! arm's sake or left it otherwise than at rest with an empty hand, after which nothing more is begun. A rollout that was cut off is not gone on with: the table is no longer as
//! it was. Nothing here moves: that is done by the world of each rollout.

use super::lay::Laid;
use super::metric::Metric;
use super::play::{self, Ended, Phase, Played, Stop, Which};
use super::record;
use super::starts::StartPoint;
use super::suite::Suite;
use super::{Bench, BenchError};
use fab_agent::outcome::Outcome;
use fab_arm::log;
use fab_arm::log::{ARM_FILE, RunState};
use fab_program::Program;
use fab_world::About;
use fab_world::start::Start;
use fab_world::{World, WorldError};
use std::path::{Path, PathBuf};

/// The arm on which a suite is carried out.
pub struct OnArm<'a> {
    /// What its world says of itself.
    pub about: About,
    /// How cloths come to lie on its table.
    pub cloths: Cloths,
    /// Makes the world of a rollout; the folder is that of the run, for the arm's journal.
    pub make_world: &'a MakeArmWorld<'a>,
    /// Makes a simulated world in which that alone can be done which the arm reaches: for questions before a rollout.
    pub make_look: &'a super::MakeWorldOf<'a>,
}

/// Makes the world of an arm for a program and a run folder.
pub type MakeArmWorld<'a> =
    dyn Fn(&Program, &Path) -> Result<Box<dyn World>, WorldError> + Sync + 'a;

/// How cloths come to lie on an arm's table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cloths {
    /// The table is simulated, and takes any start.
    Simulated,
    /// A person lays them, and nobody knows their particles.
    ByHand,
}

/// The rollout after which no further one was begun, since it did not end as one does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftArm {
    /// The run folder.
    pub folder: PathBuf,
    /// Whether the arm came to rest with an empty hand, so that a person need not look after it first.
    pub is_clear: bool,
    /// What the rollout said last.
    pub why: String,
}

/// What came of rollouts on an arm.
#[derive(Debug, Default)]
pub(super) struct Done {
    /// Those that have ended, and whether they were found so.
    pub played: Vec<(Played, bool)>,
    /// The folders of those that were cut off.
    pub cut_off: Vec<PathBuf>,
    /// Why no further one was begun, where that was so.
    pub stop: Option<Stop>,
    /// The rollout after which that was so for the arm's sake.
    pub left: Option<LeftArm>,
}

impl Cloths {
    /// Fails where a suite measures what is not known of such cloths.
    pub fn check(self, suite: &Suite) -> Result<(), BenchError> {
        let needs = |metric: &&Metric| metric.needs_particles();
        let metrics = || suite.metrics.iter();
        let unknown = match self {
            Cloths::Simulated => None,
            Cloths::ByHand if metrics().all(|metric| needs(&metric)) => metrics().next(),
            // Without a distance its column would be that of the start, as if nothing had been done.
            Cloths::ByHand => metrics().find(|metric| metric.row().fold_fraction.is_some()),
        };
        match unknown {
            Some(metric) => Err(BenchError::NoParticles {
                metric: metric.row().name,
            }),
            None => Ok(()),
        }
    }
}

/// Returns the start that a person is asked to lay; its positions are those of the flat cloth, and mean nothing.
pub(super) fn by_hand(point: &StartPoint) -> Start {
    Start {
        name: point.in_words(),
        ..Start::flat(&point.cloth)
    }
}

/// Carries rollouts out, until all have ended, or one failed for the arm's sake or left it otherwise than clear.
pub(super) fn play(
    bench: &Bench<'_>,
    laid: &Laid,
    jobs: &[Which],
    progress: &(dyn Fn(Phase, usize, usize) + Sync),
) -> Result<Done, BenchError> {
    for which in jobs {
        let folder = play::folder_of(bench, *which);
        if is_unclear(&folder)? {
            return Err(BenchError::LeftUnclear { folder });
        }
    }
    let mut done = Done::default();
    for (number, which) in jobs.iter().enumerate() {
        let folder = play::folder_of(bench, *which);
        let mut has_failed = false;
        match play::one(bench, laid, *which)? {
            Ended::Played(played, was_found) => {
                has_failed = !was_found && played.rollout.report.outcome == Outcome::WorldFailed;
                done.played.push((*played, was_found));
            }
            Ended::CutOff => done.cut_off.push(folder.clone()),
            Ended::Stopped(stop) => done.stop = Some(stop),
        }
        let is_clear = !is_unclear(&folder)?;
        // A camera that was moved, or an arm that does not answer, would fail the next one alike.
        done.left = (has_failed || !is_clear).then(|| left(&folder, is_clear));
        if done.left.is_some() {
            done.stop.get_or_insert(Stop::ArmLeft);
        }
        if done.stop.is_some() {
            break;
        }
        progress(Phase::Rollouts, number + 1, jobs.len());
    }
    Ok(done)
}

/// Returns whether a rollout was begun in a folder that an arm could not begin in the same way again.
pub(super) fn has_begun(folder: &Path) -> bool {
    let has_moved = std::fs::metadata(folder.join(ARM_FILE)).is_ok_and(|file| file.len() > 0);
    has_moved || record::has_steps(folder)
}

fn left(folder: &Path, is_clear: bool) -> LeftArm {
    let why = record::last_words(folder);
    LeftArm {
        folder: folder.to_owned(),
        is_clear,
        why: why.unwrap_or_else(|| "its journal does not say why".to_owned()),
    }
}

fn is_unclear(folder: &Path) -> Result<bool, BenchError> {
    Ok(log::run_state(folder)? != RunState::Clear)
}
