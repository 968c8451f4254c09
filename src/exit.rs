//! Exit codes, and the errors that end a verb.

use std::fmt;

/// How the command ends; scripts rely on the codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Done, and the goal reached where one is declared.
    Done,
    /// The `.fab` file is wrong.
    Author,
    /// A file, the network, a model or the robot failed.
    Environment,
    /// The job ended without reaching its goal.
    Unreached,
    /// The command line is wrong.
    Usage,
    /// The user stopped it.
    Interrupted,
}

impl Exit {
    /// Returns the process exit code.
    pub fn code(self) -> u8 {
        match self {
            Exit::Done => 0,
            Exit::Author => 1,
            Exit::Environment => 2,
            Exit::Unreached => 3,
            Exit::Usage => 64,
            Exit::Interrupted => 130,
        }
    }
}

/// An error that ends a verb: one message and the code it exits with.
#[derive(Debug)]
pub struct Failure {
    exit: Exit,
    message: String,
}

impl Failure {
    /// The environment failed.
    pub fn environment(error: impl fmt::Display) -> Failure {
        Failure {
            exit: Exit::Environment,
            message: error.to_string(),
        }
    }

    /// The command line asks for what there is not.
    pub fn usage(message: impl Into<String>) -> Failure {
        Failure {
            exit: Exit::Usage,
            message: message.into(),
        }
    }

    /// The file is wrong; its diagnostics have been shown.
    pub fn author(message: impl Into<String>) -> Failure {
        Failure {
            exit: Exit::Author,
            message: message.into(),
        }
    }

    /// Returns the exit that goes with it.
    pub fn exit(&self) -> Exit {
        self.exit
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}
