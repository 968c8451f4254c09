//! Finds faults in a declared action space before any answer is tried.

use super::flaws::{Flaws, MAX_CHOICES, MAX_FIELDS};
use fab_program::exact::{vector_of, written};
use fab_program::space::{self, DECIMALS};
use fab_program::{ActionField, Choices, Program};

/// The longest word, bytes.
const MAX_WORD_BYTES: usize = 100;

/// The largest length, in the field's unit; the reader rejects larger numbers.
const MAX_LENGTH: f64 = 1_000_000.0;

/// How far the two forms of one value may differ, relative to the value.
const SAME: f64 = 1e-9;

/// Characters that have another meaning in an answer: quotes, brackets, Markdown, statement separators.
const RESERVED: &str = "|\"'“”`*$\\~,;:!?()[]{}<>=#";

/// Reports flaws, and notes whether values can be tried at all.
pub(super) fn check(program: &Program, found: &mut Flaws) {
    if let Some(field) = program.actions.get(MAX_FIELDS) {
        let message = format!("an action has at most {MAX_FIELDS} fields");
        found.push(field, "", message);
        found.is_hopeless = true;
        return;
    }
    for (index, field) in program.actions.iter().enumerate() {
        let name = plain(&field.name);
        let is_name = |character: char| character.is_ascii_alphanumeric() || character == '_';
        let is_named = field
            .name
            .starts_with(|first: char| first.is_ascii_alphabetic());
        if !is_named || !field.name.chars().all(is_name) {
            found.push(field, "", format!("`{}` is not a name", field.name));
            found.is_hopeless = true;
        }
        if program.actions[..index]
            .iter()
            .any(|other| plain(&other.name) == name)
        {
            found.push(field, "", format!("two fields are named `{}`", field.name));
            found.is_hopeless = true;
        }
        check_field(program, field, found);
    }
}

fn check_field(program: &Program, field: &ActionField, found: &mut Flaws) {
    let n_choices = match &field.choices {
        Choices::Points { keypoints } => keypoints.len(),
        Choices::Region { .. } => 1,
        Choices::Directions { choices } => choices.len(),
        Choices::Lengths { choices, .. } => choices.len(),
        Choices::Words { choices } => choices.len(),
    };
    if n_choices == 0 {
        found.push(field, "", format!("`{}` has no choices", field.name));
        found.is_hopeless = true;
    }
    if n_choices > MAX_CHOICES {
        let message = format!(
            "`{}` has {n_choices} choices, {MAX_CHOICES} at most",
            field.name
        );
        found.push(field, "", message);
        found.is_hopeless = true;
        return;
    }
    check_alike(field, found);
    match &field.choices {
        Choices::Points { .. } | Choices::Region { .. } => {}
        Choices::Directions { choices } => {
            for choice in choices {
                let text = written(choice.deg, DECIMALS);
                if !(0.0..360.0).contains(&choice.deg) {
                    found.push(
                        field,
                        &text,
                        format!("`{text}` is not between 0 and 360 degrees"),
                    );
                    continue;
                }
                let right = vector_of(choice.deg);
                let apart = |axis: usize| (right[axis] - choice.vector[axis]).abs();
                if !(apart(0) <= SAME && apart(1) <= SAME) {
                    found.push(
                        field,
                        &text,
                        format!("the vector of `{text} deg` has another direction"),
                    );
                }
            }
        }
        Choices::Lengths { unit, choices } => {
            for choice in choices {
                let text = written(choice.value, DECIMALS);
                if !(0.0..=MAX_LENGTH).contains(&choice.value) {
                    found.push(
                        field,
                        &text,
                        format!("`{text}` is not a length that can be read"),
                    );
                    continue;
                }
                let m = choice.value * unit.size_with(program.cloth.edge_m());
                if choice.m.is_nan() || (choice.m - m).abs() > SAME * m {
                    let text = format!("{text} {}", unit.name);
                    found.push(field, &text, format!("`{text}` is not {} m", choice.m));
                }
            }
        }
        Choices::Words { choices } => {
            for word in choices {
                if let Some(why) = wrong_word(program, word) {
                    found.push(field, word, format!("the word `{}` {why}", short(word)));
                }
            }
        }
    }
}

/// Reports choices whose texts are equal except for case.
fn check_alike(field: &ActionField, found: &mut Flaws) {
    let mut texts: Vec<(String, String)> = space::declared(field)
        .iter()
        .map(|value| space::text(field, value))
        .map(|text| (plain(&text), text))
        .collect();
    texts.sort();
    for pair in texts.windows(2) {
        if pair[0].0 == pair[1].0 {
            let message = format!(
                "`{}` and `{}` cannot be told apart",
                short(&pair[0].1),
                short(&pair[1].1)
            );
            found.push(field, &pair[1].1, message);
        }
    }
}

fn wrong_word(program: &Program, word: &str) -> Option<&'static str> {
    let is_edge = |letter: Option<char>| letter.is_some_and(char::is_alphanumeric);
    if word.is_empty() {
        Some("is empty")
    } else if word.len() > MAX_WORD_BYTES {
        Some("is longer than 100 bytes")
    } else if word.chars().any(char::is_control) {
        Some("has a line break or another control character")
    } else if word.contains(|character| RESERVED.contains(character)) {
        Some("has a character that means something else in an answer")
    } else if !word.chars().any(char::is_alphabetic) {
        Some("has no letter")
    } else if !is_edge(word.chars().next()) || !is_edge(word.chars().next_back()) {
        Some("must begin and end with a letter or a digit")
    } else if program
        .actions
        .iter()
        .any(|field| plain(&field.name) == plain(word))
    {
        Some("is also the name of a field")
    } else {
        None
    }
}

/// Returns a text in lower case, with `_` and `-` as spaces.
fn plain(text: &str) -> String {
    text.to_lowercase().replace(['_', '-'], " ")
}

fn short(text: &str) -> String {
    text.escape_default().take(60).collect()
}
