//! Reads an action: one point for each field.
//!
//! An answer is searched for statements such as `Pick Point = (x, y)`, the format that is asked for. Others
//! are understood too: markdown, JSON, other brackets, words between. Statements differ in how firm they
//! are; loose ones count only where there is no firmer one, and what counts must agree.

use super::cursor::{Cursor, decorates, starts_with_word};
use super::pixel::{self, Brackets, Found};
use super::{Malformed, Proposal, Reading, bounded, quoted};
use crate::program::{ActionField, PixelPoint, Program, Value};
use crate::space;

/// The most characters between a field's name and its point.
const MAX_BETWEEN: usize = 100;

/// Words that may follow a field's name.
const NOUNS: [&str; 7] = [
    "point",
    "pixel",
    "position",
    "location",
    "coordinates",
    "coordinate",
    "coords",
];

/// Words that turn a statement into its opposite, or into one about something else.
const TURNING: [&str; 12] = [
    "not", "never", "avoid", "previous", "last", "old", "cannot", "don", "isn", "instead",
    "former", "would",
];

/// How clearly a statement is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Firmness {
    /// `pick (10, 20)`.
    Loose,
    /// `the pick point is (10, 20)`, `pick point (10, 20)`.
    Spoken,
    /// `Pick Point = (10, 20)`, `"pick": [10, 20]`.
    Assigned,
}

struct Statement<'t> {
    firmness: Firmness,
    point: PixelPoint,
    text: &'t str,
    rounding: Option<String>,
}

/// Reads every field of the action.
///
/// Fails where a field is not stated, is stated in two ways, or the answer is longer than
/// [`super::MAX_REPLY_BYTES`].
pub fn read_action(program: &Program, reply: &str) -> Result<Reading<Proposal>, Malformed> {
    read_fields(&program.actions, program.cloth.edge_m(), reply)
}

/// Reads every field of an action; `edge_m` is the cloth's longer side, metres.
pub(crate) fn read_fields(
    actions: &[ActionField],
    _edge_m: f64,
    reply: &str,
) -> Result<Reading<Proposal>, Malformed> {
    bounded("action", reply)?;
    let names: Vec<&str> = actions.iter().map(|field| field.name.as_str()).collect();
    let mut proposal = Proposal {
        fields: Vec::with_capacity(names.len()),
    };
    let mut repairs = Vec::new();
    for declared in actions {
        let name = &declared.name;
        let found = field(declared, &names, reply).map_err(|why| Malformed {
            field: name.clone(),
            message: complaint(&why, actions),
        })?;
        repairs.extend(found.repairs);
        proposal
            .fields
            .push((name.clone(), Value::Point(found.value)));
    }
    Ok(Reading {
        value: proposal,
        repairs,
    })
}

fn complaint(why: &str, actions: &[ActionField]) -> String {
    format!(
        "{why} Answer again and state the action in exactly this format, with numbers for x and y:\n{}",
        space::format(actions)
    )
}

fn field(
    declared: &ActionField,
    names: &[&str],
    reply: &str,
) -> Result<Reading<PixelPoint>, String> {
    let name = declared.name.as_str();
    let mut statements: Vec<Statement<'_>> = Vec::new();
    let mut bad: Option<String> = None;
    for at in occurrences(reply, name) {
        match statement_at(name, names, reply, at) {
            Some(Ok(statement)) => statements.push(statement),
            Some(Err(why)) => {
                bad.get_or_insert(why);
            }
            None => {}
        }
    }
    if statements
        .iter()
        .any(|statement| statement.firmness > Firmness::Loose)
    {
        statements.retain(|statement| statement.firmness > Firmness::Loose);
    }
    statements.sort_by_key(|statement| std::cmp::Reverse(statement.firmness));
    let Some(first) = statements.first() else {
        return Err(match bad {
            Some(why) => format!("The {name} point of your answer cannot be used: {why}."),
            None => format!("Your answer states no {name} point."),
        });
    };
    if let Some(other) = statements
        .iter()
        .find(|statement| statement.point != first.point)
    {
        return Err(format!(
            "Your answer states two different {name} points, {} and {}. State only the one that you choose.",
            first.point, other.point
        ));
    }
    let mut repairs = Vec::new();
    if first.text != space::statement(declared, &first.point.to_string())
        && first.rounding.is_none()
    {
        repairs.push(format!(
            "read `{}` as the {name} point {}",
            quoted(first.text),
            first.point
        ));
    }
    if let Some(rounding) = &first.rounding {
        repairs.push(format!("{name}: {rounding}"));
    }
    Ok(Reading {
        value: first.point,
        repairs,
    })
}

/// Returns the places where a word stands, in any case and not as a part of another.
fn occurrences<'t>(text: &'t str, word: &'t str) -> impl Iterator<Item = usize> + 't {
    let mut before = ' ';
    text.char_indices().filter_map(move |(at, character)| {
        let follows_letter = before.is_alphanumeric();
        before = character;
        let rest = &text[at..];
        let is_there = !follows_letter
            && rest
                .get(..word.len())
                .is_some_and(|start| start.eq_ignore_ascii_case(word));
        is_there.then_some(at)
    })
}

