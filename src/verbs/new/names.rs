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
    match is_name(&joined) && !fab_compiler::is_keyword(&joined) {
        true => joined,
        false => format!("my_{joined}").trim_end_matches('_').to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_name_is_refused_with_one_that_is() {
        for (name, right) in [
            ("9lives", "my_9lives"),
            ("tea towel", "tea_towel"),
            ("towel.fab", "towel"),
            ("tasks/towel", "tasks_towel"),
            ("fold", "my_fold"),
            ("task", "my_task"),
            ("Küche", "K_che"),
            ("", "my"),
            ("../../x", "x"),
            ("a\u{1b}[2J", "a_2J"),
        ] {
            let failure = check(name).err().map(|failure| failure.to_string());
            let message = failure.unwrap_or_default();
            assert!(
                message.ends_with(&format!("`{right}` would be right")),
                "{name}: {message}"
            );
            assert!(!message.contains('\u{1b}'), "{message}");
            assert!(check(right).is_ok(), "{right}");
        }
    }

    #[test]
    fn names_are_not_longer_than_a_file_name_may_be() {
        assert!(check(&"a".repeat(LONGEST)).is_ok());
        assert!(check(&"a".repeat(LONGEST + 1)).is_err());
    }
}
