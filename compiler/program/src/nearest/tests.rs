//! Tests which words are near enough, and how long a list gets.

use super::*;

#[test]
fn a_swap_of_neighbours_is_one_slip() {
    assert_eq!(nearest("cneter", ["corners", "center"]), Some("center"));
    assert_eq!(nearest("stgae", ["stage"]), Some("stage"));
}

#[test]
fn a_far_word_is_not_suggested() {
    assert_eq!(nearest("ab", ["goal"]), None);
    assert_eq!(nearest("verfy", ["goal", "verify"]), Some("verify"));
}

#[test]
fn the_limit_is_a_third_of_the_word() {
    assert_eq!(nearest("kitten", ["mittens"]), Some("mittens"));
    assert_eq!(nearest("kitten", ["sitting"]), None);
}

#[test]
fn lists_that_are_long_are_cut() {
    let names: Vec<String> = (0..20).map(|number| number.to_string()).collect();
    let listed = among(names.iter().map(String::as_str));
    assert!(listed.ends_with("`11` or 8 more"), "{listed}");
    let listed = among(std::iter::repeat_n("corner", 1000));
    assert!(listed.ends_with("`corner` or many more"), "{listed}");
}
