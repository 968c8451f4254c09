//! `fabc vocabulary`: every word of the language, for editors and for people.

use crate::cli::VocabularyArguments;
use crate::exit::{Exit, Failure};
use crate::output;
use fab_compiler::lang;

/// Prints the tables of the reference, or all of it as JSON.
pub fn run(arguments: &VocabularyArguments) -> Result<Exit, Failure> {
    if arguments.json {
        let json = serde_json::to_value(lang::vocabulary());
        output::json(&json.map_err(|error| Failure::environment(error.to_string()))?);
        return Ok(Exit::Done);
    }
    for (name, table) in lang::tables() {
        output::data(&format!("{}\n\n{table}", name.replace('-', " ")));
    }
    Ok(Exit::Done)
}
