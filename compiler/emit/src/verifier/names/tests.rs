//! Identifiers and literals.

use super::*;

fn of(names: &[&str]) -> Vec<String> {
    identifiers(names.iter().map(|name| (*name).to_owned()))
}

#[test]
fn identifiers_differ_from_reserved_words_and_from_each_other() {
    assert_eq!(of(&["pick", "type", "type_"]), ["pick", "type_", "type__"]);
    assert_eq!(of(&["lambda", "class", "fn"]), ["lambda_", "class_", "fn_"]);
    assert_eq!(
        of(&["_x", "9", "a b", "a_b"]),
        ["field_x", "field9", "a_b", "a_b_"]
    );
}

#[test]
fn literals_are_plain_ascii() {
    assert_eq!(
        rust_escaped("a\"\\\n\u{e9}\u{202e}"),
        "a\\\"\\\\\\n\\u{e9}\\u{202e}"
    );
    assert_eq!(
        python_escaped("a\"\\\n\u{e9}"),
        "a\\\"\\\\\\U0000000a\\U000000e9"
    );
}

#[test]
fn numbers_keep_their_bits_and_must_be_finite() {
    for value in [0.1, -0.0, 1e-300, 1e300, 224.0, f64::MIN_POSITIVE / 8.0] {
        let text = number(value).expect("a finite number");
        assert_eq!(
            text.parse::<f64>().expect("a number").to_bits(),
            value.to_bits()
        );
        assert!(
            text.contains(['.', 'e']),
            "{text} would be an integer in Python"
        );
    }
    assert!(number(f64::NAN).is_err() && number(f64::INFINITY).is_err());
}
