//! The words that descriptions and reasons are made of.
//!
//! Withdrawals come in endless words. So after the values, and beside them, a clause that speaks of the answer, its
//! author or its reader is not understood if it has a word that is not known here, and the model is asked again.

use super::vocabulary::{PEOPLE, SUPERIOR};
use std::collections::HashSet;
use std::sync::LazyLock;

/// The stems of the known words.
static KNOWN: LazyLock<HashSet<String>> = LazyLock::new(|| {
    include_str!("known.txt")
        .split_whitespace()
        .map(stem)
        .collect()
});

/// Endings that do not change what a word means; the first that fits is removed.
const ENDINGS: [&str; 13] = [
    "ingly", "edly", "ing", "ies", "ied", "est", "ed", "es", "er", "ly", "s", "e", "y",
];

/// The fewest words of a sentence that shows that an answer is in another language.
const MIN_FOREIGN: usize = 4;

/// How many words a sentence has, and how many of them are not known. Short words and other scripts are left out.
fn count(words: &[&str]) -> (usize, usize) {
    let is_letter = |letter: char| letter.is_ascii_lowercase();
    let plain = words
        .iter()
        .filter(|it| it.len() > 2 && it.chars().all(is_letter));
    plain.fold((0, 0), |(n_words, n_strange), word| {
        (
            n_words + 1,
            n_strange + usize::from(!KNOWN.contains(&stem(word))),
        )
    })
}

/// Returns whether a clause has a word that is not known.
///
/// `the placket` names a thing; judgements are seldom definite.
pub(super) fn has_strange_word(words: &[&str]) -> bool {
    let is_thing = |at: usize| {
        let judges = PEOPLE.contains(&words[at]) || SUPERIOR.contains(&words[at]);
        at > 0 && words[at - 1] == "the" && !judges && words[at] != "truth"
    };
    (0..words.len()).any(|at| count(&words[at..=at]).1 > 0 && !is_thing(at))
}

/// Returns whether a sentence is in another language than English.
pub(super) fn is_foreign(words: &[&str]) -> bool {
    let (n_words, n_strange) = count(words);
    let is_foreign = |word: &&str| {
        let is_word = word.chars().count() > 2 && word.chars().all(char::is_alphabetic);
        is_word && !word.is_ascii()
    };
    n_words >= MIN_FOREIGN && n_strange * 2 > n_words || words.iter().any(is_foreign)
}

/// Removes the endings of a word.
fn stem(word: &str) -> String {
    let mut bare = word;
    loop {
        // `flipped`, `flip`
        let mut ends = bare.bytes().rev();
        let is_doubled = bare.len() > 3 && ends.next() == ends.next();
        bare = &bare[..bare.len() - usize::from(is_doubled)];
        let shorter = ENDINGS
            .iter()
            .find_map(|ending| bare.strip_suffix(ending).filter(|left| left.len() > 2));
        match shorter {
            Some(shorter) => bare = shorter,
            None => return bare.to_owned(),
        }
    }
}
