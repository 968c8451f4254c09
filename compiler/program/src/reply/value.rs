//! Reads the value of a field that is a direction, a length or a word, where one is expected.
//!
//! In: a cursor after the field's name, in a text that ends where another field is named. Out: the value, or why
//! there is none. Text after a value counts too: `45 deg or 90 deg` states neither.

use super::around::{CHANGING, Link, is_ordinal, is_short, link, list_number, skip_leading};
use super::choice::{Expected, Resolved, TextEnd, resolve};
use super::cursor::{Cursor, decorates, first_word};
use super::expression::{self, Parsed, skip_decoration};
use super::finding::{Clarity, Found};
use super::number::unit;
use super::reading::quoted;
use super::words::{self, Offered};
use crate::data::actions::{Choices, Value};
use crate::space;

/// The most values to compare with the first one.
const MAX_OTHERS: usize = 8;

/// Words that may follow a number without a unit.
const FOLLOWING: [&str; 14] = [
    "because", "since", "as", "so", "which", "that", "with", "then", "for", "but", "and", "where",
    "while", "in",
];

/// How much a value by itself says about its kind.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Explicitness {
    /// A number without a unit, or a word.
    Bare,
    /// With a unit or pi.
    Full,
}

/// Reads a value and moves past it.
pub(super) fn read(cursor: &mut Cursor<'_>, expected: &Expected<'_>, firmness: Clarity) -> Found {
    let sign = cursor.at;
    cursor.skip(|character| character.is_whitespace() || decorates(character));
    let is_new_line = cursor.text[sign..cursor.at].contains('\n');
    if is_echo(cursor.rest(), expected) || (is_new_line && list_number(*cursor).is_some()) {
        return Found::Nothing;
    }
    let found = match stated(cursor, expected, firmness) {
        Ok(found) => found,
        Err(why) => Some(Err(why)),
    };
    match found {
        Some(Ok((value, note))) => Found::Value(value, note),
        // In running text, a number that is not a value means nothing.
        Some(Err(why)) if firmness == Clarity::Assigned => Found::Bad(why),
        _ => Found::Nothing,
    }
}

/// Returns whether the text repeats all choices as the format lists them.
fn is_echo(text: &str, expected: &Expected<'_>) -> bool {
    // Most lines have no bar, so the choices need not be written out.
    let bar = text.find(['|', '\n']);
    if !bar.is_some_and(|bar| text[bar..].starts_with('|')) {
        return false;
    }
    let values = space::declared(expected.field);
    let mut rest = text;
    for (index, value) in values.iter().enumerate() {
        let bar = if index == 0 { "" } else { " | " };
        let value = space::text(expected.field, value);
        match rest
            .strip_prefix(bar)
            .and_then(|rest| rest.strip_prefix(&*value))
        {
            Some(behind) => rest = behind,
            None => return false,
        }
    }
    values.len() > 1
}

type Stated = Option<Result<Resolved, String>>;

fn stated(
    cursor: &mut Cursor<'_>,
    expected: &Expected<'_>,
    firmness: Clarity,
) -> Result<Stated, String> {
    let mut expected = *expected;
    let begin = *cursor;
    let mut first = single(cursor, &expected, firmness);
    let mut close = None;
    if first.is_none() && firmness == Clarity::Assigned {
        close = open(cursor, &mut expected)?;
        skip_leading(cursor);
        first = single(cursor, &expected, firmness);
    }
    let Some((taken, dress)) = first.transpose()? else {
        return fallback(cursor, begin, &expected, firmness);
    };
    let is_apart = cursor.at;
    if let Err(why) = ends(cursor, dress) {
        *cursor = begin;
        return match &expected.field.choices {
            Choices::Words { .. } => fallback(cursor, begin, &expected, firmness),
            _ => Err(why),
        };
    }
    if let Some(close) = close {
        cursor.skip(|character| character.is_whitespace() || decorates(character));
        if !cursor.eat(close) {
            return Err("more than one value stands between its brackets".to_owned());
        }
    } else {
        cursor.at = is_apart;
    }
    others_agree(*cursor, &expected, &taken.0)?;
    Ok(Some(Ok(taken)))
}

