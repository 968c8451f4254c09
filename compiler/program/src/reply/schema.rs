//! The JSON Schema of an answer, for models with structured output.

use super::lexer::is_any;
use crate::data::actions::{ActionField, Choices, Value};
use crate::data::manner::manner_field;
use crate::data::program::Program;
use crate::data::stage::{Read, Stage};
use crate::pointing::{CoordinateUnit, Notation, Order, Pointing};
use crate::space;
use crate::units::Dimension;
use serde_json::{Map, Value as Json, json};

/// The pattern of a point as [`space::text`] writes it; the reader refuses larger numbers.
const POINT: &str = r"^\((0|-?[1-9][0-9]{0,5}), (0|-?[1-9][0-9]{0,5})\)$";

/// The same with decimals.
const DECIMAL_POINT: &str = r"^\(-?[0-9]{1,6}(\.[0-9]{1,9})?, -?[0-9]{1,6}(\.[0-9]{1,9})?\)$";

/// The same as a list.
const DECIMAL_LIST: &str = r"^\[-?[0-9]{1,6}(\.[0-9]{1,9})?, -?[0-9]{1,6}(\.[0-9]{1,9})?\]$";

/// The property for the reasons that a prompt asks for; the reader does not read it.
pub(super) const REASON: &str = "reason";

/// The longest reason, characters: about 150 tokens, which fit into the answers of the shipped stages. llama.cpp refuses
/// more than 2,000 repetitions in a grammar.
const MAX_REASON_CHARS: u32 = 600;

/// Returns the schema of the answer to a stage: of its text, or of the action with the values that are offered.
pub fn for_stage(
    program: &Program,
    stage: &Stage,
    notation: &Notation,
    offered: &[(String, Vec<Value>)],
) -> Json {
    match &stage.read {
        Read::Text { before, .. } => text_schema(before),
        Read::Action => schema_in(program, notation, offered),
    }
}

/// Returns the schema of a text: one property, named after the words before it.
pub fn text_schema(before: &str) -> Json {
    let text = json!({ "type": "string", "description": format!("what stands after `{before}`") });
    strict(Map::from_iter([(text_key(before), text)]))
}

/// Returns the property of a text, named after the words before it: `Instructions:` gives `instructions`.
pub(super) fn text_key(before: &str) -> String {
    let spelt = |c: char| if c.is_alphanumeric() { c } else { '_' };
    let name: String = before.to_lowercase().chars().map(spelt).collect();
    match name.trim_matches('_') {
        "" => "text".to_owned(),
        name => name.to_owned(),
    }
}

/// Returns a schema that accepts exactly the offered values, as strings that the reader of answers understands; for a
/// region, every point.
///
/// - `notation`: how points are written in the scene.
/// - `offered`: the values of each field in the scene. For a field that is not listed, the declared ones, and for
///   points none.
pub fn schema_in(program: &Program, notation: &Notation, offered: &[(String, Vec<Value>)]) -> Json {
    object(program, |field| {
        if let Choices::Region { .. } = field.choices {
            return any_point(notation, field);
        }
        let values = offered.iter().find(|(name, _)| *name == field.name);
        let values = values.map_or_else(|| space::declared(field), |(_, values)| values.clone());
        choices(notation, field, &values)
    })
}

/// Returns a schema that accepts every value that some scene may offer. Points are given by a pattern.
pub fn static_schema(program: &Program) -> Json {
    let notation = &Notation::pixels();
    object(program, |field| match field.choices {
        Choices::Points { .. } | Choices::Region { .. } => any_point(notation, field),
        _ => choices(notation, field, &space::declared(field)),
    })
}