/// Reads the statement that begins with the field's name at `at`; None where there is none.
fn statement_at<'t>(
    name: &str,
    names: &[&str],
    reply: &'t str,
    at: usize,
) -> Option<Result<Statement<'t>, String>> {
    if is_turned(reply, at) {
        return None;
    }
    let blank = |character: char| matches!(character, ' ' | '\t' | '-') || decorates(character);
    let mut cursor = Cursor::new(reply, at + name.len());
    let begins_with_upper = |cursor: &Cursor<'_>| cursor.peek().is_some_and(char::is_uppercase);
    // `pickPoint` is one word to the eye, two to the reader.
    if cursor.peek().is_some_and(char::is_alphanumeric) && !begins_with_upper(&cursor) {
        return None;
    }
    cursor.skip(blank);
    let has_noun = NOUNS.iter().any(|noun| cursor.eat_word(noun));
    if !has_noun && cursor.text[at + name.len()..].starts_with(char::is_alphanumeric) {
        return None;
    }
    skip_echo(&mut cursor);
    cursor.skip(blank);
    let (firmness, brackets) = match sign(&mut cursor) {
        Sign::Assigns => (Firmness::Assigned, Brackets::Optional),
        Sign::Says => (Firmness::Spoken, Brackets::Needed),
        Sign::None if has_noun => (Firmness::Spoken, Brackets::Needed),
        Sign::None => (Firmness::Loose, Brackets::Needed),
    };
    cursor.skip(|character| character.is_whitespace() || decorates(character));
    let mut found = pixel::read(&mut cursor, brackets);
    if matches!(found, Found::Nothing)
        && firmness == Firmness::Assigned
        && skip_words(&mut cursor, names)
    {
        found = pixel::read(&mut cursor, Brackets::Needed);
    }
    match found {
        Found::Pixel(point, rounding) => Some(Ok(Statement {
            firmness,
            point,
            text: &reply[at..cursor.at],
            rounding,
        })),
        // In free speech brackets with other numbers mean nothing.
        Found::Bad(why) if firmness == Firmness::Assigned => Some(Err(why)),
        Found::Bad(_) | Found::Nothing => None,
    }
}

/// Skips `(x, y)` between the name and the sign, a repetition of the format.
fn skip_echo(cursor: &mut Cursor<'_>) {
    let start = *cursor;
    cursor.skip(|character| character == ' ' || decorates(character));
    for echo in ["(x, y)", "(x,y)", "[x, y]", "[x,y]"] {
        if cursor
            .rest()
            .get(..echo.len())
            .is_some_and(|text| text.eq_ignore_ascii_case(echo))
        {
            cursor.at += echo.len();
            return;
        }
    }
    *cursor = start;
}

enum Sign {
    Assigns,
    Says,
    None,
}

fn sign(cursor: &mut Cursor<'_>) -> Sign {
    if cursor.eat(':') || cursor.eat('：') {
        cursor.eat('=');
        return Sign::Assigns;
    }
    if cursor.eat('=') {
        cursor.skip(|character| matches!(character, '=' | '>'));
        return Sign::Assigns;
    }
    let start = *cursor;
    for words in [
        ["is", "at"],
        ["should", "be"],
        ["will", "be"],
        ["is", ""],
        ["at", ""],
    ] {
        *cursor = start;
        let is_there = words.iter().all(|word| {
            let found = word.is_empty() || cursor.eat_word(word);
            cursor.skip(|character| character == ' ');
            found
        });
        if is_there {
            return Sign::Says;
        }
    }
    *cursor = start;
    Sign::None
}

/// Skips words up to a bracket on the same line; does not move where another field or a turning word comes first.
fn skip_words(cursor: &mut Cursor<'_>, names: &[&str]) -> bool {
    let rest = cursor.rest();
    let Some(length) = rest.find(|character: char| {
        matches!(character, '(' | '[' | '\n' | '\r' | '.' | ';' | '{') || character.is_ascii_digit()
    }) else {
        return false;
    };
    let words = &rest[..length];
    let is_bracket = rest[length..].starts_with(['(', '[']);
    let turns = words
        .split(|character: char| !character.is_alphanumeric())
        .any(|word| {
            let is = |other: &&str| word.eq_ignore_ascii_case(other);
            TURNING.iter().any(is) || names.iter().any(is)
        });
    if !is_bracket || turns || words.chars().count() > MAX_BETWEEN {
        return false;
    }
    cursor.at += length;
    true
}

/// Returns whether one of the three words before `at`, in the same sentence, turns the statement.
fn is_turned(reply: &str, at: usize) -> bool {
    let sentence = reply[..at]
        .rsplit(['\n', '\r', '.', ';', ',', ':', '!', '?'])
        .next()
        .unwrap_or_default();
    let words = sentence
        .rsplit(|character: char| !character.is_alphanumeric())
        .filter(|word| !word.is_empty());
    words.take(3).any(|word| {
        TURNING
            .iter()
            .any(|turning| starts_with_word(word, turning))
    })
}
