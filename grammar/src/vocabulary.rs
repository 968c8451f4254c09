//! The words of the language, and the names of grammar rules in "expected …" messages.
//!
//! The words are written only in `fab.pest`; this module reads them from its text.

use crate::rules::Rule;
use crate::tree::Kind;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

const GRAMMAR: &str = include_str!("fab.pest");

/// The rules of one keyword, each with its word in backticks.
static WORDS: LazyLock<BTreeMap<Rule, String>> = LazyLock::new(|| {
    let word = |rule: &Rule| {
        let name = format!("{rule:?}");
        Some((*rule, format!("`{}`", name.strip_suffix("_word")?)))
    };
    // These two stand for several words.
    let is_one = |rule: &&Rule| !matches!(rule, Rule::statement_word | Rule::setting_word);
    Rule::all_rules()
        .iter()
        .filter(is_one)
        .filter_map(word)
        .collect()
});

/// Returns the word of the language with which `rule` begins, if it is always the same.
pub(crate) fn word(rule: Rule) -> Option<&'static str> {
    let quoted = WORDS.get(&rule).map(String::as_str);
    let word = quoted.or_else(|| expectation(rule))?.trim_matches('`');
    word.bytes()
        .all(|letter| letter.is_ascii_lowercase())
        .then_some(word)
}

/// Returns a readable name for what `rule` matches; `None` if the rule does not help the reader.
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
        Rule::quantity | Rule::number | Rule::amount => "a number",
        Rule::block_text
        | Rule::string
        | Rule::triple
        | Rule::quote
        | Rule::curly_text
        | Rule::curly_string
        | Rule::single_string => "a text in quotes",
        Rule::r#move => "a fold such as `corner(back_left) -> center`",
        Rule::pair => "a pixel such as `(12px, 40px)`",
        Rule::saying => "a component or a text",
        Rule::picture => "a picture such as `subgoal(now)`",
        Rule::setting => "a setting such as `temperature 0`",
        Rule::argument => "an argument",
        Rule::compare => "a comparison",
        Rule::one_word => "`one of`",
        Rule::open => "`{`",
        Rule::close => "`}`",
        Rule::open_paren => "`(`",
        Rule::close_paren => "`)`",
        Rule::comma => "`,`",
        Rule::colon => "`:`",
        Rule::equals => "`=`",
        Rule::arrow => "`->`",
        Rule::above => "`>`",
        Rule::in_stage => "`in`",
        Rule::cited => return expectation(Rule::from_word),
        Rule::fold => return expectation(Rule::fold_word),
        Rule::reply => return expectation(Rule::reply_word),
        Rule::check => return expectation(Rule::check_word),
        Rule::else_skip | Rule::else_refuse => return expectation(Rule::else_word),
        Rule::twin => return expectation(Rule::twin_word),
        Rule::choose => return expectation(Rule::choose_word),
        Rule::revise => return expectation(Rule::revise_word),
        Rule::trust => return expectation(Rule::trust_word),
        Rule::guard => return expectation(Rule::when_word),
        Rule::relax => return expectation(Rule::then_word),
        Rule::margin => return expectation(Rule::of_word),
        Rule::with_picture => return expectation(Rule::with_word),
        Rule::retries => return expectation(Rule::retries_word),
        // The other expected tokens are enough.
        Rule::any_word | Rule::not_word => return None,
        _ => return WORDS.get(&rule).map(String::as_str),
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
            | Rule::else_refuse
            | Rule::retries
            | Rule::cited
            | Rule::unit
            | Rule::apart_unit
            | Rule::open_paren
    )
}

/// The kinds of block, each with the strict rule of its lines.
const BLOCKS: &[(Rule, Rule)] = &[
    (Rule::file, Rule::only_item),
    (Rule::experts, Rule::only_sequence),
    (Rule::material, Rule::only_property),
    (Rule::sequence, Rule::only_fold),
    (Rule::task, Rule::only_section),
    (Rule::variant, Rule::only_part),
    (Rule::subgoals, Rule::only_subgoals_line),
    (Rule::demonstrate, Rule::only_fold),
    (Rule::keypoints, Rule::only_keypoint),
    (Rule::annotate, Rule::only_keypoint),
    (Rule::actions, Rule::only_field),
    (Rule::stage, Rule::only_stage_line),
    (Rule::example, Rule::only_example_line),
    (Rule::rehearse, Rule::only_rehearse_line),
    (Rule::verify, Rule::only_verify_line),
    (Rule::test, Rule::only_test_line),
];

