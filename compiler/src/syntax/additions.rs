//! Mistakes in how a task changes what it inherits: the help names the way that works.

use crate::diag::{Code, Diagnostic, among, nearest};
use crate::lang::goal::METRICS;
use crate::lang::sections::{Inheritance, SECTIONS};
use fab_grammar::Span;

/// A word that does not begin a line in a block, and the way to write what it probably means.
struct Misplaced {
    /// The block's word.
    block: &'static str,
    word: &'static str,
    help: &'static str,
}

const fn misplaced(block: &'static str, word: &'static str, help: &'static str) -> Misplaced {
    Misplaced { block, word, help }
}

const IN_A_STAGE: &str = "it belongs in a `stage`; to change it, state the stage again: a stage replaces the inherited one of the same name";
const IN_VERIFY: &str = "it belongs in `verify`; a `verify` of this task's own replaces the inherited one, so state the inherited checks in it too";
const AS_IT_IS: &str = "a new part needs no word before it: write `component NAME \"…\"`, `check NAME { … } else \"…\"`, or `say NAME in STAGE after NAME`";

const LEFT_OUT: &str = "write `without component NAME`, `without check NAME` or `without variant NAME`; another section is stated again to change it";

const BEHIND_ELSE: &str =
    "the message of a check is behind `else`: write `check NAME { … } else \"…\"`";

/// Arguments that take a range.
const RANGED: [&str; 3] = ["size:", "friction:", "hue:"];

/// Words that people write, with the block in which they write them.
const MISPLACED: &[Misplaced] = &[
    misplaced(
        "task",
        "system",
        "write `say NAME in STAGE after NAME`: beside a part of `system`, it becomes a part of `system`",
    ),
    misplaced("task", "model", IN_A_STAGE),
    misplaced("task", "show", IN_A_STAGE),
    misplaced("task", "read", IN_A_STAGE),
    misplaced("task", "example", IN_A_STAGE),
    misplaced("task", "attempts", IN_VERIFY),
    misplaced("task", "result", IN_VERIFY),
    misplaced("task", "add", AS_IT_IS),
    misplaced("task", "append", AS_IT_IS),
    misplaced("task", "insert", AS_IT_IS),
    misplaced("task", "new", AS_IT_IS),
    misplaced("task", "extend", AS_IT_IS),
    misplaced("task", "remove", LEFT_OUT),
    misplaced("task", "delete", LEFT_OUT),
    misplaced("task", "drop", LEFT_OUT),
    misplaced("task", "omit", LEFT_OUT),
    misplaced("task", "exclude", LEFT_OUT),
    misplaced(
        "variant",
        "variant",
        "variants do not nest: write each in the task, beside the others",
    ),
    misplaced("stage", "vision", "write `model vision`"),
    misplaced("stage", "text", "write `model text`"),
    misplaced(
        "subgoals",
        "fold",
        "write `demonstrate { fold A -> B }`, with all folds between its braces",
    ),
    misplaced("verify", "else", BEHIND_ELSE),
    misplaced("verify", "then", BEHIND_ELSE),
    misplaced("verify", "otherwise", BEHIND_ELSE),
    misplaced("verify", "message", BEHIND_ELSE),
    misplaced(
        "verify",
        "override",
        "move `override check` out of `verify`, into the task; a `verify` of the task's own inherits no checks",
    ),
    misplaced(
        "verify",
        "without",
        "move `without check` out of `verify`, into the task",
    ),
];

/// Returns the help for an unknown word at the beginning of a line.
pub(super) fn help_for_word(word: &str, block: Option<&str>) -> Option<String> {
    let find = |block: &str| {
        let mut rows = MISPLACED.iter();
        rows.find(|row| (row.block, row.word) == (block, word))
    };
    let block = block?;
    let measure = METRICS.iter().find(|row| row.metric.as_str() == word);
    if let Some(row) = measure.filter(|_| matches!(block, "task" | "variant")) {
        return Some(format!(
            "a task's goal begins with `goal`: `{}`",
            row.example
        ));
    }
    // What a task may hold, a variant may hold too.
    let row = find(block).or_else(|| find("task").filter(|_| block == "variant"));
    row.map(|row| row.help.to_owned())
}

/// Makes the diagnostic for an unknown word behind `without` or `override`, unless it is a misspelt one that fits.
pub(super) fn behind_change(word: &str, span: Span, text: &str) -> Option<Diagnostic> {
    let fitting = ["check", "component", "variant"];
    let (fitting, help) = match statement(text[..span.start].trim_end()) {
        "without" => (&fitting[..], left_out(word, true)),
        "override" => (&fitting[..2], overridden(word)),
        _ => return None,
    };
    if nearest(word, fitting.iter().copied()).is_some() {
        return None;
    }
    let message = format!(
        "expected {}, found `{word}`",
        among(fitting.iter().copied())
    );
    Some(Diagnostic::new(Code::Unexpected, span, message).help(help))
}

/// Returns how to add to an inherited section instead: `verify += {` and `stage plan extends {` are not the way.
pub(super) fn added_to(section: &str) -> Option<String> {
    let merges = SECTIONS.iter().find(|row| row.word == section)?.merges;
    Some(match (section, merges) {
        ("verify", _) => {
            "to add a check, write `check NAME { … } else \"…\"` in the task, outside of `verify`"
                .to_owned()
        }
        ("stage", _) => {
            "to add to what a stage says, write `say NAME in STAGE after NAME` in the task, outside of its stages"
                .to_owned()
        }
        (_, Inheritance::ByName) => {
            "remove it: parts that are not stated again stay as they are inherited".to_owned()
        }
        _ => format!(
            "`{section}` replaces the inherited one: remove this, and state the inherited parts in it too"
        ),
    })
}

