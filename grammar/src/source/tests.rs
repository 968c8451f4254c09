//! Compares the marks with counting from the beginning.

use super::*;

#[test]
fn places_are_those_that_counting_from_the_beginning_gives() {
    let long = "é→x".repeat(400);
    for text in [
        "",
        "a",
        "\n",
        "a\n\nb\r\nc",
        &long,
        &format!("{long}\n{long}x\n\n"),
    ] {
        let mut sources = Sources::default();
        let file = sources.add("a.fab".to_owned(), text.to_owned());
        for byte in (0..=text.len()).filter(|byte| text.is_char_boundary(*byte)) {
            assert_eq!(
                sources.get(file).line_and_column(byte),
                line_and_column(text, byte),
                "byte {byte} of {text:?}"
            );
        }
    }
}
