//! Arguments of `snap`.

use crate::exit::Failure;
use crate::snap::{Moment, USUAL};
use clap::Args;

/// Arguments of `snap`.
#[derive(Args)]
pub struct SnapArguments {
    /// The files whose prompts are pinned.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<String>,
    /// Write nothing; exit 1 where a snapshot differs, waits for review, or belongs to nothing.
    #[arg(long, conflicts_with_all = ["prune", "scene"])]
    pub check: bool,
    /// Remove accepted snapshots of what the files no longer declare.
    #[arg(long)]
    pub prune: bool,
    /// Draw every picture, also where nothing that it is drawn from has changed.
    #[arg(long)]
    pub redraw: bool,
    /// Pin one more scene, under this name; it is kept from then on.
    #[arg(long, value_name = "NAME")]
    pub scene: Option<String>,
    /// How the cloth of that scene lies at first: a seed; default: as the task says.
    #[arg(long, value_name = "SEED", requires = "scene")]
    pub start: Option<u64>,
    /// The step that it is of; steps before are done as demonstrated, or as the stand-in decides.
    #[arg(long, value_name = "N", requires = "scene", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub step: u32,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

impl SnapArguments {
    /// Returns the scene that is to be pinned beside the usual ones.
    pub fn moment(&self) -> Result<Option<Moment>, Failure> {
        let Some(name) = &self.scene else {
            return Ok(None);
        };
        let is_plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
        if name.is_empty() || !name.chars().all(is_plain) {
            return Err(Failure::usage(format!(
                "`--scene {name}` cannot name a scene; use letters, digits and `_`"
            )));
        }
        if USUAL.contains(&name.as_str()) {
            return Err(Failure::usage(format!(
                "the scene `{name}` is always pinned where a task needs it; choose another name"
            )));
        }
        Ok(Some(Moment {
            name: name.clone(),
            start: self.start,
            step: self.step,
        }))
    }
}
