//! Exit codes, and the errors that end a verb.

use serde_json::{Value, json};
use std::fmt;
use std::path::Path;

/// How the command ends; scripts rely on the exit codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// Success; the goal, if the task declares one, was reached.
    Done = 0,
    /// The `.fab` file is wrong.
    Author = 1,
    /// A file, the network, a model or the robot failed.
    Environment = 2,
    /// The job ended without reaching its goal.
    Unreached = 3,
    /// The command line is wrong.
    Usage = 64,
    /// The user stopped it.
    Interrupted = 130,
}

impl Exit {
    pub fn code(self) -> u8 {
        self as u8
    }
}

/// An error that ends a verb: one message and the code it exits with.
#[derive(Debug)]
pub struct Failure {
    pub exit: Exit,
    message: String,
    diagnostics: Option<Value>,
}

impl Failure {
    fn new(exit: Exit, message: String) -> Failure {
        Failure {
            exit,
            message,
            diagnostics: None,
        }
    }

    /// The environment failed.
    pub fn environment(error: impl fmt::Display) -> Failure {
        Failure::new(Exit::Environment, error.to_string())
    }

    /// A file or a folder cannot be written.
    pub fn unwritable(path: &Path, error: std::io::Error) -> Failure {
        Failure::environment(format!("cannot write `{}`: {error}", path.display()))
    }

    /// The command line asks for something that does not exist or cannot be done.
    pub fn usage(message: impl Into<String>) -> Failure {
        Failure::new(Exit::Usage, message.into())
    }

    /// The file is wrong; `diagnostics` holds as JSON what was already shown as text.
    pub fn author(message: impl Into<String>, diagnostics: Value) -> Failure {
        Failure {
            diagnostics: Some(diagnostics),
            ..Failure::new(Exit::Author, message.into())
        }
    }

    pub fn saying(self, more: &str) -> Failure {
        Failure {
            message: format!("{}; {more}", self.message),
            ..self
        }
    }

    /// A cap stopped the verb before there was a result to report.
    pub fn capped(error: impl fmt::Display) -> Failure {
        Failure::new(Exit::Unreached, error.to_string())
    }

    /// The user stopped the verb before there was a result to report.
    pub fn interrupted() -> Failure {
        Failure::new(Exit::Interrupted, "interrupted".to_owned())
    }

    /// Returns the document that `--json` prints instead of a result.
    pub fn to_json(&self) -> Value {
        let mut value = json!({ "error": self.message, "exit": self.exit.code() });
        if let Some(diagnostics) = &self.diagnostics {
            value["diagnostics"] = diagnostics.clone();
        }
        value
    }
}

/// The environment failed, unless a world says that the user stopped it.
impl<E: std::error::Error + 'static> From<E> for Failure {
    fn from(error: E) -> Failure {
        #[cfg(feature = "runtime")]
        {
            let error: &dyn std::error::Error = &error;
            let of_run = error.downcast_ref().and_then(|error| match error {
                fab_agent::rollout::RunError::World(error) => Some(error),
                _ => None,
            });
            if let Some(fab_world::WorldError::Interrupted) = error.downcast_ref().or(of_run) {
                return Failure::interrupted();
            }
        }
        Failure::environment(error)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}
