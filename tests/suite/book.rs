//! Checks the book: every file and every command in it is run, in page order, in a folder of its own.
//!
//! In: README.md, ARCHITECTURE.md and the pages of `docs/`. `book/walk.rs` defines the kinds of blocks. If a page
//! differs from the real output, the difference is shown, and `FABC_WRITE_DOCS=1` rewrites the page.

mod links;
mod matching;
pub mod page;
mod walk;

use super::support::root;
use crate::recorded_data::recorded_data;
use page::{Block, Page, pages};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{fs, thread};
use walk::{Pace, Walked, walk};

/// Pages in parallel: more would not help, since each command starts its own threads.
const SIDE_BY_SIDE: usize = 2;

/// The variable that has differing pages rewritten.
const WRITE: &str = "FABC_WRITE_DOCS";

#[test]
#[ignore = "long"]
fn every_block_of_the_book_does_what_its_page_says() {
    let walked = walk_all(&pages(root()), &Pace::Fast);
    let n_files: usize = walked.iter().map(|walked| walked.n_files).sum();
    let n_commands: usize = walked.iter().map(|walked| walked.n_commands).sum();
    assert!(n_files > 25, "only {n_files} files were compiled");
    assert!(n_commands > 20, "only {n_commands} commands were run");
}

#[test]
#[ignore = "long"]
fn slow_blocks_of_the_book_do_what_their_pages_say() {
    let is_slow = |page: &Page| page.blocks.iter().any(|block| block.info == "console slow");
    let mut pages = pages(root());
    pages.retain(is_slow);
    let data = recorded_data("long_slow_blocks_of_the_book_do_what_their_pages_say");
    if data.is_none() {
        pages.retain(|page| page.stated("recorded").is_empty());
    }
    walk_all(&pages, &Pace::Slow(data));
}

#[test]
fn the_library_example_of_the_simulator_page_is_the_one_that_rustdoc_runs() {
    let library = fs::read_to_string(root().join("sim/src/lib.rs")).unwrap();
    let is_rust = |block: &&Block| block.info == "rust";
    let pages = pages(root());
    let mut pages = pages.iter().filter(|page| page.path == "docs/simulator.md");
    let block = pages.next().unwrap().blocks.iter().find(is_rust).unwrap();
    let documented: String = block
        .text
        .lines()
        .map(|line| format!("{}\n", format!("//! {line}").trim_end()))
        .collect();
    assert!(
        library.contains(&documented),
        "sim/src/lib.rs lacks\n{documented}"
    );
}

#[test]
fn files_that_the_pages_for_developers_name_are_there() {
    let mut n_named = 0;
    for page in pages(root())
        .iter()
        .filter(|page| page.path.starts_with("docs/adding/"))
    {
        for span in page.text.split('`').skip(1).step_by(2) {
            let is_path = span.contains('/') && !span.contains([' ', ':', '\n']);
            if is_path {
                n_named += 1;
                assert!(
                    root().join(span).exists(),
                    "{}: there is no `{span}`",
                    page.path
                );
            }
        }
    }
    assert!(n_named > 30, "only {n_named} files are named");
}

#[test]
fn a_page_that_is_wrong_is_found_out() {
    for (text, words) in [
        ("```fab\ntask a {\n```\n", "F0103"),
        (
            "```fab file=a.fab\nuse \"half.fab\"\ntask a extends half { horizon 1 }\n```\n",
            "F0505",
        ),
        (
            "```fab wrong\ntask a { cloth grid(3, 3) }\n```\n",
            "to follow",
        ),
        (
            "```fab task wrong\nhorizon 2\n```\n```text\nx\n```\n",
            "nothing is wrong",
        ),
        (
            "```fab task\ntest \"a\" { given corners = (40px, 50px) given center = (60px, 60px)\n\
          given cloth = (40px, 50px) to (60px, 60px)\nreply \"?\" expect accept }\n```\n",
            "test `a`",
        ),
        (
            "```console\n$ fabc explain F9999\n```\n",
            "ends with 64, not 0",
        ),
        (
            "```console\n$ fabc explain F0301\nsomething else\n```\n",
            "-something else",
        ),
        ("```console\n$ make\n```\n", "`make` is no command"),
        ("```console\nfabc\n```\n", "begins with `$ `"),
        ("```console slow\nfabc\n```\n", "begins with `$ `"),
        ("```sh\nmake gold\n```\n", "`make gold` is no target"),
        ("```haskell\nx\n```\n", "no test runs"),
        ("```\nx\n```\n", "no test runs"),
        (
            "```rust from=src/main.rs\nfn main_no() {\n```\n",
            "does not stand in",
        ),
        (
            "```json file=a.json\n{}\n```\n```diff a.json\n-[]\n+{}\n```\n",
            "0 times",
        ),
    ] {
        let page = Page::read("page.md", text.to_owned()).unwrap();
        let wrong = walk(&page, &half(), &Pace::Fast).wrong.join("\n");
        assert!(wrong.contains(words), "{text}\n{wrong}");
    }
    assert!(Page::read("page.md", "```fab\ntask".to_owned()).is_err());
}

#[test]
fn files_edits_and_commands_of_a_page_follow_each_other() {
    let text = "```fab file=a.fab\nuse \"half.fab\"\ntask a extends half {\n    horizon 2\n}\n```\n\
                ```diff a.fab\n task a extends half {\n-    horizon 2\n+    horizon 1\n```\n\
                ```console\n$ cat a.fab\n...\n    horizon 1\n}\n```\n";
    let page = Page::read("page.md", text.to_owned()).unwrap();
    assert_eq!(
        walk(&page, &half(), &Pace::Fast).wrong,
        Vec::<String>::new()
    );
}

/// The complete task at the beginning of the language page.
fn half() -> String {
    let pages = pages(root());
    let language = pages.iter().find(|page| page.path == "docs/language.md");
    let is_fab = |block: &&Block| block.language() == "fab";
    let block = language.unwrap().blocks.iter().find(is_fab);
    block.unwrap().text.clone()
}

/// Processes pages; panics with all their faults, or rewrites them if asked to and if that suffices.
fn walk_all(pages: &[Page], pace: &Pace) -> Vec<Walked> {
    let half = half();
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..SIDE_BY_SIDE {
            scope.spawn(|| {
                while let Some(page) = pages.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let walked = walk(page, &half, pace);
                    done.lock().unwrap().push((page, walked));
                }
            });
        }
    });
    let done = done.into_inner().unwrap();
    assert_eq!(done.len(), pages.len());
    let mut wrong = Vec::new();
    for (page, walked) in &done {
        let is_only_stale = walked.wrong.len() == walked.changes.len();
        if std::env::var_os(WRITE).is_some() && !walked.changes.is_empty() {
            fs::write(root().join(&page.path), page.with(&walked.changes)).unwrap();
            if is_only_stale {
                continue;
            }
        }
        wrong.extend(walked.wrong.iter().cloned());
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    done.into_iter().map(|(_, walked)| walked).collect()
}
