//! Tests of the parameters that refusals name.

use super::*;

#[test]
fn the_parameter_that_a_refusal_names_is_found_if_it_was_sent() {
    let request = r#"{"model":"m","messages":[{"content":"the \"top_p\": of"}],"temperature":0.2,"max_tokens":9,
        "reasoning_effort":"none","response_format":{"type":"json_schema","json_schema":{}}}"#;
    for (refusal, expected) in [
        (
            r#"{"error":{"message":"Unsupported value: 'temperature' does not support 0.2 with this model.","param":"temperature"}}"#,
            Some(Parameter::Temperature),
        ),
        (
            "Unsupported parameter: 'max_tokens' is not supported with this model. Use 'max_completion_tokens' instead.",
            Some(Parameter::MaxTokens),
        ),
        (
            r#"{"error":{"param":"reasoning_effort","message":"none is not one of low, medium, high"}}"#,
            Some(Parameter::Reasoning),
        ),
        (
            "Invalid parameter: response_format of type json_schema",
            Some(Parameter::Schema),
        ),
        ("the model `m-reasoning-1` takes no pictures", None),
        ("top_p is deprecated", None),
        ("the temperatures are high", None),
        ("model not found", None),
        ("", None),
    ] {
        assert_eq!(
            refused(refusal.as_bytes(), request.as_bytes(), None),
            expected,
            "{refusal}"
        );
    }
}

#[test]
fn the_fields_of_servers_and_of_gemini_for_reasoning_are_found() {
    for (field, tokens_field) in [
        ("thinking_budget_tokens", Some("thinking_budget_tokens")),
        ("thinking_token_budget", Some("thinking_token_budget")),
        ("thinkingLevel", None),
        ("thinkingBudget", None),
    ] {
        let request = format!(r#"{{"model":"m","{field}":2048}}"#);
        let refusal = format!("Unknown name `{field}`: cannot find field");
        let found = refused(refusal.as_bytes(), request.as_bytes(), tokens_field);
        assert_eq!(found, Some(Parameter::Reasoning), "{field}");
        assert_eq!(refused(refusal.as_bytes(), b"{}", tokens_field), None);
    }
}
