//! Tests of `terminal`.

use super::*;

#[test]
fn only_a_yes_confirms() {
    for (typed, expected) in [
        ("y\n", true),
        (" YES \n", true),
        ("what\n\nyes", true),
        ("n\ny\n", false),
        ("", false),
        ("perhaps\n", false),
    ] {
        let mut said = Vec::new();
        let mut say = |text: &str| said.push(text.to_owned());
        let mut lines = typed.as_bytes();
        let answer = choose(&mut || line_of(&mut lines), &mut say, "Move?", yes_or_no);
        assert_eq!(answer == Some(true), expected, "{typed:?}");
        assert_eq!(said[0], "Move?");
    }
    let many = "x\n".repeat(ATTEMPTS as usize) + "y\n";
    let mut lines = many.as_bytes();
    let next = &mut || line_of(&mut lines);
    assert_eq!(choose(next, &mut |_| {}, "Move?", yes_or_no), None);
}
