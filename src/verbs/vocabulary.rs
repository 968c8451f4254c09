//! `fabc vocabulary`: every word of the language, for editors and for people.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::Args;
use fab_compiler::lang;

/// Arguments of `vocabulary`.
#[derive(Args)]
pub struct VocabularyArguments {
    /// Print one JSON document, for editors.
    #[arg(long)]
    pub json: bool,
}

/// Prints the tables of the reference, or all of it as JSON.
pub fn run(arguments: &VocabularyArguments, io: &Io) -> Result<Exit, Failure> {
    if arguments.json {
        let json = serde_json::to_value(lang::vocabulary());
        io.json(&json.map_err(|error| Failure::environment(error.to_string()))?);
        return Ok(Exit::Done);
    }
    for (name, table) in lang::tables() {
        io.data(&format!("{}\n\n{table}", name.replace('-', " ")));
    }
    Ok(Exit::Done)
}
