//! Reads how large an answer says in words that a length is, or how strong: `a short pull`, `the gentlest grip`.
//!
//! In: the sentences of an answer. Out: the offered values that the words can mean. Models explain one value and give
//! another one, so a value that no such words can mean is not what they mean.

use super::claim::{Claim, Claimed};
use super::lexer::{Gap, Kind, Token};
use super::wordlist::{self, UNREAL, words};
use crate::data::actions::{ActionField, Choices, Value};
use std::ops::Range;

/// What is said of the size of one kind of value.
struct Scale {
    /// Adjectives and adverbs at both ends, by how they begin.
    low: &'static [&'static str],
    high: &'static [&'static str],
    /// What has the size.
    nouns: &'static [&'static str],
    /// Verbs that an adverb may follow: `pinches it as gently as possible`.
    verbs: &'static [&'static str],
    /// Whether only an end says enough: `it slips out of a light hold` chooses nothing.
    only_extremes: bool,
}

const LENGTH: Scale = Scale {
    low: words!("short small tiny slight minimal minimum least"),
    high: words!("long large big great maximal maximum"),
    nouns: words!("pull tug nudge distance"),
    verbs: &[],
    only_extremes: false,
};

const FORCE: Scale = Scale {
    low: words!("soft gentl light weak loose delicate"),
    high: words!("firm strong tight hard"),
    nouns: words!("grip grips pinch hold grasp squeeze pressure touch setting"),
    verbs: words!(
        "pinch pinches pinched pinching grip grips gripped gripping hold holds grasped grasps close closes closing"
    ),
    only_extremes: true,
};

/// What may stand between an adjective and its noun.
const BETWEEN: &[&str] =
    words!("of the two three four five possible offered available allowed listed all and very");

/// What links a noun to an adjective behind it: `the pull is kept short`.
const LINKING: &[&str] = words!("is be stays stay kept keep remains remain");

/// What follows a length that is no choice: `a short distance from the center`, `the largest distance that is allowed`.
const LIMITING: &[&str] = words!(
    "from between away below above beside behind inside outside off past into along under over left to at that that's which where still needed required necessary"
);

/// What begins the reason or the conclusion, behind a comma.
const REASONING: &[&str] = words!("so since because as for therefore which hence thus but and");

/// What makes a superlative another value than the last one.
const SHORT_OF: &[&str] = words!(
    "second third next half two three quarter quarters twice double nearly almost not at below under within between than neither nor"
);

/// Words in -s behind a size that do not make it a general one: `the shortest pull suffices`.
const ABOUT_THIS_SIZE: &[&str] = words!("is suffices does works fits this thus as");

/// Other verbs that do: `the longest pull can crumple the cloth`.
const SUPPOSING: &[&str] = words!("can will must should");

/// The most words from a verb to its adverb.
const MAX_TO_ADVERB: usize = 6;

/// The most words from a noun to the adjective that is linked to it.
const MAX_TO_ADJECTIVE: usize = 4;

/// The end of a scale that a word names.
#[derive(Clone, Copy, PartialEq)]
enum End {
    Low,
    High,
}

