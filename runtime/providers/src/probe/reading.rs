//! Extracts pairs of numbers and their names from an answer.
//!
//! In: any text. Out: the first two numbers after each name; or before it, if the answer puts numbers first, as in
//! `[{"point": [y, x], "label": "red"}]`. Nothing is guessed: a name with one number has no pair.

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
    let mut found = found(text, names);
    // Numbers first, then names: read backwards, each name is followed by its numbers.
    let backwards = matches!(found.first(), Some(Token::Number(_)))
        && matches!(found.last(), Some(Token::Name(_)));
    if backwards {
        found.reverse();
    }
    let mut pairs = [None; N];
    for (index, thing) in found.iter().enumerate() {
        let Token::Name(name) = *thing else { continue };
        if let [Token::Number(one), Token::Number(other), ..] = found[index + 1..] {
            let pair = if backwards {
                [other, one]
            } else {
                [one, other]
            };
            pairs[name].get_or_insert(pair);
        }
    }
    pairs
}

fn found(text: &str, names: &[&str]) -> Vec<Token> {
    let text: String = text.chars().take(MOST).collect::<String>().to_lowercase();
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
            found.extend(names.iter().position(|name| *name == word).map(Token::Name));
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
        assert_eq!(
            pairs("red: (1, 2) red: (3, 4)", &["red"]),
            [Some([1.0, 2.0])]
        );
        assert_eq!(pairs("red: (-1, 2)", &["red"]), [Some([-1.0, 2.0])]);
    }

    proptest! {
        #[test]
        fn no_answer_makes_it_panic(text in "\\PC*", more in "[0-9.,()red blue\\[\\]-]*") {
            pairs(&(text + &more), &["red", "blue"]);
        }
    }
}
