//! Finds what an answer states about each field.
//!
//! In: an answer. Out: claims, in order. Objects and tables are read as data, everything else as sentences. Thoughts,
//! quotations, examples and negations claim nothing.

use super::around;
use super::aside::{self, Aside, Cleared};
use super::candidates::{self, Candidate};
use super::chosen;
use super::claim::{Claim, Claimed};
use super::data;
use super::doubt::{self, Place};
use super::lexer::{self, Kind, Token};
use super::names;
use super::object;
use super::remarks;
use super::sentences::Reader;
use crate::data::actions::Value;
use std::ops::Range;

/// What an answer claims.
pub(super) struct Claims {
    pub claims: Vec<Claim>,
    /// Where the answer takes something back: `no wait`, `correction`.
    pub turns: Vec<usize>,
    pub cleared: Cleared,
    /// Why the answer as a whole is in doubt.
    pub doubt: Option<&'static str>,
}

/// An answer without what states nothing, for readers of other forms than an action's.
pub struct Standing {
    /// The answer, of the same length; thoughts, quotations and their like are blanks.
    pub text: String,
    /// What was set aside, in order.
    pub asides: Vec<(Range<usize>, Aside)>,
    /// Where the answer takes something back: if a value follows, none before it counts.
    pub turns: Vec<usize>,
    /// Whether a thought never ends, so that the answer is missing.
    pub is_cut_off: bool,
}

/// Sets aside what an answer does not state.
pub fn standing(reply: &str) -> Standing {
    let cleared = aside::clear(reply);
    Standing {
        turns: turns(&lexer::tokens(&cleared.text)),
        text: cleared.text,
        asides: cleared.asides,
        is_cut_off: cleared.is_cut_off,
    }
}

/// Phrases that take back what stands before them.
const TURNS: [&str; 26] = [
    "oops",
    "no wait",
    "no , wait",
    "wait",
    "correction",
    "i mean",
    "scratch that",
    "on second thought",
    "use this answer instead",
    "use this instead",
    "use these values instead",
    "use these instead",
    "revised answer",
    "corrected answer",
    "corrected final answer",
    "corrected , final answer",
    "i change the",
    "let me change",
    "second try :",
    "second attempt :",
    "new attempt :",
    "thinking about it again",
    "my answer is then :",
    "let me correct",
    "let me revise",
    "let me reconsider",
];

/// The most claims in words within objects; each is looked for in the whole answer.
const MAX_WORDED: usize = 16;

/// Returns everything that an answer states.
pub(super) fn of(reader: &Reader<'_>, reply: &str) -> Claims {
    let cleared = aside::clear(reply);
    let mut text = cleared.text.clone();
    let mut claims = Vec::new();
    let points = data::tagged_points(reader, &text, &mut claims);
    text = aside::blanked(&text, &points);
    let is_field = |key: &str| names::labelled(reader.fields, &lexer::tokens(key)).is_some();
    let objects = object::objects(&text);
    let beside = data::beside(&text, &objects, &is_field);
    let objects = data::objects(reader, objects, &mut claims);
    text = aside::blanked(&text, &objects);
    let prose = doubt::prose(&lexer::tokens(&text), doubt::MIN_EXPLANATION);
    let tables = data::tables(reader, &text, &mut claims);
    text = aside::blanked(&text, &tables);
    text = without_candidates(reader, text);
    claims.extend(reader.sentences(&text, None));
    let tokens = lexer::tokens(&text);
    let chosen = chosen::of(reader, &text, &tokens, &claims);
    claims.extend(chosen);
    let reasons = worded(reader, &beside.reasons, reply).into_iter();
    // A direction in words may stand for an angle, but not from within a reason.
    let is_stated = |field| {
        let stated = |it: &Claim| it.field == field && !it.claimed.is_worded();
        claims.iter().any(stated)
    };
    let reasons: Vec<Claim> = reasons
        .filter(|it| !matches!(it.claimed, Claimed::Course(_)) || is_stated(it.field))
        .collect();
    claims.extend(reasons);
    let unnamed = around::unnamed(reader, &text, &tokens, &claims);
    claims.extend(unnamed);
    claims.sort_by_key(|claim| claim.span.start);
    if let Some(end) = cut_off(&tokens) {
        let last = claims.iter_mut().filter(|claim| claim.span.end == end);
        last.for_each(|claim| claim.claimed = Claimed::Bad("its number may be cut off".to_owned()));
    }
    let turns = turns(&tokens);
    // A direction or size in words within an explanation does not move the end of the answer.
    let is_worded = |claim: &Claim| claim.claimed.is_worded();
    let mut has_value = vec![false; reader.fields.len()];
    for claim in claims.iter().filter(|claim| !is_worded(claim)) {
        has_value[claim.field] = true;
    }
    // After `No wait`, an answer that is whole again stands for itself.
    let restart = turns.iter().copied().rfind(|turn| {
        let follows = |field: usize| {
            let own = || {
                claims
                    .iter()
                    .filter(|claim| claim.field == field && !is_worded(claim))
            };
            own().any(|claim| claim.span.start < *turn)
                && own().any(|claim| claim.span.start > *turn)
        };
        (0..reader.fields.len()).all(follows)
    });
    let placed: Vec<&Claim> = claims
        .iter()
        .filter(|claim| !(is_worded(claim) && has_value[claim.field]))
        .filter(|claim| restart.is_none_or(|turn| claim.span.start > turn))
        .collect();
    let stated = placed
        .iter()
        .map(|claim| claim.span.start)
        .min()
        .map(|first| {
            let last = placed.iter().map(|claim| claim.span.start).max();
            let firsts = (0..reader.fields.len()).map(|field| {
                let own = placed.iter().filter(|claim| claim.field == field);
                own.map(|claim| claim.span.start)
                    .min()
                    .unwrap_or(usize::MAX)
            });
            let end = placed.iter().map(|claim| claim.span.end).max();
            remarks::Stated {
                first,
                settled: firsts.max().unwrap_or(usize::MAX),
                last: last.unwrap_or(first),
                end: end.unwrap_or(first),
            }
        });
    if let Some(stated) = stated {
        let others = around::remarks(reader, &text, &tokens, &claims, stated);
        claims.extend(others);
    }
    let at = reply.len();
    let judged = restart.map_or(0, |turn| tokens.partition_point(|token| token.at <= turn));
    let above = match (restart, claims.iter().find(|claim| !is_worded(claim))) {
        (Some(_), Some(first)) => tokens.partition_point(|token| token.at < first.span.start),
        _ => 0,
    };
    let heading =
        stated.and_then(|stated| around::heading(&text, &cleared.asides, &tokens, stated.first));
    let doubt = heading
        .or_else(|| remarks::doubt_in(&tokens[..above], None, Place::Before, prose))
        .or_else(|| remarks::doubt_in(&tokens[judged..], stated, Place::Before, prose))
        .or_else(|| remarks::doubt_beside(&beside));
    let beside = lexer::tokens(&beside.said);
    let remarks = remarks::of(&tokens, reader.notation, stated);
    let remarks = remarks
        .into_iter()
        .chain(remarks::of(&beside, reader.notation, None));
    for (about, why) in remarks {
        for (field, declared) in reader.fields.iter().enumerate() {
            if about.concerns(declared) {
                claims.push(Claim::new(field, at..at, Claimed::Bad(why.clone())));
            }
        }
    }
    Claims {
        claims,
        turns,
        cleared,
        doubt,
    }
}

