//! Finds lists in which an answer weighs the values of a field: `- 10 mm: too short`.
//!
//! In: an answer. Out: the lines that choose nothing. They tell of values that the answer does not have.

use super::cursor::Cursor;
use super::lexer::{self, Gap, Kind, Token};
use super::sentences::Reader;
use super::value::{self, Clarity};
use super::ways;
use crate::data::actions::Value;
use std::ops::Range;

/// One of several values that an answer weighs, on a line of its own.
pub(super) struct Candidate {
    /// The field, by its index.
    pub field: usize,
    pub value: Value,
    /// Its line, bytes.
    pub span: Range<usize>,
}

/// Returns the items of lists that begin with different values of one field, with words behind each: `- 10 mm: too short`.
pub(super) fn listed(reader: &Reader<'_>, text: &str) -> Vec<Candidate> {
    let tokens = lexer::tokens(text);
    let items: Vec<usize> = (0..tokens.len())
        .filter(|at| tokens[*at].gap == Gap::Item)
        .collect();
    let mut found = Vec::new();
    let fields = reader.fields.iter().enumerate();
    for (field, _) in fields.filter(|(_, it)| !it.is_point()) {
        let context = reader.context(field, text, None, Clarity::Spoken);
        let mut list: Vec<Candidate> = Vec::new();
        let mut end = 0;
        for at in &items {
            let mut cursor = Cursor::at(&tokens, *at);
            let value = value::bare(&mut cursor, &context).filter(|_| weighs(cursor));
            // Another list, or something between its items.
            if value.is_none() || tokens[end..*at].iter().any(|it| it.gap == Gap::Block) {
                found.extend(several(&mut list));
            }
            let Some((value, _)) = value else {
                continue;
            };
            end = (at + 1..tokens.len())
                .find(|next| tokens[*next].gap >= Gap::Line)
                .unwrap_or(tokens.len());
            let span = tokens[*at].at..tokens[end - 1].end();
            if !ways::chooses(&text[span.clone()]) {
                list.push(Candidate { field, value, span });
            }
        }
        found.extend(several(&mut list));
    }
    found.sort_by_key(|it| it.span.start);
    found
}

/// Empties a list; returns what was in it if that weighs several values.
fn several(list: &mut Vec<Candidate>) -> Vec<Candidate> {
    let list = std::mem::take(list);
    match list.iter().any(|it| it.value != list[0].value) {
        true => list,
        false => Vec::new(),
    }
}

/// Returns whether words behind a sign follow a value: `: too short`, `→ the hem leans over`.
fn weighs(mut cursor: Cursor<'_, '_>) -> bool {
    let is_word = |token: &Token<'_>| token.kind == Kind::Word && token.gap < Gap::Line;
    cursor.eat_signs(&[':', '→', '–', '-', '=']).is_some() && cursor.peek().is_some_and(is_word)
}
