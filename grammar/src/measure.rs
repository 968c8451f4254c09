//! Parses a piece of text by a strict rule, and finds the token at a place.

use crate::fault::{Fault, Problem};
use crate::rules::{FabParser, Rule};
use crate::source::Span;
use crate::tree::Tree;
use crate::vocabulary;
use pest::Parser;
use pest::error::{ErrorVariant, InputLocation};
use std::ops::Range;

/// Parses a piece by a strict rule and returns where and why it fails.
pub(crate) fn measure(tree: &Tree, rule: Rule, span: Span) -> Option<Fault> {
    let error = FabParser::parse(rule, &tree.text()[span.range()]).err()?;
    let offset = match error.location {
        InputLocation::Pos(at) => at,
        InputLocation::Span((start, _)) => start,
    };
    let ErrorVariant::ParsingError { positives, .. } = error.variant else {
        return None;
    };
    let words = positives.iter().filter_map(|rule| vocabulary::word(*rule));
    let words: Vec<&str> = words.collect();
    let is_needed = |rule: &Rule| !vocabulary::is_continuation(*rule);
    let mut expected: Vec<&str> = Vec::new();
    for needed in { positives.into_iter() }
        .filter(is_needed)
        .filter_map(vocabulary::expectation)
    {
        if !expected.contains(&needed) {
            expected.push(needed);
        }
    }
    let mut fault = unexpected(tree, tree.span(span.start + offset..span.end), expected);
    if let Problem::Unexpected { words: found, .. } = &mut fault.problem {
        *found = words;
    }
    Some(fault)
}

/// Makes the fault for the token at the beginning of `span`, or for the end of the line if there is none.
pub(crate) fn unexpected(tree: &Tree, span: Span, expected: Vec<&'static str>) -> Fault {
    let text = tree.text();
    let at = span.start;
    let at = at + (text[at..].len() - text[at..].trim_start_matches([' ', '\t', '\u{a0}']).len());
    // Report the token on this line even if it belongs to what comes next. Look for the end of a text only within the
    // span; beyond it the search would take quadratic time.
    let end = if text[at..].starts_with('"') {
        span.end.max(at)
    } else {
        text.len()
    };
    let found = token_at(text, at..end);
    let is_end = found.is_empty() || found.starts_with('#');
    let range = if is_end {
        // Point directly after the last word, not at the next line.
        let end = text[..at].trim_end().len();
        end..end
    } else {
        at..at + found.len()
    };
    Fault {
        span: tree.span(range),
        problem: Problem::Unexpected {
            found: (!is_end).then(|| found.to_owned()),
            expected,
            words: Vec::new(),
        },
    }
}

/// Returns the word, number, text or sign at the beginning of a piece of text.
pub(crate) fn token_at(text: &str, range: Range<usize>) -> &str {
    let rest = &text[range];
    let word = |character: char| character.is_alphanumeric() || character == '_';
    let Some(first) = rest.chars().next() else {
        return "";
    };
    if word(first) {
        return rest
            .split(|character| !word(character))
            .next()
            .unwrap_or(rest);
    }
    if rest.starts_with("\"\"\"") {
        return &rest[..3];
    }
    if first == '"' {
        let line = rest.split(['\n', '\r']).next().unwrap_or(rest);
        return line[1..]
            .find('"')
            .map_or(line, |length| &line[..length + 2]);
    }
    for sign in ["->", "=>", "<=", ">=", "==", "!=", "–>", "—>", "{{", "}}"] {
        if rest.starts_with(sign) {
            return &rest[..sign.len()];
        }
    }
    if first.is_whitespace() {
        ""
    } else {
        &rest[..first.len_utf8()]
    }
}

pub(crate) fn is_word(token: &str) -> bool {
    token.starts_with(|character: char| character.is_alphabetic() || character == '_')
}
