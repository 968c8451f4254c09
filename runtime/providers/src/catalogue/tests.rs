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
    let gathered = date("2026-11-20");
    for profile in catalogue.profiles() {
        assert!(
            profile
                .sources
                .iter()
                .all(|source| source.as_of == gathered),
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
    assert_eq!(
        (terra.facts.vision, terra.facts.temperature),
        (None, None),
        "no source says so"
    );
    let chat = find("openai-chat:gpt-6.2-sol");
    assert_eq!(
        (chat.facts, chat.provider.wire),
        (sol.facts, Wire::OpenaiChat)
    );
    assert_eq!(find("litellm:gpt-6.2-sol").facts, Facts::default());
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
    ] {
        let profile = find(model);
        assert!(profile.facts.coordinates.is_some(), "{model}");
        assert_eq!(profile.lowering().to_string(), expected, "{model}");
    }
    assert_eq!(find("vllm:InternVL3_5-8B").facts, Facts::default());
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
    assert_eq!(
        find("openai:gpt-4-vision-preview").facts.shutdown,
        Some(date("2024-12"))
    );
    assert_eq!(
        find("openai:gpt-4o").facts.shutdown,
        Some(date("2027-01-14"))
    );
    assert_eq!(
        find("openai:gpt-4o-2024-08-06").facts.shutdown,
        None,
        "no source names it"
    );
}

#[test]
fn of_an_unlisted_model_nothing_is_known_but_what_it_may_have_been() {
    let unlisted = find("anthropic:sonnet");
    assert_eq!(unlisted.facts, Facts::default());
    assert_eq!(unlisted.listed, FactsSource::Not { near: None });
    let o = find("openai:o4");
    assert_eq!(
        o.listed,
        FactsSource::Not {
            near: Some("o3".to_owned())
        }
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
