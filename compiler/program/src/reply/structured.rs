//! Reads an answer to a schema: one JSON object whose members are the fields, or the text, and nothing else.
//!
//! In: an answer whose thoughts are set aside. Out: the value of each key as the schema writes it, and where it stands. A
//! code fence around the object is tolerated. Whatever deviates is left to the reader of other forms.

use super::schema::REASON;
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde_json::value::RawValue;
use std::fmt;
use std::ops::Range;

/// The members of an object, in order; keys are as written, without repetition.
struct Members<'t>(Vec<(String, &'t RawValue)>);

impl<'de> Deserialize<'de> for Members<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Collect;
        impl<'de> Visitor<'de> for Collect {
            type Value = Members<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut members: Vec<(String, &'de RawValue)> = Vec::new();
                while let Some((key, value)) = map.next_entry::<String, &'de RawValue>()? {
                    if members.len() == MAX_MEMBERS || members.iter().any(|(it, _)| *it == key) {
                        return Err(A::Error::custom("a key stands twice, or too many keys"));
                    }
                    members.push((key, value));
                }
                Ok(Members(members))
            }
        }
        deserializer.deserialize_map(Collect)
    }
}

/// The most members; no action has as many fields.
const MAX_MEMBERS: usize = 64;

/// A string of an answer, and where it stands with its marks, bytes.
pub(super) struct Member {
    pub text: String,
    pub span: Range<usize>,
}

/// Returns the strings of these keys, in their order, if an answer is an object with just these and perhaps a reason.
pub(super) fn members(text: &str, keys: &[&str]) -> Option<Vec<Member>> {
    let object = unfenced(text);
    if !object.starts_with('{') {
        return None;
    }
    let Members(members) = serde_json::from_str(object).ok()?;
    let is_asked = |key: &str| keys.contains(&key) || key == REASON;
    if !members.iter().all(|(key, _)| is_asked(key)) {
        return None;
    }
    let found = keys.iter().map(|key| {
        let (_, value) = members.iter().find(|(it, _)| it == key)?;
        // A raw value is a piece of the text that was parsed.
        let at = value.get().as_ptr() as usize - text.as_ptr() as usize;
        Some(Member {
            text: serde_json::from_str(value.get()).ok()?,
            span: at..at + value.get().len(),
        })
    });
    found.collect()
}

/// Takes off blanks and a code fence.
fn unfenced(text: &str) -> &str {
    let text = text.trim();
    let inside = text
        .strip_prefix("```")
        .and_then(|it| it.strip_suffix("```"));
    inside.map_or(text, |inside| {
        inside
            .trim_start_matches(|letter: char| letter.is_ascii_alphanumeric())
            .trim()
    })
}
