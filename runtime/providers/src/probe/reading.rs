//! Extracts pairs of numbers and their names from an answer.
//!
//! In: any text. Out: the two numbers after each name; or before it, if the answer puts numbers first, as in
//! `[{"point": [y, x], "label": "red"}]`. The rules of `docs/answers.md` hold: thoughts and quotations state nothing, and
//! of two different values neither is read. The frame of the numbers is unknown here, so the reader of actions cannot be
//! used.

use fab_program::reply::standing;

/// A relevant word of an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Token {
    Name(usize),
    Number(f64),
}

/// Returns the pair of each name, in their order.
pub(super) fn pairs<const N: usize>(text: &str, names: &[&str; N]) -> [Option<[f64; 2]>; N] {
    let answer = standing(text);
    if answer.is_cut_off {
        return [None; N];
    }
    let mut found = tokens(&answer.text, names);
    // Numbers first, then names: read backwards, each name is followed by its numbers.
    let backwards = matches!(found[..], [Token::Number(_), .., Token::Name(_)]);
    if backwards {
        found.reverse();
    }
    let mut stated: [Vec<[f64; 2]>; N] = std::array::from_fn(|_| Vec::new());
    for three in found.windows(3) {
        if let [Token::Name(name), Token::Number(one), Token::Number(other)] = *three {
            stated[name].push(if backwards {
                [other, one]
            } else {
                [one, other]
            });
        }
    }
    stated.map(|stated| match &stated[..] {
        [only, rest @ ..] if rest.iter().all(|other| other == only) => Some(*only),
        _ => None,
    })
}

fn tokens(text: &str, names: &[&str]) -> Vec<Token> {
    let text = text.to_ascii_lowercase();
    let is_part = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    let words = text.split(|c| !is_part(c));
    let read = words.filter_map(|word| {
        if let Some(name) = names.iter().position(|name| *name == word) {
            return Some(Token::Name(name));
        }
        // A number may end a sentence, or have a unit.
        let number = word.trim_end_matches(|c: char| c == '.' || c.is_ascii_alphabetic());
        let begins = number
            .trim_start_matches('-')
            .starts_with(|c: char| c.is_ascii_digit());
        let number = number
            .parse()
            .ok()
            .filter(|number: &f64| begins && number.is_finite());
        number.map(Token::Number)
    });
    read.collect()
}
