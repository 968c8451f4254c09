//! Tests of the bounds: small plans counted by hand, and plans played through.

use super::*;
use crate::catalogue::Catalogue;
use fab_model::{Png, Speaker};

/// 100 estimated tokens.
fn words() -> Message {
    Message::text(Speaker::User, "a".repeat(400))
}

/// 100 estimated tokens, and 59 of a picture.
fn shown() -> Message {
    let mut message = words();
    let picture = fab_picture::png::encode(&image::RgbImage::new(224, 224));
    message.parts.push(Part::Image(Png::new(picture)));
    message
}

fn find(model: &str) -> Profile {
    Catalogue::builtin().find(model).expect("known")
}

/// Two stages, three steps, five rollouts.
fn estimate(
    vision: &str,
    text: &str,
    change: &dyn Fn(&mut Plan<'_>),
    longest: Option<u32>,
) -> Estimate {
    let (shown, words) = ([shown()], [words()]);
    let (vision, text) = (find(vision), find(text));
    let question = |stage, profile, messages| Question {
        stage,
        profile,
        messages,
        schema: None,
        max_tokens: longest,
        typical: Typical::shipped(40.0, 1),
        fresh: Fresh::all(5),
        hidden_tokens: 0,
        rehearsed: Rehearsed::default(),
    };
    let questions = [
        question("look", &vision, shown.as_slice()),
        question("plan", &text, words.as_slice()),
    ];
    let mut plan = Plan {
        questions: &questions,
        horizon: 3,
        actions_per_step: 1,
        attempts: 1,
        correction: Correction::Words,
        rollouts: 5,
        today: "2026-11-20".parse().expect("a date"),
    };
    change(&mut plan);
    plan.estimate()
}

const SOL: &str = "openai:gpt-6.2-sol";

#[test]
fn hidden_tokens_are_bounded_with_the_answers_and_repeated_in_no_question() {
    let with = |hidden| {
        let profile = find(SOL);
        let (words, shown) = ([words()], [shown()]);
        let question = |messages| Question {
            stage: "plan",
            profile: &profile,
            messages,
            schema: None,
            max_tokens: Some(100),
            hidden_tokens: hidden,
            rehearsed: Rehearsed::default(),
            typical: Typical::shipped(40.0, 1),
            fresh: Fresh::all(1),
        };
        let plan = Plan {
            questions: &[question(shown.as_slice()), question(words.as_slice())],
            horizon: 1,
            actions_per_step: 1,
            attempts: 2,
            correction: Correction::Words,
            rollouts: 1,
            today: "2026-11-20".parse().expect("a date"),
        };
        plan.estimate()
    };
    let (plain, thinking) = (with(0), with(1024));
    assert_eq!(plain.output_tokens.at_most, Some(4 * 100));
    assert_eq!(thinking.output_tokens.at_most, Some(4 * 1124));
    assert_eq!(
        thinking.output_tokens.at_least,
        plain.output_tokens.at_least
    );
    assert_eq!(thinking.input_tokens, plain.input_tokens);
    assert!(thinking.cost.at_most > plain.cost.at_most);
}

#[test]
fn where_each_question_is_asked_once_the_bounds_differ_by_the_answers_and_the_safety() {
    let found = estimate(SOL, SOL, &|_| {}, Some(50));
    assert_eq!(
        (found.calls.at_least, found.calls.at_most),
        (Some(30), Some(30))
    );
    assert_eq!(found.input_tokens.at_least, Some(15 * 159 + 15 * 100));
    // The second stage may quote the 50 tokens of the first one's answer.
    assert_eq!(
        found.input_tokens.at_most,
        Some(SAFETY * (15 * 159 + 15 * 150))
    );
    assert_eq!(
        (found.output_tokens.at_least, found.output_tokens.at_most),
        (Some(30), Some(30 * 50))
    );
    assert_eq!(
        found.cost.at_least,
        Some(Usd::from_nano((15 * 259) * 2_000 + 30 * 10_000))
    );
    assert_eq!(found.unknown, Vec::<String>::new());
}

#[test]
fn conversations_that_grow_by_corrections_are_counted_as_they_are_played_out() {
    let attempts = 3;
    let change = |plan: &mut Plan<'_>| {
        plan.attempts = attempts;
        plan.actions_per_step = 2;
    };
    let found = estimate(SOL, SOL, &change, Some(50));
    let mut expected = 0;
    for (first, told) in [(159, 0), (100, 50)] {
        for _action in 0..5 * 3 * 2 {
            let mut talk = first + told + CORRECTION_TOKENS;
            for _attempt in 0..attempts {
                expected += talk * SAFETY;
                talk += 50 + CORRECTION_TOKENS;
            }
        }
    }
    assert_eq!(found.input_tokens.at_most, Some(expected));
    assert_eq!(
        (found.calls.at_least, found.calls.at_most),
        (Some(30), Some(30 * 2 * 3))
    );
    let pictured = estimate(
        SOL,
        SOL,
        &|plan| {
            change(plan);
            plan.correction = Correction::Picture;
        },
        Some(50),
    );
    // Stage `look` repeats the refused action's picture once before its second question, twice before its third.
    assert_eq!(
        pictured.input_tokens.at_most,
        Some(expected + SAFETY * 30 * 3 * 59)
    );
}

