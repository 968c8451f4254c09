//! Checks that an answer can state every choice of an action: no two read alike, and none reads as something else.
//!
//! In: the fields of a program. The rules follow how answers are read; `tests/suite/action_spaces.rs` shows that an
//! action space which keeps them is read as it is written.

use super::context::Result;
use crate::diag::{Code, Diagnostic, Report};
use crate::merge::Merged;
use fab_grammar::ast::Name;
use fab_program::exact::{normalised_deg, written};
use fab_program::space::{self, DECIMALS};
use fab_program::{ActionField, Value};
use std::collections::BTreeMap;

/// Characters that have another meaning in an answer: quotes, brackets, Markdown, the signs between statements.
const RESERVED: &str = "|\"'“”`*$\\~,;:!?()[]{}<>=#";

/// Reports fields and choices that answers cannot tell apart.
pub(super) fn check(
    fields: &[ActionField],
    merged: &Merged<'_>,
    report: &mut Report,
) -> Result<()> {
    let names = merged.actions().into_iter().flat_map(|part| part.fields());
    let names: Vec<Name<'_>> = names.map(|part| part.name()).collect();
    let mut all = Ok(());
    for (index, field) in fields.iter().enumerate() {
        let Some(name) = names.iter().find(|name| name.text() == field.name) else {
            continue;
        };
        let in_name = wrong_name(field, &fields[..index]);
        for message in in_name.into_iter().chain(wrong_choices(field, fields)) {
            all = Err(report.error(Diagnostic::new(Code::Contradiction, name.span(), message)));
        }
    }
    all
}

/// Says why answers cannot name a field.
fn wrong_name(field: &ActionField, earlier: &[ActionField]) -> Option<String> {
    let name = &field.name;
    // Answers are cut into words at `_`, and where a capital follows a small letter.
    let starts_with_digit = |word: &str| word.starts_with(|first: char| first.is_ascii_digit());
    let letters = name.as_bytes().windows(2);
    let mut capitals =
        letters.filter(|pair| pair[0].is_ascii_lowercase() && pair[1].is_ascii_uppercase());
    if name.starts_with('_') || name.split('_').any(starts_with_digit) || capitals.next().is_some()
    {
        return Some(format!(
            "answers cannot name the field `{name}`: write its words in small letters, with `_` between them"
        ));
    }
    let own = labels(field);
    let is_alike = |other: &&ActionField| labels(other).iter().any(|label| own.contains(label));
    let other = &earlier.iter().find(is_alike)?.name;
    Some(format!(
        "answers cannot tell the fields `{other}` and `{name}` apart"
    ))
}

/// Returns the names that an answer has for a field, in their plain form.
fn labels(field: &ActionField) -> [String; 2] {
    let asked = space::statement(field, "");
    [
        plain(&field.name),
        plain(asked.trim_end_matches([' ', '='])),
    ]
}

/// Says what is wrong with the choices of a field.
fn wrong_choices(field: &ActionField, fields: &[ActionField]) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut seen: BTreeMap<String, String> = BTreeMap::new();
    for value in space::declared(field) {
        let text = space::text(field, &value);
        if let Value::Word(word) = &value
            && let Some(why) = wrong_word(word, fields)
        {
            wrong.push(format!("the word `{}` {why}", short(word)));
            continue;
        }
        let read = match value {
            // A whole turn is no turn.
            Value::Direction { deg } => written(rounded_turn(deg), DECIMALS),
            _ => plain(&text),
        };
        if let Some(first) = seen.insert(read, text.clone()) {
            let [first, text] = [first, text].map(|text| short(&text));
            wrong.push(format!("`{first}` and `{text}` cannot be told apart"));
        }
    }
    wrong
}

/// Returns an angle as a prompt rounds it, within one turn, degrees.
fn rounded_turn(deg: f64) -> f64 {
    written(deg, DECIMALS).parse().map_or(deg, normalised_deg)
}

fn wrong_word(word: &str, fields: &[ActionField]) -> Option<&'static str> {
    let is_edge = |letter: Option<char>| letter.is_some_and(char::is_alphanumeric);
    let is_blank = |letter: char| letter.is_control() || (letter.is_whitespace() && letter != ' ');
    if word.contains(|letter| RESERVED.contains(letter) || is_blank(letter)) {
        Some("has a character that means something else in an answer")
    } else if !word.contains(char::is_alphabetic) {
        Some("has no letter")
    } else if !is_edge(word.chars().next()) || !is_edge(word.chars().next_back()) {
        Some("must begin and end with a letter or a digit")
    } else if fields.iter().any(|field| plain(&field.name) == plain(word)) {
        Some("is also the name of a field")
    } else {
        None
    }
}

/// Returns a text as answers are read: in any case, with `_` and `-` as spaces.
fn plain(text: &str) -> String {
    let words = text.to_lowercase().replace(['_', '-'], " ");
    words.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn short(text: &str) -> String {
    text.escape_default().take(60).collect()
}
