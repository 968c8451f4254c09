//! Which `--omit` leaves out the parameter that a provider refuses.
//!
//! In: the body of a provider's refusal, and the request. Out: the parameter, if the refusal names one that was sent.

use super::settings::Parameter;

/// How each parameter is named: in messages of providers, and as a key of requests.
const NAMES: &[(Parameter, &[&str], &[&str])] = &[
    (Parameter::Temperature, &["temperature"], &["temperature"]),
    (Parameter::TopP, &["top_p", "topP"], &["top_p", "topP"]),
    (Parameter::MaxTokens, LENGTHS, LENGTHS),
    (
        Parameter::Reasoning,
        &[
            "reasoning",
            "reasoning_effort",
            "thinking",
            "thinkingConfig",
            "thinkingLevel",
            "thinkingBudget",
            "thinking_config",
            "thinking_level",
            "thinking_budget",
            "thinking_token_budget",
            "thinking_budget_tokens",
        ],
        &[
            "reasoning",
            "reasoning_effort",
            "thinking",
            "thinkingConfig",
            "thinking_token_budget",
            "thinking_budget_tokens",
        ],
    ),
    (
        Parameter::Schema,
        &[
            "response_format",
            "json_schema",
            "schema",
            "output_format",
            "structured_outputs",
            "guided_json",
            "grammar",
            "responseJsonSchema",
            "response_json_schema",
        ],
        &["response_format", "format", "responseJsonSchema"],
    ),
];

const LENGTHS: &[&str] = &[
    "max_tokens",
    "max_completion_tokens",
    "max_output_tokens",
    "maxOutputTokens",
];

/// The most of a body that is searched, bytes.
const MOST_BYTES: usize = 4096;

/// Returns the parameter that a refusal names and the request states; the one that is named first.
pub(super) fn refused(refusal: &[u8], request: &[u8]) -> Option<Parameter> {
    let refusal = &refusal[..refusal.len().min(MOST_BYTES)];
    let refusal = String::from_utf8_lossy(refusal);
    let request = String::from_utf8_lossy(request);
    // In a text, which is escaped, no name stands before a bare `":`.
    let is_sent = |name: &&str| request.contains(&format!("\"{name}\":"));
    // Ids of models hold such words too: `qwen3-vl-thinking`.
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    let mut words = refusal.split(|c| !is_part(c));
    words.find_map(|word| {
        let named = NAMES.iter().find(|(_, names, _)| names.contains(&word));
        let (parameter, _, keys) = named?;
        keys.iter().any(is_sent).then_some(*parameter)
    })
}

#[cfg(test)]
mod tests {
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
                refused(refusal.as_bytes(), request.as_bytes()),
                expected,
                "{refusal}"
            );
        }
    }
}
