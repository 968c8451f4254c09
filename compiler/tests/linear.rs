//! Parsing takes linear work, counted instead of timed.
//!
//! pest counts its calls and gives up beyond a limit for the whole process, so this is one test in its own binary.
//! The limit of an input is ten times the calls that a tenth of it needs, plus some slack.

#![allow(clippy::unwrap_used)]

#[path = "suite/common/inputs.rs"]
mod inputs;

use fab_grammar::Problem;
use std::num::NonZeroUsize;

const SMALL_BYTES: usize = 1_500;
const LARGE_BYTES: usize = 15_000;

/// How much more than ten times the calls ten times the text may need, because its beginning and end are not
/// repeated.
const SLACK: f64 = 1.15;

/// Returns whether a text is parsed within this many calls.
fn is_parsed_within(text: &str, calls: usize) -> bool {
    fab_grammar::limit_calls(NonZeroUsize::new(calls));
    let parsed = fab_grammar::parse(fab_grammar::FileId::FIRST, text);
    fab_grammar::limit_calls(None);
    let gave_up = matches!(
        parsed.faults.as_slice(),
        [fault] if fault.span.range() == (0..text.len()) && matches!(fault.problem, Problem::TooDeep { .. })
    );
    !gave_up
}

/// Returns the number of calls that a text needs.
fn calls(text: &str) -> usize {
    let mut too_few = 0;
    let mut enough = 1 << 10;
    while !is_parsed_within(text, enough) {
        too_few = enough;
        enough *= 2;
    }
    while enough - too_few > enough / 200 + 1 {
        let middle = too_few + (enough - too_few) / 2;
        if is_parsed_within(text, middle) {
            enough = middle;
        } else {
            too_few = middle;
        }
    }
    enough
}

#[test]
#[ignore = "long"]
fn ten_times_the_text_needs_at_most_ten_times_the_calls() {
    let mut wrong = Vec::new();
    for input in inputs::all() {
        let (small, large) = (input.text(SMALL_BYTES), input.text(LARGE_BYTES));
        let ratio = large.len() as f64 / small.len() as f64;
        let allowed = (calls(&small) as f64 * ratio * SLACK) as usize;
        if !is_parsed_within(&large, allowed) {
            wrong.push(format!(
                "{}: more than {allowed} calls for {} bytes",
                input.name,
                large.len()
            ));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}
