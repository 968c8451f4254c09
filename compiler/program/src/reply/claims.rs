//! Finds what an answer states about each field.
//!
//! In: an answer. Out: claims, in order. Objects and tables are read as data, everything else as sentences. Thoughts,
//! quotations, examples and negations claim nothing.

use super::aside::{self, Aside, Cleared};
use super::data;
use super::lexer::{self, Gap, Token};
use super::sentences::{Claim, Claimed, Reader};
use super::value;
use std::ops::Range;

/// What an answer claims.
pub(super) struct Claims {
    pub claims: Vec<Claim>,
    /// Where the answer takes something back: `no wait`, `final answer`.
    pub turns: Vec<usize>,
    pub cleared: Cleared,
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
const TURNS: [&str; 13] = [
    "no wait",
    "no , wait",
    "wait",
    "correction",
    "i mean",
    "scratch that",
    "on second thought",
    "final answer",
    "revised answer",
    "corrected answer",
    "let me correct",
    "let me revise",
    "let me reconsider",
];

/// Returns everything that an answer states.
pub(super) fn of(reader: &Reader<'_>, reply: &str) -> Claims {
    let cleared = aside::clear(reply);
    let mut text = cleared.text.clone();
    let mut claims = Vec::new();
    let points = data::tagged_points(reader, &text, &mut claims);
    text = aside::blanked(&text, &points);
    let objects = data::objects(reader, &text, &mut claims);
    text = aside::blanked(&text, &objects);
    let tables = data::tables(reader, &text, &mut claims);
    text = aside::blanked(&text, &tables);
    claims.extend(reader.sentences(&text, None));
    claims.sort_by_key(|claim| claim.span.start);
    let tokens = lexer::tokens(&text);
    let turns = turns(&tokens);
    let last = claims.iter().map(|claim| claim.span.start).max();
    if let Some(why) = reframed(&tokens, reader.notation.is_native(), last) {
        let at = reply.len();
        for (field, _) in reader
            .fields
            .iter()
            .enumerate()
            .filter(|(_, field)| field.is_point())
        {
            claims.push(Claim {
                field,
                span: at..at,
                claimed: Claimed::Bad(why.clone()),
            });
        }
    }
    Claims {
        claims,
        turns,
        cleared,
    }
}

/// Returns why the points of an answer are not those of the picture that was sent, or not its answer at all.
///
/// - `last_claim`: where the last claim begins; what takes an answer back stands after it.
fn reframed(tokens: &[Token<'_>], is_native: bool, last_claim: Option<usize>) -> Option<String> {
    let mut start = 0;
    let is_after_claims = |sentence: &[Token<'_>]| last_claim.is_some_and(|at| sentence[0].at > at);
    for index in 0..tokens.len() {
        let is_last = index + 1 == tokens.len();
        if !is_last && !value::ends_sentence(tokens, index) && tokens[index + 1].gap < Gap::Item {
            continue;
        }
        let sentence = &tokens[start..=index];
        start = index + 1;
        let says = |words: &[&str]| sentence.iter().find(|token| token.is_any(words));
        let denies = says(&["not", "no", "without", "top"]).is_some();
        if is_native
            && !denies
            && says(&["origin"]).is_some()
            && says(&["bottom", "lower", "center", "centre"]).is_some()
        {
            return Some("the answer counts from another origin than the top left".to_owned());
        }
        let is_scale = says(&["coordinates", "coordinate", "points", "values"]).is_some();
        let is_axes = says(&["coordinates", "coordinate", "x"]).is_some();
        let counts = says(&["normalized", "normalised"]).is_some() && is_scale
            || says(&["percent", "percentages", "thousandths"]).is_some() && is_axes;
        if is_native && !denies && counts {
            return Some("the answer counts in another unit than pixels".to_owned());
        }
        // `Please disregard those two lines`, `exchange the two points`
        let is_answer = says(&[
            "those", "these", "above", "two", "both", "points", "lines", "answer", "that", "it",
        ])
        .is_some();
        let revokes = says(&[
            "disregard",
            "ignore",
            "forget",
            "exchange",
            "swap",
            "swapped",
            "withdraw",
            "retract",
        ]);
        if let Some(word) = revokes
            && is_answer
            && !denies
            && is_after_claims(sentence)
        {
            return Some(format!("the answer takes it back with `{}`", word.text));
        }
        let is_picture = says(&["picture", "image", "crop", "view", "version"]).is_some();
        if let Some(word) = says(&[
            "enlarged",
            "cropped",
            "zoomed",
            "upscaled",
            "rescaled",
            "magnified",
        ]) && is_picture
            && is_native
            && !denies
        {
            return Some(format!(
                "the answer refers to a picture that is {}",
                word.text
            ));
        }
    }
    None
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
