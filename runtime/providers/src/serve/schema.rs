//! The JSON Schema of an answer: read before a model is asked, and held against its answer.
//!
//! In: a schema with the keywords of [`KEYWORDS`]. Out: whether a value follows it, or the first place where it does
//! not. A schema with another keyword is refused, because nothing here could hold an answer against it. Work, depth and
//! memory are bounded, whatever the schema says.

use Effect::{Is, Limited, Nothing};
use Shape::{
    Anything, Count, List, NamedSchemas, Names, Note, Number, Pattern, Reference, SchemaOrSwitch,
    Schemas, Types,
};
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

/// How a keyword is held against a value.
enum Effect {
    /// It has no effect by itself.
    Nothing,
    /// A quantity of the value has a limit; a value without that quantity is not concerned.
    Limited(Quantity, Limit),
    Is(Comparison),
}

/// Compares a value with a keyword: the keyword's value, and where and what is compared.
type Comparison = fn(&Judging, &Value, &Place<'_>) -> Result<(), String>;

/// A quantity of a value, and its unit in messages.
type Quantity = (fn(&Value) -> Option<f64>, &'static str);
const NUMBER: Quantity = (Value::as_f64, "");
const ENTRIES: Quantity = (|it| Some(it.as_array()?.len() as f64), " entries");
const LETTERS: Quantity = (|it| Some(it.as_str()?.chars().count() as f64), " letters");

/// Whether a quantity keeps a limit, and the words for it.
type Limit = (fn(&f64, &f64) -> bool, &'static str);
const LEAST: Limit = (f64::ge, "at least");
const MOST: Limit = (f64::le, "at most");
const MORE: Limit = (f64::gt, "more than");
const LESS: Limit = (f64::lt, "less than");

/// A value, its schema, and its place in the answer.
struct Place<'a> {
    schema: &'a Map<String, Value>,
    found: &'a Value,
    at: &'a str,
}

const KEYWORDS: [(&str, Shape, Effect); 26] = [
    ("title", Note, Nothing),
    ("description", Note, Nothing),
    ("default", Note, Nothing),
    ("examples", Note, Nothing),
    ("$schema", Note, Nothing),
    ("$comment", Note, Nothing),
    ("$defs", NamedSchemas, Nothing),
    ("definitions", NamedSchemas, Nothing),
    ("type", Types, Is(types)),
    ("enum", List, Is(one_of)),
    ("const", Anything, Is(constant)),
    ("anyOf", Schemas, Is(any_of)),
    ("$ref", Reference, Is(referred)),
    ("properties", NamedSchemas, Is(properties)),
    ("required", Names, Is(required)),
    ("additionalProperties", SchemaOrSwitch, Is(others)),
    ("items", Shape::Schema, Is(items)),
    ("minItems", Count, Limited(ENTRIES, LEAST)),
    ("maxItems", Count, Limited(ENTRIES, MOST)),
    ("minLength", Count, Limited(LETTERS, LEAST)),
    ("maxLength", Count, Limited(LETTERS, MOST)),
    ("pattern", Pattern, Is(pattern)),
    ("minimum", Number, Limited(NUMBER, LEAST)),
    ("maximum", Number, Limited(NUMBER, MOST)),
    ("exclusiveMinimum", Number, Limited(NUMBER, MORE)),
    ("exclusiveMaximum", Number, Limited(NUMBER, LESS)),
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
                (Note | Anything, _) => true,
                (Types, Value::String(name)) => is_type(name),
                (Types, Value::Array(names)) => {
                    names.iter().all(|name| name.as_str().is_some_and(is_type))
                }
                (List, Value::Array(_)) | (Number, Value::Number(_)) => true,
                (Count, Value::Number(count)) => count.is_u64(),
                (Names, Value::Array(names)) => names.iter().all(Value::is_string),
                (Pattern, Value::String(pattern)) => self.learn(pattern),
                (Reference, name) => self.target(name).is_some(),
                (SchemaOrSwitch, Value::Bool(_)) => true,
                (Shape::Schema | SchemaOrSwitch, Value::Object(_)) => {
                    self.check(value, &format!("{at}.{name}"))?;
                    true
                }
                (Schemas, Value::Array(list)) => {
                    for (index, schema) in list.iter().enumerate() {
                        self.check(schema, &format!("{at}.{name}[{index}]"))?;
                    }
                    true
                }
                (NamedSchemas, Value::Object(list)) => {
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
        let place = Place {
            schema: keywords,
            found,
            at,
        };
        for (name, value) in keywords {
            self.spend(1)?;
            let known = KEYWORDS.iter().find(|(keyword, ..)| keyword == name);
            match known.map(|(_, _, rule)| rule) {
                Some(Is(compare)) => compare(self, value, &place)?,
                Some(Limited((quantity, unit), (holds, words))) => {
                    let pair = quantity(found).zip(value.as_f64());
                    let holds = pair.is_none_or(|(it, limit)| holds(&it, &limit));
                    place.unless(holds, || format!("has to be {words} {value}{unit}"))?;
                }
                Some(Nothing) | None => {}
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

impl Place<'_> {
    fn unless(&self, holds: bool, why: impl FnOnce() -> String) -> Result<(), String> {
        match holds {
            true => Ok(()),
            false => Err(format!("`{}` {}", self.at, why())),
        }
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

fn types(_: &Judging, names: &Value, place: &Place<'_>) -> Result<(), String> {
    let is_one = |name: &Value| name.as_str().is_some_and(|it| is_of_type(place.found, it));
    let are_several = |names: &Vec<Value>| names.iter().any(is_one);
    let holds = is_one(names) || names.as_array().is_some_and(are_several);
    place.unless(holds, || format!("is not of the type {names}"))
}

fn constant(_: &Judging, only: &Value, place: &Place<'_>) -> Result<(), String> {
    place.unless(only == place.found, || format!("has to be {only}"))
}

fn one_of(judging: &Judging, list: &Value, place: &Place<'_>) -> Result<(), String> {
    let list = list.as_array().map_or(&[][..], Vec::as_slice);
    judging.spend(list.len())?;
    let holds = list.contains(place.found);
    place.unless(holds, || "is none of the choices".to_owned())
}

fn any_of(judging: &Judging, list: &Value, place: &Place<'_>) -> Result<(), String> {
    let depth = judging.depth.get();
    for schema in list.as_array().into_iter().flatten() {
        if judging.follow(schema, place.found, place.at).is_ok() {
            return Ok(());
        }
        // A comparison that failed left the depth where it was.
        judging.depth.set(depth);
        judging.spend(1)?;
    }
    place.unless(false, || "follows no part of `anyOf`".to_owned())
}

fn referred(judging: &Judging, name: &Value, place: &Place<'_>) -> Result<(), String> {
    let target = judging.schema.target(name).ok_or("a reference is broken")?;
    judging.follow(target, place.found, place.at)
}

fn properties(judging: &Judging, list: &Value, place: &Place<'_>) -> Result<(), String> {
    for (name, schema) in list.as_object().into_iter().flatten() {
        judging.spend(1)?;
        if let Some(found) = place.found.get(name.as_str()) {
            judging.follow(schema, found, &format!("{}.{name}", place.at))?;
        }
    }
    Ok(())
}

fn required(judging: &Judging, names: &Value, place: &Place<'_>) -> Result<(), String> {
    let Value::Object(found) = place.found else {
        return Ok(());
    };
    for name in names.as_array().into_iter().flatten() {
        judging.spend(1)?;
        let name = name.as_str().unwrap_or_default();
        place.unless(found.contains_key(name), || format!("lacks `{name}`"))?;
    }
    Ok(())
}

fn others(judging: &Judging, rule: &Value, place: &Place<'_>) -> Result<(), String> {
    let known = place.schema.get("properties").and_then(Value::as_object);
    for (name, found) in place.found.as_object().into_iter().flatten() {
        judging.spend(1)?;
        if known.is_some_and(|known| known.contains_key(name)) {
            continue;
        }
        place.unless(*rule != Value::Bool(false), || {
            let name: String = name.chars().take(80).collect();
            format!("has `{name}`, which is not asked for")
        })?;
        judging.follow(rule, found, &format!("{}.{name}", place.at))?;
    }
    Ok(())
}

fn items(judging: &Judging, schema: &Value, place: &Place<'_>) -> Result<(), String> {
    for (index, found) in place.found.as_array().into_iter().flatten().enumerate() {
        judging.follow(schema, found, &format!("{}[{index}]", place.at))?;
    }
    Ok(())
}

fn pattern(judging: &Judging, pattern: &Value, place: &Place<'_>) -> Result<(), String> {
    let (Some(pattern), Some(found)) = (pattern.as_str(), place.found.as_str()) else {
        return Ok(());
    };
    judging.spend(found.len())?;
    place.unless(judging.schema.matches(pattern, found), || {
        let pattern: String = pattern.chars().take(80).collect();
        format!("does not match `{pattern}`")
    })
}

#[cfg(test)]
#[path = "schema_tests.rs"]
mod tests;
