//! Finds the lines in which an answer weighs what it could choose: `Option A: …`, `- 10 mm: too short`.
//!
//! In: an answer. Out: the lines that choose nothing. They tell of values that the answer does not have.

use super::cursor::Cursor;
use super::lexer::{self, Gap, Kind, Token};
use super::sentences::Reader;
use super::value::{self, Clarity};
use super::wordlist::{is_any, words};
use crate::data::actions::Value;
use std::ops::Range;

/// Words with a number or a letter behind them that begin a line about one of several ways to act.
const WAYS: &[&str] = words!("option candidate possibility choice idea alternative");

/// Words in such a line that may choose what it says.
const CHOOSING: &[&str] = words!(
    "best better choose chosen chose choosing select selected selecting prefer preferred winner
    wins winning final answer yes ✅ ✓ ✔ ⭐"
);

/// One of several values that an answer weighs, on a line of its own.
pub(super) struct Candidate {
    /// The field, by its index.
    pub field: usize,
    pub value: Value,
    /// Its line, bytes.
    pub span: Range<usize>,
}

/// Returns whether a line tells one of several ways to act, and does not choose it: `Option A: corner (10, 20), 45 deg.`
pub(super) fn is_way(line: &str) -> bool {
    let is_mark = |letter: char| matches!(letter, '-' | '*' | '+' | '#' | '>' | '_' | ' ' | '•');
    let line = line.trim_start_matches(is_mark);
    let Some((word, rest)) = line.split_once(' ') else {
        return false;
    };
    let mut rest = rest.trim_start().chars();
    let is_label = { rest.next() }.is_some_and(|it| it.is_ascii_digit() || it.is_ascii_uppercase());
    let rest = rest.as_str().trim_start_matches(['*', '_', ' ']);
    let Some(said) = rest.strip_prefix([':', ')', '.', '–', '—', '-']) else {
        return false;
    };
    is_label && is_any(word, WAYS) && said.contains(char::is_alphanumeric) && !chooses(said)
}

fn chooses(line: &str) -> bool {
    line.split(|letter: char| !letter.is_alphanumeric() && !"✅✓✔⭐".contains(letter))
        .any(|word| is_any(word, CHOOSING))
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
            if !chooses(&text[span.clone()]) {
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
