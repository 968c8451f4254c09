//! Tests of smoothing: change the words or the picture, and check that the pull follows.

use super::*;

const FORMAT: &str = "\
Pick Point = (x, y)
Direction = 0 deg | 45 deg | 90 deg | 135 deg | 180 deg | 225 deg | 270 deg | 315 deg
Distance = 0.1 edge | 0.25 edge | 0.5 edge | 0.75 edge | 1 edge";

const CORNERS: &str = "The corners are (60, 60), (160, 70), (150, 150), (80, 140).";

/// A question about a cloth of 100 px a side around (110, 110).
fn question(corners: &str, more: &str) -> String {
    format!(
        "One edge, the length of that side, is 100 px in the picture.\n{FORMAT}\n{corners}\nThe center is (110, 110).\n{more}"
    )
}

fn asked(turns: &[&str]) -> String {
    let speakers = [Speaker::User, Speaker::Assistant];
    let turns = turns.iter().zip(speakers.into_iter().cycle());
    let messages = turns.map(|(words, speaker)| Message::text(speaker, *words));
    ask(ModelRole::Vision, messages.collect())
}

/// The lines that state the action, as values.
fn pull(reply: &str) -> [&str; 3] {
    ["Pick Point = ", "Direction = ", "Distance = "].map(|label| {
        let line = reply.lines().find_map(|line| line.strip_prefix(label));
        line.unwrap_or_else(|| panic!("no `{label}` in: {reply}"))
    })
}

#[test]
fn the_farthest_listed_corner_goes_to_where_a_flat_corner_would_lie() {
    for (corners, expected) in [
        (CORNERS, ["(60, 60)", "135 deg", "0.1 edge"]),
        (
            "The corners are (95, 95), (125, 115), (120, 125).",
            ["(95, 95)", "135 deg", "0.5 edge"],
        ),
        (
            "The corners are (145, 110).",
            ["(145, 110)", "0 deg", "0.25 edge"],
        ),
    ] {
        assert_eq!(pull(&asked(&[&question(corners, "")])), expected);
    }
}

#[test]
fn the_rules_in_the_words_are_followed() {
    let near =
        "Pick a corner\nthat is more than 20 px away from both of them, (65, 65) and (155, 155).";
    let fresh = asked(&[&question(CORNERS, near)]);
    assert_eq!(pull(&fresh)[0], "(160, 70)");
    let all = "Stay more than 200 px away from (110, 110).";
    let anyway = asked(&[&question(CORNERS, all)]);
    assert_eq!(pull(&anyway)[0], "(60, 60)");
    let reach = "A corner must not be placed farther than 45 px from the middle of the picture, (110, 110).";
    let within = asked(&[&question("The corners are (95, 95), (125, 115).", reach)]);
    assert_eq!(pull(&within), ["(95, 95)", "135 deg", "0.1 edge"]);
}

#[test]
fn a_refused_pull_is_not_repeated() {
    let question = question(CORNERS, "");
    let first = asked(&[&question]);
    let again = asked(&[&question, &first, "No."]);
    assert_eq!(pull(&again)[0], "(60, 60)");
    assert_ne!(pull(&again), pull(&first));
}

#[test]
fn without_a_list_a_corner_of_the_outline_is_pulled() {
    let picture = VIEW.paint(&square_fold().before);
    let words = format!("One edge is 140 px in the picture.\n{FORMAT}");
    let reply = ask(
        ModelRole::Vision,
        vec![user(vec![Part::Text(words), png(&picture)])],
    );
    let pick = prompt::points(&reply)[0];
    let corner = square_fold().before;
    let mut offs = corner
        .iter()
        .map(|at| VIEW.whole_pixel(*at).distance_px(pick));
    assert!(offs.any(|off_px| off_px < 6.0), "{reply}");
}

#[test]
fn what_is_missing_is_named() {
    let plain = question(CORNERS, "");
    for (words, expected) in [
        (
            plain.replace("px", "cells"),
            "no sentence says how many px an edge is",
        ),
        (
            plain.replace("corners", "points"),
            "no corners are listed, and there is no picture",
        ),
        (
            question(
                "The corners are (110, 110).",
                "A corner must not be farther than 1 px from (0, 0).",
            ),
            "no pull leads outward",
        ),
    ] {
        let reply = asked(&[&words]);
        assert!(reply.contains(expected), "{reply}");
    }
}
