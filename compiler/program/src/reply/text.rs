//! Reads a text that follows given words, such as `Instructions:`.
//!
//! Markdown, bullets, quotes, letter case and a missing end are tolerated and reported as repairs.

use super::cursor::{Cursor, decorates};
use super::reading::{MAX_TEXT_CHARS, Malformed, Reading, bounded, quoted};

/// Reads the text between `before` and `after`; if `after` is empty, up to the end of the line.
///
/// Fails if `before` is not found, if nothing follows it, if two lines contradict each other, or if the text is
/// longer than [`MAX_TEXT_CHARS`].
pub fn read_text(before: &str, after: &str, reply: &str) -> Result<Reading<String>, Malformed> {
    let wrong = |why: String| {
        let message =
            format!("{why} Answer again with one line in exactly this format:\n{before} …{after}");
        Malformed {
            field: before.to_owned(),
            message,
        }
    };
    bounded(before, reply)?;
    let mut found: Option<Reading<String>> = None;
    for reading in at_line_starts(before, after, reply) {
        match &found {
            Some(first) if first.value != reading.value => {
                return Err(wrong(format!(
                    "Your answer has two different lines that begin with \"{before}\"."
                )));
            }
            Some(_) => {}
            None => found = Some(reading),
        }
    }
    let Some(mut reading) = found.or_else(|| within_a_line(before, after, reply)) else {
        return Err(wrong(format!(
            "Your answer has no line that begins with \"{before}\"."
        )));
    };
    if reading.value.is_empty() {
        return Err(wrong(format!(
            "Nothing follows \"{before}\" in your answer."
        )));
    }
    let length = reading.value.chars().count();
    if length > MAX_TEXT_CHARS {
        return Err(wrong(format!(
            "The text after \"{before}\" has {length} characters; at most {MAX_TEXT_CHARS} are accepted."
        )));
    }
    reading.repairs.dedup();
    Ok(reading)
}

fn at_line_starts(before: &str, after: &str, reply: &str) -> Vec<Reading<String>> {
    let mut readings = Vec::new();
    let mut lines = reply.lines().peekable();
    while let Some(line) = lines.next() {
        let mut cursor = Cursor::new(line, 0);
        skip_bullet(&mut cursor);
        let decoration = line[..cursor.at].trim();
        let Some(is_exact) = eat_words(&mut cursor, before) else {
            continue;
        };
        let mut repairs = Vec::new();
        if !decoration.is_empty() {
            repairs.push(format!(
                "passed over `{}` before `{before}`",
                quoted(decoration)
            ));
        }
        if !is_exact {
            let written = &line[line
                .find(|character: char| character.is_alphanumeric())
                .unwrap_or(0)..cursor.at];
            repairs.push(format!("read `{}` as `{before}`", quoted(written)));
        }
        let mut value = cut(cursor.rest(), after, &mut repairs);
        if value.is_empty() {
            while lines.next_if(|next| next.trim().is_empty()).is_some() {}
            if let Some(next) = lines.peek().filter(|next| !is_labelled(next)) {
                let mut cursor = Cursor::new(next, 0);
                skip_bullet(&mut cursor);
                value = cut(cursor.rest(), after, &mut repairs);
                repairs.push(format!("took the line below `{before}`"));
            }
        }
        readings.push(Reading { value, repairs });
    }
    readings
}

/// Returns whether a line begins with its own label, such as `Explanation:`.
fn is_labelled(line: &str) -> bool {
    let mut cursor = Cursor::new(line, 0);
    skip_bullet(&mut cursor);
    let word = cursor.skip(|character| character.is_alphanumeric() || character == ' ');
    cursor.skip(decorates);
    !word.trim().is_empty() && word.split_whitespace().count() <= 3 && cursor.peek() == Some(':')
}

/// Finds the words inside a line, if no line begins with them.
fn within_a_line(before: &str, after: &str, reply: &str) -> Option<Reading<String>> {
    for line in reply.lines() {
        let starts = line.char_indices().map(|(at, _)| at).filter(|at| {
            let previous = line[..*at].chars().next_back();
            previous.is_some_and(|previous| !previous.is_alphanumeric())
        });
        for at in starts {
            let mut cursor = Cursor::new(line, at);
            if eat_words(&mut cursor, before).is_some() {
                let mut repairs = vec![format!("found `{before}` inside of a line")];
                let value = cut(cursor.rest(), after, &mut repairs);
                return Some(Reading { value, repairs });
            }
        }
    }
    None
}

/// Skips the marks of a list or a heading.
fn skip_bullet(cursor: &mut Cursor<'_>) {
    let bullet = |character: char| {
        character.is_whitespace()
            || decorates(character)
            || matches!(character, '-' | '•' | '·' | '#' | '>' | '+' | '{' | '[')
    };
    cursor.skip(bullet);
    let start = *cursor;
    if !cursor
        .skip(|character| character.is_ascii_digit())
        .is_empty()
        && (cursor.eat('.') || cursor.eat(')'))
    {
        cursor.skip(bullet);
    } else {
        *cursor = start;
    }
}

/// Skips words in any case, spacing and Markdown; returns whether they are spelled exactly.
fn eat_words(cursor: &mut Cursor<'_>, words: &str) -> Option<bool> {
    let start = *cursor;
    let mut is_exact = true;
    for wanted in words.chars() {
        if wanted.is_whitespace() {
            is_exact &= cursor.skip(char::is_whitespace) == " ";
            continue;
        }
        if cursor.peek() != Some(wanted) {
            let skipped = cursor.skip(|character| decorates(character) || character == ' ');
            is_exact &= skipped.is_empty();
        }
        match cursor.peek() {
            Some(found) if found == wanted => cursor.step(),
            Some(found)
                if found.eq_ignore_ascii_case(&wanted) || (found == '：' && wanted == ':') =>
            {
                is_exact = false;
                cursor.step();
            }
            _ => {
                *cursor = start;
                return None;
            }
        }
    }
    Some(is_exact)
}

/// Takes the text up to `after`, without the decoration around it.
fn cut(rest: &str, after: &str, repairs: &mut Vec<String>) -> String {
    let rest = rest.trim();
    let text = match rest.rfind(after).filter(|_| !after.is_empty()) {
        Some(end) => &rest[..end],
        None => {
            if !after.is_empty() && !rest.is_empty() {
                repairs.push(format!(
                    "took the text to the end of the line, as `{after}` is missing"
                ));
            }
            rest
        }
    };
    let is_quoted = text.trim_start().starts_with(['"', '“']);
    let mut bare =
        text.trim_matches(|character: char| character.is_whitespace() || decorates(character));
    if is_quoted {
        bare = bare.trim_end_matches(|character: char| {
            matches!(character, ',' | '}') || decorates(character) || character.is_whitespace()
        });
    }
    if bare.len() != text.trim().len() {
        repairs.push("removed the markdown or quotes around the text".to_owned());
    }
    bare.to_owned()
}
