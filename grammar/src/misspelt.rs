//! Finds the misspelt keyword that explains why a piece does not parse.
//!
//! In: a piece of text, its strict rule, and where it fails. Out: the word and the keyword that was meant. A word counts
//! only if the piece parses further with the keyword in its place, so names that merely look like keywords do not.

use crate::fault::{Fault, Problem};
use crate::measure::is_word;
use crate::rules::{FabParser, Rule};
use crate::source::Span;
use crate::tree::{Kind, Tree};
use crate::vocabulary::grammar_words;
use pest::Parser;
use pest::error::InputLocation;
use std::ops::Range;

/// How many words before the failure are tried. A misspelt word may be read as a name, and a few more words after it.
const MOST_WORDS: usize = 6;

/// The longest piece that is tried, bytes: each try parses it again.
const MOST_BYTES: usize = 16 << 10;

/// A strict rule, and how lines of its block begin.
#[derive(Clone, Copy)]
pub(crate) struct Strict {
    pub rule: Rule,
    /// The words that may begin a line of the block. A misspelt one may be read as the end of the line before.
    pub begins: &'static [&'static str],
}

/// Returns the misspelt keyword because of which a piece fails at the byte `failed`, if there is one.
pub(crate) fn misspelt(tree: &Tree, strict: Strict, piece: Span, failed: usize) -> Option<Fault> {
    let text = &tree.text()[piece.range()];
    let failed = failed.checked_sub(piece.start)?.min(text.len());
    if text.len() > MOST_BYTES {
        return None;
    }
    let mut words = words(text, failed);
    let last = words.len().saturating_sub(MOST_WORDS);
    let mut best: Option<(usize, Range<usize>, Vec<&'static str>)> = None;
    for range in words.drain(last..).rev() {
        let word = &text[range.clone()];
        let after = failed.max(range.end);
        for meant in candidates(word) {
            let rest = text.len() - after;
            let Some(left) = left_over(text, range.clone(), meant, strict) else {
                continue;
            };
            // Bytes that are left at the end do not depend on the keyword's length.
            match &mut best {
                _ if left >= rest => {}
                Some((least, word, meanings)) if left == *least && *word == range => {
                    meanings.push(meant);
                }
                Some((least, ..)) if left >= *least => {}
                _ => best = Some((left, range.clone(), vec![meant])),
            }
        }
    }
    let (_, range, meant) = best?;
    let span = tree.span(piece.start + range.start..piece.start + range.end);
    let word = text[range].to_owned();
    let problem = Problem::Misspelt { word, meant };
    Some(Fault { span, problem })
}

/// Returns whether the whole piece parses if a sign is left out.
pub(crate) fn parses_without(tree: &Tree, rule: Rule, piece: Span, sign: Span) -> bool {
    let text = &tree.text()[piece.range()];
    if text.len() > MOST_BYTES || sign.end > piece.end || sign.range().is_empty() {
        return false;
    }
    let (start, end) = (sign.start - piece.start, sign.end - piece.start);
    let rest = format!("{} {}", &text[..start], &text[end..]);
    parsed(rule, &rest) == rest.len()
}

/// Returns how many bytes do not parse if a word is replaced; `None` if the text before it does not parse.
fn left_over(text: &str, range: Range<usize>, meant: &str, strict: Strict) -> Option<usize> {
    let repaired = format!("{}{meant}{}", &text[..range.start], &text[range.end..]);
    let left = repaired.len() - parsed(strict.rule, &repaired);
    let before = text[..range.start].trim_end();
    if left == 0 || before.is_empty() || !strict.begins.contains(&meant) {
        return Some(left);
    }
    // The keyword may begin a line of its own.
    let is_whole = parsed(strict.rule, before) == before.len();
    let line = &repaired[range.start..];
    let left_of_line = line.len() - parsed(strict.rule, line);
    Some(if is_whole {
        left.min(left_of_line)
    } else {
        left
    })
}

/// Returns how many bytes of a text parse without junk.
fn parsed(rule: Rule, text: &str) -> usize {
    match FabParser::parse(rule, text) {
        Ok(pairs) => {
            let mut junk = pairs.flatten().filter(|pair| {
                let kind = Kind::of(pair.as_rule());
                kind.is_junk() || matches!(kind, Kind::NoOpen | Kind::NoClose)
            });
            junk.next()
                .map_or(text.len(), |pair| pair.as_span().start())
        }
        Err(error) => match error.location {
            InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
        },
    }
}

/// Returns the words outside of texts and comments that begin at or before `failed`.
fn words(text: &str, failed: usize) -> Vec<Range<usize>> {
    let mut words = Vec::new();
    let mut at = 0;
    while at < text.len() && at <= failed {
        let rest = &text[at..];
        let is_name = |character: char| character.is_alphanumeric() || character == '_';
        let length = if let Some(body) = rest.strip_prefix("\"\"\"") {
            body.find("\"\"\"").map_or(3, |length| length + 6)
        } else if let Some(body) = rest.strip_prefix('"') {
            body.find(['"', '\n', '\r']).map_or(1, |length| length + 2)
        } else if rest.starts_with('#') {
            rest.find(['\n', '\r']).unwrap_or(rest.len())
        } else {
            let word = rest.find(|next| !is_name(next)).unwrap_or(rest.len());
            if is_word(&rest[..word]) && !grammar_words().contains(&&rest[..word]) {
                words.push(at..at + word);
            }
            word.max(rest.chars().next().map_or(1, char::len_utf8))
        };
        at = (at + length).min(text.len());
        while !text.is_char_boundary(at) {
            at += 1;
        }
    }
    words
}

/// Returns the keywords that are one slip away from a word, the likelier slips first.
fn candidates(word: &str) -> impl Iterator<Item = &'static str> {
    let mut near: Vec<(Slip, &str)> = grammar_words()
        .iter()
        .filter_map(|keyword| Some((slip(keyword, word)?, *keyword)))
        .collect();
    near.sort_by_key(|(slip, _)| *slip);
    near.into_iter().map(|(_, keyword)| keyword)
}

