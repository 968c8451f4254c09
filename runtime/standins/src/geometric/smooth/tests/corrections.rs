//! Tests that the answer follows a correction's request.

use super::*;

#[test]
fn another_corner_is_picked_where_one_is_asked_for() {
    let asked = narrowed();
    let first = asked.answer();
    let correction = "That corner is too near to the last place point. Choose a corner that is more than 20 px away.";
    let second = asked.corrected(&first, correction);
    assert_ne!(pull_of(&second).0, pull_of(&first).0);
}

#[test]
fn a_direction_that_a_correction_names_is_taken() {
    let asked = narrowed();
    let first = asked.answer();
    let (pick, direction, _) = pull_of(&first);
    for turn in [45.0, -45.0] {
        let named = (direction + turn).rem_euclid(360.0);
        let correction = format!(
            "It does not lead away from the center. If that corner is the right one to pick, pull it in the direction {named} deg."
        );
        let (next, heading, _) = pull_of(&asked.corrected(&first, &correction));
        assert!(
            next != pick || heading == named,
            "{next:?} {heading}, and {named} was named"
        );
        assert!(
            (next, heading) != (pick, direction),
            "the refused direction is repeated"
        );
    }
}

#[test]
fn a_smaller_distance_is_taken_where_one_is_asked_for() {
    let asked = narrowed();
    let first = asked.answer();
    let (pick, direction, distance) = pull_of(&first);
    let correction =
        "The whole cloth would be dragged along. Choose a smaller distance or another corner.";
    let (next, heading, length) = pull_of(&asked.corrected(&first, correction));
    assert!((next, heading) != (pick, direction) || length < distance);
}

#[test]
fn an_answer_that_was_refused_without_a_hint_is_not_repeated() {
    let asked = narrowed();
    let mut turns = vec![asked.turn()];
    let mut answers = Vec::new();
    for _ in 0..4 {
        let reply = super::asked(turns.clone());
        assert!(!answers.contains(&pull_of(&reply)), "{reply}");
        answers.push(pull_of(&reply));
        turns.push(Message::text(Speaker::Assistant, reply));
        turns.push(Message::text(Speaker::User, "No."));
    }
}

#[test]
fn a_question_of_which_every_pull_was_refused_is_not_answered() {
    let one = Question {
        corners: vec![[211, 121]],
        ..narrowed()
    };
    let first = one.answer();
    let reply = one.corrected(&first, "Choose a corner that lies elsewhere.");
    assert!(
        reply.contains("every pull that the rules allow was refused"),
        "{reply}"
    );
}
