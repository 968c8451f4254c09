//! The JSON Schema of an answer: read before a model is asked, and held against its answer.
//!
//! In: a schema with the keywords of [`KEYWORDS`]. Out: whether a value follows it, or the first place where it does
//! not. A schema with another keyword is refused, because nothing here could hold an answer against it. Work, depth and
//! memory are bounded, whatever the schema says.

use regex_lite::{Regex, RegexBuilder};
use serde_json::{Map, Value};
use std::cell::Cell;
use std::collections::BTreeMap;

/// The longest schema, bytes of JSON.
const MAX_BYTES: usize = 64 << 10;
/// The most patterns, and the most memory of one, bytes.
const MAX_PATTERNS: usize = 256;
const MAX_PATTERN_BYTES: usize = 256 << 10;
/// The most comparisons for one answer: references may multiply them.
const MAX_STEPS: usize = 1 << 17;
/// The deepest nesting of an answer, and of references in one place.
const MAX_DEPTH: usize = 128;

/// A schema, ready to use.
#[derive(Debug)]
pub(super) struct Schema {
    root: Value,
    patterns: BTreeMap<String, Regex>,
}

/// What a keyword's value has to be.
#[derive(Clone, Copy, PartialEq)]
enum Shape {
    /// Anything: the keyword has no effect.
    Note,
    Types,
    List,
    Anything,
    Number,
    Count,
    Names,
    Pattern,
    Reference,
    Schema,
    Schemas,
    NamedSchemas,
    SchemaOrSwitch,
}

/// Compares a value with a keyword: `(judging, schema, keyword's value, value, place of the value)`.
type Comparison = fn(&Judging, &Map<String, Value>, &Value, &Value, &str) -> Result<(), String>;

const NONE: Comparison = |_, _, _, _, _| Ok(());

const KEYWORDS: [(&str, Shape, Comparison); 26] = [
    ("title", Shape::Note, NONE),
    ("description", Shape::Note, NONE),
    ("default", Shape::Note, NONE),
    ("examples", Shape::Note, NONE),
    ("$schema", Shape::Note, NONE),
    ("$comment", Shape::Note, NONE),
    ("$defs", Shape::NamedSchemas, NONE),
    ("definitions", Shape::NamedSchemas, NONE),
    ("type", Shape::Types, types),
    ("enum", Shape::List, one_of),
    ("const", Shape::Anything, |_, _, only, found, at| {
        unless(only == found, at, || format!("has to be {only}"))
    }),
    ("anyOf", Shape::Schemas, any_of),
    ("$ref", Shape::Reference, |judging, _, name, found, at| {
        let target = judging.schema.target(name).ok_or("a reference is broken")?;
        judging.follow(target, found, at)
    }),
    ("properties", Shape::NamedSchemas, properties),
    ("required", Shape::Names, required),
    ("additionalProperties", Shape::SchemaOrSwitch, others),
    ("items", Shape::Schema, items),
    ("minItems", Shape::Count, |_, _, n, found, at| {
        let count = found.as_array().map(|list| list.len() as f64);
        least(count, n, at, "entries")
    }),
    ("maxItems", Shape::Count, |_, _, n, found, at| {
        let count = found.as_array().map(|list| list.len() as f64);
        most(count, n, at, "entries")
    }),
    ("minLength", Shape::Count, |_, _, n, found, at| {
        least(letters(found), n, at, "letters")
    }),
    ("maxLength", Shape::Count, |_, _, n, found, at| {
        most(letters(found), n, at, "letters")
    }),
    ("pattern", Shape::Pattern, pattern),
    ("minimum", Shape::Number, |_, _, n, found, at| {
        least(found.as_f64(), n, at, "")
    }),
    ("maximum", Shape::Number, |_, _, n, found, at| {
        most(found.as_f64(), n, at, "")
    }),
    ("exclusiveMinimum", Shape::Number, |_, _, n, found, at| {
        let is_more = found.as_f64().zip(n.as_f64()).is_none_or(|(it, n)| it > n);
        unless(is_more, at, || format!("has to be more than {n}"))
    }),
    ("exclusiveMaximum", Shape::Number, |_, _, n, found, at| {
        let is_less = found.as_f64().zip(n.as_f64()).is_none_or(|(it, n)| it < n);
        unless(is_less, at, || format!("has to be less than {n}"))
    }),
];

impl Schema {
    /// Reads a schema; fails with what is wrong or unknown, beginning with its place.
    pub(super) fn read(root: &Value) -> Result<Schema, String> {
        if root.to_string().len() > MAX_BYTES {
            return Err(format!("is longer than {MAX_BYTES} bytes"));
        }
        let mut schema = Schema {
            root: root.clone(),
            patterns: BTreeMap::new(),
        };
        schema.check(root, "$")?;
        Ok(schema)
    }

    /// Returns the properties of an answer that is an object.
    pub(super) fn properties(&self) -> Option<&Map<String, Value>> {
        self.root["properties"].as_object()
    }

