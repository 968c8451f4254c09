//! What the tests share: the command, recorded data, small tasks, scripted models.

use compiler::program::Program;
use compiler::{LoadError, Loader};
use runtime::model::{Model, ModelError, Nature, Reply, Request};
use runtime::world::{SimulatedWorld, World, WorldError};
use std::collections::VecDeque;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Mutex;

/// The project's root.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A path below the project's root, as text.
pub fn project(path: &str) -> String {
    root().join(path).display().to_string()
}

/// The command, in a folder of its own and with an expert cache that all tests share.
pub fn fabc(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fabc"));
    command
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .env("FABC_CACHE_DIR", root().join("target/test-cache"));
    command
}

/// What a finished command said.
pub struct Said {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

/// Runs a command to its end.
pub fn finish(command: &mut Command) -> Said {
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().unwrap();
    Said {
        code: status.code().unwrap_or(-1),
        stdout: String::from_utf8(stdout).unwrap(),
        stderr: String::from_utf8(stderr).unwrap(),
    }
}

/// The recorded data, or `None` where it is not there; the test then counts as skipped.
pub fn recorded_data(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("FABC_REFERENCE_DATA").map(PathBuf::from);
    if folder.is_none() {
        count_as_skipped(test);
    }
    folder
}

/// Tells `make test` that a test could not do its work here.
pub fn count_as_skipped(test: &str) {
    eprintln!("skipped: {test}");
    if let Some(file) = std::env::var_os("FABC_SKIPPED_FILE") {
        let mut file = std::fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(file)
            .unwrap();
        writeln!(file, "{test}").unwrap();
    }
}

/// Reads source files from the project.
pub struct ProjectFiles;

impl Loader for ProjectFiles {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        std::fs::read_to_string(root().join(name)).map_err(|error| LoadError {
            message: error.to_string(),
        })
    }
}

/// Compiles a shipped task.
pub fn task(name: &str) -> Program {
    let compiled = compiler::compile(&format!("tasks/{name}.fab"), &ProjectFiles).unwrap();
    assert!(
        compiled.diagnostics.is_empty(),
        "{:?}",
        compiled.diagnostics
    );
    compiled.programs.into_iter().next().unwrap()
}

/// Puts the shipped library for folds beside a test's own task.
pub fn bring_library(folder: &Path) {
    std::fs::create_dir_all(folder.join("lib")).unwrap();
    std::fs::copy(
        root().join("tasks/lib/folding.fab"),
        folder.join("lib/folding.fab"),
    )
    .unwrap();
}

/// A shipped task on a cloth so small that a rollout takes a moment; scored against nothing.
pub fn small_task() -> Program {
    let mut program = task("double_triangle");
    program.cloth.dimx = 28;
    program.cloth.dimy = 28;
    program.experts.clear();
    program.goal = None;
    program
}

/// A fresh simulated world for a program.
pub fn world(program: &Program) -> Result<Box<dyn World>, WorldError> {
    Ok(Box::new(SimulatedWorld::new(&program.camera)?))
}

/// A model that says what it was told to say, and keeps what it was asked.
pub struct Scripted {
    replies: Mutex<VecDeque<String>>,
    pub asked: Mutex<Vec<Request>>,
}

impl Scripted {
    pub fn new(replies: &[&str]) -> Scripted {
        Scripted {
            replies: Mutex::new(replies.iter().map(|reply| (*reply).to_owned()).collect()),
            asked: Mutex::default(),
        }
    }
}

impl Model for Scripted {
    fn name(&self) -> &str {
        "scripted"
    }

    fn nature(&self) -> Nature {
        Nature::StandIn
    }

    fn ask(&self, request: &Request) -> Result<Reply, ModelError> {
        self.asked.lock().unwrap().push(request.clone());
        let reply = self.replies.lock().unwrap().pop_front();
        reply
            .map(|text| Reply { text })
            .ok_or_else(|| ModelError::Unsupported {
                model: "scripted".to_owned(),
                why: "the script is over".to_owned(),
            })
    }
}
