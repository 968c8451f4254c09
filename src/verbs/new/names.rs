//! Checks the name of a new task.

use crate::exit::Failure;

/// The longest name, letters; a file name with its extensions has at most 255.
const LONGEST: usize = 100;

/// Rejects an invalid name, and suggests a valid one.
pub fn check(name: &str) -> Result<(), Failure> {
    if name.len() > LONGEST {
        return Err(Failure::usage(format!(
            "a task's name has at most {LONGEST} letters, and this one has {}",
            name.chars().count()
        )));
    }
    let why = if fab_compiler::is_keyword(name) {
        "the language uses this word itself"
    } else if is_name(name) {
        return Ok(());
    } else {
        "one begins with a letter or `_`, and continues with letters, digits and `_`, without accents"
    };
    Err(Failure::usage(format!(
        "`{}` cannot name a task: {why}; `{}` would be right",
        name.escape_debug(),
        repaired(name)
    )))
}

fn is_name(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
        && name.chars().all(is_part)
}

fn is_part(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || letter == '_'
}

/// Makes a valid name from the given text.
fn repaired(name: &str) -> String {
    let name = name.strip_suffix(".fab").unwrap_or(name);
    let parts: Vec<&str> = name
        .split(|letter| !is_part(letter))
        .filter(|part| !part.is_empty())
        .collect();
    let joined = parts.join("_");
    if is_name(&joined) && !fab_compiler::is_keyword(&joined) {
        joined
    } else {
        format!("my_{joined}").trim_end_matches('_').to_owned()
    }
}

#[cfg(test)]
mod tests;
