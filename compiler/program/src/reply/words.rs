//! Reads words: those that a field offers, and those for directions in the picture.

use super::cursor::{Cursor, first_word, head};
use super::names::{NEGATING, turns};

/// The longest part of a line that is searched for a word, bytes.
const MAX_CLAUSE: usize = 160;

/// Words that negate an offered word after them, besides [`NEGATING`].
const REFUSING: [&str; 14] = [
    "no", "non", "without", "than", "neither", "nor", "but", "except", "less", "too", "or",
    "either", "between", "unlike",
];

/// Parts of directions and their angle, degrees.
const SIDES: [(&str, f64); 32] = [
    ("right", 0.0),
    ("rightward", 0.0),
    ("rightwards", 0.0),
    ("east", 0.0),
    ("up", 90.0),
    ("upward", 90.0),
    ("upwards", 90.0),
    ("upper", 90.0),
    ("top", 90.0),
    ("north", 90.0),
    ("left", 180.0),
    ("leftward", 180.0),
    ("leftwards", 180.0),
    ("west", 180.0),
    ("down", 270.0),
    ("downward", 270.0),
    ("downwards", 270.0),
    ("lower", 270.0),
    ("bottom", 270.0),
    ("south", 270.0),
    ("northeast", 45.0),
    ("northwest", 135.0),
    ("southwest", 225.0),
    ("southeast", 315.0),
    ("topright", 45.0),
    ("topleft", 135.0),
    ("bottomleft", 225.0),
    ("bottomright", 315.0),
    ("upleft", 135.0),
    ("downleft", 225.0),
    ("downright", 315.0),
    ("eastward", 0.0),
];

/// Reads a direction in words, `up`, `top-left`, `left and up`; degrees. Otherwise the cursor does not move.
pub(super) fn side(cursor: &mut Cursor<'_>) -> Option<f64> {
    let first = one_side(cursor)?;
    let behind = *cursor;
    cursor.skip(|character| matches!(character, ' ' | '-' | '_' | '/'));
    if let Some(second) = one_side(cursor) {
        let (flat, upright) = if first % 180.0 == 0.0 {
            (first, second)
        } else {
            (second, first)
        };
        // One left or right and one up or down make a diagonal; `left left` and `up northeast` mean nothing.
        if flat % 180.0 == 0.0 && upright % 180.0 == 90.0 {
            return Some(match (flat == 0.0, upright == 90.0) {
                (true, true) => 45.0,
                (false, true) => 135.0,
                (false, false) => 225.0,
                (true, false) => 315.0,
            });
        }
    }
    *cursor = behind;
    Some(first)
}

fn one_side(cursor: &mut Cursor<'_>) -> Option<f64> {
    let word = first_word(cursor.rest());
    let (_, deg) = SIDES
        .iter()
        .find(|(side, _)| word.eq_ignore_ascii_case(side))?;
    cursor.at += word.len();
    Some(*deg)
}

/// Which offered word was found.
pub(super) enum Offered<'a> {
    One(&'a str),
    /// Two that could both be meant.
    Several(&'a str, &'a str),
    Nothing,
}

/// Reads the offered word at the cursor; the longest if one begins with another.
///
/// Letters may be of any case, and `very soft` may be written `very_soft`.
pub(super) fn direct<'a>(cursor: &mut Cursor<'_>, words: &'a [String]) -> Offered<'a> {
    let rest = cursor.rest();
    let mut best: Option<(usize, &str)> = None;
    let mut other: Option<&str> = None;
    for word in words.iter().filter(|word| !word.is_empty()) {
        let Some(length) = length_in(rest, word).filter(|length| ends_word(&rest[*length..]))
        else {
            continue;
        };
        match best {
            Some((longest, _)) if longest > length => {}
            Some((longest, known)) if longest == length => {
                // An exact match wins over one that differs in case or separators.
                if rest.starts_with(word.as_str()) {
                    (best, other) = (Some((length, word.as_str())), None);
                } else if !rest.starts_with(known) {
                    other = Some(word);
                }
            }
            _ => (best, other) = (Some((length, word.as_str())), None),
        }
    }
    match (best, other) {
        (Some((_, word)), Some(other)) => Offered::Several(word, other),
        (Some((length, word)), None) => {
            cursor.at += length;
            Offered::One(word)
        }
        (None, _) => Offered::Nothing,
    }
}

/// Finds the only offered word up to the next punctuation mark, and moves past the words there.
///
/// A negated word does not count.
pub(super) fn within<'a>(cursor: &mut Cursor<'_>, words: &'a [String]) -> Offered<'a> {
    let text = head(cursor.rest(), MAX_CLAUSE);
    let ends = |character: char| ".,;:!?()[]{}<>|\n\r".contains(character);
    let text = &text[..text.find(ends).unwrap_or(text.len())];
    let mut at = Cursor::new(text, 0);
    let mut found: Option<&str> = None;
    let mut before = ' ';
    while let Some(character) = at.peek() {
        // `non-soft` is not `soft`.
        let is_compound = before == '-'
            && text[..at.at]
                .trim_end_matches('-')
                .ends_with(char::is_alphanumeric);
        let begins = !before.is_alphanumeric() && !is_compound;
        before = character;
        let start = at.at;
        match if begins {
            direct(&mut at, words)
        } else {
            Offered::Nothing
        } {
            Offered::Several(one, other) => return Offered::Several(one, other),
            Offered::One(word) => {
                before = 'x';
                let preceding = &text[..start];
                if turns(preceding, 3, &NEGATING) || turns(preceding, 3, &REFUSING) {
                    continue;
                }
                match found {
                    Some(known) if known != word => return Offered::Several(known, word),
                    _ => found = Some(word),
                }
            }
            Offered::Nothing => at.step(),
        }
    }
    if turns(text, usize::MAX, &["or"]) {
        return Offered::Nothing;
    }
    cursor.at += text.trim_end().len();
    found.map_or(Offered::Nothing, Offered::One)
}

/// Returns the length of a word at the start of a text.
fn length_in(text: &str, word: &str) -> Option<usize> {
    let mut rest = text;
    for letter in word.chars() {
        let found = rest.chars().next()?;
        let is_blank = |character: char| matches!(character, ' ' | '_' | '-');
        let is_same = found == letter
            || (is_blank(found) && is_blank(letter))
            || found.to_lowercase().eq(letter.to_lowercase());
        if !is_same {
            return None;
        }
        rest = &rest[found.len_utf8()..];
    }
    Some(text.len() - rest.len())
}

/// Returns whether a word that precedes this text ends there.
fn ends_word(text: &str) -> bool {
    let mut letters = text.chars();
    match letters.next() {
        Some('-' | '_') => !letters.next().is_some_and(char::is_alphanumeric),
        Some(letter) => !letter.is_alphanumeric(),
        None => true,
    }
}
