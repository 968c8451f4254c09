//! Phrases by which an answer says that its values are no answer: it saw no picture, gave an example, or counts in another
//! frame.

use super::lexer::{self, Kind};

/// What makes an answer unusable, in lower case, as its words and numbers follow each other.
const PHRASES: [&str; 12] = [
    "no image",
    "no picture",
    "can't see any",
    "cannot see the picture",
    "can't view",
    "unable to view",
    "not able to see",
    "don't see an",
    "placeholder",
    "are made up",
    "dummy",
    "normalized",
];

/// Returns the first such phrase that a text contains.
pub(super) fn unusable(text: &str) -> Option<&'static str> {
    let tokens = lexer::tokens(text);
    let mut words = String::with_capacity(text.len() + 2);
    words.push(' ');
    for token in tokens {
        if matches!(token.kind, Kind::Word | Kind::Number) {
            words.extend(token.text.chars().map(|letter| match letter {
                '’' => '\'',
                _ => letter.to_ascii_lowercase(),
            }));
            words.push(' ');
        }
    }
    PHRASES
        .into_iter()
        .find(|phrase| words.contains(&format!(" {phrase} ")))
}
