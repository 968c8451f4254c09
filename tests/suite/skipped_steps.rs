//! Steps without an executable answer: skipped if the task allows it, and what the model is shown after a rejection.

use super::steered::{LEFT, Played, RIGHT, answer, play_with, steered_but};
use super::support;
use fab_agent::outcome::Outcome;
use fab_model::{Part, Request, Speaker};
use fab_program::render::REFUSED_ACTION;
use serde_json::json;

/// Plays the steered task with another `attempts` line.
fn play(attempts: &str, horizon: u32, replies: &[&str]) -> Played {
    let program = steered_but(&[("attempts 2, then without new_place", attempts)]);
    play_with(&program, replies, |trial| trial.horizon = Some(horizon))
}

fn inward() -> String {
    answer(LEFT, "0 deg", "10 mm")
}

fn outward() -> String {
    answer(RIGHT, "0 deg", "10 mm")
}

#[test]
fn a_skipped_step_moves_nothing_is_counted_and_lets_the_rollout_go_on() {
    let replies = [inward(), inward(), outward()];
    let replies: Vec<&str> = replies.iter().map(String::as_str).collect();
    let played = play("attempts 2, else skip", 2, &replies);
    let report = &played.report;
    assert_eq!(report.outcome, Outcome::HorizonReached, "{report:?}");
    assert_eq!((report.steps, report.skipped_steps), (1, 1));
    assert_eq!(json!(report.skipped), json!({ "attempts_exhausted": 1 }));
    assert_eq!(played.grips.len(), 1);
    let [skipped, taken] = &played.steps[..] else {
        panic!("two steps are written down")
    };
    assert_eq!(skipped["skipped"], "attempts_exhausted");
    assert_eq!(skipped["executed"], json!(null));
    assert_eq!(skipped["stopped"], json!(null));
    assert_eq!(
        skipped["coverage_true"].as_f64(),
        report.coverage_true_at_start
    );
    assert_eq!(taken["skipped"], json!(null));
    assert_ne!(taken["coverage_true"], skipped["coverage_true"]);
}

#[test]
fn answers_that_cannot_be_read_are_skipped_under_their_own_name() {
    let replies = ["?", "?", &inward(), &inward(), &outward()];
    let played = play("attempts 2, else skip", 3, &replies);
    assert_eq!(
        json!(played.report.skipped),
        json!({ "attempts_exhausted": 1, "malformed_reply": 1 })
    );
    assert_eq!(played.report.outcome, Outcome::HorizonReached);
    assert_eq!(played.report.malformed_replies, 2);
}

#[test]
fn a_rollout_of_skipped_steps_alone_ends_as_its_last_one_would_have() {
    let wrong = inward();
    let always_wrong = play("attempts 2, else skip", 3, &[wrong.as_str(); 6]);
    let report = always_wrong.report;
    assert_eq!(report.outcome, Outcome::AttemptsExhausted);
    assert_eq!((report.steps, report.skipped_steps), (0, 3));
    assert_eq!(
        json!(report.refusals),
        json!({ "outward": 6 }),
        "every refusal is counted"
    );
    let never_readable = play("attempts 2, else skip", 3, &["?"; 6]).report;
    assert_eq!(never_readable.outcome, Outcome::MalformedReply);
    assert_eq!(never_readable.malformed_replies, 6);
}

#[test]
fn without_it_a_step_without_an_answer_ends_the_rollout() {
    let wrong = inward();
    let played = play("attempts 2", 3, &[wrong.as_str(); 6]);
    assert_eq!(played.report.outcome, Outcome::AttemptsExhausted);
    assert_eq!(played.steps.len(), 1);
    assert_eq!(played.report.skipped_steps, 0);
}

#[test]
fn what_no_model_did_wrong_is_never_skipped() {
    let played = play("attempts 2, else skip", 3, &[]);
    assert_eq!(played.report.outcome, Outcome::ModelFailed);
    assert_eq!(played.steps.len(), 1);
}

#[test]
fn the_relaxed_checks_come_before_the_skip() {
    // The second step's answers pick where the first one ended; without `new_place` this is allowed.
    let right = answer("(112, 112)", "0 deg", "10 mm");
    let left = answer("(112, 112)", "180 deg", "10 mm");
    let played = play(
        "attempts 2, then without new_place, else skip",
        2,
        &[&right, &left, &left],
    );
    assert_eq!(played.report.skipped_steps, 0);
    assert_eq!(played.steps[1]["accepted"]["without"][0], "new_place");
}

/// The pictures of a message, decoded.
fn pictures(parts: &[Part]) -> Vec<image::RgbImage> {
    let png = parts.iter().filter_map(|part| match part {
        Part::Image(png) => Some(png.bytes()),
        Part::Text(_) => None,
    });
    png.map(|bytes| image::load_from_memory(bytes).unwrap().to_rgb8())
        .collect()
}

fn last_parts(request: &Request) -> &[Part] {
    let message = request.messages.last().unwrap();
    assert_eq!(message.speaker, Speaker::User);
    &message.parts
}

#[test]
fn a_correction_shows_the_refused_action_on_the_picture_that_the_model_saw() {
    let wrong = inward();
    let played = play("attempts 3 with picture", 1, &[&wrong, "?", &outward()]);
    let [first, second, third] = &played.asked[..] else {
        panic!("three questions: {:?}", played.report)
    };
    let Part::Text(told) = &last_parts(second)[0] else {
        panic!("a correction begins with words")
    };
    assert!(told.contains("0 deg leads inward") && told.ends_with(REFUSED_ACTION));
    let [shown] = &pictures(last_parts(second))[..] else {
        panic!("a correction has one picture")
    };
    let seen = pictures(last_parts(first));
    let annotated = seen.last().unwrap();
    // 10 mm are 9 px here: a green ring around (66, 66), a purple one around (75, 66).
    assert_eq!(shown.get_pixel(66, 61).0, [0, 255, 0]);
    assert_eq!(shown.get_pixel(75, 71).0, [128, 0, 128]);
    let changed = shown.enumerate_pixels().filter(|(u, v, pixel)| {
        let is_drawn = annotated.get_pixel(*u, *v) != *pixel;
        assert!(!is_drawn || (58..84).contains(u) && (58..75).contains(v));
        is_drawn
    });
    assert!(changed.count() > 50);
    // An unreadable answer has no action to show; pictures shown before stay in the conversation.
    assert!(pictures(last_parts(third)).is_empty());
    assert_eq!(third.messages[..second.messages.len()], second.messages[..]);
}

#[test]
fn an_action_that_leads_nowhere_is_corrected_in_words_alone() {
    let never_offered = answer(LEFT, "180 deg", "11 mm");
    let played = play("attempts 2 with picture", 1, &[&never_offered, &outward()]);
    assert!(pictures(last_parts(&played.asked[1])).is_empty());
    let Part::Text(told) = &last_parts(&played.asked[1])[0] else {
        panic!("a correction has words")
    };
    assert!(!told.contains(REFUSED_ACTION), "{told}");
}

#[test]
fn without_the_words_a_correction_has_no_picture() {
    let wrong = inward();
    let played = play("attempts 2", 1, &[&wrong, &outward()]);
    assert!(pictures(last_parts(&played.asked[1])).is_empty());
    assert!(!support::small_task().verify.with_picture);
}
