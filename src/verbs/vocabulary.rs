//! `fabc vocabulary`: every word of the language, for editors and for people.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::Args;
use fab_compiler::lang;

#[derive(Args)]
pub struct VocabularyArguments {
    /// Print one JSON document, for editors.
    #[arg(long)]
    pub json: bool,
}

/// The page that holds the tables; a test of the compiler writes them.
const PAGE: &str = include_str!("../../docs/language.md");

pub fn run(arguments: &VocabularyArguments, io: &Io) -> Result<Exit, Failure> {
    if arguments.json {
        io.json(&lang::vocabulary());
        return Ok(Exit::Done);
    }
    for part in PAGE.split("<!-- table: ").skip(1) {
        let table = part
            .split_once("<!-- end -->")
            .map_or(part, |(table, _)| table);
        if let Some((name, table)) = table.split_once(" -->") {
            io.data(&format!("{}\n\n{}\n", name.replace('-', " "), table.trim()));
        }
    }
    Ok(Exit::Done)
}
