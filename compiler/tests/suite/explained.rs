//! Explanations are true: each example has its code, and the pages of the book are generated from them.

use crate::common::{Memory, workspace};
use fab_compiler::diag::{CODES, Code, GROUPS};
use fab_compiler::explain::{self, HALF};
use std::fs;

/// Codes whose examples would be too large to show.
const WITHOUT_EXAMPLE: [&str; 3] = ["F0001", "F0004", "F0605"];

fn codes_of(text: &str) -> Vec<Code> {
    let files = Memory::of([("example.fab", text), ("half.fab", HALF)]);
    let compiled = fab_compiler::compile("example.fab", &files).unwrap();
    compiled.diagnostics.into_iter().map(|it| it.code).collect()
}

#[test]
fn the_wrong_version_of_an_example_has_its_fault_alone_and_the_right_one_has_none() {
    let mut wrong = Vec::new();
    for code in CODES.iter().map(|entry| entry.code) {
        let Some(example) = explain::example(code) else {
            assert!(
                WITHOUT_EXAMPLE.contains(&code.as_str()),
                "{}",
                code.as_str()
            );
            continue;
        };
        if codes_of(&example.wrong).iter().any(|found| *found != code)
            || codes_of(&example.wrong).is_empty()
        {
            wrong.push(format!(
                "{}:\n{}",
                code.as_str(),
                explain::report_of(&example.wrong)
            ));
        }
        if !codes_of(&example.right).is_empty() {
            wrong.push(format!(
                "{}, right:\n{}",
                code.as_str(),
                explain::report_of(&example.right)
            ));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn examples_extend_the_first_task_of_the_language_page() {
    let page = fs::read_to_string(workspace().join("docs/language.md")).unwrap();
    let (_, task) = page.split_once("```fab\n").unwrap();
    let (task, _) = task.split_once("```\n").unwrap();
    assert_eq!(HALF, task);
}

#[test]
fn every_code_is_in_a_group_and_in_the_list() {
    let list = explain::list();
    for entry in CODES {
        let code = entry.code.as_str();
        let of = GROUPS.iter().filter(|(prefix, _)| code.starts_with(prefix));
        assert_eq!(of.count(), 1, "{code}");
        assert!(list.contains(&format!("{code}  {}", entry.severity.as_str())));
        let text = explain::to_text(entry.code);
        assert!(text.contains(entry.title) && text.contains(entry.explanation));
        let shows_example = text.contains("For example:") && text.contains("Right would be:");
        assert_eq!(shows_example, !WITHOUT_EXAMPLE.contains(&code), "{code}");
    }
}

#[test]
fn the_pages_of_the_book_are_those_that_are_made_from_the_codes() {
    let folder = workspace().join("docs/diagnostics");
    let pages = explain::pages();
    if std::env::var_os("FABC_WRITE_DOCS").is_some() {
        fs::create_dir_all(&folder).unwrap();
        for (name, text) in &pages {
            fs::write(folder.join(name), text).unwrap();
        }
    }
    let mut there: Vec<String> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    there.sort();
    let mut expected: Vec<String> = pages.iter().map(|(name, _)| name.clone()).collect();
    expected.sort();
    assert_eq!(
        there, expected,
        "pages of codes that there are not, or the reverse"
    );
    for (name, text) in &pages {
        let page = fs::read_to_string(folder.join(name)).unwrap();
        assert_eq!(
            &page, text,
            "docs/diagnostics/{name} is stale: `fabc explain --pages docs/diagnostics` writes it anew"
        );
    }
}
