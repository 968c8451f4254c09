//! Reads words: those that a field offers, and those for directions in the picture.

use super::cursor::Cursor;
use super::lexer::{self, Kind, Token};
use super::wordlist::words;

/// Parts of directions and their angle, degrees.
const SIDES: &[(&[&str], f64)] = &[
    (words!("right rightward rightwards east eastward"), 0.0),
    (
        words!("up upward upwards upper top north northward n"),
        90.0,
    ),
    (words!("left leftward leftwards west westward w"), 180.0),
    (
        words!("down downward downwards lower bottom south southward"),
        270.0,
    ),
    (words!("northeast ne topright upright"), 45.0),
    (words!("northwest nw topleft upleft"), 135.0),
    (words!("southwest sw bottomleft downleft"), 225.0),
    (words!("southeast se bottomright downright"), 315.0),
];

/// Arrows that are directions.
const ARROWS: [(char, f64); 10] = [
    ('⬇', 270.0),
    ('⬅', 180.0),
    ('↑', 90.0),
    ('↓', 270.0),
    ('←', 180.0),
    ('↗', 45.0),
    ('↖', 135.0),
    ('↙', 225.0),
    ('↘', 315.0),
    ('⬆', 90.0),
];

/// Words before a direction that do not change it.
const LEADING: &[&str] = words!(
    "to toward towards the pointing points straight directly diagonally diagonal horizontally vertically going in into
    due facing heading empty free open bare"
);

/// Words after a direction that do not change it.
const TRAILING: &[&str] = words!(
    "direction diagonal diagonally corner side edge of the image picture frame table in image's part border"
);

/// Reads a direction in words, `straight up`, `top-left`, `left and up`; degrees. Otherwise the cursor does not move.
pub(super) fn side(cursor: &mut Cursor<'_, '_>) -> Option<f64> {
    let start = *cursor;
    cursor.skip(LEADING, &[]);
    let Some(first) = one_side(cursor) else {
        *cursor = start;
        return None;
    };
    let behind = *cursor;
    let _ = cursor.eat_signs(&['-', '/']);
    cursor.eat_word("and");
    cursor.skip(&["to", "the", "towards"], &[]);
    let mut deg = first;
    match one_side(cursor) {
        // `up towards the top`
        Some(second) if second == first => {}
        Some(second) => {
            let (flat, upright) = if first % 180.0 == 0.0 {
                (first, second)
            } else {
                (second, first)
            };
            // One left or right and one up or down make a diagonal; `left left` and `up northeast` mean nothing.
            if flat % 180.0 != 0.0 || upright % 180.0 != 90.0 {
                *cursor = start;
                return None;
            }
            deg = match (flat == 0.0, upright == 90.0) {
                (true, true) => 45.0,
                (false, true) => 135.0,
                (false, false) => 225.0,
                (true, false) => 315.0,
            };
        }
        None => {
            *cursor = behind;
            // `Up to half an edge`
            let is_up = start.peek().is_some_and(|it| it.is("up"));
            let is_bound = is_up && cursor.eat_word("to") && {
                let is_whole = cursor.eat_any(&["half"]);
                cursor.eat_any(&["a", "an", "one", "three"]);
                is_whole
                    || cursor.peek().is_some_and(|next| {
                        next.kind == Kind::Number
                            || next
                                .is_any(&["quarter", "quarters", "tenth", "half", "edge", "full"])
                    })
            };
            *cursor = behind;
            if is_bound {
                *cursor = start;
                return None;
            }
        }
    }
    // `right of the center` is a place; `the top of the picture` is a direction.
    let of_picture = (1..=2).any(|at| {
        cursor.ahead(at).is_some_and(|next| {
            next.is_any(&["image", "picture", "photo", "frame", "view", "table"])
        })
    });
    let is_place = !of_picture && cursor.peek().is_some_and(|next| next.is("of"));
    // `a right angle`, `the right corner`
    let is_diagonal = deg % 90.0 != 0.0;
    if cursor
        .peek()
        .is_some_and(|next| next.is("angle") || is_place || (next.is("corner") && !is_diagonal))
    {
        *cursor = start;
        return None;
    }
    cursor.skip(TRAILING, &[]);
    Some(deg)
}

/// Returns the angle between two directions, 0 to 180 degrees.
pub(super) fn apart_deg(one: f64, other: f64) -> f64 {
    let apart = (one - other).abs() % 360.0;
    apart.min(360.0 - apart)
}

fn one_side(cursor: &mut Cursor<'_, '_>) -> Option<f64> {
    let token = cursor.peek()?;
    let deg = match token.kind {
        Kind::Word => SIDES
            .iter()
            .find(|(sides, _)| token.is_any(sides))
            .map(|(_, deg)| *deg),
        Kind::Sign(sign) => ARROWS
            .iter()
            .find(|(arrow, _)| *arrow == sign)
            .map(|(_, deg)| *deg),
        Kind::Number => None,
    }?;
    cursor.at += 1;
    Some(deg)
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
/// - `whole`: the answer.
pub(super) fn offered<'a>(
    cursor: &mut Cursor<'_, '_>,
    words: &'a [String],
    whole: &str,
) -> Offered<'a> {
    let start = *cursor;
    let mut best: Option<(usize, &str)> = None;
    let mut other: Option<&str> = None;
    let Some(first) = cursor.peek() else {
        return Offered::Nothing;
    };
    for word in words {
        let mut ahead = start;
        let letter = word.trim_start_matches(['-', '"', '\'']).chars().next();
        let may_be = letter
            .zip(first.text.chars().next())
            .is_some_and(|(one, other)| one.to_lowercase().eq(other.to_lowercase()));
        if !may_be || !eat(&mut ahead, &lexer::tokens(word)) {
            continue;
        }
        match best {
            Some((at, _)) if at > ahead.at => {}
            Some((at, known)) if at == ahead.at => {
                // An exact match wins over one that differs in case or separators.
                let written = ahead.text_in(start.at, whole);
                if written == word {
                    (best, other) = (Some((at, word.as_str())), None);
                } else if written != known {
                    other = Some(word);
                }
            }
            _ => (best, other) = (Some((ahead.at, word.as_str())), None),
        }
    }
    match (best, other) {
        (Some((_, word)), Some(other)) => Offered::Several(word, other),
        (Some((at, word)), None) => {
            cursor.at = at;
            Offered::One(word)
        }
        (None, _) => Offered::Nothing,
    }
}

/// Skips these words in any case, with or without hyphens between them.
pub(super) fn eat(cursor: &mut Cursor<'_, '_>, wanted: &[Token<'_>]) -> bool {
    let start = *cursor;
    for token in wanted.iter().filter(|token| !token.is_sign('-')) {
        if cursor.at > start.at {
            cursor.eat_sign('-');
        }
        let is_same = cursor.peek().is_some_and(|found| {
            found.kind == token.kind && found.text.to_lowercase() == token.text.to_lowercase()
        });
        if !is_same {
            *cursor = start;
            return false;
        }
        cursor.at += 1;
    }
    cursor.at > start.at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_between_directions_is_symmetric_and_exact_for_whole_degrees() {
        for one in 0..360_i32 {
            for turned in 0..360_i32 {
                let expected = f64::from(turned.min(360 - turned));
                let (one, other) = (f64::from(one), f64::from((one + turned) % 360));
                assert_eq!(apart_deg(one, other), expected, "{one} and {other}");
                assert_eq!(apart_deg(other, one), expected, "{other} and {one}");
            }
        }
        assert_eq!(apart_deg(-10.0, 730.0), 20.0);
    }
}
