//! Tests of requests, byte for byte as JSON; `make test-all` passes them to the providers' own clients.

use super::*;
use crate::catalogue::{Catalogue, Date, MaxTokensField};
use fab_program::ReasoningLevel;
use serde_json::json;

fn encoded(request: &Request, settings: &Settings) -> Result<Encoded, String> {
    let wire = settings.profile.provider.wire;
    wire.encode(request, settings, Lengths::of(request, settings))
}

fn sent(request: &Request, settings: &Settings) -> Value {
    let encoded = encoded(request, settings).expect("it fits");
    serde_json::from_slice(&encoded.body).expect("JSON")
}

fn refused(request: &Request, settings: &Settings) -> String {
    encoded(request, settings).expect_err("unfit")
}

#[test]
fn conversations_are_told_with_pictures_and_frames_where_each_provider_wants_them() {
    let expected = |wire| match wire {
        Wire::OpenaiChat => json!({
            "model": "a-model",
            "messages": [
                { "role": "system", "content": "You fold." },
                { "role": "user", "content": [
                    { "type": "text", "text": "fold" },
                    { "type": "image_url", "image_url": { "url": "data:image/png;base64,AQID" } },
                    { "type": "text", "text": "it" },
                ] },
                { "role": "assistant", "content": "how?" },
                { "role": "user", "content": "so" },
            ],
        }),
        Wire::OpenaiResponses => json!({
            "model": "a-model",
            "input": [
                { "role": "system", "content": "You fold." },
                { "role": "user", "content": [
                    { "type": "input_text", "text": "fold" },
                    { "type": "input_image", "image_url": "data:image/png;base64,AQID", "detail": "auto" },
                    { "type": "input_text", "text": "it" },
                ] },
                { "role": "assistant", "content": "how?" },
                { "role": "user", "content": [{ "type": "input_text", "text": "so" }] },
            ],
            "store": false,
        }),
        Wire::Anthropic => json!({
            "model": "a-model",
            "max_tokens": 4096,
            "system": "You fold.",
            "messages": [
                { "role": "user", "content": [
                    { "type": "text", "text": "fold" },
                    { "type": "image", "source": { "type": "base64", "media_type": "image/png", "data": "AQID" } },
                    { "type": "text", "text": "it" },
                ] },
                { "role": "assistant", "content": "how?" },
                { "role": "user", "content": [{ "type": "text", "text": "so" }] },
            ],
        }),
        Wire::Gemini => json!({
            "contents": [
                { "role": "user", "parts": [
                    { "text": "fold" },
                    { "inlineData": { "mimeType": "image/png", "data": "AQID" } },
                    { "text": "it" },
                ] },
                { "role": "model", "parts": [{ "text": "how?" }] },
                { "role": "user", "parts": [{ "text": "so" }] },
            ],
            "systemInstruction": { "parts": [{ "text": "You fold." }] },
            "generationConfig": {},
        }),
    };
    for wire in Wire::ALL {
        assert_eq!(
            sent(&request(), &settings(wire)),
            expected(wire),
            "{wire:?}"
        );
    }
}

#[test]
fn settings_and_schema_go_where_each_provider_wants_them() {
    let of = |bound: &[&str]| {
        let reason = json!({ "type": "string", "maxLength": 600 });
        let pick = json!({ "type": "string", "pattern": "^a$" });
        let mut properties = json!({ "reason": reason, "pick": pick });
        for (keyword, property) in [("maxLength", "reason"), ("pattern", "pick")] {
            let fields = properties[property].as_object_mut().expect("a table");
            fields.retain(|name, _| name != keyword || bound.contains(&keyword));
        }
        json!({ "type": "object", "properties": properties, "required": ["reason", "pick"] })
    };
    let schema = of(&["maxLength", "pattern"]);
    let mut ordered = of(&[]);
    ordered["propertyOrdering"] = json!(["reason", "pick"]);
    let request = Request {
        temperature: Some(0.2),
        top_p: Some(1.0),
        max_tokens: Some(769),
        schema: Some(schema.clone()),
        ..request()
    };
    let format =
        json!({ "type": "json_schema", "name": "action", "schema": schema, "strict": true });
    let expected = |wire| match wire {
        Wire::OpenaiChat => json!([
            ["/temperature", 0.2], ["/top_p", 1.0], ["/max_tokens", 769], ["/response_format/type", "json_schema"],
            ["/response_format/json_schema", { "name": "action", "schema": schema, "strict": true }],
        ]),
        Wire::OpenaiResponses => json!([
            ["/temperature", 0.2],
            ["/top_p", 1.0],
            ["/max_output_tokens", 769],
            ["/text/format", format],
        ]),
        Wire::Anthropic => json!([
            ["/temperature", 0.2], ["/top_p", 1.0], ["/max_tokens", 769],
            ["/output_config/format", { "type": "json_schema", "schema": of(&["pattern"]) }],
        ]),
        Wire::Gemini => json!([
            ["/generationConfig", {
                "temperature": 0.2, "topP": 1.0, "maxOutputTokens": 769,
                "responseMimeType": "application/json", "responseJsonSchema": ordered,
            }],
        ]),
    };
    for wire in Wire::ALL {
        let knowing = |structured_output| {
            let facts = Facts {
                structured_output,
                ..Facts::default()
            };
            knowing(wire, facts)
        };
        for structured in [Some(true), None] {
            let body = sent(&request, &knowing(structured));
            for place in expected(wire).as_array().expect("a list") {
                let pointer = place[0].as_str().expect("a pointer");
                // As text, in which the order of properties counts.
                let found = body.pointer(pointer).map(Value::to_string);
                assert_eq!(found, Some(place[1].to_string()), "{wire:?} {pointer}");
            }
        }
        let plain = sent(&request, &knowing(Some(false))).to_string();
        assert!(!plain.to_lowercase().contains("schema"), "{plain}");
    }
}

