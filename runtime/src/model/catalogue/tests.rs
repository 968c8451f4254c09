//! Facts as they are found, laid over each other, refused, told of and priced.

use super::*;
use crate::calls::{Usage, Usd};
use crate::model::{Message, ModelRole, Part, Png, Request, Speaker};

fn find(model: &str) -> Profile {
    Catalogue::builtin().find(model).expect("a known provider")
}

fn date(text: &str) -> Date {
    text.parse().expect("a date")
}

fn with(text: &str) -> Result<Catalogue, CatalogueError> {
    Catalogue::builtin().overlaid(text, "mine.toml")
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
            Listed::ByFamily | Listed::Not { .. }
        ));
    }
}

#[test]
fn what_is_listed_is_found_with_all_that_is_known_and_nothing_else() {
    let sol = find("openai:gpt-6.2-sol");
    assert_eq!(sol.listed, Listed::ById);
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
    assert_eq!(sol.facts.coordinates, Some(Habit::PIXELS));
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
        let habit = find(model).facts.coordinates.expect(model);
        assert_eq!(habit.to_string(), expected, "{model}");
    }
    assert_eq!(find("vllm:InternVL3_5-8B").facts, Facts::default());
    let flash = find("google:gemini-3.5-flash");
    assert_eq!(flash.listed, Listed::ByFamily);
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
    assert_eq!(unlisted.listed, Listed::Not { near: None });
    let o = find("openai:o4");
    assert_eq!(
        o.listed,
        Listed::Not {
            near: Some("o3".to_owned())
        }
    );
    let error = Catalogue::builtin()
        .find("opnai:gpt-6.2-sol")
        .expect_err("no such provider");
    assert!(
        error
            .to_string()
            .starts_with("there is no provider `opnai`; did you mean `openai`?; there is `openai`"),
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

#[test]
fn a_users_file_replaces_what_it_gives_and_keeps_the_rest() {
    let mine = r#"
        [[model]]
        provider = "openai"
        id = "gpt-6.2-sol"
        price = [{ input = 1.5, output = 7.5 }]
        as_of = "2027-01-05"
        source = "our contract"

        [[model]]
        part = "internvl"
        coordinates = { unit = "per_mille", order = "xy" }
        as_of = "2027-01-05"
        source = "fabc probe"

        [[provider]]
        name = "ollama"
        base_url = "http://gpu.example:11434/v1"
        as_of = "2027-01-05"
        source = "our machine"

        [[provider]]
        name = "house"
        wire = "openai_chat"
        key = "optional"
        runs_on = "own"
        as_of = "2027-01-05"
        source = "our machine"
    "#;
    let catalogue = with(mine).expect("right");
    let before = find("openai:gpt-6.2-sol");
    let after = catalogue.find("openai:gpt-6.2-sol").expect("known");
    let expected = Facts {
        price: Some(vec![Price {
            from: None,
            input: 1.5,
            cached_input: None,
            output: 7.5,
        }]),
        ..before.facts
    };
    assert_eq!(after.facts, expected);
    assert_eq!(after.sources[0].source, "our contract");
    assert_eq!(after.sources[1..], before.sources);
    assert!(
        catalogue
            .find("vllm:OpenGVLab/InternVL-8B")
            .expect("known")
            .facts
            .coordinates
            .is_some()
    );
    let ollama = catalogue.provider("ollama").expect("known");
    assert_eq!(
        ollama.base_url.as_deref(),
        Some("http://gpu.example:11434/v1")
    );
    assert_eq!(
        (ollama.runs_on, ollama.key_env.len()),
        (Some(RunsOn::Own), 1)
    );
    assert!(catalogue.find("house:anything").expect("new").is_free());
}

#[test]
fn what_is_wrong_in_a_file_is_told_with_its_line() {
    let entry = |fields: &str| {
        format!(
            "# mine\n\n[[model]]\nprovider = \"openai\"\nid = \"x\"\n{fields}\nas_of = \"2027-01-05\"\nsource = \"s\"\n"
        )
    };
    let provider = |fields: &str| {
        format!("\n[[provider]]\nname = \"p\"\nas_of = \"2027-01-05\"\nsource = \"s\"\n{fields}\n")
    };
    for (text, expected) in [
        ("[[model]]\nid = 3", "line 2"),
        (
            "[[model]]\nprovider = \"openai\"\nid = \"x\"\nsource = \"s\"",
            "as_of",
        ),
        (
            "[[model]]\nprovider = \"openai\"\nid = \"x\"\nas_of = \"2027-01-05\"",
            "source",
        ),
        ("[[modle]]\n", "unknown field `modle`"),
        (&entry("visoin = true"), "line 6"),
        (&entry("shutdown = \"soon\""), "`soon` is no date"),
        (
            &entry("temperature = { only = [] }"),
            "line 3: `temperature` needs finite numbers",
        ),
        (
            &entry("top_p = { range = [1, 0] }"),
            "line 3: `top_p` needs finite numbers",
        ),
        (
            &entry("top_p = { only = [nan] }"),
            "line 3: `top_p` needs finite numbers",
        ),
        (
            &entry("price = [{ input = -1, output = 1 }]"),
            "line 3: the price -1 is not from 0",
        ),
        (
            &entry("price = [{ input = inf, output = 1 }]"),
            "line 3: the price inf is not from 0",
        ),
        (
            &entry("price = [{ input = 1, output = 1 }, { input = 2, output = 1 }]"),
            "line 3: two prices count from no day",
        ),
        (
            &entry("image_tokens = { patches = { side_px = 0 } }"),
            "line 3: `side_px = 0` is not from 1",
        ),
        (
            &entry("image_tokens = { flat = { at_least = 2, at_most = 1 } }"),
            "more tokens at least (2)",
        ),
        (
            &entry("coordinates = { unit = \"pixels\", order = \"xy\", multiples_of_px = 0 }"),
            "`multiples_of_px = 0`",
        ),
        (
            &entry("coordinates = { unit = \"inches\", order = \"xy\" }"),
            "unknown variant `inches`",
        ),
        (
            &entry("name = \"X\""),
            "line 3: a model needs one of `id`, `name` and `part`",
        ),
        (
            &entry("aliases = [\"\"]"),
            "line 3: `aliases` is not 1 to 200 bytes",
        ),
        (
            &(entry("") + &entry("")),
            "line 11: the id `x` is there twice",
        ),
        (
            &entry("").replace("\"openai\"", "\"opnai\""),
            "line 3: there is no provider `opnai`",
        ),
        (
            &entry("").replace("provider = \"openai\"", ""),
            "a model without `provider` needs `part`",
        ),
        (&entry("").replace("\"s\"", "\" \""), "`source` is empty"),
        (
            &provider(""),
            "line 2: the new provider `p` needs `wire` and `key`",
        ),
        (
            &provider("key_env = [\"sk-canary-0123\"]"),
            "`key_env` lists names of variables",
        ),
        (&provider("base_url = \"ftp://x\""), "begins with neither"),
        (
            &provider("wire = \"openai_chat\"\nkey = \"optional\"\nmodels_of = \"q\""),
            "has the models of `q`",
        ),
        (
            &provider("").replace("\"p\"", "\"A b\""),
            "is not 1 to 40 small letters",
        ),
    ] {
        let error = with(text).expect_err(text).to_string();
        assert!(
            error.contains(expected),
            "expected {expected:?} in: {error}"
        );
        assert!(error.contains("`mine.toml`"), "{error}");
        assert!(!error.contains("canary"), "{error}");
    }
    assert!(with(&"#".repeat((1 << 20) + 1)).is_err());
    assert!(with("").is_ok());
}

#[test]
fn notices_tell_what_a_day_makes_of_a_model() {
    let told = |model: &str, day: &str| find(model).notices(date(day));
    assert_eq!(
        told("openai:gpt-4-0613", "2026-11-20")[0],
        Notice::Retired {
            on: date("2026-10-23")
        }
    );
    assert_eq!(
        told("openai:o3", "2026-12-11")[0],
        Notice::Retired {
            on: date("2026-12-11")
        }
    );
    let soon = Notice::RetiresSoon {
        on: date("2026-12-11"),
        days: 21,
    };
    assert_eq!(told("openai:o3", "2026-11-20")[0], soon);
    let on = date("2027-01-14");
    assert_eq!(
        told("openai:gpt-4o", "2026-10-16")[0],
        Notice::RetiresSoon { on, days: 90 }
    );
    assert!(
        !told("openai:gpt-4o", "2026-10-15")
            .iter()
            .any(|it| matches!(it, Notice::RetiresSoon { .. }))
    );
    assert_eq!(told("openai:gpt-6.2-sol", "2026-11-20"), [Notice::Undated]);
    let argon = told("google:gemini-4-argon", "2026-11-30");
    let by_name = Notice::ByName {
        name: "Gemini 4 Argon".to_owned(),
    };
    assert_eq!(
        argon,
        [
            by_name,
            Notice::PriceChanges {
                on: date("2026-12-01")
            },
            Notice::Undated
        ]
    );
    assert!(
        !told("google:gemini-4-argon", "2026-12-01")
            .iter()
            .any(|it| matches!(it, Notice::PriceChanges { .. }))
    );
    let unlisted = Notice::Unlisted { near: None };
    assert_eq!(
        told("ollama:llava", "2026-11-20"),
        [unlisted.clone(), Notice::CoordinatesUnknown]
    );
    assert_eq!(
        told("anthropic:x-20260101", "2026-11-20"),
        [unlisted, Notice::PriceUnknown, Notice::CoordinatesUnknown]
    );
    for notice in argon {
        assert!(
            !notice.to_string().ends_with('.') && !notice.is_warning(),
            "{notice}"
        );
    }
}

#[test]
fn costs_are_exact_to_the_last_billionth() {
    let priced = find("openai:gpt-6.2-sol").priced_on(date("2026-11-20"));
    let usage = Usage {
        input_tokens: 1_000_003,
        cached_input_tokens: 1_000_000,
        output_tokens: 7,
    };
    // 1,000,000 at 0.10 + 3 at 2 + 7 at 10 USD per million.
    assert_eq!(
        priced.cost(usage),
        Some(Usd::from_nano(100_000_000 + 6_000 + 70_000))
    );
    let third = Price {
        from: None,
        input: 0.07,
        cached_input: None,
        output: 0.0,
    };
    let one = |input_tokens, cached_input_tokens| Usage {
        input_tokens,
        cached_input_tokens,
        output_tokens: 0,
    };
    assert_eq!(
        third.cost(one(1_000_000, 0)),
        Usd::from_nano(70_000_000),
        "0.07 has no exact binary form"
    );
    assert_eq!(
        third.cost(one(1, 1)),
        Usd::from_nano(70),
        "cached tokens without a price count as others"
    );
    assert_eq!(
        third.cost(one(5, 50)),
        Usd::from_nano(350),
        "no more can be cached than were sent"
    );
    let huge = Usage {
        input_tokens: u64::MAX,
        cached_input_tokens: 0,
        output_tokens: u64::MAX,
    };
    assert_eq!(
        Price {
            input: Price::MOST,
            ..third
        }
        .cost(huge),
        Usd::from_nano(u64::MAX)
    );
    assert_eq!(
        find("openai:o3").priced_on(date("2026-11-20")).cost(usage),
        None
    );
    assert_eq!(
        find("vllm:anything")
            .priced_on(date("2026-11-20"))
            .cost(usage),
        Some(Usd::ZERO)
    );
}

#[test]
fn a_later_price_counts_from_its_day() {
    let argon = find("google:gemini-4-argon");
    let input = |day: &str| argon.price_on(date(day)).map(|price| price.input);
    assert_eq!(input("2026-11-30"), Some(2.0));
    assert_eq!(input("2026-12-01"), Some(4.0));
}

#[test]
fn the_most_that_a_request_may_cost_covers_input_answer_and_pictures() {
    let mut message = Message::text(Speaker::User, "a".repeat(400));
    let picture = crate::picture::encode(&image::RgbImage::new(224, 224));
    message.parts.push(Part::Image(Png::new(picture)));
    let mut request = Request::new(ModelRole::Vision, vec![message]);
    let today = date("2026-11-20");
    let sol = find("openai:gpt-6.2-sol").priced_on(today);
    assert_eq!(sol.at_most(&request), None, "no longest answer is stated");
    request.max_tokens = Some(1000);
    // 3 * (100 + 59) tokens at 2 USD, 1000 at 10 USD per million.
    assert_eq!(
        sol.at_most(&request),
        Some(Usd::from_nano(3 * 159 * 2_000 + 1000 * 10_000))
    );
    request.schema = Some(serde_json::json!({ "a": 1 }));
    // `{"a":1}` has seven letters, two tokens.
    assert_eq!(
        sol.at_most(&request),
        Some(Usd::from_nano(3 * 161 * 2_000 + 1000 * 10_000))
    );
    for (model, why) in [
        ("openai:o3", "no price"),
        ("google:gemini-4-argon", "no formula for pictures"),
    ] {
        assert_eq!(
            find(model).priced_on(today).at_most(&request),
            None,
            "{why}"
        );
    }
    request.max_tokens = None;
    assert_eq!(
        find("ollama:x").priced_on(today).at_most(&request),
        Some(Usd::ZERO)
    );
}