#[test]
fn a_likely_value_lies_between_the_bounds_and_follows_recorded_calls() {
    let found = estimate(SOL, SOL, &|plan| plan.attempts = 3, Some(500));
    // One word of 400 letters is 58 pieces; the second stage quotes the first one's 40 tokens.
    assert_eq!(found.calls.likely, Some(30));
    assert_eq!(
        found.input_tokens.likely,
        Some(15 * (58 + 59) + 15 * (58 + 40))
    );
    assert_eq!(found.output_tokens.likely, Some(30 * 40));
    let cost = found.cost;
    assert!(
        cost.at_least <= cost.likely && cost.likely <= cost.at_most,
        "{found}"
    );
    let recorded = Typical {
        calls_per_step: 1.5,
        steps_share: 0.5,
        input_tokens: Some(300.0),
        output_tokens: 700.0,
        recorded_calls: 9,
    };
    let profile = find("ollama:x");
    let messages = [shown()];
    let question = Question {
        stage: "look",
        profile: &profile,
        messages: &messages,
        schema: None,
        max_tokens: None,
        hidden_tokens: 0,
        rehearsed: Rehearsed::default(),
        typical: recorded,
        fresh: Fresh {
            at_least: 3,
            likely: 10,
        },
    };
    let plan = Plan {
        questions: &[question],
        horizon: 4,
        actions_per_step: 1,
        attempts: 2,
        correction: Correction::Words,
        rollouts: 10,
        today: "2026-11-20".parse().expect("a date"),
    };
    let found = plan.estimate();
    assert_eq!(
        Typical::shipped(1.0, 2).calls_per_step,
        Typical::CALLS_PER_RETRIED_STEP
    );
    // 40 steps, of which half are taken, with three questions for two of them; a picture's tokens need not be known.
    assert_eq!(found.calls.likely, Some(30));
    assert_eq!(found.input_tokens.likely, Some(9_000));
    assert_eq!(found.output_tokens.likely, Some(21_000));
    // Three rollouts ask it anew, and the others may share their answers.
    assert!(
        found.to_string().contains("calls: 12 to 80, likely 30"),
        "{found}"
    );
}

#[test]
fn what_is_not_known_is_named_and_leaves_the_bound_open() {
    let found = estimate("google:gemini-4-argon", "openai:o3", &|_| {}, None);
    assert_eq!(
        found.cost,
        Bounds {
            at_least: None,
            likely: None,
            at_most: None
        }
    );
    assert_eq!(
        found.input_tokens,
        Bounds {
            at_least: None,
            likely: None,
            at_most: None
        }
    );
    assert_eq!(found.calls.at_most, Some(30));
    assert_eq!(
        found.unknown,
        [
            "how many tokens a picture has for google:gemini-4-argon",
            "the longest answer of the stage `look`: state `tokens`",
            "the longest answer of the stage `plan`: state `tokens`",
            "the price of openai:o3",
        ]
    );
    let text = found.to_string();
    assert!(
        text.contains("cost: ? to ?\nnot known: how many tokens"),
        "{text}"
    );
}

#[test]
fn models_on_the_users_own_machine_cost_nothing_whatever_is_unknown() {
    let found = estimate("ollama:x", "vllm:y", &|_| {}, None);
    assert_eq!(
        found.cost,
        Bounds {
            at_least: Some(Usd::ZERO),
            likely: Some(Usd::ZERO),
            at_most: Some(Usd::ZERO)
        }
    );
}

#[test]
fn no_plan_makes_a_sum_overflow() {
    let found = estimate(
        SOL,
        SOL,
        &|plan| {
            plan.rollouts = u64::MAX;
            plan.horizon = u32::MAX;
            plan.attempts = u32::MAX;
            plan.actions_per_step = u32::MAX;
        },
        Some(u32::MAX),
    );
    assert_eq!(found.calls.at_most, Some(u64::MAX));
    assert_eq!(found.cost.at_most, Some(Usd::from_nano(u64::MAX)));
}

#[test]
fn a_rehearsal_adds_its_candidates_and_revisions_to_every_bound_but_the_least() {
    let profile = find(SOL);
    let messages = [words()];
    let with = |rehearsed| {
        let question = Question {
            stage: "plan",
            profile: &profile,
            messages: &messages,
            schema: None,
            max_tokens: Some(100),
            hidden_tokens: 0,
            rehearsed,
            typical: Typical::shipped(40.0, 1),
            // The first answers are those of another method.
            fresh: Fresh {
                at_least: 0,
                likely: 0,
            },
        };
        let plan = Plan {
            questions: &[question],
            horizon: 2,
            actions_per_step: 1,
            attempts: 3,
            correction: Correction::Words,
            rollouts: 5,
            today: "2026-11-20".parse().expect("a date"),
        };
        plan.estimate()
    };
    let plain = with(Rehearsed::default());
    assert_eq!(
        (plain.calls.likely, plain.calls.at_most),
        (Some(0), Some(30))
    );
    let four = with(Rehearsed {
        candidates: 3,
        revisions: 0,
    });
    // Ten actions: three answers that nobody shares, and four times three questions.
    assert_eq!(
        (four.calls.likely, four.calls.at_most),
        (Some(30), Some(120))
    );
    let most = |it: &Estimate| it.input_tokens.at_most.expect("known");
    assert_eq!(most(&four), 4 * most(&plain));
    let revised = with(Rehearsed {
        candidates: 0,
        revisions: 2,
    });
    assert_eq!(
        (revised.calls.likely, revised.calls.at_most),
        (Some(20), Some(50))
    );
    assert!(most(&revised) > most(&plain));
}
