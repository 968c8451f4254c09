//! `fabc explain`: what diagnostics mean and what to do.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::Args;
use fab_compiler::diag::Code;
use fab_compiler::explain;

#[derive(Args)]
pub struct ExplainArguments {
    /// The code of a message, such as F0203; default: list all codes.
    #[arg(value_name = "CODE")]
    pub code: Option<String>,
}

pub fn run(arguments: &ExplainArguments, io: &Io) -> Result<Exit, Failure> {
    match &arguments.code {
        Some(code) => io.data(explain::to_text(known(code)?).trim_end()),
        None => io.data(explain::list().trim_end()),
    }
    Ok(Exit::Done)
}

fn known(code: &str) -> Result<Code, Failure> {
    Code::parse(code).ok_or_else(|| {
        Failure::usage(format!(
            "there is no diagnostic `{code}`; every diagnostic prints its code, such as `F0203`"
        ))
    })
}
