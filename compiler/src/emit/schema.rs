//! `actions.schema.json`: the JSON Schema of an answer, whatever the scene shows.
//!
//! Points are known only with a scene, so their field is any `(x, y)`; whether it was offered is judged by
//! the verifier. All other fields enumerate what they may be, written as prompts list it.

use crate::program::{ActionField, Choices, Program};
use crate::space;
use serde_json::{Map, Value, json};

/// What a point looks like: [`crate::program::PixelPoint`] as text.
const POINT_PATTERN: &str = r"^\(-?[0-9]+, -?[0-9]+\)$";

/// Writes the schema, indented, with a line end.
pub(super) fn emit(program: &Program) -> String {
    let properties: Map<String, Value> = program
        .actions
        .iter()
        .map(|field| (field.name.clone(), property(field)))
        .collect();
    let names: Vec<&String> = program.actions.iter().map(|field| &field.name).collect();
    let schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": format!("an action of the task {}", program.title()),
        "type": "object",
        "properties": properties,
        "required": names,
        "additionalProperties": false,
    });
    let mut text = serde_json::to_string_pretty(&schema).expect("a JSON value can be written");
    text.push('\n');
    text
}

fn property(field: &ActionField) -> Value {
    let name = &field.name;
    let choices: Vec<String> = space::declared(field)
        .iter()
        .map(|value| space::text(field, value))
        .collect();
    match &field.choices {
        Choices::Points { .. } => json!({
            "type": "string",
            "description": format!("the {name} point (x, y), pixels: one of those that the prompt lists"),
            "pattern": POINT_PATTERN,
        }),
        Choices::Directions { .. } => json!({
            "type": "string",
            "description": format!("the {name}, degrees counter-clockwise from the picture's right"),
            "enum": choices,
        }),
        Choices::Lengths { .. } | Choices::Words { .. } => json!({
            "type": "string",
            "description": format!("the {name}"),
            "enum": choices,
        }),
    }
}
