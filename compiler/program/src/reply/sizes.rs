//! Reads how large an answer says in words that a length is, or how strong: `a short pull`, `the gentlest grip`.
//!
//! In: the sentences of an answer. Out: the offered values that the words can mean. Models explain one value and give
//! another one, so a value that no such words can mean is not what they mean.

use super::claim::{Claim, Claimed};
use super::lexer::{Kind, Token};
use super::wordlist::words;
use crate::data::actions::{ActionField, Choices, Value};
use std::ops::Range;

/// Adjectives and adverbs at both ends of a scale, by how they begin.
struct Scale {
    low: &'static [&'static str],
    high: &'static [&'static str],
}

const LENGTH: Scale = Scale {
    low: words!("short small tiny slight minimal minimum least"),
    high: words!("long large big great maximal maximum"),
};

const FORCE: Scale = Scale {
    low: words!("soft gentl light weak loose delicate"),
    high: words!("firm strong tight hard"),
};

/// What is short or long.
const PULLS: &[&str] = words!("pull tug nudge distance drag");

/// What is gentle or firm.
const GRIPS: &[&str] = words!("grip grips pinch hold grasp squeeze pressure");

/// Verbs with an adverb: `pinches it gently`.
const GRIPPING: &[&str] =
    words!("pinch pinches pinched pinching grip grips gripped gripping held holds grasped grasps");

/// What may stand between an adjective and its noun.
const BETWEEN: &[&str] =
    words!("of the two three four five possible offered available allowed listed all and very");

/// What links a noun to an adjective behind it: `the pull is kept short`.
const LINKING: &[&str] = words!("is be stays stay kept keep remains");

/// What follows a size that is no choice: `a short distance from the center`, `the largest distance that is allowed`.
const LIMITING: &[&str] =
    words!("from between away below above beside behind to at that that's which where");

/// What begins the reason or the conclusion, behind a comma.
const REASONING: &[&str] = words!("so since because as for therefore which hence thus but and");

/// The most words from a noun or verb to an adjective behind it.
const MAX_BEHIND: usize = 6;

/// The end of a scale that a word names.
#[derive(Clone, Copy, PartialEq)]
enum End {
    Low,
    High,
}

impl Scale {
    /// Returns the end that a word names, and whether nothing is farther out: `shortest`, `minimal`.
    fn end(&self, token: &Token<'_>) -> Option<(End, bool)> {
        let text = token.text.to_ascii_lowercase();
        let begins = |stems: &[&str]| stems.iter().any(|stem| text.starts_with(stem));
        let is_extreme = text.ends_with("est") || text.starts_with("m") || text == "least";
        let end = match () {
            () if begins(self.low) => End::Low,
            () if begins(self.high) => End::High,
            () => return None,
        };
        Some((end, is_extreme))
    }
}

/// Returns where the parts of a sentence stand that give its reasons and its conclusion, as indices of tokens.
pub(super) fn parts(tokens: &[Token<'_>], sentence: Range<usize>) -> Vec<Range<usize>> {
    let mut parts = Vec::new();
    let mut begin = sentence.start;
    for at in sentence.start + 1..sentence.end {
        let is_reason = tokens[at].is_any(REASONING) && tokens[at - 1].is_sign(',');
        if is_reason || matches!(tokens[at].kind, Kind::Sign(';' | ':' | '-' | '–' | '—')) {
            parts.push(begin..at);
            begin = at;
        }
    }
    parts.push(begin..sentence.end);
    parts
}

/// Returns the offered values that a part of a sentence says it takes.
///
/// - `part`: its tokens' indices.
/// - `field`: the field and its index.
pub(super) fn of_part(
    tokens: &[Token<'_>],
    part: Range<usize>,
    (index, field): (usize, &ActionField),
) -> Vec<Claim> {
    let (scale, nouns) = match &field.choices {
        Choices::Lengths { .. } => (LENGTH, PULLS),
        Choices::Words { .. } => (FORCE, GRIPS),
        _ => return Vec::new(),
    };
    let words = &tokens[part];
    let said = (0..words.len()).filter_map(|at| {
        // `longer` compares with another length.
        let compares = nouns == PULLS && words[at].text.ends_with("er");
        let (end, mut is_extreme) = scale.end(&words[at]).filter(|_| !compares)?;
        let before = &words[at.saturating_sub(MAX_BEHIND)..at];
        let behind = &words[at + 1..];
        let n_between = behind.iter().take_while(|it| it.is_any(BETWEEN)).count();
        let noun = behind.get(n_between).filter(|it| it.is_any(nouns));
        let next = behind.get(n_between + 1);
        let is_limited = nouns == PULLS && next.is_some_and(|it| it.is_any(LIMITING));
        let is_before = noun.is_some() && !is_limited;
        let verb = before.iter().rposition(|it| it.is_any(GRIPPING));
        let is_adverb = nouns == GRIPS
            && verb.is_some_and(|verb| before[verb..].iter().all(|it| it.kind == Kind::Word));
        let link = before.iter().rposition(|it| it.is_any(LINKING));
        let is_behind = link.is_some_and(|link| before[..link].iter().any(|it| it.is_any(nouns)))
            && before
                .iter()
                .rposition(|it| it.is_any(nouns))
                .is_some_and(|noun| before.len() - noun <= 4);
        let is_as = before.last().is_some_and(|it| it.is("as"))
            && behind.first().is_some_and(|it| it.is("as"));
        is_extreme |= is_as && behind.get(1).is_some_and(|it| it.is("possible"));
        // `as long as` compares or means `while`, and `it slips out of a light hold` chooses nothing.
        let says_little = (is_as || nouns == GRIPS) && !is_extreme;
        (!says_little && (is_before || is_adverb || is_behind)).then_some((at, end, is_extreme))
    });
    let claims = said.filter_map(|(at, end, is_extreme)| {
        let values = values(&field.choices, &scale, end, is_extreme)?;
        let last = (at..words.len().min(at + 3))
            .rev()
            .find(|it| words[*it].is_any(nouns))
            .unwrap_or(at);
        Some(Claim {
            field: index,
            span: words[at].at..words[last].end(),
            claimed: Claimed::OneOf(values),
        })
    });
    claims.collect()
}

/// Returns the values at one end of what is offered; of several lengths the half, with the middle one.
fn values(choices: &Choices, scale: &Scale, end: End, is_extreme: bool) -> Option<Vec<Value>> {
    match choices {
        Choices::Lengths { choices, .. } => {
            let mut choices: Vec<_> = choices.iter().collect();
            choices.sort_by(|one, other| one.m.total_cmp(&other.m));
            if end == End::High {
                choices.reverse();
            }
            let n_meant = match is_extreme {
                true => 1,
                false => choices.len().div_ceil(2),
            };
            let meant = choices.into_iter().take(n_meant);
            Some(meant.map(|it| Value::Length { length: it.value }).collect())
        }
        Choices::Words { choices } => {
            let ends: Option<Vec<End>> = choices
                .iter()
                .map(|choice| {
                    let words = super::lexer::tokens(choice);
                    words
                        .iter()
                        .find_map(|it| scale.end(it))
                        .map(|(end, _)| end)
                })
                .collect();
            // Words on no scale, or all at one end, cannot be told apart.
            let ends = ends.filter(|ends| ends.windows(2).any(|pair| pair[0] != pair[1]))?;
            let meant = choices.iter().zip(ends).filter(|(_, it)| *it == end);
            let value = |word: &String| Value::Word(word.clone());
            Some(meant.map(|(word, _)| value(word)).collect())
        }
        _ => None,
    }
}