#[test]
fn newer_models_get_the_longest_answer_under_its_newer_name() {
    let request = Request {
        max_tokens: Some(7),
        ..request()
    };
    let facts = Facts {
        max_tokens_field: Some(MaxTokensField::MaxCompletionTokens),
        ..Facts::default()
    };
    let newer = knowing(Wire::OpenaiChat, facts);
    let body = sent(&request, &newer);
    assert_eq!(
        (&body["max_completion_tokens"], &body["max_tokens"]),
        (&json!(7), &Value::Null)
    );
}

#[test]
fn sampling_goes_to_the_version_of_anthropics_interface_that_knows_it() {
    let version = |request: &Request| {
        let settings = settings(Wire::Anthropic);
        encoded(request, &settings).expect("it fits").headers
    };
    let warm = Request {
        temperature: Some(1.0),
        ..request()
    };
    assert_eq!(version(&request()), [("anthropic-version", "2026-10-21")]);
    assert_eq!(version(&warm), [("anthropic-version", "2023-06-01")]);
}

#[test]
fn a_parameter_that_the_model_does_not_accept_is_refused_by_name_and_value() {
    let request = Request {
        temperature: Some(0.2),
        top_p: Some(0.5),
        ..request()
    };
    for wire in Wire::ALL {
        let accepting = |temperature, top_p| {
            let facts = Facts {
                temperature,
                top_p,
                ..Facts::default()
            };
            knowing(wire, facts)
        };
        let only_one = accepting(Some(Accepted::Only(vec![1.0])), None);
        let said = refused(&request, &only_one);
        assert!(
            said.contains("`temperature` 0.2") && said.contains("1 alone"),
            "{said}"
        );
        let none = accepting(None, Some(Accepted::Refused));
        let said = refused(&request, &none);
        assert!(
            said.contains("`top_p` 0.5") && said.contains("accepts no value of it;"),
            "{said}"
        );
        sent(
            &request,
            &accepting(Some(Accepted::Only(vec![0.2, 1.0])), None),
        );
        let omitted = Settings {
            omit: Parameter::ALL.to_vec(),
            ..only_one
        };
        let body = sent(&request, &omitted).to_string();
        assert!(
            !body.contains("temperature") && !body.contains("op_p"),
            "{body}"
        );
        let no_number = Request {
            temperature: Some(f64::NAN),
            ..request.clone()
        };
        let said = refused(&no_number, &settings(wire));
        assert!(said.contains("accepts a finite number"), "{said}");
    }
}

