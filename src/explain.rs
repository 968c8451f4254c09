//! `fabc explain CODE`: what a diagnostic means and what to do.

use crate::cli::ExplainArguments;
use crate::exit::{Exit, Failure};
use crate::output;
use compiler::diag::Code;

/// Prints the explanation of one code.
pub fn run(arguments: &ExplainArguments) -> Result<Exit, Failure> {
    let Some(code) = Code::parse(&arguments.code) else {
        let wanted = &arguments.code;
        return Err(Failure::usage(format!(
            "there is no diagnostic `{wanted}`; a code looks like `F0203` and stands in every message"
        )));
    };
    let entry = code.entry();
    let severity = entry.severity.as_str();
    let title = entry.title;
    output::data(&format!(
        "{severity}[{}]: {title}\n\n{}",
        code.as_str(),
        entry.explanation
    ));
    Ok(Exit::Done)
}
