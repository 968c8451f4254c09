//! Finds worlds, in which actions are executed, by their names on the command line.

use fab_base::child::CommandLine;
use fab_base::interrupt::Interrupt;
use fab_program::Program;
use fab_world::{ExternalWorld, World, WorldError};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::Path;
use std::str::FromStr;

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum WorldChoice {
    Sim,
    Arm,
    Program(CommandLine),
}

impl FromStr for WorldChoice {
    type Err = String;

    fn from_str(name: &str) -> Result<WorldChoice, String> {
        match (name, name.split_once(':')) {
            ("sim", _) => Ok(WorldChoice::Sim),
            ("arm" | "jaco", _) => Ok(WorldChoice::Arm),
            (_, Some(("exec", command))) => CommandLine::parse(command).map(WorldChoice::Program),
            _ => Err(
                "there is `sim` (the bundled simulator), `arm` (an arm, with `--robot FILE`; `jaco` is another name for it) and `exec:\"CMD ARG...\"` (a program of yours)"
                    .to_owned(),
            ),
        }
    }
}

impl TryFrom<String> for WorldChoice {
    type Error = String;

    fn try_from(name: String) -> Result<WorldChoice, String> {
        name.parse()
    }
}

impl From<WorldChoice> for String {
    fn from(choice: WorldChoice) -> String {
        choice.to_string()
    }
}

impl fmt::Display for WorldChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WorldChoice::Sim => f.write_str("sim"),
            WorldChoice::Arm => f.write_str("arm"),
            WorldChoice::Program(command) => write!(f, "exec:{command}"),
        }
    }
}

/// Starts a program as the world of a task; `run` is the run folder, which gets its stderr.
pub fn external(
    command: &CommandLine,
    program: &Program,
    run: Option<&Path>,
    interrupt: &Interrupt,
) -> Result<Box<dyn World>, WorldError> {
    let world = ExternalWorld::start(command, &program.camera, program.picker, run, interrupt)?;
    Ok(Box::new(
        world.with_material(program.cloth.material.as_ref())?,
    ))
}