/// Blanks the candidates that the rest of the text does not choose.
fn without_candidates(reader: &Reader<'_>, text: String) -> String {
    let candidates = candidates::listed(reader, &text);
    if candidates.is_empty() {
        return text;
    }
    let spans: Vec<Range<usize>> = candidates.iter().map(|it| it.span.clone()).collect();
    let stated = reader.sentences(&aside::blanked(&text, &spans), None);
    // What is weighed below the answer may take it back.
    let is_passed_over = |candidate: &&Candidate| {
        let own = stated
            .iter()
            .filter(|it| it.value_of(candidate.field).is_some());
        let last = own.clone().map(|it| it.span.start).max();
        let is_other = |it: &Claim| it.value_of(candidate.field) != Some(&candidate.value);
        last.is_some_and(|last| candidate.span.end <= last) && own.clone().all(is_other)
    };
    let passed_over = candidates.iter().filter(is_passed_over);
    let spans: Vec<Range<usize>> = passed_over.map(|it| it.span.clone()).collect();
    aside::blanked(&text, &spans)
}

/// Returns what the reasons within an object say of the values: words that are coarser than the choices, and points.
fn worded(reader: &Reader<'_>, reasons: &str, reply: &str) -> Vec<Claim> {
    let claims = reader.sentences(reasons, None).into_iter();
    let claims = claims.filter(|claim| {
        matches!(
            claim.claimed,
            Claimed::Side(_)
                | Claimed::OneOf(_)
                | Claimed::Course(_)
                | Claimed::Value(Value::Point(_), _)
        )
    });
    let claims = claims.take(MAX_WORDED).map(|claim| {
        // Escaped letters stand otherwise in the answer.
        let said = &reasons[claim.span.clone()];
        let start = reply.find(said).unwrap_or(reply.len());
        let end = reply.len().min(start + said.len());
        // A point within a reason is held against the value, but is none itself.
        let claimed = match claim.claimed {
            Claimed::Value(value @ Value::Point(_), _) => Claimed::OneOf(vec![value]),
            claimed => claimed,
        };
        Claim {
            span: start..end,
            claimed,
            ..claim
        }
    });
    claims.collect()
}

/// Returns where a text ends, if it ends with a number inside of braces that are never closed.
fn cut_off(tokens: &[Token<'_>]) -> Option<usize> {
    let last = tokens.last().filter(|last| last.kind == Kind::Number)?;
    let count = |sign: char| tokens.iter().filter(|token| token.is_sign(sign)).count();
    (count('{') > count('}')).then(|| last.end())
}

/// Returns where a text takes something back.
fn turns(tokens: &[Token<'_>]) -> Vec<usize> {
    let phrases: Vec<Vec<Token<'_>>> = TURNS.iter().map(|phrase| lexer::tokens(phrase)).collect();
    let says = |at: usize| {
        phrases.iter().any(|phrase| {
            phrase.len() <= tokens.len() - at
                && phrase.iter().zip(&tokens[at..]).all(|(wanted, found)| {
                    wanted.kind == found.kind && wanted.text.eq_ignore_ascii_case(found.text)
                })
        })
    };
    (0..tokens.len())
        .filter(|at| says(*at))
        .map(|at| tokens[at].at)
        .collect()
}
