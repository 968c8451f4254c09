//! The subgoal pictures of a new task: drawn before anything is written, pinned together with the rest.

use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::new::staging::Staging;
use crate::verbs::runtime::setting;
use fab_agent::subgoals::{self, SubgoalError, SubgoalSet};
use fab_program::{Program, Subgoals};
use fab_world::WorldError;
use std::path::{Path, PathBuf};

/// The pictures of `demonstrate`, and the world parameters with which they were drawn.
pub struct Drawn(Option<(subgoals::Drawn, String)>);

impl Drawn {
    /// Executes a task's demonstration, if it has one.
    pub fn of(program: &Program, io: &Io) -> Result<Drawn, Failure> {
        if !matches!(program.subgoals, Some(Subgoals::Demonstrate { .. })) {
            return Ok(Drawn(None));
        }
        let interrupt = io.interrupt()?;
        let mut world = setting::world(program).map_err(Failure::environment)?;
        let drawn = SubgoalSet::draw(
            program,
            Path::new(""),
            world.as_mut(),
            &interrupt,
            &mut |_| {},
        );
        match drawn {
            Ok(drawn) => Ok(Drawn(Some((drawn, world.parameters())))),
            Err(SubgoalError::World(WorldError::Interrupted)) => Err(Failure::interrupted()),
            Err(error) => Err(Failure::environment(error)),
        }
    }

    /// Stages the pictures; returns their paths relative to the task.
    pub fn stage(&self, program: &Program, staging: &mut Staging) -> Result<Vec<PathBuf>, Failure> {
        let Some((drawn, parameters)) = &self.0 else {
            return Ok(Vec::new());
        };
        let pinned = drawn
            .pin(program, staging.aside(), parameters)
            .map_err(Failure::environment)?;
        let aside = staging.aside();
        let places = pinned
            .iter()
            .filter_map(|path| path.strip_prefix(aside).ok());
        let places: Vec<PathBuf> = places.map(Path::to_owned).collect();
        if let Some(folder) = places.first().and_then(|path| path.parent()) {
            staging.include(folder);
        }
        Ok(places)
    }
}
