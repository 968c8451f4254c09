//! Tests of the bound and of the likely value: small plans counted by hand, and plans played through.

use super::*;
use crate::catalogue::Catalogue;
use fab_model::{Message, ModelRole, Png, Speaker};

/// 100 estimated tokens, and 58 likely ones.
fn words() -> Message {
    Message::text(Speaker::User, "a".repeat(400))
}

/// The same, and 59 tokens of a picture.
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
    change: &dyn Fn(&mut Plan<'_>, &mut [Question<'_>; 2]),
) -> Estimate {
    let asking = |message| Request::new(ModelRole::Vision, vec![message]);
    let (shown, words) = (asking(shown()), asking(words()));
    let (vision, text) = (find(vision), find(text));
    let question = |stage, profile, request| Question {
        stage,
        profile,
        request,
        lengths: Lengths {
            visible: Some(100),
            hidden: 0,
        },
        fresh: 5,
        candidates: 0,
        revisions: 0,
    };
    let mut questions = [
        question("look", &vision, &shown),
        question("plan", &text, &words),
    ];
    let mut plan = Plan {
        questions: &[],
        horizon: 3,
        actions_per_step: 1,
        attempts: 1,
        shows_correction: false,
        rollouts: 5,
        today: Date::try_from("2026-11-20".to_owned()).expect("a date"),
    };
    change(&mut plan, &mut questions);
    Plan {
        questions: &questions,
        ..plan
    }
    .estimate()
}

const SOL: &str = "openai:gpt-6.2-sol";

#[test]
fn where_each_question_is_asked_once_the_bound_differs_by_the_answers_and_the_safety() {
    let found = estimate(SOL, SOL, &|_, _| {});
    let likely = Amount {
        calls: 30,
        // The second stage quotes the answer of the first one.
        input_tokens: Some(15 * (58 + 59) + 15 * (58 + 56)),
        output_tokens: Some(30 * 56),
        cost: Some(Usd::from_nano(15 * (117 + 114) * 2_000 + 30 * 56 * 10_000)),
    };
    let at_most = Amount {
        calls: 30,
        input_tokens: Some(SAFETY * (15 * 159 + 15 * 200)),
        output_tokens: Some(30 * 100),
        cost: Some(Usd::from_nano(
            SAFETY * 15 * 359 * 2_000 + 30 * 100 * 10_000,
        )),
    };
    assert_eq!((found.likely, found.at_most), (likely, at_most));
    assert!(found.unknown.is_empty());
    assert_eq!(
        found.to_string(),
        "likely: calls 30, input tokens 3465, output tokens 1680, cost 0.0237 USD\n\
         at most: calls 30, input tokens 16155, output tokens 3000, cost 0.0623 USD"
    );
    let short = estimate(SOL, SOL, &|_, questions| {
        questions[0].lengths.visible = Some(9)
    });
    assert_eq!(short.likely.output_tokens, Some(15 * 9 + 15 * 56));
}

#[test]
fn hidden_tokens_are_bounded_with_the_answers_and_repeated_in_no_question() {
    let with = |hidden| {
        estimate(SOL, SOL, &|plan, questions| {
            plan.attempts = 2;
            questions
                .iter_mut()
                .for_each(|it| it.lengths.hidden = hidden);
        })
    };
    let (plain, thinking) = (with(0), with(1024));
    assert_eq!(plain.at_most.output_tokens, Some(60 * 100));
    assert_eq!(thinking.at_most.output_tokens, Some(60 * 1124));
    assert_eq!(thinking.at_most.input_tokens, plain.at_most.input_tokens);
    assert_eq!(thinking.likely, plain.likely);
    assert!(thinking.at_most.cost > plain.at_most.cost);
}