/// Returns the schema of an action. A reason comes first, so that a model without hidden reasoning thinks before it
/// decides.
fn object(program: &Program, property: impl Fn(&ActionField) -> Json) -> Json {
    let mut properties = Map::new();
    if asks_for_reasons(program) && program.field(REASON).is_none() {
        let reason = json!({
            "type": "string",
            "description": "the reason for this action",
            "maxLength": MAX_REASON_CHARS,
        });
        properties.insert(REASON.to_owned(), reason);
    }
    let fields = program.actions.iter();
    properties.extend(fields.map(|field| (field.name.clone(), property(field))));
    strict(properties)
}

/// Returns the schema of an object with these properties and no others.
fn strict(properties: Map<String, Json>) -> Json {
    let names: Vec<String> = properties.keys().cloned().collect();
    json!({
        "type": "object",
        "properties": properties,
        "required": names,
        "additionalProperties": false,
    })
}

/// Words with which a prompt asks for reasons.
const ASKING: &str = "reason reasons reasoning why explain explains explanation explanations justify justification rationale step-by-step";

/// Words with which it wants none, or means something else.
const NOT_ASKING: &str = "no not don't don’t never without this that";

/// Returns whether a question for an action asks for reasons.
fn asks_for_reasons(program: &Program) -> bool {
    let is_action = |stage: &&Stage| matches!(stage.read, Read::Action);
    let stages = program.stages.iter().filter(is_action);
    let names = stages.flat_map(|stage| stage.system.iter().chain(&stage.say));
    let mut texts = names.filter_map(|name| {
        let template = program.templates.iter().find(|it| it.name == *name)?;
        Some(template.text.replace("step by step", "step-by-step"))
    });
    texts.any(|text| text.split(['.', '!', '?', ';', ':']).any(wants_reasons))
}

/// Returns whether a sentence asks for reasons: `then give your reason`, not `give no reason`, `for this reason`.
fn wants_reasons(sentence: &str) -> bool {
    let is_part = |letter: char| letter.is_alphabetic() || "'’-".contains(letter);
    let words: Vec<&str> = sentence.split(|letter: char| !is_part(letter)).collect();
    words.iter().enumerate().any(|(at, word)| {
        let mut before = words[at.saturating_sub(3)..at].iter();
        is_any(word, ASKING) && !before.any(|it| is_any(it, NOT_ASKING))
    })
}

/// Accepts everything written as a point.
fn any_point(notation: &Notation, field: &ActionField) -> Json {
    let pattern = if notation.is_native() {
        POINT
    } else {
        match (notation.unit(), notation.order()) {
            (CoordinateUnit::Pixels, Order::Xy) => POINT,
            (_, Order::Xy) => DECIMAL_POINT,
            (_, Order::Yx) => DECIMAL_LIST,
        }
    };
    json!({ "type": "string", "description": what(notation, field), "pattern": pattern })
}

fn choices(notation: &Notation, field: &ActionField, values: &[Value]) -> Json {
    let texts: Vec<String> = values
        .iter()
        .map(|value| notation.stated_value(field, value))
        .collect();
    json!({ "type": "string", "description": what(notation, field), "enum": texts })
}

fn what(notation: &Notation, field: &ActionField) -> String {
    let name = space::spoken(field);
    let point = match notation.pointing() {
        _ if notation.is_native() => format!("the {name} point (x, y), pixels"),
        Pointing::Marks(_) => format!("the number of the {name} point"),
        pointing => format!("the {name} point {}", pointing.phrase()),
    };
    if let Some(row) = manner_field(&field.name) {
        return row.doc.to_owned();
    }
    match field.choices {
        Choices::Points { .. } => point,
        Choices::Region { ref mask } => format!("{point}: {}", space::any_of(mask)),
        Choices::Directions { .. } => {
            format!("the {name}, counter-clockwise from the image's right")
        }
        Choices::Lengths { unit, .. } if unit.dimension == Dimension::Speed => {
            format!("the {name}")
        }
        Choices::Lengths { .. } => format!("the {name}, on the table"),
        Choices::Words { .. } => format!("the {name}"),
    }
}

#[cfg(test)]
#[path = "schema_tests.rs"]
mod tests;
