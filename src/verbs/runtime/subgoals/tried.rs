//! The findings about what a demonstration did, in its task's file.
//!
//! In: a file, and the results of its demonstration, which need not be pinned. Out: the warnings that `fabc check` gives
//! once they are.

use crate::exit::Failure;
use crate::sources::Disk;
use fab_compiler::{Compiled, LoadError, Loader, diag};
use fab_program::{Program, Trial};

/// A loader that knows what one demonstration did.
struct Knowing<'t> {
    disk: Disk,
    title: String,
    trial: &'t Trial,
}

impl Loader for Knowing<'_> {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        self.disk.load(name)
    }

    fn trial(&self, title: &str) -> Option<Trial> {
        (title == self.title).then(|| self.trial.clone())
    }
}

/// Compiles a program's file, and returns only its findings about what the demonstration did.
pub fn compile(file: &str, program: &Program, trial: &Trial) -> Result<Compiled, Failure> {
    let loader = Knowing {
        disk: Disk::beside(file),
        title: program.title(),
        trial,
    };
    let mut compiled = fab_compiler::compile(file, &loader)
        .map_err(|error| Failure::environment(error.message))?;
    let is_of_steps = |code| code == diag::Code::StepFoldsNothing;
    compiled.diagnostics.retain(|it| is_of_steps(it.code));
    compiled.left_out = 0;
    Ok(compiled)
}
