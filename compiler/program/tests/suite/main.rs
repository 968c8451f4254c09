//! The tests of programs and of the reading of answers, in one binary; `../answers.rs` reads the collected answers.

#![allow(clippy::unwrap_used)]

mod any_answer;
mod camera;
mod colours;
mod exact;
mod extractors;
#[path = "../../../tests/suite/common/growth.rs"]
mod growth;
mod linear;
mod manner;
mod measures;
mod page;
#[path = "../spaces/mod.rs"]
mod spaces;
mod statements;
mod tokens;
mod units;

use fab_program::Proposal;
use fab_program::pointing::Notation;
use fab_program::reply::{self, Malformed, Reading};

/// Reads an answer in a space of `answers/spaces.txt`.
fn read(space: &str, answer: &str) -> Result<Reading<Proposal>, Malformed> {
    let fields = spaces::space(space);
    reply::read_fields(&fields, spaces::EDGE_M, &Notation::pixels(), answer)
}
