//! The review on a terminal: one group at a time, one key each.
//!
//! In: pending snapshots, and keys. Out: changed folders, and the decisions. A settled snapshot is written at once, so
//! quitting keeps it; partial acceptances are discarded on quit.

use super::decide::{self, Decision, Decisions};
use super::show;
use crate::exit::{Exit, Failure};
use crate::io::Io;
use console::{Key, Term};
use std::ops::Range;

const KEYS: &str = "\
a  accept: from now on this is what is compared with
r  reject: what is pending goes, what was accepted stays
s  skip: it stays pending
A  accept all that are left
q  quit, as Ctrl-C and Ctrl-D do; what was settled is kept
?  these keys";
const PROMPT: &str = "[a]ccept [r]eject [s]kip [A]ccept all left [q]uit [?] ";
/// The character that Ctrl-D sends.
const END_OF_INPUT: char = '\u{4}';

/// Shows each group in turn and applies the decisions.
pub fn run(mut decisions: Decisions<'_>, io: &Io) -> Result<Exit, Failure> {
    let ended = go_through(&mut decisions, io);
    decisions.outcome().report(io);
    ended
}

fn go_through(decisions: &mut Decisions<'_>, io: &Io) -> Result<Exit, Failure> {
    let groups = decisions.groups;
    for (number, group) in groups.iter().enumerate() {
        if group.members.iter().all(|at| decisions.is_settled(*at)) {
            // Another edit of all these snapshots was rejected.
            continue;
        }
        io.data(&format!("\n{} of {}", number + 1, groups.len()));
        io.painted_data(&show::group(group, decisions.pending, io.data_color()));
        let this = number..number + 1;
        loop {
            match key()? {
                Key::Char('a') => decide(decisions, this, Decision::Accept, io)?,
                Key::Char('r') => decide(decisions, this, Decision::Reject, io)?,
                Key::Char('s') => {}
                Key::Char('A') => {
                    decide(decisions, number..groups.len(), Decision::Accept, io)?;
                    return Ok(Exit::Done);
                }
                Key::Char('q' | END_OF_INPUT) => return Ok(Exit::Done),
                Key::CtrlC => return Ok(Exit::Interrupted),
                Key::Char('?') => {
                    io.data(KEYS);
                    continue;
                }
                _ => continue,
            }
            break;
        }
    }
    Ok(Exit::Done)
}

fn decide(
    decisions: &mut Decisions<'_>,
    groups: Range<usize>,
    decision: Decision,
    io: &Io,
) -> Result<(), Failure> {
    for group in groups {
        decisions.decide(group, decision);
    }
    decisions.apply()?;
    let n_waiting = decisions.outcome().waiting.len();
    if n_waiting > 0 {
        io.data(&decide::waiting(n_waiting));
    }
    Ok(())
}

/// Asks for a key, on a line of its own.
fn key() -> Result<Key, Failure> {
    let term = Term::stdout();
    term.write_str(PROMPT)?;
    term.flush()?;
    let key = term.read_key_raw()?;
    let echo = match key {
        Key::Char(letter) if !letter.is_control() => letter.to_string(),
        _ => String::new(),
    };
    term.write_line(&echo)?;
    Ok(key)
}
