//! What a build without simulator and vision can add: texts, for scenes that are already pinned.

use super::scene::{Moment, PinnedScene};
use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::render::page::DisplayMessage;
use crate::verbs::render::shown_without_drawing;
use fab_program::render::{self, Values};
use fab_program::{Picture, Program, Stage};
use std::path::Path;

/// Returns the programs unchanged: this build lays no cloth.
pub fn fitted(_file: &str, programs: Vec<Program>, _io: &Io) -> Result<Vec<Program>, Failure> {
    Ok(programs)
}

/// Takes the place of a camera.
pub struct Camera<'p> {
    program: &'p Program,
    /// Holds the program's file.
    pub folder: &'p Path,
    /// The stream for talk.
    pub io: &'p Io,
}

impl<'p> Camera<'p> {
    /// Makes one for a program; `folder` holds its file.
    pub fn of(program: &'p Program, folder: &'p Path, io: &'p Io) -> Camera<'p> {
        Camera {
            program,
            folder,
            io,
        }
    }

    /// Fails: this build has no camera.
    pub fn scene(&mut self, moment: &Moment, _seen_of: String) -> Result<PinnedScene, Failure> {
        Err(Failure::environment(format!(
            "the scene `{}` of `{}` is not pinned, or is of another cloth, camera or keypoints; this build of fabc has no camera to see it anew",
            moment.name,
            self.program.title()
        )))
    }

    /// Returns the messages of a stage; `None` if they include demonstrations, which this build cannot read.
    pub fn messages(
        &self,
        stage: &Stage,
        values: Values<'_>,
        step: u32,
    ) -> Result<Option<Vec<DisplayMessage>>, Failure> {
        if let Some(demos) = &self.program.demos
            && demos.stage == stage.name
        {
            self.io.talk(&format!(
                "note: `{}` is shown demonstrations in stage {}, which this build of fabc cannot read; its snapshots are not checked",
                self.program.title(),
                stage.name
            ));
            return Ok(None);
        }
        let messages =
            render::messages(self.program, stage, values).map_err(Failure::environment)?;
        Ok(Some(shown_without_drawing(messages, step)))
    }

    /// Returns `None`: this build cannot draw.
    pub fn picture(
        &mut self,
        _moment: &Moment,
        _picture: &Picture,
    ) -> Result<Option<Vec<u8>>, Failure> {
        self.io.talk(&format!(
            "note: a picture of `{}` may have changed, and this build of fabc cannot draw",
            self.program.title()
        ));
        Ok(None)
    }
}