/// Returns the help for a token that does not fit.
///
/// - `found`: the token; `None` for the end of the line.
/// - `expected`: what would fit, in backticks where it is literal.
/// - `text`: the whole file.
pub(super) fn help(
    found: Option<&str>,
    span: Span,
    expected: &[&str],
    text: &str,
) -> Option<String> {
    let expects = |words: &str| expected.contains(&words);
    let before = text[..span.start].trim_end();
    let line = statement(before);
    let found = found.unwrap_or_default();
    if expected.is_empty() {
        let mut rows = MISPLACED.iter();
        let row = rows.find(|row| row.word == found && row.help == AS_IT_IS)?;
        return Some(row.help.to_owned());
    }
    let mut rows = MISPLACED.iter();
    if expected == ["`,`"]
        && fab_grammar::is_keyword(found)
        && let Some(row) = rows.find(|row| (row.block, row.word) == ("task", found))
    {
        return Some(row.help.to_owned());
    }
    if line == "override" && expects("`component`") {
        return Some(overridden(found));
    }
    if line == "without" && expects("`component`") {
        return Some(left_out(found, expects("`variant`")));
    }
    // `size: 0.9-1.1`
    let number = |it: char| it.is_ascii_digit() || it == '.';
    let label = before.trim_end_matches(number).trim_end();
    let is_range = label.len() < before.len() && RANGED.iter().any(|it| label.ends_with(it));
    let behind = text[span.start..].strip_prefix(['-', '–', '…']);
    if is_range && behind.is_some_and(|rest| rest.trim_start().starts_with(number)) {
        return Some("a range is written with `to`: `0.9 to 1.1`".to_owned());
    }
    let said = line.strip_prefix("say")?.trim();
    if matches!(found, "in" | "after" | "before") && expected == ["`,`"] {
        let help = "`say` in a stage lists what it says; `say NAME in STAGE after NAME` stands in the task, outside of its stages";
        return Some(help.to_owned());
    }
    if said.is_empty() && expects("a name") && found.starts_with('"') {
        let help =
            "declare the text, `component NAME \"…\"`, and write `say NAME in STAGE after NAME`";
        return Some(help.to_owned());
    }
    if expects("`in`") {
        let beside = text[span.start..].trim_start_matches(found).trim_start();
        let beside = beside.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
        let beside = { beside }.next().filter(|name| is_name(name));
        return Some(match (found, beside) {
            ("after" | "before", Some(beside)) => {
                format!("write `say {said} in STAGE {found} {beside}`")
            }
            _ => format!("write `say {said} in STAGE after NAME`"),
        });
    }
    if expects("`after`") {
        return Some(format!(
            "write `{line} after NAME`, or `before NAME`, with a component that the stage says"
        ));
    }
    if expects("a name") && found.starts_with('"') {
        let help = "name the component that it goes beside: the stage's `say` lists them";
        return Some(help.to_owned());
    }
    if found == "when" {
        let part = said.rsplit([',', ' ']).next().unwrap_or_default();
        let help = match is_name(part) {
            true => format!("a part of `say` has no condition; write it where the text is declared: `component {part} when … \"…\"`"),
            false => "a part of `say` has no condition; declare the text with one, `component NAME when … \"…\"`, and name it here".to_owned(),
        };
        return Some(help);
    }
    if said.ends_with(" in") && found == "stage" {
        return Some("write the stage's name alone, such as `in plan`".to_owned());
    }
    None
}

/// Returns the beginning of the statement that ends a text, from its last `say`, `override` or `without`, which may
/// stand behind another statement on the line.
fn statement(before: &str) -> &str {
    let line = before.rsplit(['\n', '{', '}']).next().unwrap_or(before);
    let (mut start, mut at, mut is_text) = (0, 0, false);
    for piece in line.split_inclusive([' ', '\t']) {
        if !is_text && matches!(piece.trim_end(), "say" | "override" | "without") {
            start = at;
        }
        is_text ^= piece.matches('"').count() % 2 == 1;
        at += piece.len();
    }
    line[start..].trim_start()
}

/// Returns how to replace something that `override` does not replace.
fn overridden(found: &str) -> String {
    let near = nearest(found, SECTIONS.iter().map(|row| row.word));
    let found = near.unwrap_or(found);
    let mut rows = SECTIONS.iter();
    match rows.find(|row| row.word == found).map(|row| row.merges) {
        Some(Inheritance::Whole) => {
            format!("write `{found}` without `override`: it replaces the inherited one")
        }
        Some(Inheritance::ByName) => format!(
            "write `{found}` without `override`: parts of the same name replace the inherited ones"
        ),
        _ if is_name(found) => {
            format!("write `override component {found}` or `override check {found}`")
        }
        _ => "write `override component NAME \"…\"` or `override check NAME { … } else \"…\"`"
            .to_owned(),
    }
}

/// Returns how to leave out something that `without` does not leave out.
///
/// - `in_task`: whether it stands in a task; a variant has no variants to leave out.
fn left_out(found: &str, in_task: bool) -> String {
    match found {
        "variant" if !in_task => {
            "write `without variant NAME` in the task, outside of its variants".to_owned()
        }
        _ if is_name(found) && nearest(found, SECTIONS.iter().map(|row| row.word)).is_none() => {
            format!("write `without component {found}`, or `without check {found}` for a check")
        }
        _ => "only components, checks and variants can be left out; state a stage or another section again to change it"
            .to_owned(),
    }
}

fn is_name(found: &str) -> bool {
    let is_word = found.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_');
    is_word && !fab_grammar::is_keyword(found)
}
