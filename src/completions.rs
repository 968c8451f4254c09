//! `fabc completions`: what a shell needs to complete this command line.

use crate::cli::Cli;
use crate::cli::completions::CompletionsArguments;
use crate::exit::{Exit, Failure};
use crate::output;
use clap::CommandFactory;

/// Writes the completions for one shell.
pub fn run(arguments: &CompletionsArguments) -> Result<Exit, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "fabc", &mut script);
    let script = String::from_utf8(script).map_err(Failure::environment)?;
    output::data(script.trim_end());
    Ok(Exit::Done)
}