/// A slip of the fingers; likelier ones first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Slip {
    Swapped,
    Doubled,
    Dropped,
    Added,
    Replaced,
}

/// Returns how a word differs from a keyword, if by one slip.
fn slip(keyword: &str, word: &str) -> Option<Slip> {
    if keyword.len().abs_diff(word.len()) > 1 || keyword == word {
        return None;
    }
    let (meant, written) = (keyword.as_bytes(), word.as_bytes());
    let pairs = || meant.iter().zip(written);
    let start = pairs().take_while(|(a, b)| a == b).count();
    let ends = meant[start..]
        .iter()
        .rev()
        .zip(written[start..].iter().rev());
    let end = ends.take_while(|(a, b)| a == b).count();
    match (
        &meant[start..meant.len() - end],
        &written[start..written.len() - end],
    ) {
        ([], [added]) if start > 0 && meant[start - 1] == *added => Some(Slip::Doubled),
        ([], [_]) => Some(Slip::Added),
        ([_], []) => Some(Slip::Dropped),
        ([_], [_]) => Some(Slip::Replaced),
        ([a, b], [c, d]) if a == d && b == c => Some(Slip::Swapped),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_one_letter_or_two_neighbours() {
        assert_eq!(slip("when", "wehn"), Some(Slip::Swapped));
        assert_eq!(slip("when", "whenn"), Some(Slip::Doubled));
        assert_eq!(slip("when", "wen"), Some(Slip::Dropped));
        assert_eq!(slip("when", "whens"), Some(Slip::Added));
        assert_eq!(slip("when", "whem"), Some(Slip::Replaced));
        assert_eq!(slip("all", "al"), Some(Slip::Dropped));
        assert_eq!(slip("when", "when"), None);
        assert_eq!(slip("when", "nehw"), None);
        assert_eq!(slip("in", "é"), None);
    }
}
