//! Names and literals that are right in Rust and in Python alike.
//!
//! A name of a task is data: where it becomes an identifier it must be none of either language's own words.

use crate::error::EmitError;

/// Words that cannot name anything in Rust or in Python, in any edition or version.
const RESERVED: &str = "False None Self True abstract and as assert async await become box break class \
const continue crate def del do dyn elif else enum except extern false final finally fn for from gen global \
if impl import in is lambda let loop macro match mod move mut nonlocal not or override pass priv pub raise \
ref return self static struct super trait true try type typeof unsafe unsized use virtual where while with \
yield";

/// Turns names into identifiers: each keeps its own where it can, and no two become the same.
///
/// What is no letter of ASCII, digit or `_` becomes `_`; `_` is put behind reserved words and behind all but
/// the first of names that would be alike.
pub(super) fn identifiers(names: impl IntoIterator<Item = String>) -> Vec<String> {
    let mut known: Vec<String> = Vec::new();
    for name in names {
        let mut identifier: String = name
            .chars()
            .map(|it| if it.is_ascii_alphanumeric() { it } else { '_' })
            .collect();
        // Python changes names that begin with two of them, and a lone one is no name in Rust.
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

/// Writes a Rust string literal of ASCII alone.
pub(super) fn rust_text(text: &str) -> String {
    format!("\"{}\"", text.escape_default())
}

/// Writes a Python string literal of ASCII alone.
pub(super) fn python_text(text: &str) -> String {
    format!("\"{}\"", python_escaped(text))
}

/// Escapes text for a Python string or docstring.
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
mod tests {
    use super::*;

    fn of(names: &[&str]) -> Vec<String> {
        identifiers(names.iter().map(|name| (*name).to_owned()))
    }

    #[test]
    fn identifiers_differ_from_reserved_words_and_from_each_other() {
        assert_eq!(of(&["pick", "type", "type_"]), ["pick", "type_", "type__"]);
        assert_eq!(of(&["lambda", "class", "fn"]), ["lambda_", "class_", "fn_"]);
        assert_eq!(
            of(&["_x", "9", "a b", "a_b"]),
            ["field_x", "field9", "a_b", "a_b_"]
        );
    }

    #[test]
    fn literals_are_plain_ascii() {
        assert_eq!(
            rust_text("a\"\\\n\u{e9}\u{202e}"),
            "\"a\\\"\\\\\\n\\u{e9}\\u{202e}\""
        );
        assert_eq!(
            python_text("a\"\\\n\u{e9}"),
            "\"a\\\"\\\\\\U0000000a\\U000000e9\""
        );
    }

    #[test]
    fn numbers_keep_their_bits_and_must_be_finite() {
        for value in [0.1, -0.0, 1e-300, 1e300, 224.0, f64::MIN_POSITIVE / 8.0] {
            let text = number(value).expect("a finite number");
            assert_eq!(
                text.parse::<f64>().expect("a number").to_bits(),
                value.to_bits()
            );
            assert!(
                text.contains(['.', 'e']),
                "{text} would be an integer in Python"
            );
        }
        assert!(number(f64::NAN).is_err() && number(f64::INFINITY).is_err());
    }
}
