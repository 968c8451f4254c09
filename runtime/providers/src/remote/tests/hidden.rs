//! Tests of answers that reasoning cut off.

use super::*;
use fab_model::calls::{Fault, Usage};

fn failure(text: &str, output: u64, hidden: Option<u64>) -> Failure {
    Failure {
        fault: Fault::Truncated,
        why: String::new(),
        usage: Some(Usage {
            output_tokens: output,
            reasoning_tokens: hidden,
            ..Usage::default()
        }),
        cut_text: Some(text.to_owned()),
        reasoning: None,
    }
}

const LENGTHS: Lengths = Lengths {
    visible: Some(100),
    hidden: 1024,
};

#[test]
fn an_answer_that_got_its_length_is_not_starved() {
    for (text, output, hidden) in [
        ("words", 100, None),
        ("words", 100, Some(0)),
        ("", 1124, Some(0)),
        ("words", 1124, Some(1024)),
        ("words", 1124, Some(1030)),
    ] {
        assert_eq!(starved(&failure(text, output, hidden), LENGTHS), None);
    }
}

#[test]
fn a_starved_answer_is_asked_again_with_twice_as_many_hidden_tokens() {
    for (text, output, hidden, more) in [
        ("", 1124, Some(1124), 2248),
        ("wo", 1124, Some(1060), 2120),
        (" ", 1124, None, 2248),
        ("", 60, Some(60), 2048),
        ("", u64::MAX, None, 200_000),
    ] {
        let found = starved(&failure(text, output, hidden), LENGTHS).expect("it is starved");
        let again = found.again.expect("it is asked again");
        assert_eq!((again.visible, again.hidden), (Some(100), more));
        let spent = hidden.unwrap_or(output);
        assert!(
            found.why.contains(&format!("took {spent} tokens")),
            "{}",
            found.why
        );
    }
}

#[test]
fn thoughts_that_are_the_whole_answer_count_as_reasoning() {
    let thoughts = "x".repeat(188);
    for (text, output, reported, spent) in [
        (format!("<think>{thoughts}"), 100, None, 100),
        (format!("<think>{thoughts}"), 100, Some(0), 100),
        (format!("<think>{thoughts}</think>\n"), 100, None, 100),
        (format!("{thoughts}12345</think>"), 100, None, 100),
    ] {
        let failure = failure(&text, output, reported);
        let found = starved(&failure, LENGTHS).expect(&text);
        let told = format!("thoughts in its text took {spent} tokens");
        assert!(found.why.starts_with(&told), "{}", found.why);
        let again = found.again.expect("it is asked again");
        assert_eq!((again.visible, again.hidden), (Some(100), 2048));
    }
    // A part of the text is the answer, and nobody says what the thoughts took.
    let text = format!("<think>{}</think>{}", "x".repeat(85), "y".repeat(100));
    assert_eq!(starved(&failure(&text, 200, None), LENGTHS), None);
}

#[test]
fn without_a_limit_there_is_nothing_to_raise() {
    let unlimited = Lengths {
        visible: None,
        hidden: 0,
    };
    let found = starved(&failure("", 9000, Some(9000)), unlimited).expect("it is starved");
    assert_eq!(found.again, None);
}
