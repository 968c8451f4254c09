//! Estimates how many tokens a text has. It is a rule of thumb, and is called an estimate wherever it is shown.

/// Letters per token, on average of English text.
const LETTERS: u64 = 4;

/// Estimates the tokens of a text: a quarter of its letters, rounded up.
pub fn of_text(text: &str) -> u64 {
    (text.chars().count() as u64).div_ceil(LETTERS)
}
