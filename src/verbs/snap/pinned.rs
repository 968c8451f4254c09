//! Finds the pinned scenes and their names.

use super::expected::name;
use super::plan::{Plan, Readable};
use super::scene::{Moment, PinnedScene};
use crate::exit::Failure;
use crate::io::Io;
use crate::snapshots::{Contents, Name};
use fab_program::Program;
use std::collections::BTreeSet;

pub fn scene_name(program: &Program, scene: &str) -> Result<Name, Failure> {
    name(program, None, scene, Some(POINTS))
}

/// The last part of the name of a scene's snapshot.
const POINTS: &str = "points";

/// Returns the name of the scene that a snapshot of the task itself pins.
pub fn moment_of<'n>(name: &'n Name, program: &Program) -> Option<&'n str> {
    let rest = name.as_str().strip_prefix(&program.task)?;
    let scene = rest.strip_prefix('@')?.strip_suffix(POINTS)?;
    scene.strip_suffix('.')
}

/// Fails if the requested scene is already pinned in another way, or the task does not reach its step.
pub fn pinned_alike(
    wanted: &Moment,
    pinned: &BTreeSet<Moment>,
    program: &Program,
) -> Result<(), Failure> {
    let words = |moment: &Moment| match moment.start {
        Some(seed) => format!("start {seed}, step {}", moment.step),
        None => format!("the task's own start, step {}", moment.step),
    };
    if wanted.step > program.horizon {
        return Err(Failure::usage(format!(
            "`{}` has {} steps; there is no step {} to pin",
            program.task, program.horizon, wanted.step
        )));
    }
    let other = pinned
        .iter()
        .find(|known| known.name == wanted.name && *known != wanted);
    match other {
        None => Ok(()),
        Some(known) => Err(Failure::usage(format!(
            "the scene `{}` of `{}` is pinned already: {}; choose another name, or remove its `.points.snap`",
            wanted.name,
            program.task,
            words(known)
        ))),
    }
}

/// Reads the scenes pinned under a name: the pending one, which is newer, then the accepted one.
///
/// Fails if a readable snapshot is not a valid scene, since somebody edited it.
pub fn known_scenes(name: &Name, plan: &Plan, io: &Io) -> Result<Vec<PinnedScene>, Failure> {
    let folder = &plan.folder;
    let pending = plan.pending(name).map(|it| (it, folder.pending_path(name)));
    let accepted = match plan.accepted(name, io) {
        Readable::Yes(Some(accepted)) => Some((*accepted, folder.accepted_path(name))),
        Readable::Yes(None) | Readable::No => None,
    };
    let mut scenes = Vec::new();
    for (snapshot, path) in pending.into_iter().chain(accepted) {
        let wrong =
            |why: String| Failure::environment(format!("`{}` is no scene: {why}", path.display()));
        match snapshot.contents {
            Contents::Text(text) => scenes.push(PinnedScene::parse(&text).map_err(wrong)?),
            Contents::Picture(_) => return Err(wrong("it is a picture".to_owned())),
        }
    }
    Ok(scenes)
}