    /// Returns whether a pattern of the schema matches a text.
    pub(super) fn matches(&self, pattern: &str, text: &str) -> bool {
        let pattern = self.patterns.get(pattern);
        pattern.is_some_and(|pattern| pattern.is_match(text))
    }

    /// Fails with the first place where a text is not JSON that follows the schema.
    pub(super) fn judge(&self, text: &str) -> Result<(), String> {
        let found: Value = serde_json::from_str(text).map_err(|_| "it is not JSON".to_owned())?;
        let judging = Judging {
            schema: self,
            steps: Cell::new(MAX_STEPS),
            depth: Cell::new(0),
        };
        judging.follow(&self.root, &found, "$")
    }

    /// Checks a schema inside the root; JSON that was parsed is nested at most 128 deep.
    fn check(&mut self, schema: &Value, at: &str) -> Result<(), String> {
        let Value::Object(keywords) = schema else {
            return Err(format!("is not a schema at `{at}`"));
        };
        for (name, value) in keywords {
            let known = KEYWORDS.iter().find(|(keyword, ..)| keyword == name);
            let Some((_, shape, _)) = known else {
                let name: String = name.chars().take(80).collect();
                return Err(format!(
                    "has `{name}` at `{at}`, which cannot be checked here"
                ));
            };
            let is_right = match (shape, value) {
                (Shape::Note | Shape::Anything, _) => true,
                (Shape::Types, Value::String(name)) => is_type(name),
                (Shape::Types, Value::Array(names)) => {
                    names.iter().all(|name| name.as_str().is_some_and(is_type))
                }
                (Shape::List, Value::Array(_)) | (Shape::Number, Value::Number(_)) => true,
                (Shape::Count, Value::Number(count)) => count.is_u64(),
                (Shape::Names, Value::Array(names)) => names.iter().all(Value::is_string),
                (Shape::Pattern, Value::String(pattern)) => self.learn(pattern),
                (Shape::Reference, name) => self.target(name).is_some(),
                (Shape::SchemaOrSwitch, Value::Bool(_)) => true,
                (Shape::Schema | Shape::SchemaOrSwitch, Value::Object(_)) => {
                    self.check(value, &format!("{at}.{name}"))?;
                    true
                }
                (Shape::Schemas, Value::Array(list)) => {
                    for (index, schema) in list.iter().enumerate() {
                        self.check(schema, &format!("{at}.{name}[{index}]"))?;
                    }
                    true
                }
                (Shape::NamedSchemas, Value::Object(list)) => {
                    for (inner, schema) in list {
                        self.check(schema, &format!("{at}.{name}.{inner}"))?;
                    }
                    true
                }
                _ => false,
            };
            if !is_right {
                return Err(format!("has a wrong `{name}` at `{at}`"));
            }
        }
        Ok(())
    }

    /// Compiles a pattern; returns whether that is possible.
    fn learn(&mut self, pattern: &str) -> bool {
        let mut builder = RegexBuilder::new(pattern);
        let built = builder.size_limit(MAX_PATTERN_BYTES).build();
        let has_room = self.patterns.len() < MAX_PATTERNS;
        match built {
            Ok(built) if has_room => {
                self.patterns.insert(pattern.to_owned(), built);
                true
            }
            _ => self.patterns.contains_key(pattern),
        }
    }

    /// Returns what a reference names: the root, or an entry of `$defs` or `definitions`.
    fn target(&self, reference: &Value) -> Option<&Value> {
        let inside = reference.as_str()?.strip_prefix('#')?;
        let Some(inside) = inside.strip_prefix('/') else {
            return inside.is_empty().then_some(&self.root);
        };
        let (list, name) = inside.split_once('/')?;
        let is_list = matches!(list, "$defs" | "definitions");
        is_list.then(|| self.root[list].get(name))?
    }
}

/// One comparison of an answer with its schema.
struct Judging<'a> {
    schema: &'a Schema,
    /// Comparisons left.
    steps: Cell<usize>,
    depth: Cell<usize>,
}

impl Judging<'_> {
    fn follow(&self, schema: &Value, found: &Value, at: &str) -> Result<(), String> {
        let Value::Object(keywords) = schema else {
            return Ok(());
        };
        if self.depth.get() > MAX_DEPTH {
            return Err(format!("`{at}` is nested too deeply to be checked"));
        }
        self.depth.set(self.depth.get() + 1);
        for (name, value) in keywords {
            self.spend(1)?;
            let known = KEYWORDS.iter().find(|(keyword, ..)| keyword == name);
            if let Some((_, _, compare)) = known {
                compare(self, keywords, value, found, at)?;
            }
        }
        self.depth.set(self.depth.get() - 1);
        Ok(())
    }

    fn spend(&self, steps: usize) -> Result<(), String> {
        let left = self.steps.get().checked_sub(steps);
        self.steps
            .set(left.ok_or("its schema takes too long to check")?);
        Ok(())
    }
}

fn unless(holds: bool, at: &str, why: impl FnOnce() -> String) -> Result<(), String> {
    match holds {
        true => Ok(()),
        false => Err(format!("`{at}` {}", why())),
    }
}