#[test]
fn what_is_known_of_a_model_decides_what_is_sent() {
    let known = |model: &str| {
        let profile = Catalogue::builtin().find(model).expect("a provider");
        let base = BaseUrl::parse("http://localhost:1").expect("a base URL");
        Settings::of(
            &profile,
            base,
            Date::try_from("2026-11-20".to_owned()).expect("a date"),
        )
    };
    let short = Request {
        max_tokens: Some(7),
        schema: Some(json!({ "type": "object" })),
        ..request()
    };
    let newer = known("openai-chat:gpt-6.2-sol");
    let body = sent(&short, &newer);
    assert_eq!(body["max_completion_tokens"], 7);
    assert_eq!(body["response_format"]["type"], "json_schema");
    for (temperature, top_p) in [(Some(0.2), None), (None, Some(0.2))] {
        let stated = Request {
            temperature,
            top_p,
            ..request()
        };
        assert!(refused(&stated, &newer).contains("1 alone"));
        sent(&stated, &known("openai-chat:gpt-6.1-terra"));
    }
    for server in ["llamacpp", "vllm", "ollama", "lmstudio"] {
        for model in ["a-model", "gpt-5.5-pro"] {
            let body = sent(&short, &known(&format!("{server}:{model}")));
            assert_eq!(body["max_tokens"], 7);
            assert_eq!(
                body["response_format"]["type"], "json_schema",
                "{server}:{model}"
            );
        }
    }
    let body = sent(&short, &known("openai-chat:gpt-5.5-pro"));
    assert_eq!(body["response_format"], Value::Null);
    let google = known("google:gemini-3.5-flash").lowering;
    assert_eq!(google.to_string(), "y x, 0-1000");
}

#[test]
fn requests_that_a_model_cannot_take_are_refused() {
    let png = || Part::Image(Png::new(vec![1]));
    let turn = |speaker, part| Message {
        speaker,
        parts: vec![part],
    };
    for wire in Wire::ALL {
        let facts = Facts {
            vision: Some(false),
            ..Facts::default()
        };
        let blind = knowing(wire, facts);
        assert!(refused(&request(), &blind).contains("picture"));
        let mut drawn = request();
        drawn.messages.push(turn(Speaker::Assistant, png()));
        assert!(refused(&drawn, &settings(wire)).contains("turn of the model"));
        let mut framed = request();
        framed.messages.insert(0, turn(Speaker::System, png()));
        assert!(refused(&framed, &settings(wire)).contains("turn of the system"));
        let silent = Request::new(ModelRole::Text, Vec::new());
        assert!(refused(&silent, &settings(wire)).contains("asks nothing"));
        let mut late = request();
        late.messages.push(Message::text(Speaker::System, "more"));
        let has_place = matches!(wire, Wire::OpenaiChat | Wire::OpenaiResponses);
        assert_eq!(
            encoded(&late, &settings(wire)).is_ok(),
            has_place,
            "{wire:?}"
        );
    }
}

const LEVELS: [Reasoning; 4] = [
    Reasoning::Level(ReasoningLevel::None),
    Reasoning::Level(ReasoningLevel::Low),
    Reasoning::Level(ReasoningLevel::Medium),
    Reasoning::Level(ReasoningLevel::High),
];

fn thinking(reasoning: Reasoning) -> Request {
    Request {
        max_tokens: Some(100),
        reasoning: Some(reasoning),
        ..request()
    }
}

#[test]
fn reasoning_goes_where_each_provider_wants_it_with_room_for_it_beside_the_answer() {
    let at = |wire, pointer: &str, reasoning| {
        let mut settings = settings(wire);
        settings.profile.provider.reasoning.tokens_field = Some("thinking_token_budget".to_owned());
        let body = sent(&thinking(reasoning), &settings);
        body.pointer(pointer).cloned().unwrap_or_default()
    };
    let levels = |wire, pointer: &str| LEVELS.map(|level| at(wire, pointer, level));
    let efforts = ["none", "low", "medium", "high"].map(Value::from);
    let longest = [100, 1124, 4196, 16_484].map(Value::from);
    let tokens = Reasoning::Tokens(2048);

    assert_eq!(levels(Wire::OpenaiChat, "/reasoning_effort"), efforts);
    assert_eq!(levels(Wire::OpenaiChat, "/max_tokens"), longest);
    assert_eq!(at(Wire::OpenaiChat, "/thinking_token_budget", tokens), 2048);
    assert_eq!(at(Wire::OpenaiChat, "/max_tokens", tokens), 2148);
    assert_eq!(
        at(Wire::OpenaiChat, "/reasoning_effort", tokens),
        Value::Null
    );

    assert_eq!(levels(Wire::OpenaiResponses, "/reasoning/effort"), efforts);
    assert_eq!(levels(Wire::OpenaiResponses, "/max_output_tokens"), longest);

    let types = ["disabled", "adaptive", "adaptive", "adaptive"].map(Value::from);
    assert_eq!(levels(Wire::Anthropic, "/thinking/type"), types);
    let [_, low, medium, high] = efforts;
    let expected = [Value::Null, low, medium, high];
    assert_eq!(levels(Wire::Anthropic, "/output_config/effort"), expected);
    assert_eq!(levels(Wire::Anthropic, "/max_tokens"), longest);
    let enabled = json!({ "type": "enabled", "budget_tokens": 2048 });
    assert_eq!(at(Wire::Anthropic, "/thinking", tokens), enabled);

    let config = "/generationConfig/thinkingConfig";
    assert_eq!(
        levels(Wire::Gemini, config),
        [
            json!({ "thinkingBudget": 0 }),
            json!({ "thinkingLevel": "LOW" }),
            json!({ "thinkingLevel": "MEDIUM" }),
            json!({ "thinkingLevel": "HIGH" }),
        ]
    );
    assert_eq!(
        at(Wire::Gemini, config, tokens),
        json!({ "thinkingBudget": 2048 })
    );
    assert_eq!(
        levels(Wire::Gemini, "/generationConfig/maxOutputTokens"),
        longest
    );
}

