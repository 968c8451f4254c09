//! `fabc new` in a build without the simulator: drafts and draws nothing.

use super::staging::Staging;
use super::{Draft, NewFoldArguments};
use crate::exit::Failure;
use crate::io::Io;
use clap::Args;
use fab_program::{Program, Subgoals};
use std::path::PathBuf;

/// The verbs to suggest next.
pub const NEXT: [&str; 3] = ["check", "render", "test"];

/// Nothing: pictures need the simulator.
#[derive(Args)]
pub struct PictureArguments {}

/// Drafts nothing.
pub fn draft(_arguments: &NewFoldArguments, _io: &Io) -> Result<Option<Draft>, Failure> {
    Ok(None)
}

/// Stands for subgoal pictures that are not drawn.
pub struct Drawn;

impl Drawn {
    /// Reports that a demonstration is not drawn.
    pub fn of(program: &Program, io: &Io) -> Result<Drawn, Failure> {
        if let Some(Subgoals::Demonstrate { .. }) = program.subgoals {
            io.talk(
                "note: no subgoal pictures are drawn, since this build of fabc has no simulator",
            );
        }
        Ok(Drawn)
    }

    /// Writes nothing.
    pub fn stage(
        &self,
        _program: &Program,
        _staging: &mut Staging,
    ) -> Result<Vec<PathBuf>, Failure> {
        Ok(Vec::new())
    }
}
