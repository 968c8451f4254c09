//! Laws of answers in a wanted form, over many schemas and answers.

use super::*;
use proptest::prelude::*;

/// Values of `enum`, among them ones that no reader of words knows.
fn choice() -> impl Strategy<Value = Value> {
    let texts = [
        "(1, 2)",
        "(-1, 20)",
        "(9999999999, 1)",
        "0 deg",
        "45 deg",
        "360 deg",
        "NaN deg",
        "0.5 edge",
        "-1 cm",
        "1 ell",
        "soft",
        "Soft",
        "",
        " ",
        "a b",
        "ß",
        "not",
        "null",
        "1",
    ];
    prop_oneof![
        proptest::sample::select(texts.to_vec()).prop_map(Value::from),
        Just(json!(1)),
        Just(Value::Null),
    ]
}

fn property() -> impl Strategy<Value = Value> {
    let patterns = [r"^\([0-9]+, [0-9]+\)$", "^x", ""];
    prop_oneof![
        proptest::collection::vec(choice(), 0..4)
            .prop_map(|list| json!({ "type": "string", "enum": list })),
        proptest::sample::select(patterns.to_vec())
            .prop_map(|it| json!({ "type": "string", "pattern": it })),
        Just(json!({ "type": "string" })),
        Just(json!({ "type": "integer" })),
        Just(json!({})),
    ]
}

fn answer() -> impl Strategy<Value = String> {
    let lines = [
        "pick = (1, 2)",
        "Pick Point = (-1, 20)",
        "place: (3, 4)",
        "direction = 45 deg",
        "distance = 0.5 edge",
        "grip = soft",
        "grip is not soft",
        "{\"pick\": \"(1, 2)\"}",
        "```json",
        "```",
        "<think>",
        "</think>",
        "no wait",
        "pick",
        "=",
        "ß",
        "",
    ];
    proptest::collection::vec(proptest::sample::select(lines.to_vec()), 0..6)
        .prop_map(|lines| lines.join("\n"))
}

proptest! {
    #[test]
    fn an_answer_to_a_strict_schema_follows_it_or_is_refused(
        properties in proptest::collection::vec((proptest::sample::select(
            vec!["pick", "place", "direction", "distance", "grip", "Grip", "reason", "", "a b", "ß"]), property()), 0..4),
        text in answer(),
    ) {
        let properties: Map<String, Value> =
            properties.into_iter().map(|(name, property)| (name.to_owned(), property)).collect();
        let required: Vec<&String> = properties.keys().collect();
        let stated = json!({
            "type": "object", "properties": properties, "required": required, "additionalProperties": false,
        });
        let schema = Schema::read(&stated).expect("a schema of known keywords");
        let strict = Format { stated: Some(stated), schema: Some(schema), is_strict: true };
        if let Ok(fitted) = strict.fit(text) {
            let schema = strict.schema.as_ref().expect("it has one");
            prop_assert_eq!(schema.judge(&fitted), Ok(()));
        }
    }
}
