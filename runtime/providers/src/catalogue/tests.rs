//! Tests of the catalogue: the embedded facts, which entries an id gets, warnings and days.

mod files;
mod money;
mod tokens;

use super::*;
use fab_model::Lowering;

pub(super) fn find(model: &str) -> Profile {
    Catalogue::builtin().find(model).expect("a known provider")
}

pub(super) fn date(text: &str) -> Date {
    Date::try_from(text.to_owned()).expect("a date")
}

#[test]
fn the_embedded_facts_are_read_and_every_entry_has_a_source() {
    let catalogue = Catalogue::builtin();
    assert_eq!(catalogue.providers().len(), 10);
    for provider in catalogue.providers() {
        assert!(
            provider.as_of.is_some() && provider.source.is_some(),
            "{}",
            provider.name
        );
    }
    for Entry { head, .. } in &catalogue.entries {
        assert!(
            head.origin.as_of.is_some() && head.origin.source.is_some(),
            "{head:?}"
        );
    }
}

#[test]
fn an_id_gets_its_own_facts_before_those_of_its_families() {
    let sol = find("openai:gpt-6.2-sol");
    assert_eq!(
        (sol.facts.vision, sol.facts.structured_output),
        (Some(true), Some(true))
    );
    let temperature = sol.facts.temperature.as_ref().expect("known");
    assert!(
        temperature.takes(1.0) && !temperature.takes(0.2),
        "{temperature}"
    );
    assert_eq!(
        sol.facts.max_tokens_field,
        Some(MaxTokensField::MaxCompletionTokens)
    );
    assert_eq!(sol.facts.lowering(), Lowering::PIXELS);
    let terra = find("openai:gpt-6.1-terra");
    assert_eq!(terra.facts.temperature, None, "no source says so");
    assert_eq!(
        find("openai:gpt-5.5-pro").facts.structured_output,
        Some(false),
        "the longer beginning counts before `gpt-5`"
    );
    assert!(
        find("openai:gpt-6.2-sol-mini").facts.price.is_none(),
        "a price is that of one id"
    );
    assert!(
        find("anthropic:claude-opus-5-5-20260901")
            .facts
            .price
            .is_some()
    );
    let chat = find("openai-chat:gpt-6.2-sol");
    assert_eq!(
        (&chat.facts, chat.provider.wire),
        (&sol.facts, Wire::OpenaiChat)
    );
    let through = find("litellm:openrouter/openai/gpt-6.2-sol");
    let expected = Facts {
        price: None,
        structured_output: None,
        max_tokens_field: None,
        ..sol.facts
    };
    assert_eq!(through.facts, expected, "another server bills and reads");
    for spelled in ["openai:GPT-6.2-Sol", "openai:gpt_6.2:sol"] {
        assert_eq!(find(spelled).facts, chat.facts, "{spelled}");
    }
    let spelled = find("litellm:openrouter/OpenAI/GPT-6.2-Sol");
    assert_eq!(spelled.facts, through.facts);
    assert_eq!(find("litellm:gpt-oss-20b").facts, Facts::default());
    assert_eq!(find("openai:claude-opus-5-5").facts, Facts::default());
}

#[test]
fn families_say_how_weights_answer_wherever_they_are_served() {
    for (model, expected) in [
        ("vllm:Qwen/Qwen3-VL-8B-Instruct", "x y, 0-1000"),
        ("ollama:qwen2.5vl:7b", "x y, pixels in multiples of 28"),
        ("compatible:Qwen2-VL-7B", "x y, 0-1000"),
        ("llamacpp:Molmo-7B-D", "x y, 0-100"),
        ("lmstudio:moondream:1.8b", "x y, 0-1"),
        ("google:gemini-robotics-er-2-preview", "y x, 0-1000"),
        ("google:gemini-3.5-flash", "y x, 0-1000"),
        ("anthropic:claude-sonnet-5-5", "x y, pixels"),
        (
            "litellm:hosted_vllm/Qwen/Qwen3-VL-30B-A3B-Thinking-FP8",
            "x y, 0-1000",
        ),
        (
            "ollama:hf.co/unsloth/Qwen3-VL-8B-Instruct-GGUF:Q4_K_M",
            "x y, 0-1000",
        ),
        ("llamacpp:Qwen3VL-8B-Instruct-Q8_0.gguf", "x y, 0-1000"),
        ("vllm:Qwen/Qwen3.5-9B", "x y, 0-1000"),
        (
            "compatible:accounts/fireworks/models/qwen2p5-vl-7b-instruct",
            "x y, pixels in multiples of 28",
        ),
        ("litellm:vertex_ai/gemini-3.5-flash", "y x, 0-1000"),
        ("compatible:openai/gpt-4o-2024-11-20", "x y, pixels"),
    ] {
        let profile = find(model);
        assert!(profile.facts.coordinates.is_some(), "{model}");
        assert_eq!(profile.facts.lowering().to_string(), expected, "{model}");
    }
    for (model, vision, side_224) in [
        ("vllm:OpenGVLab/InternVL3_5-8B", Some(true), Some(258)),
        ("ollama:gemma3:27b", Some(true), Some(256)),
        ("ollama:gemma3:1b", None, None),
        ("llamacpp:llava-v1.5-7b-Q4_K.gguf", Some(true), Some(576)),
        ("ollama:llava:13b", Some(true), None),
        ("vllm:allenai/Molmo2-8B", Some(true), None),
        ("ollama:moondream:1.8b", Some(true), None),
        ("vllm:ByteDance-Seed/UI-TARS-1.5-7B", Some(true), None),
        ("lmstudio:qwen/qwen3-vl-4b", Some(true), Some(49)),
        ("lmstudio:qwen3-4b", None, None),
        ("openai:gpt-4o-2024-08-06", Some(true), Some(255)),
        ("openai:gpt-4o-mini", Some(true), None),
        ("google:gemini-3.5-flash", Some(true), Some(1065)),
        ("google:gemini-4-argon", Some(true), None),
    ] {
        let facts = find(model).facts;
        let tokens = facts
            .image_tokens
            .map(|formula| formula.of(224, 224).at_least);
        assert_eq!((facts.vision, tokens), (vision, side_224), "{model}");
    }
    assert_eq!(find("vllm:allenai/Molmo2-8B").facts.coordinates, None);
}

