//! Tests of the catalogue: lookup, merging, rejection, notices and prices.

mod files;
mod money;

use super::*;

pub(super) fn find(model: &str) -> Profile {
    Catalogue::builtin().find(model).expect("a known provider")
}

pub(super) fn date(text: &str) -> Date {
    text.parse().expect("a date")
}

#[test]
fn the_embedded_facts_are_read_and_every_entry_has_a_source() {
    let catalogue = Catalogue::builtin();
    assert_eq!(catalogue.providers().len(), 10);
    for provider in catalogue.providers() {
        assert!(!provider.sources.is_empty(), "{}", provider.name);
    }
    let gathered = ["2026-11-20", "2026-11-24", "2026-11-25"].map(date);
    for profile in catalogue.profiles() {
        assert!(
            profile
                .sources
                .iter()
                .all(|source| gathered.contains(&source.as_of)),
            "{}",
            profile.id
        );
        let again = catalogue.find(&profile.title()).expect("its own provider");
        assert_eq!(again, profile, "a listed model is found by its own title");
        assert!(!matches!(
            profile.listed,
            FactsSource::ByFamily | FactsSource::Not { .. }
        ));
    }
}

#[test]
fn what_is_listed_is_found_with_all_that_is_known_and_nothing_else() {
    let sol = find("openai:gpt-6.2-sol");
    assert_eq!(sol.listed, FactsSource::ById);
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
    assert!(sol.facts.coordinates.is_some());
    assert_eq!(sol.lowering(), Lowering::PIXELS);
    assert_eq!(sol.facts.shutdown, None);
    let terra = find("openai:gpt-6.1-terra");
    assert_eq!(terra.facts.temperature, None, "no source says so");
    assert_eq!(
        find("openai:gpt-5.5-pro").facts.structured_output,
        Some(false),
        "unlike its family"
    );
    let chat = find("openai-chat:gpt-6.2-sol");
    assert_eq!(
        (chat.facts, chat.provider.wire),
        (sol.facts.clone(), Wire::OpenaiChat)
    );
    let through = find("litellm:openrouter/openai/gpt-6.2-sol");
    let expected = Facts {
        price: None,
        structured_output: None,
        max_tokens_field: None,
        ..sol.facts
    };
    assert_eq!(through.facts, expected, "another server bills and reads");
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
            "compatible:openrouter/qwen/qwen3-vl-8b-instruct",
            "x y, 0-1000",
        ),
        (
            "litellm:hosted_vllm/Qwen/Qwen3-VL-30B-A3B-Thinking-FP8",
            "x y, 0-1000",
        ),
        ("ollama:qwen3-vl:8b-instruct-q4_K_M", "x y, 0-1000"),
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
        (
            "litellm:bedrock/us.anthropic.claude-sonnet-5-5",
            "x y, pixels",
        ),
        ("litellm:vertex_ai/gemini-3.5-flash", "y x, 0-1000"),
        ("compatible:openai/gpt-4o-2024-11-20", "x y, pixels"),
    ] {
        let profile = find(model);
        assert!(profile.facts.coordinates.is_some(), "{model}");
        assert_eq!(profile.lowering().to_string(), expected, "{model}");
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
    ] {
        let facts = find(model).facts;
        let tokens = facts
            .image_tokens
            .map(|formula| formula.of(224, 224).at_least);
        assert_eq!((facts.vision, tokens), (vision, side_224), "{model}");
    }
    assert_eq!(find("vllm:allenai/Molmo2-8B").facts.coordinates, None);
    let flash = find("google:gemini-3.5-flash");
    assert_eq!(flash.listed, FactsSource::ByFamily);
    assert!(flash.facts.image_tokens.is_some() && flash.facts.price.is_none());
    assert!(
        find("google:gemini-4-argon").facts.image_tokens.is_none(),
        "told of 3.x alone"
    );
}

#[test]
fn dated_and_older_ids_are_found_by_alias_and_no_further() {
    for model in [
        "openai:gpt-4",
        "openai:gpt-4-0613",
        "openai:gpt-4-1106-preview",
        "openai:gpt-3.5-turbo-0125",
    ] {
        assert_eq!(
            find(model).facts.shutdown,
            Some(date("2026-10-23")),
            "{model}"
        );
    }
    for (model, on, instead) in [
        ("openai:gpt-4-vision-preview", "2024-12-06", None),
        ("openai:gpt-4-0613", "2026-10-23", Some("gpt-5.6-sol")),
        ("openai:gpt-3.5-turbo", "2026-10-23", Some("gpt-5.6-terra")),
        ("openai:gpt-5", "2026-12-11", Some("gpt-6.1-sol")),
        ("openai:o3", "2026-12-11", Some("gpt-5.6-sol")),
        ("openai:gpt-4o", "2027-01-14", Some("gpt-6-luna")),
        ("openai:gpt-4.1-mini", "2027-01-14", Some("gpt-6-luna")),
        ("openrouter:openai/gpt-4o", "2027-01-14", Some("gpt-6-luna")),
        ("anthropic:claude-sonnet-4-5", "2026-11-30", None),
        (
            "anthropic:claude-opus-4-20250514",
            "2026-06-15",
            Some("claude-opus-4-8"),
        ),
        (
            "openrouter:anthropic/claude-sonnet-4-20250514",
            "2026-06-15",
            Some("claude-sonnet-4-6"),
        ),
        (
            "anthropic:claude-3-haiku-20240307",
            "2026-04-20",
            Some("claude-haiku-4-5-20251001"),
        ),
        ("anthropic:claude-opus-4-1-20250805", "2026-08-05", None),
        ("anthropic:claude-2.1", "2025-07-21", None),
    ] {
        let model = model.replace("openrouter:", "compatible:openrouter/");
        let facts = find(&model).facts;
        assert_eq!(facts.shutdown, Some(date(on)), "{model}");
        assert_eq!(facts.replaced_by.as_deref(), instead, "{model}");
    }
    let dated = find("openai:gpt-4o-2024-08-06");
    assert!(dated.facts.image_tokens.is_some() && dated.facts.shutdown.is_some());
    assert_eq!(
        find("openai:gpt-4o-2025-01-01").facts.shutdown,
        None,
        "no source names it"
    );
}

#[test]
fn of_an_unlisted_model_nothing_is_known_but_what_it_may_have_been() {
    let unlisted = find("anthropic:sonnet");
    assert_eq!(unlisted.facts, Facts::default());
    assert_eq!(unlisted.listed, FactsSource::Not { near: None });
    let misspelt = find("google:gemni-4-argon");
    assert_eq!(
        misspelt.listed,
        FactsSource::Not {
            near: Some("gemini-4-argon".to_owned())
        }
    );
    assert_eq!(
        find("openai:o4").listed,
        FactsSource::Not { near: None },
        "a retired model is not recommended"
    );
    let error = Catalogue::builtin()
        .find("opnai:gpt-6.2-sol")
        .expect_err("no such provider");
    assert!(
        error.to_string().starts_with(
            "there is no provider `opnai` (did you mean `openai`?); there is `openai`"
        ),
        "{error}"
    );
    for wrong in [
        "gpt-6.2-sol",
        "openai:",
        "openai:a\nb",
        &format!("openai:{}", "a".repeat(201)),
        "",
    ] {
        assert!(Catalogue::builtin().find(wrong).is_err(), "{wrong:?}");
    }
}
