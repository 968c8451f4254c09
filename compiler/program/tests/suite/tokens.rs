//! How many tokens a text is taken for.

use fab_program::tokens::of_text;

#[test]
fn text_counts_letters_and_not_bytes() {
    assert_eq!(
        ["", "a", "abcd", "abcde", "äöüß"].map(of_text),
        [0, 1, 1, 2, 1]
    );
}