/// Looks for an offered word in the following words, and fails if there is something else.
fn fallback(
    cursor: &mut Cursor<'_>,
    begin: Cursor<'_>,
    expected: &Expected<'_>,
    firmness: Clarity,
) -> Result<Stated, String> {
    if firmness != Clarity::Assigned {
        return Ok(None);
    }
    let line = begin.rest().lines().next().unwrap_or_default().trim();
    let none = || format!("`{}` is none of its choices", quoted(line));
    if let Choices::Words { choices } = &expected.field.choices {
        let is_open = cursor.at;
        return match words::within(cursor, choices) {
            Offered::One(word) => {
                others_agree(*cursor, expected, &Value::Word(word.to_owned()))?;
                let note = format!("the word `{word}` in it");
                Ok(Some(Ok((Value::Word(word.to_owned()), Some(note)))))
            }
            Offered::Several(one, other) => Err(format!("it has both `{one}` and `{other}`")),
            Offered::Nothing if line.is_empty() && is_open == begin.at => Ok(None),
            Offered::Nothing => Err(none()),
        };
    }
    if line.is_empty() {
        Ok(None)
    } else {
        Err(none())
    }
}

/// Reads one value and ignores what follows it.
fn single(
    cursor: &mut Cursor<'_>,
    expected: &Expected<'_>,
    firmness: Clarity,
) -> Option<Result<(Resolved, Explicitness), String>> {
    if let Choices::Words { choices } = &expected.field.choices {
        return match words::direct(cursor, choices) {
            Offered::One(word) => Some(Ok((
                (Value::Word(word.to_owned()), None),
                Explicitness::Bare,
            ))),
            Offered::Several(one, other) => Some(Err(format!("it can be `{one}` or `{other}`"))),
            Offered::Nothing => None,
        };
    }
    let start = cursor.at;
    match expression::read(cursor) {
        Parsed::Quantity(quantity) => {
            let dress = if quantity.times_pi || quantity.unit.is_some() {
                Explicitness::Full
            } else {
                Explicitness::Bare
            };
            if dress == Explicitness::Bare && firmness == Clarity::Loose {
                return None;
            }
            let text = quoted(&cursor.text[start..cursor.at]);
            Some(resolve(expected, quantity, &text).map(|taken| (taken, dress)))
        }
        Parsed::Bad(why) => Some(Err(why)),
        Parsed::Nothing => side(cursor, expected, firmness),
    }
}

/// Reads a direction in words.
fn side(
    cursor: &mut Cursor<'_>,
    expected: &Expected<'_>,
    firmness: Clarity,
) -> Option<Result<(Resolved, Explicitness), String>> {
    let Choices::Directions { choices } = &expected.field.choices else {
        return None;
    };
    if firmness != Clarity::Assigned {
        return None;
    }
    let start = cursor.at;
    if cursor.eat_word("to") {
        skip_decoration(cursor);
        cursor.eat_word("the");
        skip_decoration(cursor);
    }
    let Some(deg) = words::side(cursor) else {
        cursor.at = start;
        return None;
    };
    let text = quoted(&cursor.text[start..cursor.at]);
    if !choices.iter().any(|choice| choice.deg == deg) {
        return Some(Err(format!("`{text}` is none of its choices")));
    }
    let note = format!("`{text}` as a direction in the picture");
    Some(Ok((
        (Value::Direction { deg }, Some(note)),
        Explicitness::Bare,
    )))
}

