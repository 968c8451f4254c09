//! Explains diagnostics. Each has an example that is compiled when it is shown.
//!
//! In: the table of codes and the files of `diag/examples`. Out: text for a terminal.

use crate::diag::{self, CODES, Code, CodeEntry, Color};
use crate::{Listed, LoadError, Loader, Wanted};
use fab_program::{Material, Trial};
use std::collections::BTreeMap;

/// The name of an example's file.
const FILE: &str = "example.fab";

/// The task that most examples extend: the first one of the language page.
pub const HALF: &str = include_str!("diag/examples/half.fab");

/// The name of its file.
pub const HALF_FILE: &str = "half.fab";

/// A file with a diagnostic, and the same file corrected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Example {
    /// With the mistake.
    pub wrong: String,
    /// Without it.
    pub right: String,
}

/// Returns the example of a code; `None` if it would be too large to show.
pub fn example(code: Code) -> Option<Example> {
    let text = code.entry().example();
    let version = |mark: &str, other: &str| -> String {
        let lines = text.lines().filter(|line| !line.ends_with(other));
        let lines = lines.map(|line| line.strip_suffix(mark).unwrap_or(line).trim_end());
        lines.map(|line| format!("{line}\n")).collect()
    };
    let (wrong, right) = (version("# wrong", "# right"), version("# right", "# wrong"));
    (wrong != right).then_some(Example { wrong, right })
}

/// Returns the diagnostics of an example's file, as `fabc check` prints them.
pub fn report_of(text: &str) -> String {
    match crate::compile(FILE, &Files(text)) {
        Ok(compiled) => diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain),
        Err(error) => error.message,
    }
}

/// Explains a code for a terminal.
pub fn to_text(code: Code) -> String {
    let entry = code.entry();
    let head = format!(
        "{}[{}]: {}",
        entry.severity.as_str(),
        code.as_str(),
        entry.title()
    );
    let mut text = format!("{head}\n\n{}\n", entry.explanation());
    if let Some(Example { wrong, right }) = example(code) {
        let uses_half = wrong.contains(HALF_FILE) || right.contains(HALF_FILE);
        let (report, wrong, right) = (report_of(&wrong), indented(&wrong), indented(&right));
        text.push_str(&format!(
            "\nFor example:\n\n{wrong}\n{report}\nRight would be:\n\n{right}"
        ));
        if uses_half {
            text.push_str("\n(`half.fab` is the first task of docs/language.md.)\n");
        }
    }
    text
}

/// Lists every code with its severity and its title, for a terminal.
pub fn list() -> String {
    let row = |entry: &CodeEntry| {
        let (code, severity) = (entry.code.as_str(), entry.severity.as_str());
        format!("{code}  {severity:<7}  {}\n", entry.title())
    };
    CODES.iter().map(row).collect()
}

fn indented(text: &str) -> String {
    let line = |line: &str| match line {
        "" => "\n".to_owned(),
        line => format!("    {line}\n"),
    };
    text.lines().map(line).collect()
}

/// An example's file, the file that it may use, and what examples need of the outside.
pub struct Files<'t>(pub &'t str);

impl Loader for Files<'_> {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        match name {
            FILE => Ok(self.0.to_owned()),
            HALF_FILE => Ok(HALF.to_owned()),
            _ => Err(LoadError {
                message: format!("there is no file `{name}`"),
            }),
        }
    }

    /// Returns what the folder `listed` holds; other files that examples name are not looked for.
    fn look(&self, path: &str, _wanted: Wanted) -> Listed {
        let picture = |side| Listed::Picture {
            width: side,
            height: side,
        };
        match path.strip_prefix("listed/") {
            None => Listed::Unknown,
            Some("flat.png" | "folded.png") => picture(224),
            Some("large.png") => picture(720),
            Some(_) => Listed::Nothing("no such file".to_owned()),
        }
    }

    /// Returns what the demonstration of an example did, as `fabc subgoals` found it.
    fn trial(&self, title: &str) -> Option<Trial> {
        let found = serde_json::from_str(include_str!("diag/examples/trials.json")).ok();
        found.and_then(|mut found: BTreeMap<String, Trial>| found.remove(title))
    }

    /// Returns what the simulator says of the example of a cloth that is too stiff for its spacing.
    fn refuses_cloth(&self, material: &Material, spacing_m: f64) -> Option<String> {
        let why = include_str!("diag/examples/F0512.txt").trim_end();
        let is_too_stiff = material.bending_length_m.warp == 0.09 && spacing_m < 0.0076;
        is_too_stiff.then(|| why.to_owned())
    }
}
