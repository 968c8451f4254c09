//! Tests of users' files: what they override, and what is rejected.

use super::super::*;
use super::find;
use proptest::prelude::*;

fn with(text: &str) -> Result<Catalogue, CatalogueError> {
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
        (&entry("shutdown = \"soon\""), "`soon` is not a date"),
        (
            &entry("temperature = { only = [] }"),
            "line 3: `temperature` needs finite numbers",
        ),
        (
            &entry("top_p = { range = [1, 0] }"),
            "line 3: `top_p` needs finite numbers",
        ),
        (
            &entry("reasoning = { least_tokens = 0 }"),
            "line 3: `least_tokens = 0` is not from 1",
        ),
        (
            &entry("reasoning = { tokens_field = \"max_tokens\" }"),
            "line 3: `tokens_field = \"max_tokens\"` is not a name such as `thinking_token_budget`",
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
            &(entry("") + "[[model.more]]\nid = \"y\"\nas_of = \"2027-01-05\"\nsource = \"s\""),
            "line 3: `more` holds facts with their source",
        ),
        (
            &(entry("") + "[[model.more]]\nvision = true\nas_of = \"2027-01-05\"\nsource = \"\""),
            "line 3: `source` is empty",
        ),
        (
            "[[retired]]\nprovider = \"opnai\"\non = \"2027-01-05\"\nids = [\"x\"]\nas_of = \"2027-01-05\"\nsource = \"s\"",
            "line 1: there is no provider `opnai`",
        ),
        (
            "[[gateway]]\nprefixes = [\"open\"]\nas_of = \"2027-01-05\"\nsource = \"s\"",
            "line 1: the prefix `open` ends in neither",
        ),
        (
            &provider(""),
            "line 2: the new provider `p` needs `wire` and `key`",
        ),
        (
            &provider("key_env = [\"sk-canary-0123\"]"),
            "`key_env` lists names of variables",
        ),
        (
            &provider("base_url = \"http://me:canary@x/v1\""),
            "a key has no place in it",
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
fn a_users_file_retires_models_names_gateways_and_keeps_prices_for_the_ids_it_names() {
    let mine = r#"
        [[retired]]
        provider = "vllm"
        on = "2027-01-01"
        ids = ["old-*"]
        instead = "new"
        as_of = "2027-01-05"
        source = "our lab"

        [[gateway]]
        prefixes = ["house/"]
        as_of = "2027-01-05"
        source = "our lab"

        [[model]]
        provider = "litellm"
        id = "house/openai/gpt-6.2-sol"
        price = [{ input = 3, output = 4 }]
        structured_output = true
        as_of = "2027-01-05"
        source = "our contract"
    "#;
    let catalogue = with(mine).expect("right");
    let old = catalogue.find("vllm:old-1").expect("known").facts;
    assert_eq!(old.replaced_by.as_deref(), Some("new"));
    let named = catalogue
        .find("litellm:house/openai/gpt-6.2-sol")
        .expect("known")
        .facts;
    assert!(named.price.is_some() && named.structured_output == Some(true));
    assert!(
        named.temperature.is_some(),
        "the vendor's own row is seen through the prefix"
    );
    let other = catalogue
        .find("compatible:house/openai/gpt-6.2-sol")
        .expect("known")
        .facts;
    assert!(other.price.is_none() && other.temperature.is_some());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_damage_to_a_file_makes_its_reader_panic(cut in 0.0f64..1.0, length in 0usize..200, put in "[\\PC\n]{0,20}") {
        let text = BUILTIN.as_bytes();
        let start = (cut * text.len() as f64) as usize;
        let end = (start + length).min(text.len());
        let damaged = [&text[..start], put.as_bytes(), &text[end..]].concat();
        if let Err(error) = with(&String::from_utf8_lossy(&damaged)) {
            prop_assert!(error.to_string().contains("`mine.toml`"), "{}", error);
        }
    }
}
