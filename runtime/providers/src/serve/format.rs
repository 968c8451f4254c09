//! The form in which a client wants its answer: free text, or JSON that follows a schema.
//!
//! In: the format of a request; an answer. Out: the answer in that form, or why it has none. An answer in words that
//! states each value once is written as JSON, by the rules of `docs/answers.md`; nothing is guessed or filled in.

use super::fields::Fields;
use super::refusal::Refusal;
use super::schema::Schema;
use fab_program::data::actions::{ActionField, Choices, Direction, LengthChoice};
use fab_program::exact::vector_of;
use fab_program::pointing::Notation;
use fab_program::reply::{read_fields, read_text};
use fab_program::space;
use fab_program::units::{LengthUnit, UNITS};
use serde_json::{Map, Value, json};

/// The most properties of an answer in words.
const MAX_FIELDS: usize = 32;

/// A wanted form of an answer.
#[derive(Debug, Default)]
pub(super) struct Format {
    /// The schema as the model gets it.
    pub stated: Option<Value>,
    /// The schema that answers are held against; absent if it cannot be checked, and need not be.
    schema: Option<Schema>,
    /// Whether an answer that does not follow it is refused.
    is_strict: bool,
}

impl Format {
    /// Reads `{"type": "json_schema", …}`; `inner` is its place in Chat Completions.
    pub(super) fn read(mut format: Fields, inner: Option<&str>) -> Result<Format, Refusal> {
        let kind = format.text("type")?;
        match kind.as_str() {
            "text" => format.finish(&[]).map(|()| Format::default()),
            "json_schema" => {
                let mut described = match inner {
                    Some(name) => {
                        let value = format.required(name)?;
                        let described = Fields::of(format.path(name), value)?;
                        format.finish(&[])?;
                        described
                    }
                    None => format,
                };
                let stated = described.required("schema")?;
                if !stated.is_object() {
                    return Err(described.wrong("schema", "is not an object"));
                }
                let is_strict = described.switch("strict")?;
                let schema = match Schema::read(&stated) {
                    Ok(schema) => Some(schema),
                    Err(why) if is_strict => return Err(described.wrong("schema", &why)),
                    Err(_) => None,
                };
                described.finish(&["name", "description"])?;
                Ok(Format {
                    stated: Some(stated),
                    schema,
                    is_strict,
                })
            }
            _ => {
                let path = format.path("type");
                let message = format!(
                    "`{path}` is {}; here it is `text` or `json_schema`",
                    json!(kind)
                );
                Err(Refusal::unsupported(&path, message))
            }
        }
    }

    /// Returns an answer in this form; fails with the reason if it has to follow a schema and does not.
    pub(super) fn fit(&self, text: String) -> Result<String, String> {
        let Some(schema) = &self.schema else {
            return Ok(text);
        };
        let Err(why) = schema.judge(&text) else {
            return Ok(text);
        };
        let readings = [fenced(&text).map(str::to_owned), in_words(schema, &text)];
        let mut readings = readings.into_iter().flatten();
        match readings.find(|reading| schema.judge(reading).is_ok()) {
            Some(reading) => Ok(reading),
            None if self.is_strict => Err(why),
            None => Ok(text),
        }
    }
}

/// Returns what the only fenced block of an answer holds.
fn fenced(text: &str) -> Option<&str> {
    let (_, block) = text.split_once("```")?;
    let (_, block) = block.split_once('\n')?;
    let (inside, after) = block.split_once("```")?;
    (!after.contains("```")).then_some(inside.trim())
}

/// Reads an answer in words, and writes its values as JSON; a property for free text gets the whole answer.
fn in_words(schema: &Schema, text: &str) -> Option<String> {
    let properties = schema.properties()?;
    if properties.len() > MAX_FIELDS {
        return None;
    }
    let mut fields = Vec::new();
    for (name, property) in properties {
        if property["type"] != "string" {
            return None;
        }
        if !(property["enum"].is_null() && property["pattern"].is_null()) {
            fields.push(field(schema, name, property)?);
        }
    }
    if fields.is_empty() {
        let name = properties.keys().next()?;
        let read = read_text(&format!("{name}:"), "", text).ok()?;
        return Some(json!({ name: read.value }).to_string());
    }
    let action = read_fields(&fields, 1.0, &Notation::pixels(), text).ok()?;
    let value = |name: &String| {
        let field = fields.iter().find(|field| field.name == *name);
        let stated = field.zip(action.value.get(name));
        stated.map_or(text.to_owned(), |(field, value)| space::text(field, value))
    };
    let object: Map<String, Value> = properties
        .keys()
        .map(|name| (name.clone(), value(name).into()))
        .collect();
    Some(Value::Object(object).to_string())
}

/// Returns the field that a property describes: a point, a direction, a length or a word.
fn field(schema: &Schema, name: &str, property: &Value) -> Option<ActionField> {
    let is_word = |word: &str| {
        let begins = word.starts_with(|letter: char| letter.is_ascii_alphabetic());
        begins
            && word
                .chars()
                .all(|it| it.is_ascii_alphanumeric() || it == '_')
    };
    let choices = match &property["pattern"] {
        Value::String(pattern) => schema.matches(pattern, "(1, 2)").then(any_point)?,
        _ => {
            let listed = property["enum"].as_array()?.iter();
            let listed: Vec<&str> = listed.map(Value::as_str).collect::<Option<_>>()?;
            points(&listed)
                .or_else(|| directions(&listed))
                .or_else(|| lengths(&listed))
                .or_else(|| {
                    let words = listed.iter().map(|word| (*word).to_owned()).collect();
                    let are_words = listed.iter().all(|word| is_word(word));
                    are_words.then_some(Choices::Words { choices: words })
                })?
        }
    };
    let name = is_word(name).then(|| name.to_owned())?;
    Some(ActionField { name, choices })
}

fn any_point() -> Choices {
    let mask = String::new();
    Choices::Region { mask }
}

fn points(listed: &[&str]) -> Option<Choices> {
    let is_point = |text: &&str| {
        let inside = text.strip_prefix('(').and_then(|it| it.strip_suffix(')'));
        let numbers = inside.and_then(|inside| inside.split_once(", "));
        numbers.is_some_and(|(u, v)| u.parse::<i32>().is_ok() && v.parse::<i32>().is_ok())
    };
    listed.iter().all(is_point).then(any_point)
}

fn directions(listed: &[&str]) -> Option<Choices> {
    let read = |text: &&str| {
        let deg: f64 = text.strip_suffix(" deg")?.parse().ok()?;
        (0.0..360.0).contains(&deg).then(|| Direction {
            deg,
            vector: vector_of(deg),
        })
    };
    let choices = listed.iter().map(read).collect::<Option<_>>()?;
    Some(Choices::Directions { choices })
}

fn lengths(listed: &[&str]) -> Option<Choices> {
    let (_, name) = listed.first()?.split_once(' ')?;
    let unit = UNITS.iter().find(|unit| unit.name == name)?;
    let read = |text: &&str| {
        let value: f64 = text.strip_suffix(name)?.trim_end().parse().ok()?;
        // `edge` has no size of its own; the cloth that answers are read for has an edge of 1 m.
        let size = if unit.size.is_nan() { 1.0 } else { unit.size };
        let m = value * size;
        (m >= 0.0 && m.is_finite()).then_some(LengthChoice { value, m })
    };
    let choices = listed.iter().map(read).collect::<Option<_>>()?;
    Some(Choices::Lengths {
        unit: LengthUnit::of(unit)?,
        choices,
    })
}

#[cfg(test)]
#[path = "format_tests.rs"]
mod tests;
