//! `--video`: where a film of the simulated cloth goes, and what became of it.

use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::runtime::setting::{self, worlds::WorldChoice};
use clap::{Args, ValueHint};
use fab_program::Program;
use fab_world::film::{self, Film, FilmPlan, Recorder};
use serde::{Deserialize, Deserializer, Serialize};
use std::path::{Path, PathBuf};

pub const VIDEO_FILE: &str = "video.gif";

/// Whether a run is filmed, and how.
#[derive(Args, Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VideoArguments {
    /// Film the whole motion as an animated GIF; default: video.gif in the run folder. With `--world sim` only.
    #[arg(long, value_name = "FILE.gif", num_args = 0..=1, value_hint = ValueHint::FilePath)]
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "given"
    )]
    pub video: Option<Option<PathBuf>>,
}

/// Reads an option that was given, with or without a value.
fn given<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Option<PathBuf>>, D::Error> {
    Option::deserialize(from).map(Some)
}

impl VideoArguments {
    pub fn is_absent(&self) -> bool {
        *self == VideoArguments::default()
    }

    /// Refuses a video of a world that has no simulated cloth, and a file that cannot be one.
    pub fn check(&self, world: &WorldChoice) -> Result<(), Failure> {
        let Some(file) = &self.video else {
            return Ok(());
        };
        if *world != WorldChoice::Sim {
            return Err(Failure::usage(format!(
                "`--video` films the bundled simulator's cloth, and `--world {world}` has none; use `--world sim`, or leave `--video` out"
            )));
        }
        let path = file.as_deref();
        path.map_or(Ok(()), |path| check_file("--video", path))
    }

    /// Prepares the film of a run; `None` if it is not filmed.
    pub fn recorder(&self, program: &Program, folder: &Path) -> Result<Option<Recorder>, Failure> {
        let Some(file) = &self.video else {
            return Ok(None);
        };
        let motions = program.horizon.saturating_mul(program.actions_per_step());
        Ok(Some(Recorder::new(FilmPlan {
            path: file.clone().unwrap_or_else(|| folder.join(VIDEO_FILE)),
            camera: film::table_camera(&program.camera)?,
            motions,
            max_bytes: film::MAX_BYTES,
        })?))
    }
}

/// Refuses a file that is no GIF by its name, or whose folder is missing, before anything moves.
pub fn check_file(option: &str, path: &Path) -> Result<(), Failure> {
    setting::check_ending(option, path, "gif")?;
    let folder = path.parent().unwrap_or(path);
    if Path::new(".").join(folder).is_dir() {
        return Ok(());
    }
    Err(Failure::environment(format!(
        "cannot write `{}`: there is no folder `{}`",
        path.display(),
        folder.display()
    )))
}

/// Ends the film of a run; a fault is told on stderr, since the run itself is whole without a film.
pub fn finish(recorder: &Recorder, io: &Io) -> Option<Film> {
    recorder.finish().unwrap_or_else(|error| {
        io.talk(&format!("warning: there is no video: {error}"));
        None
    })
}
