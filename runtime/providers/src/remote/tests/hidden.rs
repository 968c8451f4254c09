//! Tests of answers that reasoning cut off.

use super::*;

fn found(text: &str, output: u64, hidden: Option<u64>, lengths: Lengths) -> (String, Option<u32>) {
    let usage = Usage {
        output_tokens: output,
        reasoning_tokens: hidden,
        ..Usage::default()
    };
    let (words, again) = remedy(text, Some(usage), lengths);
    (words, again.map(|again| again.hidden))
}

const LENGTHS: Lengths = Lengths {
    visible: Some(100),
    hidden: 1024,
};

#[test]
fn an_answer_that_got_its_length_is_not_starved() {
    let thoughts = format!("<think>{}</think>{}", "x".repeat(85), "y".repeat(100));
    for (text, output, hidden) in [
        ("words", 100, None),
        ("words", 100, Some(0)),
        ("", 1124, Some(0)),
        ("words", 1124, Some(1024)),
        ("words", 1124, Some(1030)),
        (&thoughts, 200, None),
    ] {
        let (words, again) = found(text, output, hidden, LENGTHS);
        assert_eq!(
            (words.as_str(), again),
            ("raise the stage's `tokens`", None)
        );
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
        ("<think>about", 100, None, 2048),
        ("<think>about", 100, Some(0), 2048),
        ("<think>about</think>\n", 100, None, 2048),
        ("12345</think>", 100, None, 2048),
    ] {
        let (words, again) = found(text, output, hidden, LENGTHS);
        assert_eq!(again, Some(more), "{text}: {words}");
        let spent = hidden.filter(|it| *it > 0).unwrap_or(output);
        assert!(words.contains(&format!("took {spent} tokens")), "{words}");
    }
    assert!(remedy("", None, LENGTHS).1.is_some());
}

#[test]
fn without_a_limit_there_is_nothing_to_raise() {
    let unlimited = Lengths {
        visible: None,
        hidden: 0,
    };
    let (words, again) = found("", 9000, Some(9000), unlimited);
    assert!(words.contains("took 9000 tokens: no limit") && again.is_none());
}