/// Skips an opening bracket, and the key of an object; returns the closing one.
fn open(cursor: &mut Cursor<'_>, expected: &mut Expected<'_>) -> Result<Option<char>, String> {
    let close = match cursor.peek() {
        Some('(') => ')',
        Some('[') => ']',
        Some('{') => '}',
        _ => return Ok(None),
    };
    cursor.step();
    cursor.skip(|character| character.is_whitespace() || decorates(character));
    if close == '}' {
        let key = first_word(cursor.rest());
        let hint = unit(&mut Cursor::new(key, 0));
        let is_known = ["value", "angle", "length", "word", "choice"]
            .iter()
            .any(|known| key.eq_ignore_ascii_case(known));
        if hint.is_none() && !is_known {
            return Err(format!("`{}` is none of its choices", quoted(key)));
        }
        cursor.at += key.len();
        cursor.skip(|character| character.is_whitespace() || decorates(character));
        if !cursor.eat(':') {
            return Err(format!("nothing follows `{}`", quoted(key)));
        }
        cursor.skip(|character| character.is_whitespace() || decorates(character));
        expected.hint = hint.or(expected.hint);
    }
    Ok(Some(close))
}

/// Skips decoration after a value; fails if the value continues as something else.
fn ends(cursor: &mut Cursor<'_>, dress: Explicitness) -> Result<(), String> {
    let start = cursor.at;
    let goes_on = |cursor: &Cursor<'_>| {
        let word = &cursor.rest()[..cursor
            .rest()
            .find([' ', '\n'])
            .unwrap_or(cursor.rest().len())];
        Err(format!(
            "`{}` behind its value is not understood",
            quoted(word)
        ))
    };
    let mut letters = cursor.rest().chars();
    match (letters.next(), letters.next()) {
        (Some('^' | '²' | '³'), _) => return goes_on(cursor),
        (Some(letter), _) if letter.is_alphanumeric() => return goes_on(cursor),
        (Some('.' | '\'' | '"' | ':' | '_'), Some(next)) if next.is_numeric() => {
            return goes_on(cursor);
        }
        _ => {}
    }
    skip_decoration(cursor);
    let word = first_word(cursor.rest());
    let is = |known: &&str| word.eq_ignore_ascii_case(known);
    if CHANGING.iter().any(is) {
        return goes_on(cursor);
    }
    let is_on_line = cursor.at > start;
    let is_joined = !word.is_empty() && link(&mut cursor.clone()).is_none();
    if dress == Explicitness::Bare && is_on_line && is_joined && !FOLLOWING.iter().any(is) {
        return goes_on(cursor);
    }
    Ok(())
}

/// Fails if the same line continues with a different value, or with a range.
fn others_agree(
    mut cursor: Cursor<'_>,
    expected: &Expected<'_>,
    value: &Value,
) -> Result<(), String> {
    for _ in 0..MAX_OTHERS {
        cursor.skip(|character| {
            matches!(character, ' ' | '\t' | ')' | ']' | '}') || decorates(character)
        });
        // `45 deg down` has no link between its two statements.
        let link = match link(&mut cursor) {
            Some(link) => link,
            None if matches!(expected.field.choices, Choices::Directions { .. }) => Link::Same,
            None => return Ok(()),
        };
        skip_leading(&mut cursor);
        if expected.end == TextEnd::Name && list_number(cursor).is_some_and(is_short) {
            return Ok(());
        }
        let word = first_word(cursor.rest());
        if CHANGING
            .iter()
            .any(|known| word.eq_ignore_ascii_case(known))
        {
            return Err(format!("`{word}` behind its value changes it"));
        }
        let is_number = cursor.rest().starts_with(char::is_numeric);
        match single(&mut cursor, expected, Clarity::Assigned) {
            Some(Ok(((other, _), _))) if other == *value && link == Link::Same => {}
            Some(Ok(((other, _), _))) if other == *value && link == Link::Or => {}
            Some(Ok(((other, _), _))) => {
                return Err(format!(
                    "it has both {} and {}",
                    space::text(expected.field, value),
                    space::text(expected.field, &other)
                ));
            }
            Some(Err(_)) | None if link == Link::Or || (link == Link::Range && is_number) => {
                return Err("it leaves more than one value open".to_owned());
            }
            // `45, 30` states two numbers, whatever the second one is.
            Some(Err(_)) if is_number && !is_ordinal(cursor.rest()) => {
                return Err("it contains more than one number".to_owned());
            }
            _ => return Ok(()),
        }
    }
    Err("it has too many values".to_owned())
}
