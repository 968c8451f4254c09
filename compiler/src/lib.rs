//! Turns `.fab` text into [`Program`]s, and says what is wrong with it.
//!
//! ```text
//! text ─load→ trees ─merge→ one task with what it inherits ─check→ Program
//!            └───────────────── Diagnostics ────────────┘
//! ```
//!
//! In: the name of a file and a [`Loader`]. Out: the programs that the file defines, and diagnostics. The crate is
//! pure: it has no access to the outside except the loader, uses no clock and no random numbers, and gives the same
//! bytes for the same texts. `fab-grammar` parses, `fab-program` defines what a program means, and `fab-emit` writes
//! a program as files; executing it is left to others. [`lang`] lists every word of the language.
//!
//! Any program can compile a task from memory:
//!
//! ```
//! use fab_compiler::{LoadError, Loader, diag};
//!
//! /// Returns one text for every name.
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
pub mod fix;
pub mod lang;
mod load;
mod loader;
mod merge;
mod path;
mod syntax;

pub use fab_grammar::is_keyword;
pub use fab_grammar::{FileId, Source, Sources, Span};
pub use load::MAX_FILES;
pub use loader::{Listed, LoadError, Loader, Wanted};
pub use merge::MAX_EXTENDS_DEPTH;

use diag::{Diagnostic, Report, Severity};
use fab_program::{Material, Program, Test};

/// The result of a compilation.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The tasks of the entry file that have no errors and can run by themselves, in source order, each followed
    /// by its variants.
    pub programs: Vec<Program>,
    /// The task and the name of each variant that has errors, in source order.
    pub broken_variants: Vec<(String, String)>,
    /// The tests of those tasks, in source order.
    pub tests: Vec<Test>,
    /// The materials without errors that the entry file declares or uses, by the order of the files.
    pub materials: Vec<Material>,
    /// The findings of all files, by file and place; at most [`diag::MAX_FINDINGS`] of each severity.
    pub diagnostics: Vec<Diagnostic>,
    /// How many more findings there are.
    pub left_out: usize,
    /// Every file that was read.
    pub sources: Sources,
}

impl Compiled {
    /// Returns whether there is any error.
    pub fn has_errors(&self) -> bool {
        self.diagnostics
            .iter()
            .any(|diagnostic| diagnostic.severity == Severity::Error)
    }
}

/// Compiles the file `entry` and the files that it uses.
///
/// Fails only if the entry itself cannot be loaded; everything else is a diagnostic.
pub fn compile(entry: &str, loader: &dyn Loader) -> Result<Compiled, LoadError> {
    compile_for(entry, loader, None)
}

/// Compiles the file `entry` for a cloth of another grid than its tasks declare.
///
/// - `grid`: particles along X and along Y, 2 to 200 each, instead of every task's own; `None` is the same as
///   [`compile`].
///
/// A start file may have a larger or smaller cloth than the task declares. Everything that depends on the cloth, such
/// as lengths in `edge` and the flat area, then follows `grid`. Subgoal pictures belong to the declared cloth, so
/// look them up with the program that [`compile`] returns.
pub fn compile_for(
    entry: &str,
    loader: &dyn Loader,
    grid: Option<[u32; 2]>,
) -> Result<Compiled, LoadError> {
    let mut report = Report::default();
    let texts = load::read(entry, loader, &mut report)?;
    let loaded = load::Loaded::of(&texts, loader);
    let checked = check::check(&loaded, grid, &mut report);
    let left_out = report.left_out();
    Ok(Compiled {
        programs: checked.programs,
        broken_variants: checked.broken_variants,
        tests: checked.tests,
        materials: checked.materials,
        left_out,
        diagnostics: report.into_sorted(),
        sources: texts.sources,
    })
}
