//! Extracts pairs of numbers and their names from an answer.
//!
//! In: any text. Out: the two numbers after each name; or before it, if the answer puts numbers first, as in
//! `[{"point": [y, x], "label": "red"}]`. The rules of `docs/answers.md` hold: thoughts and quotations state nothing, and
//! of two different values neither is read. The frame of the numbers is
//! unknown here, so the reader of actions cannot be used.

use fab_program::reply::standing;

/// A relevant token of an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Token {
    Name(usize),
    Number(f64),
}

/// The most of an answer that is read, bytes.
const MOST: usize = 100_000;

/// Returns the pair of each name, in their order.
pub(super) fn pairs<const N: usize>(text: &str, names: &[&str; N]) -> [Option<[f64; 2]>; N] {
    let end = (0..=MOST.min(text.len()))
        .rev()
        .find(|end| text.is_char_boundary(*end));
    let answer = standing(&text[..end.unwrap_or(0)]);
    let mut pairs = [None; N];
    if answer.is_cut_off {
        return pairs;
    }
    let mut found = found(&answer.text, names);
    // Numbers first, then names: read backwards, each name is followed by its numbers.
    let backwards = matches!(found.first(), Some(Token::Number(_)))
        && matches!(found.last(), Some(Token::Name(_)));
    if backwards {
        found.reverse();
    }
    let mut stated: [Vec<[f64; 2]>; N] = std::array::from_fn(|_| Vec::new());
    for (index, token) in found.iter().enumerate() {
        let Token::Name(name) = *token else { continue };
        if let [Token::Number(one), Token::Number(other), ..] = found[index + 1..] {
            let pair = if backwards {
                [other, one]
            } else {
                [one, other]
            };
            stated[name].push(pair);
        }
    }
    for (pair, stated) in pairs.iter_mut().zip(stated) {
        *pair = match &stated[..] {
            [only, rest @ ..] if rest.iter().all(|other| other == only) => Some(*only),
            _ => None,
        };
    }
    pairs
}

/// Returns the colours, red or blue, that an answer gives to the first and the second picture.
pub(super) fn colours(text: &str) -> Option<[&'static str; 2]> {
    let answer = standing(text);
    if answer.is_cut_off {
        return None;
    }
    let text = answer.text.to_ascii_lowercase();
    let words: Vec<&str> = text
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    let after = |name: &str| {
        let mut named = words.iter().skip_while(|word| **word != name).skip(1);
        let next = named.find(|word| ["red", "blue", "first", "second"].contains(*word))?;
        ["red", "blue"].into_iter().find(|colour| colour == next)
    };
    Some([after("first")?, after("second")?])
}

fn found(text: &str, names: &[&str]) -> Vec<Token> {
    let text = text.to_ascii_lowercase();
    let bytes = text.as_bytes();
    let is_word = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_alphanumeric);
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let begun = at;
        if bytes[at].is_ascii_alphabetic() {
            while is_word(at) || bytes.get(at) == Some(&b'_') {
                at += 1;
            }
            let word = &text[begun..at];
            let name = names.iter().position(|name| *name == word);
            found.extend(name.map(Token::Name));
        } else if bytes[at].is_ascii_digit() {
            while bytes.get(at).is_some_and(|byte| byte.is_ascii_digit())
                || (bytes.get(at) == Some(&b'.')
                    && bytes.get(at + 1).is_some_and(u8::is_ascii_digit))
            {
                at += 1;
            }
            let sign = if begun > 0 && bytes[begun - 1] == b'-' {
                -1.0
            } else {
                1.0
            };
            let number = text[begun..at]
                .parse::<f64>()
                .ok()
                .filter(|number| number.is_finite());
            found.extend(number.map(|number| Token::Number(sign * number)));
        } else {
            at += 1;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn pairs_are_read_in_the_forms_that_models_write() {
        let expected = [Some([12.0, 34.5]), Some([0.25, 1000.0])];
        for text in [
            "red: (12, 34.5)\nblue: (0.25, 1000)",
            "- **Red** dot: [12, 34.5]\n- Blue: 0.25 1000",
            "{\"red\": [12, 34.5], \"blue\": {\"x\": 0.25, \"y\": 1000}}",
            "```json\n[{\"point\": [12, 34.5], \"label\": \"red\"}, {\"point\": [0.25, 1000], \"label\": \"blue\"}]\n```",
            "<point x=\"12\" y=\"34.5\" alt=\"red\">red</point><point x1=\"0.25\" y1=\"1000\">blue</point>",
            "red: x=12, y=34.5; blue: x=0.25, y=1000. The red dot is left.",
        ] {
            assert_eq!(pairs(text, &["red", "blue"]), expected, "{text}");
        }
    }

    #[test]
    fn what_names_no_pair_is_not_guessed_at() {
        for text in [
            "",
            "red: 12",
            "redder: (1, 2)",
            "I cannot see red or blue.",
            "12, 34",
            "red blue",
        ] {
            assert_eq!(pairs(text, &["red", "blue"]), [None, None], "{text}");
        }
        assert_eq!(pairs("red: (1, 2)\nred: (3, 4)", &["red"]), [None]);
        assert_eq!(
            pairs("red: (1, 2)\nred: (1, 2)", &["red"]),
            [Some([1.0, 2.0])]
        );
        assert_eq!(pairs("red: (-1, 2)", &["red"]), [Some([-1.0, 2.0])]);
    }

    #[test]
    fn thoughts_and_quotations_are_not_read_and_a_correction_is_a_second_value() {
        for (text, expected) in [
            (
                "<think>red: (9, 9), or rather (8, 8)</think>\nred: (1, 2)",
                Some([1.0, 2.0]),
            ),
            ("> red: (9, 9)\nred: (1, 2)", Some([1.0, 2.0])),
            ("red: (9, 9)\nNo wait, correction:\nred: (1, 2)", None),
            ("<think>red: (1, 2)", None),
        ] {
            assert_eq!(pairs(text, &["red"]), [expected], "{text}");
        }
    }

    #[test]
    fn colours_of_two_pictures_are_read_by_their_names() {
        for (text, expected) in [
            ("first: red\nsecond: blue", Some(["red", "blue"])),
            (
                "The **first** picture is Blue, the second is red.",
                Some(["blue", "red"]),
            ),
            (
                "<think>first: blue</think>\nfirst: red\nsecond: red",
                Some(["red", "red"]),
            ),
            ("first: green\nsecond: blue", None),
            ("I see one picture.", None),
            ("", None),
        ] {
            assert_eq!(colours(text), expected, "{text}");
        }
    }

    proptest! {
        #[test]
        fn no_answer_makes_it_panic(text in "\\PC*", more in "[0-9.,()red blue\\[\\]-]*") {
            pairs(&(text + &more), &["red", "blue"]);
        }
    }
}
