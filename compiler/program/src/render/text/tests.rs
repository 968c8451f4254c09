//! Tests which words and values a rendered text consists of.

use super::*;

fn template(text: &str) -> Template {
    Template {
        name: "role".to_owned(),
        when: None,
        text: text.to_owned(),
        variables: Vec::new(),
        declared_in: "a.fab".to_owned(),
        line: 7,
    }
}

/// The stretches of a template: their words, lines and variables.
fn stretches(text: &str, rendered: &str) -> Vec<(String, u32, Option<String>)> {
    let values = BTreeMap::from([
        ("corners".to_owned(), "(1, 2)".to_owned()),
        ("format".to_owned(), "Pick\nPlace {{ corners }}".to_owned()),
        ("nothing".to_owned(), String::new()),
    ]);
    let said = laid_over(&template(text), &values, rendered.to_owned());
    assert_eq!(said.text, rendered);
    let one = |stretch: Stretch| {
        let place = stretch.origin.place.map_or(0, |place| place.line);
        (
            said.text[stretch.bytes].to_owned(),
            place,
            stretch.origin.value,
        )
    };
    said.stretches.into_iter().map(one).collect()
}

fn words(text: &str, line: u32) -> (String, u32, Option<String>) {
    (text.to_owned(), line, None)
}

fn value(text: &str, line: u32, variable: &str) -> (String, u32, Option<String>) {
    (text.to_owned(), line, Some(variable.to_owned()))
}

#[test]
fn lines_and_values_are_told_apart() {
    let found = stretches(
        "Pick one of {{ corners }}.\n\n{{ format }}\nEnd{{ nothing }}",
        "Pick one of (1, 2).\n\nPick\nPlace {{ corners }}\nEnd",
    );
    let expected = [
        words("Pick one of ", 7),
        value("(1, 2)", 7, "corners"),
        words(".\n", 7),
        words("\n", 8),
        value("Pick\nPlace {{ corners }}", 9, "format"),
        words("\n", 9),
        words("End", 10),
    ];
    assert_eq!(found, expected);
}

#[test]
fn an_escaped_brace_is_words() {
    let found = stretches("a {{ \"{\" }}% b", "a {% b");
    let all: String = found.iter().map(|(words, ..)| words.as_str()).collect();
    assert_eq!(all, "a {% b");
    assert!(
        found
            .iter()
            .all(|(_, line, value)| *line == 7 && value.is_none())
    );
}

#[test]
fn a_template_of_another_form_counts_as_one_stretch() {
    for (text, rendered) in [
        ("{% if corners %}yes{% endif %}", "yes"),
        ("{{ corners | upper }}", "(1, 2)"),
        ("{{ unknown }}", "?"),
        ("{{ corners", "{{ corners"),
    ] {
        assert_eq!(stretches(text, rendered), [words(rendered, 7)], "{text}");
    }
}
