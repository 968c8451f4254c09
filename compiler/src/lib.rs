//! Turns `.fab` text into [`Program`]s, and says what is wrong with it.
//!
//! ```text
//! text ─grammar→ tree ─ast→ File ─merge→ one task with what it inherits ─check→ Program
//!                  └────────────── Diagnostics ──────────────────────────┘
//! ```
//!
//! In: the name of a file and a [`Loader`]. Out: the programs that the file defines, and diagnostics. The
//! crate is pure: no file, clock, network or chance is reached but through the loader, and the same
//! texts give the same bytes. What a program's data means is defined here too: [`render`] fills its
//! templates, [`reply`] reads answers, [`verify`] judges them; [`emit`] writes all
//! of it as files. Executing it is left to others.
//!
//! A task can be compiled from memory, in any program:
//!
//! ```
//! use fab_compiler::{LoadError, Loader, diag};
//!
//! /// One text, whatever is asked for.
//! struct Memory(&'static str);
//!
//! impl Loader for Memory {
//!     fn load(&self, _name: &str) -> Result<String, LoadError> {
//!         Ok(self.0.to_owned())
//!     }
//! }
//!
//! let text = "task tried {\n    goal particle_distance < 40deg\n}\n";
//! let compiled = fab_compiler::compile("fold.fab", &Memory(text))?;
//! assert!(compiled.has_errors() && compiled.programs.is_empty());
//!
//! let shown = diag::to_text(&compiled.diagnostics, &compiled.sources, diag::Color::Plain);
//! println!("{shown}");
//! assert!(shown.contains("error[F0203]: expected a length on the table, found an angle"));
//! assert!(shown.contains("--> fold.fab:2:30"));
//! # Ok::<(), LoadError>(())
//! ```

mod check;
pub mod diag;
pub mod explain;
mod form;
pub mod lang;
mod load;
mod loader;
mod merge;
mod path;
pub mod proof;

pub use check::MAX_INHERITED_BYTES;
pub use fab_grammar::is_keyword;
pub use fab_grammar::{FileId, Source, Sources, Span, line_and_column};
pub use load::{MAX_FILES, MAX_TOTAL_BYTES, MAX_USE_DEPTH};
pub use loader::{LoadError, Loader};
pub use merge::MAX_EXTENDS_DEPTH;

use diag::{Diagnostic, Report, Severity};
use fab_program::{Program, Test};

/// What came of a compilation.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The tasks of the entry file that are right and can run by themselves, in source order, each followed
    /// by its variants.
    pub programs: Vec<Program>,
    /// The tests of those tasks, in source order.
    pub tests: Vec<Test>,
    /// What is wrong in any file, by file and place; of each severity the first [`diag::MAX_FINDINGS`] that were found.
    pub diagnostics: Vec<Diagnostic>,
    /// How many further findings there are.
    pub left_out: usize,
    /// Every file that was read.
    pub sources: Sources,
}

impl Compiled {
    /// Returns whether anything keeps a task from being right.
    pub fn has_errors(&self) -> bool {
        self.diagnostics
            .iter()
            .any(|diagnostic| diagnostic.severity == Severity::Error)
    }
}

/// Compiles the file `entry` and what it uses.
///
/// Fails only where the entry itself cannot be loaded; all else is a diagnostic.
pub fn compile(entry: &str, loader: &dyn Loader) -> Result<Compiled, LoadError> {
    compile_for(entry, loader, None)
}

/// Compiles the file `entry` for a cloth of another grid than its tasks declare.
///
/// - `grid`: particles along X and along Y, 2 to 200 each, in place of every task's own; none: as [`compile`] does.
///
/// A start file may hold a larger or smaller cloth than the task is written for. All that follows from the cloth,
/// lengths in `edge` and the flat area among it, is then that of `grid`. Subgoal pictures belong to the declared
/// cloth, so they are looked up with the program that [`compile`] gives.
pub fn compile_for(
    entry: &str,
    loader: &dyn Loader,
    grid: Option<[u32; 2]>,
) -> Result<Compiled, LoadError> {
    let mut report = Report::default();
    let texts = load::read(entry, loader, &mut report)?;
    let loaded = load::Loaded::of(&texts);
    let checked = check::check(&loaded, grid, &mut report);
    Ok(Compiled {
        programs: checked.programs,
        tests: checked.tests,
        left_out: report.left_out(),
        diagnostics: report.into_sorted(),
        sources: texts.sources,
    })
}
