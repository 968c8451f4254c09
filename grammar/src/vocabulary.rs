//! What the grammar's rules are called when one of them is expected.

use crate::rules::{FabParser, Rule};
use pest::Parser;

/// Returns how a person would name what `rule` matches; none where it says nothing by itself.
pub(crate) fn expectation(rule: Rule) -> Option<&'static str> {
    let words = match rule {
        Rule::name | Rule::label | Rule::path => "a name",
        Rule::target => "a unit",
        Rule::expr
        | Rule::conjunction
        | Rule::negation
        | Rule::relation
        | Rule::group
        | Rule::call
        | Rule::operand
        | Rule::heading => "a value",
        Rule::quantity | Rule::number => "a number",
        Rule::block_text | Rule::string | Rule::triple | Rule::quote | Rule::curly_text => {
            "a text in quotes"
        }
        Rule::curly_string | Rule::single_string => "a text in quotes",
        Rule::fold => "`fold`",
        Rule::r#move => "a fold such as `corner(back_left) -> center`",
        Rule::pair => "a pixel such as `(12px, 40px)`",
        Rule::saying => "a component or a text",
        Rule::picture => "a picture such as `subgoal(now)`",
        Rule::reply => "`reply`",
        Rule::setting => "a setting such as `temperature 0`",
        Rule::argument => "an argument",
        Rule::open => "`{`",
        Rule::close => "`}`",
        Rule::open_paren => "`(`",
        Rule::close_paren => "`)`",
        Rule::comma => "`,`",
        Rule::colon => "`:`",
        Rule::equals => "`=`",
        Rule::arrow => "`->`",
        Rule::compare => "a comparison",
        Rule::arrow_word => "`arrow`",
        Rule::at_word => "`at`",
        Rule::and_word => "`and`",
        Rule::component_word => "`component`",
        Rule::check | Rule::check_head | Rule::check_word => "`check`",
        Rule::else_word | Rule::else_skip => "`else`",
        Rule::guard | Rule::when_word => "`when`",
        Rule::in_word => "`in`",
        Rule::to_word => "`to`",
        Rule::then_word | Rule::relax => "`then`",
        Rule::without_word => "`without`",
        Rule::extends_word => "`extends`",
        Rule::from_word => "`from`",
        Rule::of_word | Rule::margin => "`of`",
        Rule::one_word => "`one of`",
        Rule::or_word => "`or`",
        Rule::with_word | Rule::with_picture => "`with`",
        Rule::picture_word => "`picture`",
        Rule::skip_word => "`skip`",
        Rule::overlap_word => "`overlap`",
        Rule::above => "`>`",
        Rule::retries_word | Rule::retries => "`retries`",
        Rule::within_word => "`within`",
        _ => return None,
    };
    Some(words)
}

/// Returns whether `rule` only continues a value that is complete without it.
pub(crate) fn is_continuation(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::and_word
            | Rule::or_word
            | Rule::compare
            | Rule::within_word
            | Rule::in_word
            | Rule::to_word
            | Rule::path
            | Rule::guard
            | Rule::when_word
            | Rule::relax
            | Rule::with_picture
            | Rule::else_skip
            | Rule::retries
            | Rule::unit
            | Rule::known_unit
            | Rule::open_paren
    )
}

/// The words that begin a file's items.
pub(crate) const ITEMS: &[&str] = &["use", "task", "experts"];

/// The words that begin a task's sections.
pub(crate) const SECTIONS: &[&str] = &[
    "const",
    "cloth",
    "camera",
    "picker",
    "goal",
    "horizon",
    "subgoals",
    "experts",
    "demos",
    "keypoints",
    "annotate",
    "actions",
    "component",
    "override",
    "without",
    "stage",
    "verify",
    "variant",
    "ablate",
    "test",
];

/// The words that begin a variant's sections: all but the last three of a task's.
pub(crate) fn parts() -> &'static [&'static str] {
    &SECTIONS[..SECTIONS.len() - 3]
}

/// The words that begin a line of `subgoals`.
pub(crate) const SUBGOALS: &[&str] = &["demonstrate", "image"];

/// The words that begin a line of a stage.
pub(crate) const STAGE: &[&str] = &["model", "show", "system", "say", "read", "example"];

/// The words that begin a line of an example.
pub(crate) const EXAMPLE: &[&str] = &["say", "image", "reply"];

/// The words that begin a line of a test.
pub(crate) const TEST: &[&str] = &["given", "reply", "expect"];

/// The words that begin a line of `verify`.
pub(crate) const VERIFY: &[&str] = &["check", "attempts", "result"];

/// Returns whether a word of the language can name nothing.
pub fn is_keyword(word: &str) -> bool {
    word.starts_with(|character: char| character.is_ascii_alphabetic() || character == '_')
        && word
            .bytes()
            .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
        && FabParser::parse(Rule::name, word).is_err()
}