#[test]
fn reasoning_without_a_limit_on_the_answer_sets_none() {
    for wire in Wire::ALL {
        let request = Request {
            max_tokens: None,
            ..thinking(LEVELS[1])
        };
        let body = sent(&request, &settings(wire));
        let lengths = [
            "/max_tokens",
            "/max_output_tokens",
            "/generationConfig/maxOutputTokens",
        ];
        let found: Vec<&Value> = lengths.iter().filter_map(|at| body.pointer(at)).collect();
        match wire {
            Wire::Anthropic => assert_eq!(found, [&Value::from(4096 + 1024)]),
            _ => assert!(found.is_empty(), "{body}"),
        }
    }
}

#[test]
fn a_model_that_takes_numbers_alone_gets_levels_as_numbers() {
    for (wire, pointer) in [
        (Wire::Anthropic, "/thinking/budget_tokens"),
        (
            Wire::Gemini,
            "/generationConfig/thinkingConfig/thinkingBudget",
        ),
    ] {
        let mut settings = settings(wire);
        settings.profile.provider.reasoning.levels_as_tokens = Some(true);
        let body = sent(&thinking(LEVELS[2]), &settings);
        assert_eq!(body.pointer(pointer), Some(&Value::from(4096)));
        let off = sent(&thinking(LEVELS[0]), &settings).to_string();
        assert!(off.contains(r#"{"type":"disabled"}"#) || off.contains(r#""thinkingBudget":0"#));
    }
}

#[test]
fn reasoning_that_the_model_refuses_is_refused_before_it_is_sent() {
    let find = |model: &str| {
        let profile = Catalogue::builtin().find(model).expect("a provider");
        let base = BaseUrl::parse("http://localhost:1").expect("a base URL");
        Settings::of(
            &profile,
            base,
            Date::try_from("2026-11-24".to_owned()).expect("a date"),
        )
    };
    let none = LEVELS[0];
    for (model, stated, said) in [
        (
            "openai:gpt-6.2-sol",
            none,
            "`none`, and it accepts `low`, `medium`, `high`;",
        ),
        (
            "openai-chat:gpt-6.2-astra",
            none,
            "accepts `low`, `medium`, `high`;",
        ),
        (
            "openai:gpt-6.1-terra",
            Reasoning::Tokens(9),
            "is `9 tokens`, and it accepts `none`, `low`",
        ),
        (
            "ollama:qwen3-vl",
            Reasoning::Tokens(9),
            "accepts `none`, `low`, `medium`, `high`;",
        ),
        (
            "anthropic:claude-x",
            Reasoning::Tokens(1023),
            "a number of tokens from 1024;",
        ),
    ] {
        let settings = find(model);
        let why = refused(&thinking(stated), &settings);
        assert!(why.contains(said), "{model}: {why}");
        assert!(
            why.contains("`--reasoning`") && why.contains("`--omit reasoning`"),
            "{why}"
        );
        let omitted = Settings {
            omit: vec![Parameter::Reasoning],
            ..settings
        };
        let plain = Request {
            reasoning: None,
            ..thinking(stated)
        };
        assert_eq!(sent(&thinking(stated), &omitted), sent(&plain, &omitted));
    }
    for (model, stated) in [
        ("openai:gpt-6.2-sol", LEVELS[1]),
        ("vllm:qwen3-vl", Reasoning::Tokens(9)),
        ("llamacpp:any", Reasoning::Tokens(9)),
        ("anthropic:claude-x", Reasoning::Tokens(1024)),
        ("google:gemini-2.5-flash", Reasoning::Tokens(1)),
    ] {
        sent(&thinking(stated), &find(model));
    }
    let budget = find("google:gemini-2.5-flash");
    let body = sent(&thinking(LEVELS[3]), &budget);
    assert_eq!(
        body["generationConfig"]["thinkingConfig"],
        json!({ "thinkingBudget": 16_384 })
    );
}
