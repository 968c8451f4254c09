//! Finds labelled statements: `Pick Point = (10, 20)`, `**Direction:** 45 deg (up)`, `<grip>soft</grip>`.
//!
//! In: a text. Out: claims, in order. A statement may stand anywhere. Behind its value there may be nothing, a comment in
//! brackets, another statement, or a sentence after punctuation; whatever else is there makes it unreadable.

use super::claim::{Claim, Claimed, Reader};
use super::cursor::Cursor;
use super::lexer::{self, Gap, Kind, TAG_END, Token};
use super::names::Label;
use super::point;
use super::value::{self, Context};
use crate::data::actions::{Choices, Value};

/// Words that may stand between the start of a clause and a label.
const LEADING: &str = "my the a final chosen selected answer action decision choice output result response so thus therefore hence recommended new next and then with";

/// Words that may introduce another value.
const TURNING: &str = "or no wait actually alternatively alternative correction sorry rather instead maybe perhaps possibly better then twice times each wrong if unless hmm";

/// The most tokens between the start of a clause and a label.
const MAX_LEAD: usize = 12;

/// The most tokens of a comment that are looked at.
const MAX_COMMENT: usize = 200;

/// Returns every labelled statement of a text.
pub(super) fn statements(reader: &Reader<'_>, text: &str) -> Vec<Claim> {
    let tokens = lexer::tokens(text);
    let ends = line_ends(&tokens);
    let mut claims = Vec::new();
    let (mut at, mut clause) = (0, 0);
    while at < tokens.len() {
        let ends_sentence = at > 0 && tokens[at - 1].is_sign('.') && tokens[at].gap >= Gap::Space;
        if tokens[at].gap >= Gap::Line || ends_sentence {
            clause = at;
        }
        let Some(label) = reader.names.label(&tokens, at) else {
            at += 1;
            continue;
        };
        let is_own = begins_clause(&tokens, clause, at);
        let (claimed, end) = statement(reader, &tokens, &ends, &label);
        if let Some(claimed) = claimed {
            let is_read = matches!(claimed, Claimed::Value(..) | Claimed::Axis(..));
            if is_read && is_own {
                clause = end;
            }
            let last = match is_read {
                true => end,
                false => ends[at].max(label.end),
            };
            claims.push(Claim {
                field: label.field,
                span: tokens[at].at..tokens[last - 1].end(),
                claimed,
                is_own,
            });
        }
        at = end.max(label.end).max(at + 1);
    }
    claims
}

