//! Tests of users' files: what they override, and what is rejected.

use super::super::*;
use super::find;
use fab_model::Lowering;
use fab_program::pointing::{CoordinateUnit, Order};
use proptest::prelude::*;

fn with(text: &str) -> Result<Catalogue, String> {
    Catalogue::builtin().overlaid(text, "mine.toml")
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
        family = ["internvl"]
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
        base_url = "http://gpu.example:8000/v1"
        runs_on = "own"
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
    let listed = catalogue.listed(None);
    let sol = listed.iter().find(|it| it.model == "openai:gpt-6.2-sol");
    let sources = &sol.expect("listed").sources;
    assert_eq!(sources[0].source.as_deref(), Some("our contract"));
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
    assert_eq!(ollama.source.as_deref(), Some("our machine"));
    let house = catalogue.find("house:anything").expect("new");
    assert!(house.is_free());
    assert_eq!(house.provider.wire, Wire::OpenaiChat);
}

#[test]
fn a_users_family_counts_before_an_embedded_id_and_a_longer_embedded_family() {
    let mine = r#"
        [[model]]
        provider = "openai"
        family = ["gpt"]
        coordinates = { unit = "percent", order = "yx" }
        price = [{ input = 7, output = 9 }]

        [[model]]
        family = ["qwen3"]
        coordinates = { unit = "pixels", order = "xy" }
    "#;
    let catalogue = with(mine).expect("right");
    let after = |model: &str| catalogue.find(model).expect("known").facts;
    let before = find("openai:gpt-6.2-sol").facts;
    let expected = Facts {
        coordinates: Some(PositionFormat {
            unit: CoordinateUnit::Percent,
            order: Order::Yx,
            multiples_of_px: None,
        }),
        price: Some(vec![Price {
            from: None,
            input: 7.0,
            cached_input: None,
            output: 9.0,
        }]),
        ..before
    };
    assert_eq!(after("openai:gpt-6.2-sol"), expected);
    let qwen = catalogue.find("vllm:Qwen/Qwen3-VL-8B-Instruct");
    let qwen = qwen.expect("known");
    assert_eq!(qwen.facts.lowering(), Lowering::PIXELS);
    assert!(
        qwen.facts.image_tokens.is_some(),
        "what it does not give stays"
    );
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
        ("[[model]]\nid = 3", "line 1: invalid type: integer `3`"),
        ("[[modle]]\n", "line 1: unknown field `modle`"),
        ("\n[[model]\n", "line 2: "),
        (
            &entry("visoin = true"),
            "line 3: unknown field `visoin`, expected one of `vision`",
        ),
        (
            &entry("price = [{ input = 1, output = 1, from = \"soon\" }]"),
            "line 3: `soon` is not a date",
        ),
        (
            &entry("price = [{ input = -1, output = 1 }]"),
            "line 3: the price -1 is not from 0",
        ),
        (
            &entry("price = [{ input = 1, output = 1 }, { input = inf, output = 1 }]"),
            "line 3: the price inf is not from 0",
        ),
        (
            &entry("price = [{ input = 1, cached_input = nan, output = 1 }]"),
            "line 3: the price NaN is not from 0",
        ),
        (
            &entry("image_tokens = { patches = { side = 3 } }"),
            "line 3: unknown field `side`",
        ),
        (
            &entry("coordinates = { unit = \"pixels\", order = \"xy\", multiples_of_px = 0 }"),
            "expected a nonzero u32",
        ),
        (
            &entry("coordinates = { unit = \"inches\", order = \"xy\" }"),
            "unknown variant `inches`",
        ),
        (
            &entry("").replace("id = \"x\"", ""),
            "line 3: a model needs `id`, or `family`",
        ),
        (
            &entry("").replace("\"openai\"", "\"opnai\""),
            "line 3: there is no provider `opnai`",
        ),
        (
            &entry("").replace("provider = \"openai\"", ""),
            "line 3: a model with `id` needs `provider`",
        ),
        (
            &provider("base_url = \"https://me:sk-canary-0123@host/v1\""),
            "line 2: `base_url` holds `@`, `?` or `#`",
        ),
        (
            &provider("key_env = [\"sk-canary-0123\"]"),
            "line 2: `key_env` lists names of variables",
        ),
        (
            &provider("wire = \"grpc\""),
            "line 2: unknown variant `grpc`, expected one of `openai_responses`",
        ),
        (
            &provider("").replace("name = \"p\"", ""),
            "line 2: missing field `name`",
        ),
    ] {
        let error = with(text).expect_err(text);
        assert!(
            error.contains(expected),
            "expected {expected:?} in: {error}"
        );
        assert!(error.contains("`mine.toml`"), "{error}");
        assert!(!error.contains("canary"), "{error}");
    }
    assert!(with("").is_ok());
}

#[test]
fn a_row_for_one_id_behind_a_server_has_a_price_of_its_own() {
    let mine = r#"
        [[model]]
        provider = "litellm"
        id = "house/openai/gpt-6.2-sol"
        price = [{ input = 3, output = 4 }]
        structured_output = true
    "#;
    let catalogue = with(mine).expect("right");
    let find = |model: &str| catalogue.find(model).expect("known").facts;
    let named = find("litellm:house/openai/gpt-6.2-sol");
    assert!(named.price.is_some() && named.structured_output == Some(true));
    assert!(
        named.temperature.is_some(),
        "the vendor's own row holds behind any prefix"
    );
    let other = find("compatible:house/openai/gpt-6.2-sol");
    assert!(other.price.is_none() && other.temperature.is_some());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_damage_to_a_file_makes_its_reader_panic(cut in 0.0f64..1.0, length in 0usize..200, put in "[\\PC\n]{0,20}") {
        let text = include_bytes!("../families/openai.toml");
        let start = (cut * text.len() as f64) as usize;
        let end = (start + length).min(text.len());
        let damaged = [&text[..start], put.as_bytes(), &text[end..]].concat();
        if let Err(error) = with(&String::from_utf8_lossy(&damaged)) {
            prop_assert!(error.contains("`mine.toml`"), "{}", error);
        }
    }
}
