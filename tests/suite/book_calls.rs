//! Checks the book against this command line: each call is parsed, including those that no test can run.
//!
//! In: the pages that `book::page` reads. The book's own test checks the output of calls.

use super::book::page::{self, Page};
use super::support::root;

/// Splits a call into words like a shell.
fn words_of(call: &str) -> Vec<String> {
    shlex::split(call).unwrap_or_else(|| panic!("`{call}` has a quote without an end"))
}

/// The parser's own name for the error of a call.
fn kind(error: &fabc::UsageError) -> String {
    format!("{:?}", error.kind())
}

fn pages() -> Vec<Page> {
    page::pages(root())
}

#[test]
fn every_call_in_a_block_can_be_parsed() {
    let mut n_calls = 0;
    for page in pages() {
        for block in page.blocks.iter().filter(|it| it.language() == "console") {
            let steps = block
                .steps()
                .unwrap_or_else(|wrong| panic!("{}: {wrong}", page.path));
            for step in steps.iter().filter(|step| step.command.starts_with("fabc")) {
                n_calls += 1;
                let parsed = fabc::command().try_get_matches_from(words_of(&step.command));
                let Err(error) = parsed else { continue };
                let is_help = ["DisplayHelp", "DisplayVersion"].contains(&kind(&error).as_str());
                let is_fine = is_help || step.code == 64;
                assert!(is_fine, "{}: {}: {error}", page.path, step.command);
            }
        }
    }
    assert!(n_calls > 20, "only {n_calls} calls were found");
}

/// Running text abbreviates: it may omit required arguments, and write `[--fix]`, `A|B` and `DIR…`.
#[test]
fn every_call_in_running_text_names_verbs_and_flags_that_there_are() {
    let mut n_calls = 0;
    for page in pages() {
        for call in inline_calls(&page) {
            n_calls += 1;
            let words = call.replace(['[', ']', '…'], "");
            let parsed = fabc::command().try_get_matches_from(words_of(&words));
            let Err(error) = parsed else { continue };
            let is_abbreviated = [
                "DisplayHelp",
                "DisplayHelpOnMissingArgumentOrSubcommand",
                "DisplayVersion",
                "MissingRequiredArgument",
                "MissingSubcommand",
            ]
            .contains(&kind(&error).as_str());
            // A value may be a placeholder in capitals, such as `--size N`.
            let is_spelt = ["ValueValidation", "InvalidValue"].contains(&kind(&error).as_str());
            assert!(
                is_abbreviated || is_spelt,
                "{}: `{call}`: {error}",
                page.path
            );
        }
    }
    assert!(n_calls > 20, "only {n_calls} calls were found");
}

/// Calls between single backticks, outside blocks.
fn inline_calls(page: &Page) -> Vec<String> {
    let mut text = page.text.clone();
    for block in &page.blocks {
        text = text.replacen(&block.text, "", 1);
    }
    let text = text.replace("```", "");
    let spans = text.split('`').skip(1).step_by(2);
    spans
        .map(|span| span.split_whitespace().collect::<Vec<_>>().join(" "))
        .filter(|span| span.starts_with("fabc "))
        .collect()
}

#[test]
fn every_verb_is_on_the_page_of_commands() {
    let pages = pages();
    let page = pages.iter().find(|page| page.path == "docs/commands.md");
    let page = page.expect("there is a page of commands");
    let help_of = |name: &str| format!("$ fabc {name} --help\n");
    for verb in fabc::command().get_subcommands() {
        let verbs = match verb.has_subcommands() {
            true => verb
                .get_subcommands()
                .filter(|it| !it.is_hide_set())
                .map(|it| format!("{} {}", verb.get_name(), it.get_name()))
                .collect(),
            false => vec![verb.get_name().to_owned()],
        };
        for name in verbs {
            assert!(
                page.text.contains(&help_of(&name)),
                "docs/commands.md lacks {name}"
            );
        }
    }
}