/// Reads what follows a label; returns it, and the token after it. A label without anything, or with the format in
/// place of a value, states nothing.
fn statement(
    reader: &Reader<'_>,
    tokens: &[Token<'_>],
    ends: &[usize],
    label: &Label,
) -> (Option<Claimed>, usize) {
    let nothing = (None, label.end);
    let wrong = || match label.is_exact {
        true => (Some(Claimed::Unreadable), label.end),
        false => (Some(Claimed::Vague), label.end),
    };
    let is_next = |it: Label| it.end > label.end;
    let next = reader.names.label(tokens, label.end).is_some_and(is_next);
    if label.end >= tokens.len() || next {
        return nothing;
    }
    let mut cursor = Cursor::at(&tokens[..ends[label.end]], label.end);
    if let Some(axis) = label.axis {
        let number = point::number(&mut cursor);
        // `10-12`, `10 or 12`
        let goes_on = |it: &Token<'_>| lexer::is_any(it.text, "- – / % * + or to");
        let goes_on = cursor.peek().is_some_and(goes_on);
        return match number {
            Some(number) if !goes_on => (Some(Claimed::Axis(axis, number)), cursor.at),
            _ => wrong(),
        };
    }
    let context = reader.context(label.field);
    if let Some((value, note)) = value::read(&mut cursor, &context) {
        // The next item of a list.
        let next = ends[label.end];
        let is_item = |it: &Token<'_>| it.gap == Gap::Item;
        let is_list = is_item(&tokens[label.end]) && tokens.get(next).is_some_and(is_item);
        let other = is_list.then(|| Cursor::at(&tokens[..ends[next]], next));
        let other = other.and_then(|mut other| value::read(&mut other, &context));
        let is_only = other.is_none_or(|(other, _)| other == value);
        return match is_only && comment(reader, &mut cursor, &context, &value) {
            true => (Some(Claimed::Value(value, note)), cursor.at),
            false => wrong(),
        };
    }
    // `x: 10` and `y: 20` on lines of their own
    let end = ends[label.end];
    if context.field.is_point() && end < tokens.len() {
        let mut cursor = Cursor::at(&tokens[..ends[end]], label.end);
        if let Some((value, note)) = value::read(&mut cursor, &context) {
            return (Some(Claimed::Value(value, note)), cursor.at);
        }
    }
    match is_placeholder(cursor) {
        true => nothing,
        false => wrong(),
    }
}

/// Returns for each token the one that begins the next line.
fn line_ends(tokens: &[Token<'_>]) -> Vec<usize> {
    let mut end = tokens.len();
    let mut ends = vec![end; tokens.len()];
    for (at, token) in tokens.iter().enumerate().rev() {
        ends[at] = end;
        if token.gap >= Gap::Line {
            end = at;
        }
    }
    ends
}

/// Reads a text that is the value of a field, with nothing but a comment behind it.
pub(super) fn whole(reader: &Reader<'_>, field: usize, text: &str) -> Claimed {
    let tokens = lexer::tokens(text);
    let context = reader.context(field);
    let mut cursor = Cursor::at(&tokens, 0);
    let read = value::read(&mut cursor, &context);
    let read = read.filter(|(value, _)| comment(reader, &mut cursor, &context, value));
    read.map_or(Claimed::Unreadable, |(value, note)| {
        Claimed::Value(value, note)
    })
}

/// Returns whether a label begins a clause, or is an argument in the brackets of a call.
fn begins_clause(tokens: &[Token<'_>], clause: usize, at: usize) -> bool {
    let is_call = at > 1 && tokens[at - 1].is_sign('(') && tokens[at - 2].kind == Kind::Word;
    is_call
        || at - clause <= MAX_LEAD
            && tokens[clause..at].iter().all(|token| match token.kind {
                // `b) Pick Point`, `[x] Pick Point`
                Kind::Word => token.text.len() == 1 || token.is_any(LEADING),
                Kind::Number => false,
                Kind::Sign(_) | Kind::Tag => true,
            })
}

/// Returns whether the format stands in place of a value: `(x, y)`, `…`, `number`.
fn is_placeholder(mut cursor: Cursor<'_, '_>) -> bool {
    let start = cursor.at;
    let is_open = cursor.eat_signs(&['(', '[']).is_some();
    if is_open && cursor.eat_any("x y") && cursor.eat_sign(',') {
        return true;
    }
    cursor.skip(
        "x y number value",
        &['(', ')', '[', ']', '<', '>', ',', '…'],
    );
    cursor.at > start && cursor.peek().is_none()
}

/// Returns whether what stands between a value and the end of its line leaves the value as it is; moves past remarks in
/// brackets.
fn comment(
    reader: &Reader<'_>,
    cursor: &mut Cursor<'_, '_>,
    context: &Context<'_>,
    value: &Value,
) -> bool {
    while let Some(inside) = bracketed(cursor) {
        if !is_harmless(inside, context, Some(value)) {
            return false;
        }
    }
    // The brackets of a call: `fold(distance=0.75)  # over the center`
    while cursor.eat_signs(&[')', ']', '}']).is_some() {}
    let ends = |token: &Token<'_>| {
        token.gap >= Gap::Line || token.kind == Kind::Tag || token.is_sign(TAG_END)
    };
    let rest = cursor.rest();
    let rest = &rest[..rest.len().min(MAX_COMMENT)];
    let rest = &rest[..rest.iter().position(ends).unwrap_or(rest.len())];
    let Some(first) = rest.first() else {
        return true;
    };
    let changes = |token: &Token<'_>| match token.kind {
        Kind::Sign(sign) => "?+%±<>".contains(sign),
        _ => true,
    };
    let is_tail = rest.iter().all(|it| !changes(it) || it.is_any("and"));
    if is_tail {
        return true;
    }
    // Another statement.
    let mut next = Cursor::at(cursor.tokens, cursor.at);
    next.skip(LEADING, &[',', ';', '.', '|', '•', '→', '-', '–']);
    if reader.names.label(cursor.tokens, next.at).is_some() {
        return true;
    }
    // `0.25 – 0.5 edge`, `soft / firm`
    let mut other = Cursor::at(cursor.tokens, cursor.at);
    let is_joined = other.eat_signs(&['-', '–', '/', ',', ';', ':']).is_some();
    let is_range = is_joined || other.eat_any("to");
    if is_range && value::read(&mut other, context).is_some_and(|(other, _)| other != *value) {
        return false;
    }
    let is_word = first.is_any("because since as so to");
    let is_list = first.is_sign(',') || first.is_sign(':') || first.is_any("to as");
    let is_apart = first.gap >= Gap::Space;
    let begins = match first.kind {
        Kind::Sign('.' | ',' | ';' | '#' | '–' | '←' | ':' | '!') => true,
        Kind::Sign('-' | '/') => is_apart,
        _ => is_word,
    };
    // A sentence of its own may name other values; one behind a comma tells of this one.
    let said = match is_list {
        true => rest,
        false => {
            let is_stop = |token: &Token<'_>| token.is_sign('.') || token.is_sign(';');
            let sentence = rest[1..].iter().position(is_stop);
            &rest[..sentence.map_or(rest.len(), |length| length + 1)]
        }
    };
    begins && is_harmless(said, context, is_list.then_some(value))
}

/// Takes a remark in brackets; returns its tokens.
fn bracketed<'a, 't>(cursor: &mut Cursor<'a, 't>) -> Option<&'a [Token<'t>]> {
    let rest = cursor.rest();
    let open = rest.first().filter(|it| it.gap < Gap::Line)?;
    let (open, close) = match open.kind {
        Kind::Sign('(') => ('(', ')'),
        Kind::Sign('[') => ('[', ']'),
        _ => return None,
    };
    let mut depth = 0_usize;
    for (at, token) in rest.iter().take(MAX_COMMENT).enumerate() {
        depth += usize::from(token.is_sign(open));
        depth -= usize::from(token.is_sign(close));
        if depth == 0 {
            cursor.at += at + 1;
            return Some(&rest[..=at]);
        }
    }
    None
}

