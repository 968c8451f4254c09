//! Finds where an answer names the fields of an action.
//!
//! In: the fields and an answer. Out: for each field the positions of its name, in order, and how far the text after
//! each may belong to it. A name inside a longer one (`angle` in `Tip angle`) belongs to the longer one.

use super::cursor::{starts_with_word, tail};
use crate::data::actions::ActionField;

/// How far before a statement a word that negates it may be, bytes.
const MAX_BEFORE: usize = 120;

/// Words that negate a statement, or make it one about something else.
pub(super) const NEGATING: [&str; 12] = [
    "not", "never", "avoid", "previous", "last", "old", "cannot", "don", "isn", "instead",
    "former", "would",
];

/// A position where a field is named.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mention {
    /// The field, by its index.
    field: usize,
    /// Where the name begins.
    pub at: usize,
    /// Where it ends.
    pub end: usize,
    /// Where it ends together with the noun that the format puts after it.
    claimed: usize,
    /// Where the next name of any field begins, or the answer ends.
    pub until: usize,
}

/// Returns the positions of each field's name, in the order of the fields and of the answer.
pub(super) fn named(fields: &[ActionField], reply: &str) -> Vec<Vec<Mention>> {
    let mut all: Vec<Mention> = Vec::new();
    for (index, field) in fields.iter().enumerate() {
        all.extend(occurrences(index, field, reply));
    }
    all.sort_by_key(|named| (named.at, std::cmp::Reverse(named.claimed), named.field));
    let mut kept: Vec<Mention> = Vec::new();
    for named in all {
        // In this order, a name comes after any that contains it. Equal spans are kept, for the proof to find.
        let inside = kept.last().is_some_and(|last: &Mention| {
            named.end < last.claimed || (named.end == last.claimed && last.at < named.at)
        });
        if !inside {
            kept.push(named);
        }
    }
    let mut found = vec![Vec::new(); fields.len()];
    let mut until = reply.len();
    let mut next_at = reply.len();
    for named in kept.into_iter().rev() {
        if named.at < next_at {
            until = next_at;
            next_at = named.at;
        }
        found[named.field].push(Mention { until, ..named });
    }
    for places in &mut found {
        places.reverse();
    }
    found
}

/// Returns the positions of a name, in any case and not as a part of another word.
fn occurrences(index: usize, field: &ActionField, reply: &str) -> Vec<Mention> {
    let mut before = ' ';
    let mut found = Vec::new();
    let Some(first) = field.name.chars().next() else {
        return found;
    };
    for (at, character) in reply.char_indices() {
        let previous = std::mem::replace(&mut before, character);
        if !character.eq_ignore_ascii_case(&first) || previous.is_alphanumeric() {
            continue;
        }
        let Some(length) = name_length(&field.name, &reply[at..]) else {
            continue;
        };
        let end = at + length;
        // `pickPoint` is one word in the text, but two words to the reader.
        let rest = &reply[end..];
        if rest.starts_with(|next: char| next.is_alphanumeric() && !next.is_uppercase()) {
            continue;
        }
        let noun = rest.trim_start_matches([' ', '_', '-']);
        let has_noun = field.is_point() && starts_with_word(noun, "point");
        let claimed = if has_noun {
            reply.len() - noun.len() + "point".len()
        } else {
            end
        };
        found.push(Mention {
            field: index,
            at,
            end,
            claimed,
            until: reply.len(),
        });
    }
    found
}

/// Returns the length of a name at the start of a text: `tip_angle`, `Tip angle`, `tipAngle`.
fn name_length(name: &str, text: &str) -> Option<usize> {
    let mut rest = text;
    for letter in name.chars() {
        if letter == '_' {
            rest = rest.strip_prefix(['_', ' ', '-']).unwrap_or(rest);
            continue;
        }
        let found = rest.chars().next()?;
        if !found.eq_ignore_ascii_case(&letter) {
            return None;
        }
        rest = &rest[found.len_utf8()..];
    }
    Some(text.len() - rest.len())
}

/// Returns whether one of the three words before `at`, in the same sentence, negates the statement.
pub(super) fn is_negated(reply: &str, at: usize) -> bool {
    let sentence = tail(&reply[..at], MAX_BEFORE)
        .rsplit(['\n', '\r', '.', ';', ',', ':', '!', '?'])
        .next()
        .unwrap_or_default();
    turns(sentence, 3, &NEGATING)
}

/// Returns whether one of the last words of a text is one of these; `don't` counts as `don`.
pub(super) fn turns(text: &str, last: usize, words: &[&str]) -> bool {
    text.rsplit(|character: char| !character.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .take(last)
        .any(|word| {
            words
                .iter()
                .any(|turning| word.eq_ignore_ascii_case(turning))
        })
}
