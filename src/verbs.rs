//! The verbs of the command line: one file each, with its arguments, its work and its report.
//!
//! A new verb needs a file here, its `mod` line and its row below. Verbs that need the simulator, pictures or models
//! are in [`runtime`], behind one feature.

pub mod build;
pub mod check;
pub mod completions;
pub mod explain;
pub mod manual;
pub mod new;
pub mod price;
pub mod render;
pub mod review;
#[cfg(feature = "runtime")]
pub mod runtime;
pub mod snap;
pub mod test;
pub mod vocabulary;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::shipped;
use clap::{ArgMatches, Parser, Subcommand};

const EXIT_CODES: &str = "Exit codes: 0 done (and the goal reached), 1 the .fab file is wrong, 2 the environment failed, \
3 ended without reaching the goal, 64 wrong usage, 130 interrupted.";

/// Compiles cloth-manipulation tasks (.fab) to prompts and a verifier, and runs them.
#[derive(Parser)]
#[command(name = "fabc", version, after_help = EXIT_CODES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub verb: Verb,
}

/// What to do.
#[derive(Subcommand)]
#[cfg_attr(
    feature = "runtime",
    expect(clippy::large_enum_variant, reason = "there is one command line")
)]
pub enum Verb {
    #[command(flatten)]
    Author(Author),
    #[cfg(feature = "runtime")]
    #[command(flatten)]
    Runtime(runtime::Verb),
    #[command(flatten)]
    Shell(Shell),
}

impl Verb {
    /// Resolves the names of tasks, and runs the verb.
    pub fn run(&mut self, io: &Io) -> Result<Exit, Failure> {
        // These two report a name that means nothing beside their findings in the other files.
        let reports_each = matches!(self, Verb::Author(Author::Check(_) | Author::Test(_)));
        for file in self.files() {
            match shipped::find(file, io) {
                Ok(found) => *file = found,
                Err(_) if reports_each => {}
                Err(failure) => return Err(failure),
            }
        }
        match self {
            Verb::Author(verb) => verb.run(io),
            #[cfg(feature = "runtime")]
            Verb::Runtime(verb) => verb.run(io),
            Verb::Shell(verb) => verb.run(io),
        }
    }

    fn files(&mut self) -> Vec<&mut String> {
        match self {
            Verb::Author(Author::Check(check)) => check.files.iter_mut().collect(),
            Verb::Author(Author::Test(test)) => test.files.iter_mut().collect(),
            Verb::Author(Author::Snap(snap)) => snap.files.iter_mut().collect(),
            Verb::Author(Author::Build(build)) => vec![&mut build.file],
            Verb::Author(Author::Render(render)) => vec![&mut render.task.file],
            Verb::Author(
                Author::New(_) | Author::Explain(_) | Author::Vocabulary(_) | Author::Review(_),
            ) => Vec::new(),
            #[cfg(feature = "runtime")]
            Verb::Runtime(verb) => verb.file().into_iter().collect(),
            Verb::Shell(_) => Vec::new(),
        }
    }
}

/// Returns whether a command line asks for one JSON document on stdout.
pub fn wants_json(matches: &ArgMatches) -> bool {
    match matches.subcommand() {
        Some((_, of_verb)) => wants_json(of_verb),
        None => matches!(matches.try_get_one("json"), Ok(Some(true))),
    }
}

/// Defines the enumeration of verbs from its rows, `Name(module::Arguments)`; each module has `run(arguments, io)`.
macro_rules! verbs {
    ($(#[$about:meta])* $enum:ident: $($(#[$help:meta])* $name:ident($module:ident::$arguments:ident),)*) => {
        $(#[$about])*
        #[derive(clap::Subcommand)]
        pub enum $enum {
            $($(#[$help])* $name($module::$arguments),)*
        }

        impl $enum {
            /// Runs the verb.
            pub fn run(&self, io: &$crate::io::Io) -> Result<$crate::exit::Exit, $crate::exit::Failure> {
                match self {
                    $($enum::$name(arguments) => $module::run(arguments, io),)*
                }
            }
        }
    };
}
#[cfg(feature = "runtime")]
use verbs;

verbs! {
    /// Verbs for those who write tasks: no camera, no model, no system library.
    Author:
    /// Writes a commented task that runs at once.
    #[command(subcommand)]
    New(new::NewVerb),
    /// Reports mistakes in .fab files; `--fix` applies corrections that are certain.
    Check(check::CheckArguments),
    /// Runs the tests in task files: is an answer accepted or rejected? Needs no model or camera.
    Test(test::TestArguments),
    /// Explains a diagnostic and how to fix it, with an example.
    Explain(explain::ExplainArguments),
    /// Lists every word of the language with its arguments, ranges and meaning.
    Vocabulary(vocabulary::VocabularyArguments),
    /// Prints the exact messages that a model gets, without asking one.
    Render(render::RenderArguments),
    /// Pins the prompts of tasks as snapshots beside their files; `--check` fails if they differ.
    Snap(snap::SnapArguments),
    /// Writes tasks as prompt templates, an answer schema and verifiers for other systems.
    Build(build::BuildArguments),
    /// Shows what changed in prompts, scenes and pictures, and accepts or rejects it.
    Review(review::ReviewArguments),
}

verbs! {
    /// Verbs about the command line itself.
    Shell:
    /// Prints a completion script for a shell.
    Completions(completions::CompletionsArguments),
    /// Writes manual pages for `man`, one for each verb.
    Manual(manual::ManualArguments),
}