#[test]
fn conversations_that_grow_by_corrections_are_counted_as_they_are_played_out() {
    let attempts = 3;
    let change = |plan: &mut Plan<'_>| {
        plan.attempts = attempts;
        plan.actions_per_step = 2;
    };
    let found = estimate(SOL, SOL, &|plan, _| change(plan));
    let mut expected = 0;
    for (first, told) in [(159, 0), (100, 100)] {
        for _action in 0..5 * 3 * 2 {
            let mut talk = first + told + CORRECTION_TOKENS;
            for _attempt in 0..attempts {
                expected += talk * SAFETY;
                talk += 100 + CORRECTION_TOKENS;
            }
        }
    }
    assert_eq!(found.at_most.input_tokens, Some(expected));
    assert_eq!(found.at_most.calls, 30 * 2 * 3);
    assert_eq!(found.likely.calls, 30 * 14 / 10);
    let pictured = estimate(SOL, SOL, &|plan, _| {
        change(plan);
        plan.shows_correction = true;
    });
    // Stage `look` repeats the refused action's picture once before its second question, twice before its third.
    assert_eq!(
        pictured.at_most.input_tokens,
        Some(expected + SAFETY * 30 * 3 * 59)
    );
}

#[test]
fn what_is_not_known_is_named_and_leaves_the_amounts_open() {
    let found = estimate("google:gemini-4-argon", "openai:o3", &|_, questions| {
        questions
            .iter_mut()
            .for_each(|it| it.lengths.visible = None);
    });
    for amount in [found.likely, found.at_most] {
        assert_eq!((amount.calls, amount.cost), (30, None));
        assert_eq!(amount.input_tokens, None);
    }
    assert_eq!(
        found.unknown.iter().map(String::as_str).collect::<Vec<_>>(),
        [
            "how many tokens a picture has for google:gemini-4-argon",
            "the longest answer of the stage `look`: state `tokens`",
            "the longest answer of the stage `plan`: state `tokens`",
            "the price of openai:o3",
        ]
    );
    let text = found.to_string();
    assert!(
        text.contains("cost ?\nnot known: how many tokens"),
        "{text}"
    );
}

#[test]
fn models_on_the_users_own_machine_cost_nothing_whatever_is_unknown() {
    let found = estimate("ollama:x", "vllm:y", &|_, _| {});
    assert_eq!(found.likely.cost, Some(Usd::ZERO));
    assert_eq!(found.at_most.cost, Some(Usd::ZERO));
}

#[test]
fn no_plan_makes_a_sum_overflow() {
    let found = estimate(SOL, SOL, &|plan, questions| {
        plan.rollouts = u64::MAX;
        plan.horizon = u32::MAX;
        plan.attempts = u32::MAX;
        plan.actions_per_step = u32::MAX;
        for question in questions {
            question.lengths.visible = Some(u32::MAX);
            question.candidates = u32::MAX;
            question.revisions = u32::MAX;
            question.fresh = u64::MAX;
        }
    });
    assert_eq!(found.at_most.calls, u64::MAX);
    assert_eq!(found.at_most.cost, Some(Usd::from_nano(u64::MAX)));
}

#[test]
fn a_rehearsal_adds_its_candidates_and_revisions_to_both_amounts() {
    let with = |candidates, revisions| {
        estimate(SOL, SOL, &|plan, questions| {
            plan.attempts = 3;
            for question in questions {
                // The first answers are those of another method.
                question.fresh = 0;
                question.candidates = candidates;
                question.revisions = revisions;
            }
        })
    };
    let plain = with(0, 0);
    assert_eq!((plain.likely.calls, plain.at_most.calls), (0, 90));
    // Thirty actions: three answers that nobody shares, and four times three questions.
    let four = with(3, 0);
    assert_eq!((four.likely.calls, four.at_most.calls), (90, 360));
    let most = |it: &Estimate| it.at_most.input_tokens.expect("known");
    assert_eq!(most(&four), 4 * most(&plain));
    let revised = with(0, 2);
    assert_eq!((revised.likely.calls, revised.at_most.calls), (60, 150));
    assert!(most(&revised) > most(&plain));
}
