//! Tests that the lists of words in the grammar agree.

use super::*;

#[test]
fn the_words_of_blocks_are_read_from_the_grammar() {
    assert_eq!(words(Kind::File), ["use", "task", "experts", "material"]);
    assert_eq!(words(Kind::Verify), ["check", "attempts", "result"]);
    assert_eq!(words(Kind::Experts), ["sequence"]);
    assert_eq!(words(Kind::Keypoints), [""; 0]);
    assert!(words(Kind::Task).starts_with(words(Kind::Variant)));
    assert!(words(Kind::Task).ends_with(&["say", "verify", "check", "test", "variant", "ablate"]));
    assert!(words(Kind::Task).starts_with(&["const", "cloth", "camera"]));
}

/// Pest needs some lists twice, to look ahead; they must agree.
#[test]
fn lists_of_words_agree() {
    let sorted = |words: &[&'static str]| words.iter().copied().collect::<BTreeSet<_>>();
    let mut sections = sorted(&first_words("section_word"));
    sections.extend(["test", "say", "check", "rehearse"]);
    assert_eq!(sections, sorted(words(Kind::Task)));
    let mut listed = sorted(keywords());
    listed.extend(first_words("soft_word"));
    for rule in Rule::all_rules() {
        for word in first_words(&format!("{rule:?}")) {
            assert!(
                listed.contains(word),
                "`{word}` is neither a keyword nor a soft word"
            );
        }
    }
}

#[test]
fn keywords_name_nothing() {
    assert!(is_keyword("goal") && is_keyword("None"));
    assert!(!is_keyword("cloth") && !is_keyword("goals") && !is_keyword("_"));
}

/// A block that is missing there is swallowed by an unclosed text before it.
#[test]
fn an_unclosed_text_ends_before_every_named_section() {
    let listed = definition("runaway");
    let sections = blocks().iter().filter(|block| {
        let is_section = words(Kind::Task).contains(&block.name.as_str());
        is_section && block.kind != Kind::Experts
    });
    for block in sections {
        let word = format!("\"{}\"", block.name.as_str());
        assert!(listed.contains(&word), "`runaway` lacks {word}");
    }
}
