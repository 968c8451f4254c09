//! Which `--omit` leaves out the parameter that a provider refuses.
//!
//! In: the body of a provider's refusal, the request, and the field that the catalogue knows for a number of tokens for
//! reasoning. Out: the parameter, if the refusal names one that was sent.

use super::settings::Parameter;

/// How each parameter is named in requests and in messages of providers.
const NAMES: [(Parameter, &str); 5] = [
    (Parameter::Temperature, "temperature"),
    (Parameter::TopP, "top_p topP"),
    (
        Parameter::MaxTokens,
        "max_tokens max_completion_tokens max_output_tokens maxOutputTokens",
    ),
    (
        Parameter::Reasoning,
        "reasoning reasoning_effort thinking thinkingConfig thinking_config thinkingLevel thinking_level \
         thinkingBudget thinking_budget",
    ),
    (
        Parameter::Schema,
        "response_format json_schema schema output_format responseJsonSchema response_json_schema",
    ),
];

/// The most of a body that is searched, bytes.
const MOST_BYTES: usize = 4096;

/// Returns the parameter that a refusal names and the request states; the one that is named first.
pub(super) fn refused(
    refusal: &[u8],
    request: &[u8],
    tokens_field: Option<&str>,
) -> Option<Parameter> {
    let refusal = String::from_utf8_lossy(&refusal[..refusal.len().min(MOST_BYTES)]);
    let request = String::from_utf8_lossy(request);
    let mut names: Vec<(Parameter, &str)> = Vec::new();
    for (parameter, own) in NAMES {
        names.extend(own.split(' ').map(|name| (parameter, name)));
    }
    names.extend(tokens_field.map(|name| (Parameter::Reasoning, name)));
    let is_sent = |parameter: Parameter| {
        let mut own = names.iter().filter(|(of, _)| *of == parameter);
        // In a text, which is escaped, no name stands before a bare `":`.
        own.any(|(_, name)| request.contains(&format!("\"{name}\":")))
    };
    // Ids of models hold such words too: `qwen3-vl-thinking`.
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    let mut words = refusal.split(|c| !is_part(c));
    words.find_map(|word| {
        let (parameter, _) = names.iter().find(|(_, name)| *name == word)?;
        is_sent(*parameter).then_some(*parameter)
    })
}

#[cfg(test)]
#[path = "tests/omit.rs"]
mod tests;
