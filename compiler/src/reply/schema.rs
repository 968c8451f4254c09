//! The JSON Schema of an answer, for models that keep to one.

use crate::program::{ActionField, Choices, Program, Value};
use crate::space;
use serde_json::{Map, Value as Json, json};

/// What a point looks like as [`space::text`] writes it; the reader refuses larger numbers.
const POINT: &str = r"^\((0|-?[1-9][0-9]{0,6}), (0|-?[1-9][0-9]{0,6})\)$";

/// Returns a schema that accepts exactly the offered values, as strings that [`space::text`] writes; of a region, every
/// point.
///
/// - `offered`: for each field what it may be in the scene; for a field that is not among them, what is
///   declared, and nothing for points.
///
/// Strings, because they are what every provider's structured output enumerates; the reader of answers
/// understands them.
pub fn schema(program: &Program, offered: &[(String, Vec<Value>)]) -> Json {
    object(program, |field| {
        if let Choices::Region { .. } = field.choices {
            return any_point(field);
        }
        let values = offered.iter().find(|(name, _)| *name == field.name);
        let values = values.map_or_else(|| space::declared(field), |(_, values)| values.clone());
        choices(field, &values)
    })
}

/// Returns a schema that accepts every value that some scene may offer; points are given by a pattern.
pub fn static_schema(program: &Program) -> Json {
    object(program, |field| match field.choices {
        Choices::Points { .. } | Choices::Region { .. } => any_point(field),
        _ => choices(field, &space::declared(field)),
    })
}

fn object(program: &Program, property: impl Fn(&ActionField) -> Json) -> Json {
    let properties: Map<String, Json> = program
        .actions
        .iter()
        .map(|field| (field.name.clone(), property(field)))
        .collect();
    let names: Vec<&str> = properties.keys().map(String::as_str).collect();
    json!({
        "type": "object",
        "properties": properties,
        "required": names,
        "additionalProperties": false,
    })
}

/// Accepts whatever is written as a point.
fn any_point(field: &ActionField) -> Json {
    json!({ "type": "string", "description": what(field), "pattern": POINT })
}

fn choices(field: &ActionField, values: &[Value]) -> Json {
    let texts: Vec<String> = values
        .iter()
        .map(|value| space::text(field, value))
        .collect();
    json!({ "type": "string", "description": what(field), "enum": texts })
}

fn what(field: &ActionField) -> String {
    let name = space::spoken(field);
    match field.choices {
        Choices::Points { .. } => format!("the {name} point (x, y), pixels"),
        Choices::Region { ref mask } => {
            format!("the {name} point (x, y), pixels: {}", space::any_of(mask))
        }
        Choices::Directions { .. } => {
            format!("the {name}, counter-clockwise from the image's right")
        }
        Choices::Lengths { .. } => format!("the {name}, on the table"),
        Choices::Words { .. } => format!("the {name}"),
    }
}