/// A kind of block, and the words that may begin a line of it.
#[derive(Clone, Debug)]
pub struct Block {
    /// The kind of its nodes.
    pub kind: Kind,
    /// Its keyword; `file` for a whole file.
    pub name: String,
    /// The words in the order of the reference; empty if lines begin with a name.
    pub words: Vec<&'static str>,
    /// The strict rule of its lines.
    pub(crate) line: Rule,
}

/// Returns every kind of block, outer ones first.
pub fn blocks() -> &'static [Block] {
    static ALL: LazyLock<Vec<Block>> = LazyLock::new(|| {
        let block = |(block, line): &(Rule, Rule)| Block {
            kind: Kind::of(*block),
            name: format!("{block:?}"),
            words: first_words(&format!("{line:?}")),
            line: *line,
        };
        BLOCKS.iter().map(block).collect()
    });
    &ALL
}

/// Returns the block of a node's kind, if it is a block.
pub(crate) fn block(kind: Kind) -> Option<&'static Block> {
    blocks().iter().find(|block| block.kind == kind)
}

/// Returns the words that may begin a line in a block; empty if lines begin with names, or if `kind` is not a block.
pub fn words(kind: Kind) -> &'static [&'static str] {
    block(kind).map_or(&[], |block| &block.words)
}

/// Returns the words that cannot be names: those that begin or join statements, and Jinja's keywords.
pub fn keywords() -> &'static [&'static str] {
    static ALL: LazyLock<Vec<&str>> = LazyLock::new(|| first_words("keyword"));
    &ALL
}

/// Returns whether a word cannot be a name.
pub fn is_keyword(word: &str) -> bool {
    keywords().contains(&word)
}

/// Collects the words that a text of the rule can begin with, in the order of the grammar.
///
/// Recursion ends because no rule of the grammar begins with itself.
fn first_words(rule: &str) -> Vec<&'static str> {
    let mut words = Vec::new();
    // Whether the next token is at the beginning, here and at each open bracket.
    let mut is_first = true;
    let mut brackets = vec![is_first];
    for sign in signs(definition(rule)) {
        match sign {
            "(" => brackets.push(is_first),
            ")" => {
                brackets.pop();
                is_first = false;
            }
            "|" => is_first = brackets.last().copied().unwrap_or(true),
            "SOI" | "~" | "&" => {}
            _ if is_first => {
                is_first = false;
                let found = match sign.strip_prefix('"') {
                    Some(quoted) => vec![quoted.trim_end_matches('"')],
                    None => first_words(sign),
                };
                words.extend(found);
            }
            _ => {}
        }
    }
    let mut seen = BTreeSet::new();
    words.retain(|word| {
        word.starts_with(|first: char| first.is_ascii_alphabetic()) && seen.insert(*word)
    });
    words
}

/// Returns the text between a rule's braces; empty if the grammar has no such rule.
fn definition(rule: &str) -> &'static str {
    let rule = GRAMMAR.split_once(&format!("\n{rule} "));
    let body = rule
        .and_then(|(_, rest)| rest.split_once("}\n"))
        .and_then(|(rule, _)| rule.split_once('{'));
    body.map_or("", |(_, body)| body)
}

/// Splits a rule into its names, quoted words and signs.
fn signs(rule: &str) -> impl Iterator<Item = &str> {
    let mut rest = rule;
    std::iter::from_fn(move || {
        rest = rest.trim_start();
        let first = rest.chars().next()?;
        let is_word = |character: char| character.is_ascii_alphanumeric() || character == '_';
        let length = match first {
            '"' => rest[1..].find('"').map_or(rest.len(), |end| end + 2),
            _ if is_word(first) => rest.find(|next| !is_word(next)).unwrap_or(rest.len()),
            _ => first.len_utf8(),
        };
        let (sign, after) = rest.split_at(length);
        rest = after;
        Some(sign)
    })
}

#[cfg(test)]
mod tests;
