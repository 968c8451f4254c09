//! The JSON Schema of an answer, for models with structured output.

use super::wordlist::words;
use crate::data::actions::{ActionField, Choices, Value};
use crate::data::manner::manner_field;
use crate::data::program::Program;
use crate::data::stage::Read;
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

/// Returns a schema that accepts exactly the offered values, as strings that [`space::text`] writes; for a region,
/// every point.
///
/// - `offered`: the values of each field in the scene. For a field that is not listed, the declared ones, and for
///   points none.
///
/// Values are strings because every provider's structured output can enumerate those, and the reader of answers
/// understands them.
pub fn schema(program: &Program, offered: &[(String, Vec<Value>)]) -> Json {
    schema_in(program, &Notation::pixels(), offered)
}

/// Returns the same with points written as in a scene: in another frame, or as numbers.
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

fn object(program: &Program, property: impl Fn(&ActionField) -> Json) -> Json {
    let mut properties: Map<String, Json> = program
        .actions
        .iter()
        .map(|field| (field.name.clone(), property(field)))
        .collect();
    if asks_for_reasons(program) && program.field(REASON).is_none() {
        // Without it, a model that answers with this schema could not reason where the prompt asks it to.
        let reason = json!({ "type": "string", "description": "the reason for this action" });
        properties.insert(REASON.to_owned(), reason);
    }
    let names: Vec<&str> = properties.keys().map(String::as_str).collect();
    json!({
        "type": "object",
        "properties": properties,
        "required": names,
        "additionalProperties": false,
    })
}

/// The property for the reasons that a prompt asks for; the reader does not read it.
const REASON: &str = "reason";

/// Words with which a prompt asks for reasons.
const ASKING: &[&str] = words!(
    "reason reasons reasoning why explain explains explanation explanations justify justification rationale step-by-step"
);

/// Words with which it wants none, or means something else.
const NOT_ASKING: &[&str] = words!("no not don't don’t never without this that");

/// Returns whether a question for an action asks for reasons.
fn asks_for_reasons(program: &Program) -> bool {
    let stages = program
        .stages
        .iter()
        .filter(|stage| matches!(stage.read, Read::Action));
    let mut names = stages.flat_map(|stage| stage.system.iter().chain(&stage.say));
    names.any(|name| {
        let template = program
            .templates
            .iter()
            .find(|template| template.name == *name);
        template.is_some_and(|template| {
            let text = template
                .text
                .to_lowercase()
                .replace("step by step", "step-by-step");
            text.split(['.', '!', '?', ';', ':']).any(wants_reasons)
        })
    })
}

/// Returns whether a sentence asks for reasons: `then give your reason`, not `give no reason`, `for this reason`.
fn wants_reasons(sentence: &str) -> bool {
    let is_part = |letter: char| letter.is_alphabetic() || "'’-".contains(letter);
    let words: Vec<&str> = sentence
        .split(|letter: char| !is_part(letter))
        .filter(|word| !word.is_empty())
        .collect();
    words.iter().enumerate().any(|(at, word)| {
        ASKING.contains(word)
            && !words[at.saturating_sub(3)..at]
                .iter()
                .any(|before| NOT_ASKING.contains(before))
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
mod tests {
    use super::wants_reasons;

    #[test]
    fn a_prompt_asks_for_reasons_in_many_words_and_wants_none_in_others() {
        for asking in [
            "then give your reason",
            "explain your choice",
            "state your rationale first",
            "think step-by-step",
            "say why you chose it",
        ] {
            assert!(wants_reasons(asking), "{asking}");
        }
        for other in [
            "give no reason",
            "do not explain",
            "for this reason stay on the cloth",
            "there is no reason to hurry",
            "without explanations",
            "begin your answer with these two lines",
        ] {
            assert!(!wants_reasons(other), "{other}");
        }
    }
}
