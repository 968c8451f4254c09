//! The JSON Schema of an answer, for models that keep to one.

use crate::program::{PixelPoint, Program};
use serde_json::{Map, Value, json};

/// Returns a schema that accepts exactly the offered points, as strings `(x, y)`.
///
/// - `offered`: for each field its points; a field without any accepts nothing.
///
/// Strings, because they are what every provider's structured output enumerates; the reader of answers
/// understands them.
pub fn schema(program: &Program, offered: &[(String, Vec<PixelPoint>)]) -> Value {
    let mut properties = Map::new();
    for field in &program.actions {
        let points = offered
            .iter()
            .find(|(name, _)| *name == field.name)
            .map_or(&[][..], |(_, points)| points);
        let choices: Vec<String> = points.iter().map(PixelPoint::to_string).collect();
        let what = format!("the {} point (x, y), pixels", field.name);
        properties.insert(
            field.name.clone(),
            json!({ "type": "string", "description": what, "enum": choices }),
        );
    }
    let names: Vec<&str> = program
        .actions
        .iter()
        .map(|field| field.name.as_str())
        .collect();
    json!({
        "type": "object",
        "properties": properties,
        "required": names,
        "additionalProperties": false,
    })
}
