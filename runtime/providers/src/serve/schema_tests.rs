//! Tests of schemas: what follows them, what cannot be checked, and what never ends.

use super::*;
use serde_json::json;

#[test]
fn an_answer_follows_a_schema_or_the_first_place_is_named() {
    let action = json!({
        "type": "object",
        "properties": {
            "pick": { "type": "string", "enum": ["(1, 2)", "(3, 4)"] },
            "place": { "type": "string", "pattern": "^\\([0-9]+, [0-9]+\\)$" },
            "grips": { "type": "array", "items": { "$ref": "#/$defs/grip" }, "minItems": 1, "maxItems": 2 },
            "note": { "anyOf": [{ "type": "string", "minLength": 2, "maxLength": 4 }, { "type": "null" }] },
        },
        "required": ["pick"],
        "additionalProperties": false,
        "$defs": { "grip": { "type": ["integer", "boolean"], "minimum": 1, "exclusiveMaximum": 4 } },
    });
    let schema = Schema::read(&action).expect("a schema");
    for (answer, place) in [
        (json!({ "pick": "(1, 2)" }), None),
        (
            json!({ "pick": "(1, 2)", "place": "(5, 6)", "grips": [1, 3.0, true], "note": null }),
            Some("$.grips"),
        ),
        (
            json!({ "pick": "(1, 2)", "place": "(5, 6)", "grips": [1, 3.0], "note": "äöüß" }),
            None,
        ),
        (
            json!({ "pick": "(1, 2)", "grips": [1, false], "note": null }),
            None,
        ),
        (json!({ "pick": "(2, 1)" }), Some("$.pick")),
        (json!({ "pick": 1 }), Some("$.pick")),
        (
            json!({ "pick": "(1, 2)", "place": "(5, 6) " }),
            Some("$.place"),
        ),
        (json!({ "place": "(5, 6)" }), Some("$")),
        (json!({ "pick": "(1, 2)", "why": "so" }), Some("$")),
        (json!({ "pick": "(1, 2)", "grips": [] }), Some("$.grips")),
        (
            json!({ "pick": "(1, 2)", "grips": [1, 4] }),
            Some("$.grips[1]"),
        ),
        (
            json!({ "pick": "(1, 2)", "grips": [1, 1.5] }),
            Some("$.grips[1]"),
        ),
        (json!({ "pick": "(1, 2)", "note": "x" }), Some("$.note")),
        (
            json!({ "pick": "(1, 2)", "note": "letters" }),
            Some("$.note"),
        ),
        (json!(["(1, 2)"]), Some("$")),
    ] {
        let judged = schema.judge(&answer.to_string());
        match (&judged, place) {
            (Ok(()), None) => {}
            (Err(why), Some(place)) => {
                assert!(why.starts_with(&format!("`{place}` ")), "{answer}: {why}")
            }
            _ => panic!("{answer}: {judged:?}"),
        }
    }
    assert_eq!(
        schema.judge("Pick = (1, 2)").expect_err("a reason"),
        "it is not JSON"
    );
}

#[test]
fn a_schema_that_nothing_here_can_check_is_refused_with_the_keyword_and_its_place() {
    let long = json!({ "description": "a".repeat(MAX_BYTES) });
    let patterns: Vec<Value> = (0..=MAX_PATTERNS)
        .map(|n| json!({ "pattern": format!("^{n}$") }))
        .collect();
    for (schema, part) in [
        (json!({ "format": "date" }), "has `format` at `$`"),
        (
            json!({ "items": { "oneOf": [] } }),
            "has `oneOf` at `$.items`",
        ),
        (
            json!({ "properties": { "a": { "not": {} } } }),
            "has `not` at `$.properties.a`",
        ),
        (
            json!({ "anyOf": [{}, { "if": {} }] }),
            "has `if` at `$.anyOf[1]`",
        ),
        (json!({ "type": "text" }), "has a wrong `type` at `$`"),
        (
            json!({ "type": ["string", 3] }),
            "has a wrong `type` at `$`",
        ),
        (json!({ "enum": "a" }), "has a wrong `enum` at `$`"),
        (json!({ "minItems": -1 }), "has a wrong `minItems` at `$`"),
        (json!({ "required": [1] }), "has a wrong `required` at `$`"),
        (json!({ "pattern": "(" }), "has a wrong `pattern` at `$`"),
        (
            json!({ "pattern": "((a{1000}){1000}){1000}" }),
            "has a wrong `pattern` at `$`",
        ),
        (json!({ "anyOf": patterns }), "has a wrong `pattern`"),
        (json!({ "$ref": "#/$defs/a" }), "has a wrong `$ref` at `$`"),
        (
            json!({ "$ref": "https://example.org/a.json" }),
            "has a wrong `$ref` at `$`",
        ),
        (
            json!({ "$ref": "#/properties/a", "properties": { "a": {} } }),
            "has a wrong `$ref` at `$`",
        ),
        (json!({ "items": 3 }), "has a wrong `items` at `$`"),
        (
            json!({ "properties": { "a": true } }),
            "is not a schema at `$.properties.a`",
        ),
        (long, "is longer than 65536 bytes"),
    ] {
        let why = Schema::read(&schema).expect_err("a reason");
        assert!(why.starts_with(part), "{why}");
    }
}

#[test]
fn references_that_multiply_or_never_end_are_given_up() {
    let circle = Schema::read(&json!({ "$ref": "#" })).expect("a schema");
    assert!(
        circle
            .judge("1")
            .expect_err("a reason")
            .contains("too deeply")
    );
    // Each level asks the next one twice: 2^60 comparisons.
    let levels = (0..60).map(|level| {
        let next = json!({ "$ref": format!("#/$defs/l{}", level + 1) });
        (
            format!("l{level}"),
            json!({ "anyOf": [next.clone(), next] }),
        )
    });
    let mut levels: Map<String, Value> = levels.collect();
    levels.insert("l60".to_owned(), json!({ "type": "string" }));
    let wide = json!({ "$ref": "#/$defs/l0", "$defs": levels });
    assert!(Schema::read(&wide).expect("a schema").judge("1").is_err());
}
