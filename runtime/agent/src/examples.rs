//! The examples shown to a task's stages: the author's pictures, and demonstrations from a file.
//!
//! In: a program and the folder of its file. Out: pictures by path, and questions with their answers by step. An
//! example's question is the task's own, filled with a demonstration's observations, so the two cannot drift apart.

use crate::demos::Demonstrations;
use crate::error::RunError;
use crate::task_files;
use fab_model::Png;
use fab_picture::png;
use fab_program::Program;
use std::collections::BTreeMap;
use std::path::Path;

/// The examples of one task.
#[derive(Clone, Debug, Default)]
pub struct Examples {
    /// By path.
    pub(crate) pictures: BTreeMap<String, Png>,
    /// The demonstrations, if the task shows any.
    pub demonstrations: Option<Demonstrations>,
}

impl Examples {
    /// Reads the pictures and the demonstrations of a program; `folder` is the one that holds its file.
    pub fn load(program: &Program, folder: &Path) -> Result<Examples, RunError> {
        let mut pictures = BTreeMap::new();
        let examples = program.stages.iter().flat_map(|stage| &stage.examples);
        for file in examples.flat_map(|example| &example.images) {
            let path = task_files::resolve(folder, file)?;
            let picture = png::load(&path).map_err(|why| {
                RunError::Failed(format!("the picture of an example cannot be used: {why}"))
            })?;
            pictures.insert(file.path.clone(), Png::new(png::encode(&picture)));
        }
        let demos = program.demos.as_ref();
        let demonstrations = demos.map(|demos| Demonstrations::load(program, demos, folder));
        Ok(Examples {
            pictures,
            demonstrations: demonstrations.transpose()?,
        })
    }
}