#[test]
fn every_entry_is_listed_once_with_all_that_holds_of_it() {
    let catalogue = Catalogue::builtin();
    let all = catalogue.listed(None);
    let mut names: Vec<_> = all.iter().map(|listed| &listed.model).collect();
    names.dedup();
    assert_eq!(names.len(), all.len(), "{names:?}");
    let find = |model: &str| {
        let found = all.iter().find(|listed| listed.model == model);
        found.unwrap_or_else(|| panic!("no {model} in {names:?}"))
    };
    let sol = find("openai:gpt-6.2-sol");
    assert_eq!(
        sol.facts,
        catalogue.find("openai:gpt-6.2-sol").expect("known").facts
    );
    assert_eq!(sol.sources.len(), 2, "its own and its family's day are one");
    assert_eq!(find("qwen3-vl*").sources.len(), 2);
    let chat = catalogue.provider("openai-chat").expect("known");
    let chat = catalogue.listed(Some(chat));
    assert!(
        chat.iter()
            .any(|listed| listed.model == "openai-chat:gpt-6.2-sol")
    );
    assert!(!chat.iter().any(|listed| listed.model.contains("claude")));
}

#[test]
fn a_similar_id_is_named_and_a_wrong_provider_is_refused() {
    let near = |model: &str| find(model).near;
    assert_eq!(
        near("google:gemni-4-argon").as_deref(),
        Some("gemini-4-argon")
    );
    assert_eq!(near("anthropic:sonnet"), None);
    assert_eq!(near("google:gemini-4-argon"), None);
    assert_eq!(find("anthropic:sonnet").facts, Facts::default());
    let error = Catalogue::builtin()
        .find("opnai:gpt-6.2-sol")
        .expect_err("no such provider");
    assert!(
        error.starts_with(
            "there is no provider `opnai` (did you mean `openai`?); there is `anthropic`"
        ),
        "{error}"
    );
    for wrong in ["gpt-6.2-sol", "openai:", "openai:a\nb", ""] {
        assert!(Catalogue::builtin().find(wrong).is_err(), "{wrong:?}");
    }
}

#[test]
fn a_warning_tells_of_an_unknown_frame() {
    for model in ["openai:gpt-6.2-sol", "openai:gpt-4o", "openai:gpt-4.1"] {
        assert_eq!(find(model).warning(), None, "{model}");
    }
    assert_eq!(
        find("ollama:fabric").warning().as_deref(),
        Some("it is not known how it states positions in a picture: `fabc probe` finds out")
    );
}

#[test]
fn dates_are_days_of_the_calendar_and_written_as_they_are_read() {
    for text in ["2026-11-20", "2024-02-29", "1970-01-01", "9999-12-31"] {
        assert_eq!(date(text).to_string(), text);
    }
    for text in [
        "",
        "2026-11",
        "2026-13-01",
        "2026-02-29",
        "26-11-20",
        "2026-1-2",
        "2026-11-20-1",
        "1969-12-31",
        "２０２６-11-20",
    ] {
        assert!(Date::try_from(text.to_owned()).is_err(), "{text}");
    }
    for (days, expected) in [
        (0, "1970-01-01"),
        (11_016, "2000-02-29"),
        (20_777, "2026-11-20"),
        (u64::MAX, "9999-12-31"),
    ] {
        assert_eq!(Date::from_unix_days(days), date(expected), "{days}");
    }
    assert!(date("2026-11-30") < date("2026-12-01"));
}
