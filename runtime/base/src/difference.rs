//! The first value in which two JSON documents differ, for people.
//!
//! In: what was stored, and what is there now. Out: where they differ, with both values, shortened. Whoever compares a
//! record with what would be recorded now says the difference in these words.

use serde_json::Value;
use std::fmt;

/// The most characters of a value that are shown.
const MAX_SHOWN: usize = 60;
/// The characters shown before the first one that differs.
const CONTEXT: usize = 20;

/// A value that two documents do not share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Its path, such as `messages[0].parts[1].text`, and its line if it is a text of several lines.
    pub place: String,
    /// The stored value, or `nothing`.
    pub stored: String,
    /// The value now, or `nothing`.
    pub now: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} (recorded {}, now {})",
            self.place, self.stored, self.now
        )
    }
}

/// Finds the first difference, in the order of the stored document; `None` if the two are equal.
pub fn first(stored: &Value, now: &Value) -> Option<Difference> {
    at(String::new(), Some(stored), Some(now))
}

fn at(path: String, stored: Option<&Value>, now: Option<&Value>) -> Option<Difference> {
    if stored == now {
        return None;
    }
    match (stored, now) {
        (Some(Value::Object(stored)), Some(Value::Object(now))) => {
            let is_new = |name: &&String| !stored.contains_key(*name);
            let mut names = stored.keys().chain(now.keys().filter(is_new));
            names.find_map(|name| {
                let dot = if path.is_empty() { "" } else { "." };
                at(
                    format!("{path}{dot}{name}"),
                    stored.get(name),
                    now.get(name),
                )
            })
        }
        (Some(Value::Array(stored)), Some(Value::Array(now))) => {
            let mut indices = 0..stored.len().max(now.len());
            indices.find_map(|index| {
                at(
                    format!("{path}[{index}]"),
                    stored.get(index),
                    now.get(index),
                )
            })
        }
        (Some(Value::String(stored)), Some(Value::String(now))) => {
            Some(of_texts(path, stored, now))
        }
        _ => Some(Difference {
            place: format!("`{path}`"),
            stored: shown(stored),
            now: shown(now),
        }),
    }
}

/// Compares two texts that differ, line by line.
fn of_texts(path: String, stored: &str, now: &str) -> Difference {
    let has_lines = stored.contains('\n') || now.contains('\n');
    let (mut stored, mut now) = (stored.split('\n'), now.split('\n'));
    let pairs = std::iter::from_fn(|| Some((stored.next(), now.next())));
    let mut numbered = (1..).zip(pairs);
    let (number, (stored, now)) = numbered
        .find(|(_, (stored, now))| stored != now)
        .expect("the texts differ");
    let [old, new] = [stored, now].map(|line| line.unwrap_or_default().chars());
    let n_equal = old.zip(new).take_while(|(a, b)| a == b).count();
    // From a little before the first character that differs.
    let excerpt = |line: &str| match n_equal.checked_sub(CONTEXT + 2) {
        None => line.to_owned(),
        Some(_) => format!(
            "…{}",
            line.chars().skip(n_equal - CONTEXT).collect::<String>()
        ),
    };
    let excerpt = |line: Option<&str>| shown(line.map(|line| excerpt(line).into()).as_ref());
    let line = if has_lines {
        format!(", line {number}")
    } else {
        String::new()
    };
    Difference {
        place: format!("`{path}`{line}"),
        stored: excerpt(stored),
        now: excerpt(now),
    }
}

fn shown(value: Option<&Value>) -> String {
    let Some(value) = value else {
        return "nothing".to_owned();
    };
    crate::wording::shown(&value.to_string(), MAX_SHOWN)
}

#[cfg(test)]
mod tests;
