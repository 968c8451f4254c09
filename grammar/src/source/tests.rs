//! Tests where lines and columns are.

use super::*;

#[test]
fn lines_and_columns_are_counted_from_one_and_columns_in_characters() {
    let mut sources = Sources::default();
    let text = "a\n\né→b\r\nc";
    let file = sources.add("a.fab".to_owned(), text.to_owned());
    let place = |part: &str| {
        let byte = text.find(part).unwrap_or(text.len());
        sources.get(file).line_and_column(byte)
    };
    let places = ["a", "é", "b", "c", "nowhere"].map(place);
    assert_eq!(places, [(1, 1), (3, 1), (3, 3), (4, 1), (4, 2)]);
}
