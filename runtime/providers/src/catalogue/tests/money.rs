//! Tests of prices, costs and the most that a request may cost.

use super::super::*;
use super::{date, find};
use fab_model::calls::{Usage, Usd};
use fab_model::{Message, ModelRole, Part, Png, Request, Speaker};

#[test]
fn costs_are_exact_to_the_last_billionth() {
    let price = |model: &str| find(model).price_on(date("2026-11-20"));
    let sol = price("openai:gpt-6.2-sol").expect("known");
    let usage = Usage {
        input_tokens: 1_000_003,
        cached_input_tokens: 1_000_000,
        output_tokens: 7,
        ..Usage::default()
    };
    // 1,000,000 at 0.10 + 3 at 2 + 7 at 10 USD per million.
    assert_eq!(
        sol.cost(usage),
        Usd::from_nano(100_000_000 + 6_000 + 70_000)
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
        ..Usage::default()
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
        output_tokens: u64::MAX,
        ..Usage::default()
    };
    assert_eq!(
        Price {
            input: Price::MOST,
            ..third
        }
        .cost(huge),
        Usd::from_nano(u64::MAX)
    );
    assert_eq!(price("openai:o3"), None);
    assert_eq!(price("vllm:anything"), Some(Price::FREE));
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
    let picture = fab_picture::png::encode(&image::RgbImage::new(224, 224));
    message.parts.push(Part::Image(Png::new(picture)));
    let mut request = Request::new(ModelRole::Vision, vec![message]);
    let today = date("2026-11-20");
    let most = |model: &str, request: &Request| {
        let model = find(model);
        model.at_most(model.price_on(today), request, request.max_tokens)
    };
    let sol = |request: &Request| most("openai:gpt-6.2-sol", request);
    assert_eq!(sol(&request), None, "no longest answer is stated");
    request.max_tokens = Some(1000);
    // 3 * (100 + 59) tokens at 2 USD, 1000 at 10 USD per million.
    assert_eq!(
        sol(&request),
        Some(Usd::from_nano(3 * 159 * 2_000 + 1000 * 10_000))
    );
    request.schema = Some(serde_json::json!({ "a": 1 }));
    // `{"a":1}` has seven letters, two tokens.
    assert_eq!(
        sol(&request),
        Some(Usd::from_nano(3 * 161 * 2_000 + 1000 * 10_000))
    );
    for (model, why) in [
        ("openai:o3", "no price"),
        ("google:gemini-4-argon", "no formula for pictures"),
    ] {
        assert_eq!(most(model, &request), None, "{why}");
    }
    request.max_tokens = None;
    assert_eq!(most("ollama:x", &request), Some(Usd::ZERO));
}