fn is_type(name: &str) -> bool {
    matches!(
        name,
        "string" | "number" | "integer" | "boolean" | "null" | "object" | "array"
    )
}

fn is_of_type(found: &Value, name: &str) -> bool {
    match name {
        "string" => found.is_string(),
        "number" => found.is_number(),
        "integer" => found.as_f64().is_some_and(|number| number.fract() == 0.0),
        "boolean" => found.is_boolean(),
        "null" => found.is_null(),
        "object" => found.is_object(),
        _ => found.is_array(),
    }
}

fn types(
    _: &Judging,
    _: &Map<String, Value>,
    names: &Value,
    found: &Value,
    at: &str,
) -> Result<(), String> {
    let is_one = |name: &Value| name.as_str().is_some_and(|name| is_of_type(found, name));
    let holds = is_one(names)
        || names
            .as_array()
            .is_some_and(|names| names.iter().any(is_one));
    unless(holds, at, || format!("is not of the type {names}"))
}

fn one_of(
    judging: &Judging,
    _: &Map<String, Value>,
    list: &Value,
    found: &Value,
    at: &str,
) -> Result<(), String> {
    let list = list.as_array().map_or(&[][..], Vec::as_slice);
    judging.spend(list.len())?;
    unless(list.contains(found), at, || {
        "is none of the choices".to_owned()
    })
}

fn any_of(
    judging: &Judging,
    _: &Map<String, Value>,
    list: &Value,
    found: &Value,
    at: &str,
) -> Result<(), String> {
    let depth = judging.depth.get();
    for schema in list.as_array().into_iter().flatten() {
        if judging.follow(schema, found, at).is_ok() {
            return Ok(());
        }
        // A comparison that failed left the depth where it was.
        judging.depth.set(depth);
        judging.spend(1)?;
    }
    Err(format!("`{at}` follows no part of `anyOf`"))
}

fn properties(
    judging: &Judging,
    _: &Map<String, Value>,
    list: &Value,
    found: &Value,
    at: &str,
) -> Result<(), String> {
    for (name, schema) in list.as_object().into_iter().flatten() {
        judging.spend(1)?;
        if let Some(found) = found.get(name.as_str()) {
            judging.follow(schema, found, &format!("{at}.{name}"))?;
        }
    }
    Ok(())
}

fn required(
    judging: &Judging,
    _: &Map<String, Value>,
    names: &Value,
    found: &Value,
    at: &str,
) -> Result<(), String> {
    let Value::Object(found) = found else {
        return Ok(());
    };
    for name in names.as_array().into_iter().flatten() {
        judging.spend(1)?;
        let name = name.as_str().unwrap_or_default();
        unless(found.contains_key(name), at, || format!("lacks `{name}`"))?;
    }
    Ok(())
}

fn others(
    judging: &Judging,
    schema: &Map<String, Value>,
    rule: &Value,
    found: &Value,
    at: &str,
) -> Result<(), String> {
    let known = schema.get("properties").and_then(Value::as_object);
    for (name, found) in found.as_object().into_iter().flatten() {
        judging.spend(1)?;
        if known.is_some_and(|known| known.contains_key(name)) {
            continue;
        }
        unless(*rule != Value::Bool(false), at, || {
            let name: String = name.chars().take(80).collect();
            format!("has `{name}`, which is not asked for")
        })?;
        judging.follow(rule, found, &format!("{at}.{name}"))?;
    }
    Ok(())
}

fn items(
    judging: &Judging,
    _: &Map<String, Value>,
    schema: &Value,
    found: &Value,
    at: &str,
) -> Result<(), String> {
    for (index, found) in found.as_array().into_iter().flatten().enumerate() {
        judging.follow(schema, found, &format!("{at}[{index}]"))?;
    }
    Ok(())
}

fn pattern(
    judging: &Judging,
    _: &Map<String, Value>,
    pattern: &Value,
    found: &Value,
    at: &str,
) -> Result<(), String> {
    let (Some(pattern), Some(found)) = (pattern.as_str(), found.as_str()) else {
        return Ok(());
    };
    judging.spend(found.len())?;
    unless(judging.schema.matches(pattern, found), at, || {
        let pattern: String = pattern.chars().take(80).collect();
        format!("does not match `{pattern}`")
    })
}

fn letters(found: &Value) -> Option<f64> {
    Some(found.as_str()?.chars().count() as f64)
}

/// A value of another type, `None`, is not concerned.
fn least(found: Option<f64>, limit: &Value, at: &str, of: &str) -> Result<(), String> {
    let holds = found.zip(limit.as_f64()).is_none_or(|(it, n)| it >= n);
    unless(holds, at, || {
        format!("has to be at least {limit} {of}")
            .trim_end()
            .to_owned()
    })
}

fn most(found: Option<f64>, limit: &Value, at: &str, of: &str) -> Result<(), String> {
    let holds = found.zip(limit.as_f64()).is_none_or(|(it, n)| it <= n);
    unless(holds, at, || {
        format!("has to be at most {limit} {of}")
            .trim_end()
            .to_owned()
    })
}

#[cfg(test)]
#[path = "schema_tests.rs"]
mod tests;
