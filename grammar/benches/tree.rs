//! Times the tree of a 500-line task: less than 2 ms on one core of 2020 or later.
//!
//! `cargo bench -p fab-grammar`

#![allow(missing_docs)]

use divan::Bencher;
use divan::counter::BytesCount;
use fab_grammar::FileId;

const LINES: usize = 500;

fn main() {
    divan::main();
}

/// Repeats the sections of a shipped task up to [`LINES`] lines.
fn task() -> String {
    let shipped = include_str!("../../tasks/lib/folding.fab");
    let (head, body) = shipped.split_once("{\n").expect("a task has a head");
    let (body, _) = body.rsplit_once('}').expect("a task ends with a brace");
    let sections = body.lines().cycle();
    let rest = LINES - head.lines().count() - 1;
    let lines: Vec<&str> = head
        .lines()
        .chain(["{"])
        .chain(sections.take(rest - 1))
        .chain(["}"])
        .collect();
    lines.join("\n")
}

#[divan::bench]
fn tree_of_500_lines(bencher: Bencher) {
    let text = task();
    bencher
        .counter(BytesCount::of_str(&text))
        .bench(|| fab_grammar::parse(FileId::FIRST, &text));
}
