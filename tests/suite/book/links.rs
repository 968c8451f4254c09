//! Checks the book's references: every page is in SUMMARY.md, and every link and every heading in a link exists.
//!
//! In: the pages as Markdown, and the book as mdBook writes it (`make book`).

use super::page::{Page, pages};
use crate::suite::support::root;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

#[test]
fn every_page_of_the_book_is_in_its_summary_once() {
    let pages = pages(root());
    let summary = pages.iter().find(|page| page.path == "docs/SUMMARY.md");
    let mut listed: Vec<String> = links(summary.unwrap())
        .iter()
        .map(|link| format!("docs/{link}"))
        .collect();
    listed.sort();
    let is_chapter =
        |page: &&Page| page.path.starts_with("docs/") && page.path != "docs/SUMMARY.md";
    let chapters: Vec<String> = pages
        .iter()
        .filter(is_chapter)
        .map(|page| page.path.clone())
        .collect();
    let differ = |of: &[String], other: &[String]| -> Vec<String> {
        let is_new = |page: &&String| !other.contains(page);
        of.iter().filter(is_new).cloned().collect()
    };
    let (missing, unknown) = (differ(&chapters, &listed), differ(&listed, &chapters));
    assert!(
        listed == chapters,
        "docs/SUMMARY.md lacks {missing:?}, and lists {unknown:?}, which do not exist; each page is listed once"
    );
}

#[test]
fn decisions_are_listed_under_their_own_titles() {
    let pages = pages(root());
    let lists = ["decisions/README.md", "SUMMARY.md"].map(|list| {
        (
            list,
            fs::read_to_string(root().join("docs").join(list)).unwrap(),
        )
    });
    let mut n_records = 0;
    for page in &pages {
        let Some(file) = page.path.strip_prefix("docs/decisions/") else {
            continue;
        };
        if file == "README.md" {
            continue;
        }
        n_records += 1;
        let text = fs::read_to_string(root().join(&page.path)).unwrap();
        let title = text.lines().next().unwrap().trim_start_matches("# ");
        for (list, text) in &lists {
            let beside = if *list == "SUMMARY.md" {
                "decisions/"
            } else {
                ""
            };
            let entry = format!("[{title}]({beside}{file})");
            assert!(text.contains(&entry), "docs/{list} lacks {entry}");
        }
    }
    assert!(n_records > 60, "only {n_records} records were found");
}

#[test]
fn every_link_between_pages_leads_somewhere() {
    let pages = pages(root());
    let mut n_links = 0;
    for page in &pages {
        for link in links(page) {
            n_links += 1;
            let (file, heading) = link.split_once('#').unwrap_or((&link, ""));
            let target = match file {
                "" => page.path.clone(),
                file => resolved(&page.path, file),
            };
            assert!(
                root().join(&target).exists(),
                "{}: `{link}` leads nowhere",
                page.path
            );
            if let Some(target) = pages.iter().find(|page| page.path == target) {
                let is_there = heading.is_empty() || headings(target).contains(heading);
                assert!(is_there, "{}: no heading is `{link}`", page.path);
            }
        }
    }
    assert!(n_links > 100, "only {n_links} links were found");
}

#[test]
#[ignore = "needs mdBook"]
fn peer_mdbook_builds_the_book_and_every_link_in_it_leads_somewhere() {
    let made = Command::new("sh")
        .arg(root().join("scripts/book.sh"))
        .env("FABC_NO_INSTALL", "1")
        .output()
        .unwrap();
    let (said, complaints) = (
        String::from_utf8(made.stdout).unwrap(),
        String::from_utf8(made.stderr).unwrap(),
    );
    assert!(made.status.success(), "{complaints}");
    assert!(
        !complaints.contains("WARN") && !complaints.contains("ERROR"),
        "{complaints}"
    );
    let book = Path::new(said.lines().last().unwrap()).parent().unwrap();
    let (mut n_pages, mut n_links) = (0, 0);
    for page in pages(root()) {
        let Some(chapter) = page
            .path
            .strip_prefix("docs/")
            .and_then(|path| path.strip_suffix(".md"))
        else {
            continue;
        };
        if chapter == "SUMMARY" {
            continue;
        }
        n_pages += 1;
        // mdBook turns a folder's README into its index.
        let chapter = chapter.replace("README", "index");
        let file = book.join(format!("{chapter}.html"));
        let html = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{chapter}: {error}"));
        for target in ["href=\"", "src=\""]
            .iter()
            .flat_map(|attribute| attributes(&html, attribute))
        {
            if target.contains("://") || target.starts_with("data:") {
                continue;
            }
            n_links += 1;
            let (path, heading) = target.split_once('#').unwrap_or((&target, ""));
            let linked = match path {
                "" => file.clone(),
                path => file.parent().unwrap().join(path),
            };
            assert!(linked.exists(), "{chapter}: `{target}` leads nowhere");
            if !heading.is_empty() {
                let text = fs::read_to_string(&linked).unwrap();
                assert!(
                    text.contains(&format!("id=\"{heading}\"")),
                    "{chapter}: no heading is `{target}`"
                );
            }
        }
    }
    assert!(
        n_pages > 80 && n_links > 1000,
        "{n_pages} pages, {n_links} links"
    );
}

/// The targets of a page's links to files, outside blocks.
fn links(page: &Page) -> Vec<String> {
    let mut text = page.text.clone();
    for block in &page.blocks {
        text = text.replacen(&block.text, "", 1);
    }
    let targets = text.split("](").skip(1);
    targets
        .filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target.to_owned())
        .filter(|target| !target.contains("://"))
        .collect()
}

/// A link's target as a path from the project's root.
fn resolved(page: &str, link: &str) -> String {
    let mut path = PathBuf::from(page);
    path.pop();
    for part in link.split('/') {
        match part {
            ".." => drop(path.pop()),
            part => path.push(part),
        }
    }
    path.to_str().unwrap().replace('\\', "/")
}

/// The anchors of a page's headings.
fn headings(page: &Page) -> BTreeSet<String> {
    let mut text = page.text.clone();
    for block in &page.blocks {
        text = text.replacen(&block.text, "", 1);
    }
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings
        .map(|line| {
            let words = line.trim_start_matches('#').trim().to_lowercase();
            let kept = words
                .chars()
                .filter(|it| it.is_alphanumeric() || " -_".contains(*it));
            kept.collect::<String>().replace(' ', "-")
        })
        .collect()
}

/// The values of an attribute.
fn attributes(html: &str, opening: &str) -> Vec<String> {
    let values = html.split(opening).skip(1);
    values
        .filter_map(|rest| rest.split_once('"'))
        .map(|(value, _)| value.to_owned())
        .collect()
}
