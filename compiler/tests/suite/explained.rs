//! Explanations are true: each example has its code, and the pages of the book are generated from them.

use crate::common::{Memory, workspace};
use fab_compiler::diag::{CODES, Code, CodeEntry, GROUPS};
use fab_compiler::explain::{self, Example, HALF, HALF_FILE, example, report_of};
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
fn codes_are_in_the_order_of_their_numbers_and_each_is_found_by_it() {
    assert!(CODES.is_sorted_by_key(|entry| entry.code.as_str()));
    for entry in CODES {
        let number = entry.code.as_str();
        assert_eq!(Code::parse(&number.to_lowercase()), Some(entry.code));
        assert_eq!(entry.code.entry().code, entry.code);
    }
    assert_eq!(Code::parse("F9999"), None);
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
        assert!(text.contains(entry.title()) && text.contains(&entry.explanation()));
        let shows_example = text.contains("For example:") && text.contains("Right would be:");
        assert_eq!(shows_example, !WITHOUT_EXAMPLE.contains(&code), "{code}");
    }
}

#[test]
fn the_pages_of_the_book_are_those_that_are_made_from_the_codes() {
    let folder = workspace().join("docs/diagnostics");
    let pages = pages();
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
            "docs/diagnostics/{name} is stale: `FABC_WRITE_DOCS=1` before this test writes it anew"
        );
    }
}

/// Returns the pages of the book: the name of each file, `index.md` first, and its text.
fn pages() -> Vec<(String, String)> {
    let mut pages = vec![("index.md".to_owned(), index())];
    pages.extend(CODES.iter().map(|entry| (file_of(entry), page(entry))));
    pages
}

fn file_of(entry: &CodeEntry) -> String {
    format!("{}.md", entry.code.as_str())
}

fn index() -> String {
    let mut text = "# Diagnostics\n\nWhat the compiler says, by its codes. `fabc explain CODE` shows the same in a \
                    terminal. An *error* keeps a task\nfrom running; with a *warning* it runs, but probably not as intended; \
                    a *note* is good to know.\n"
        .to_owned();
    for (prefix, about) in GROUPS {
        text.push_str(&format!(
            "\n## {prefix}: {about}\n\n| code | severity | what |\n|---|---|---|\n"
        ));
        for entry in CODES
            .iter()
            .filter(|it| it.code.as_str().starts_with(prefix))
        {
            let (code, file) = (entry.code.as_str(), file_of(entry));
            let severity = entry.severity.as_str();
            text.push_str(&format!(
                "| [{code}]({file}) | {severity} | {} |\n",
                entry.title()
            ));
        }
    }
    text
}

fn page(entry: &CodeEntry) -> String {
    let (code, severity) = (entry.code.as_str(), entry.severity.as_str());
    let group = GROUPS.iter().find(|(prefix, _)| code.starts_with(prefix));
    let about = group.map_or("", |(_, about)| *about);
    let mut text = format!(
        "# {code}: {}\n\n*{severity}*, {about}\n\n{}\n",
        entry.title(),
        entry.explanation()
    );
    if let Some(Example { wrong, right }) = example(entry.code) {
        let report = report_of(&wrong);
        text.push_str(&format!(
            "\n## Wrong\n\n```fab wrong\n{wrong}```\n\n```text\n{report}```\n\n## Right\n\n```fab\n{right}```\n"
        ));
        if wrong.contains(HALF_FILE) || right.contains(HALF_FILE) {
            text.push_str("\n`half.fab` is [the first task of the language page](../language.md#a-whole-task).\n");
        }
    }
    text
}