/// Returns whether a comment states nothing: it has no word that turns, and names no other value of the field.
///
/// - `value`: `None` if the comment may name others.
fn is_harmless(said: &[Token<'_>], context: &Context<'_>, value: Option<&Value>) -> bool {
    let turns = said.iter().enumerate().any(|(at, token)| match token.kind {
        // `counter-clockwise` is how angles are measured anyway.
        Kind::Word if token.is_any("clockwise") => {
            let mut before = said[at.saturating_sub(2)..at].iter();
            !before.any(|it| it.is_any("counter anti"))
        }
        Kind::Word => token.is_any(TURNING),
        Kind::Sign(sign) => "?±".contains(sign),
        _ => false,
    });
    let differs =
        |value: &Value| names_other(said, context, value) || points_elsewhere(said, context, value);
    !turns && !value.is_some_and(differs)
}

/// Returns whether a comment names another direction than its angle: `90 deg (straight down)`, not `(from the left)`.
fn points_elsewhere(said: &[Token<'_>], context: &Context<'_>, value: &Value) -> bool {
    let is_place = |it: &Token<'_>| it.is_any("from away corner side edge border of");
    let Value::Direction { deg } = value else {
        return false;
    };
    let mut words = (0..said.len()).filter(|at| said[*at].text.len() > 1);
    let named = words.find_map(|at| value::side(&mut Cursor::at(said, at)));
    value::is_compass(&context.field.choices)
        && !said.iter().any(is_place)
        && named.is_some_and(|named| named != *deg)
}

/// Returns whether tokens name a value of the field's kind that is not this one, offered or not.
fn names_other(said: &[Token<'_>], context: &Context<'_>, value: &Value) -> bool {
    (0..said.len()).any(|at| {
        let next = |ahead: usize| said.get(at + ahead);
        let is_number = |it: Option<&Token<'_>>| it.is_some_and(|it| it.kind == Kind::Number);
        let units = match context.field.choices {
            Choices::Directions { .. } => "deg degree degrees ° rad radians",
            _ => "edge edges mm cm m",
        };
        let begins = match context.field.choices {
            Choices::Words { .. } => false,
            _ if context.field.is_point() => {
                matches!(said[at].kind, Kind::Sign('(' | '['))
                    && is_number(next(1))
                    && next(2).is_some_and(|it| it.is_sign(','))
            }
            _ => is_number(next(0)) && next(1).is_some_and(|it| lexer::is_any(it.text, units)),
        };
        let is_negative = at > 0 && said[at - 1].is_sign('-') && said[at].gap == Gap::None;
        let mut cursor = Cursor::at(said, at - usize::from(is_negative));
        begins && value::read(&mut cursor, context).is_none_or(|(other, _)| other != *value)
    })
}
