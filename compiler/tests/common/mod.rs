//! Tasks and loaders that the tests share.

#![allow(dead_code, clippy::unwrap_used)]

use compiler::program::Program;
use compiler::{Compiled, LoadError, Loader};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A small task with everything that one needs.
pub const TASK: &str = include_str!("task.fab");

/// Files in memory, by name.
#[derive(Default)]
pub struct Memory(pub BTreeMap<String, String>);

impl Memory {
    pub fn of<const N: usize>(files: [(&str, &str); N]) -> Memory {
        Memory(
            files
                .map(|(name, text)| (name.to_owned(), text.to_owned()))
                .into(),
        )
    }
}

impl Loader for Memory {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        self.0.get(name).cloned().ok_or_else(|| LoadError {
            message: format!("there is no file `{name}`"),
        })
    }
}

/// Compiles one file.
pub fn compile(name: &str, text: &str) -> Compiled {
    compiler::compile(name, &Memory::of([(name, text)])).unwrap()
}

/// Returns the only program of a file that must be right.
pub fn program(name: &str, text: &str) -> Program {
    let mut compiled = compile(name, text);
    let shown = compiler::diag::to_text(
        &compiled.diagnostics,
        &compiled.sources,
        compiler::diag::Color::Plain,
    );
    assert!(
        !compiled.has_errors() && compiled.programs.len() == 1,
        "{shown}"
    );
    compiled.programs.remove(0)
}

/// Returns the messages of everything that is wrong with a text.
pub fn messages(text: &str) -> Vec<String> {
    compile("task.fab", text)
        .diagnostics
        .into_iter()
        .map(|it| format!("{} {}", it.code.as_str(), it.message))
        .collect()
}

/// Returns the folder of the workspace.
pub fn workspace() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap()
        .to_owned()
}