impl Scale {
    /// Returns the scale of a field's values, if there is one.
    fn of(field: &ActionField) -> Option<&'static Scale> {
        match &field.choices {
            Choices::Lengths { .. } => Some(&LENGTH),
            Choices::Words { .. } => Some(&FORCE),
            _ => None,
        }
    }

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

    /// Returns what the word at this index says is chosen: an end, and whether nothing is farther out.
    fn chosen(&self, words: &[Token<'_>], at: usize) -> Option<(End, bool)> {
        let (end, is_superlative) = self.end(&words[at])?;
        let behind = &words[at + 1..];
        // `longer` compares with another value, `long enough` says little, and `the second longest` means another.
        let before = &words[at.saturating_sub(3)..at];
        if words[at].text.to_ascii_lowercase().ends_with("er")
            || behind.first().is_some_and(|it| it.is("enough"))
            || before.iter().any(|it| it.is_any(SHORT_OF))
            // `between the shortest and the longest pull`
            || before.iter().any(|it| self.end(it).is_some())
            // `With the longest pull the cloth slides off the table`
            || words[0].is("with") && at <= 2
        {
            return None;
        }
        let is_as =
            at > 0 && words[at - 1].is("as") && behind.first().is_some_and(|it| it.is("as"));
        let is_extreme = is_superlative
            || is_as
                && behind[1..]
                    .iter()
                    .take(3)
                    .any(|it| it.is_any(&["possible", "possibly"]));
        // `as long as` compares, or means `while`.
        if !is_extreme && (is_as || self.only_extremes) {
            return None;
        }
        let is_chosen = self.precedes_noun(&words[at], behind)
            || self.follows_verb(&words[at.saturating_sub(MAX_TO_ADVERB)..at])
            || self.follows_noun(&words[at.saturating_sub(MAX_TO_ADJECTIVE)..at]);
        is_chosen.then_some((end, is_extreme))
    }

    /// `(shortest) possible pull`
    fn precedes_noun(&self, adjective: &Token<'_>, behind: &[Token<'_>]) -> bool {
        // `the hardest one to reach` is no grip.
        let is_plain = self.only_extremes && adjective.is_any(&["softest", "gentlest", "firmest"]);
        let n_between = behind.iter().take_while(|it| it.is_any(BETWEEN)).count();
        let next = behind.get(n_between + 1);
        let is_limited = match self.only_extremes {
            true => behind.iter().take(n_between + 3).any(|it| it.is("still")),
            false => next.is_some_and(|it| it.is_any(LIMITING) || it.text.ends_with("ing")),
        };
        // `a long pull drags the whole cloth` is about long pulls in general, `the longest pull is 1 edge` about a choice.
        let is_number = behind
            .get(n_between + 2)
            .is_some_and(|it| it.kind == Kind::Number);
        let is_general = next.is_some_and(|it| {
            let is_verb =
                it.kind == Kind::Word && it.text.ends_with('s') && !it.is_any(ABOUT_THIS_SIZE);
            is_verb || it.is_any(SUPPOSING) || it.is("is") && is_number
        });
        let is_noun = |it: &Token<'_>| {
            let one = it.text.strip_suffix('s').unwrap_or(it.text);
            // `the smallest of the distances`, `the softest option`
            it.is_any(self.nouns)
                || behind[0].is("of") && wordlist::is_any(one, self.nouns)
                || is_plain && it.is_any(&["option", "one"])
        };
        !is_limited && !is_general && behind.get(n_between).is_some_and(is_noun)
    }

    /// `pinches it as (gently)`
    fn follows_verb(&self, before: &[Token<'_>]) -> bool {
        let verb = before.iter().rposition(|it| it.is_any(self.verbs));
        verb.is_some_and(|verb| before[verb..].iter().all(|it| it.kind == Kind::Word))
    }

    /// `the pull is kept (short)`
    fn follows_noun(&self, before: &[Token<'_>]) -> bool {
        let link = before.iter().rposition(|it| it.is_any(LINKING));
        link.is_some_and(|link| before[..link].iter().any(|it| it.is_any(self.nouns)))
    }
}

/// Returns where the parts of a sentence stand that give its reasons and its conclusion, as indices of tokens.
pub(super) fn parts(tokens: &[Token<'_>], sentence: Range<usize>) -> Vec<Range<usize>> {
    let mut parts = Vec::new();
    let mut begin = sentence.start;
    for at in sentence.start + 1..sentence.end {
        let is_reason = tokens[at].is_any(REASONING) && tokens[at - 1].is_sign(',');
        let is_apart = |at: usize| tokens.get(at).is_some_and(|it| it.gap > Gap::None);
        let is_dash = matches!(tokens[at].kind, Kind::Sign('-' | '–' | '—'))
            && is_apart(at)
            && is_apart(at + 1);
        // `the strongest grip to make sure that it does not slip`
        let is_aim = tokens[at].is("to")
            && tokens
                .get(at + 1)
                .is_some_and(|it| it.is_any(&["make", "ensure", "avoid", "prevent", "keep"]))
            // `There is no need to make the longest pull`
            && !tokens[begin..at]
                .iter()
                .any(|it| it.is_any(UNREAL) || it.is_any(&["need", "needed", "necessary"]));
        let is_aim =
            is_aim || tokens[at].is("in") && tokens.get(at + 1).is_some_and(|it| it.is("order"));
        let is_sign = is_dash || matches!(tokens[at].kind, Kind::Sign(';' | ':'));
        if is_reason || is_aim || is_sign {
            parts.push(begin..at);
            begin = at + usize::from(is_sign);
        }
    }
    parts.retain(|part| !part.is_empty());
    if begin < sentence.end {
        parts.push(begin..sentence.end);
    }
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
    let Some(scale) = Scale::of(field) else {
        return Vec::new();
    };
    let words = &tokens[part];
    let claims = (0..words.len()).filter_map(|at| {
        let (end, is_extreme) = scale.chosen(words, at)?;
        let values = values(&field.choices, scale, end, is_extreme)?;
        let behind = &words[at..words.len().min(at + 3)];
        let noun = behind.iter().rfind(|it| it.is_any(scale.nouns));
        Some(Claim::new(
            index,
            words[at].at..noun.unwrap_or(&words[at]).end(),
            Claimed::OneOf(values),
        ))
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
