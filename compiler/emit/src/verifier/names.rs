//! Names and literals that are valid in both Rust and Python.
//!
//! Names in a task are data. Where one becomes an identifier, it must not be a reserved word of either language.

use crate::error::EmitError;

/// Words that cannot be names in Rust or in Python, in any edition or version.
const RESERVED: &str = "False None Self True abstract and as assert async await become box break class \
const continue crate def del do dyn elif else enum except extern false final finally fn for from gen global \
if impl import in is lambda let loop macro match mod move mut nonlocal not or override pass priv pub raise \
ref return self static struct super trait true try type typeof unsafe unsized use virtual where while with \
yield";

/// Turns names into identifiers. A name is kept if possible, and no two become the same.
///
/// Every character except ASCII letters, digits and `_` becomes `_`. A `_` is appended to reserved words and to all
/// but the first of equal names.
pub(super) fn identifiers(names: impl IntoIterator<Item = String>) -> Vec<String> {
    let mut known: Vec<String> = Vec::new();
    for name in names {
        let mut identifier: String = name
            .chars()
            .map(|it| if it.is_ascii_alphanumeric() { it } else { '_' })
            .collect();
        // Python mangles names that begin with two underscores, and a lone one is not a name in Rust.
        if !identifier.starts_with(|it: char| it.is_ascii_alphabetic()) {
            identifier = format!("field{identifier}");
        }
        while RESERVED.split(' ').any(|word| word == identifier) || known.contains(&identifier) {
            identifier.push('_');
        }
        known.push(identifier);
    }
    known
}

/// Writes a number that reads back to the same bits in both languages.
pub(super) fn number(value: f64) -> Result<String, EmitError> {
    if value.is_finite() {
        Ok(format!("{value:?}"))
    } else {
        Err(EmitError::Number {
            value: value.to_string(),
        })
    }
}

/// Escapes text for a Rust string or comment.
pub(super) fn rust_escaped(text: &str) -> String {
    text.escape_default().to_string()
}

/// Escapes text for a Python string or comment.
pub(super) fn python_escaped(text: &str) -> String {
    text.chars()
        .map(|character| match character {
            '"' | '\\' => format!("\\{character}"),
            ' '..='~' => character.to_string(),
            _ => format!("\\U{:08x}", u32::from(character)),
        })
        .collect()
}

#[cfg(test)]
mod tests;
