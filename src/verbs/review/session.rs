//! The review on a terminal: one group at a time, one key each.
//!
//! In: pending snapshots, and keys. Out: changed folders, and the decisions. A settled snapshot is written at once, so
//! quitting keeps it.

use super::decide::{Decision, Outcome};
use super::find::Pending;
use super::groups::Group;
use super::show;
use crate::exit::{Exit, Failure};
use crate::io::Io;
use console::{Key, Term};

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
pub fn run(pending: &[Pending], groups: &[Group], io: &Io) -> Result<Exit, Failure> {
    let mut outcome = Outcome::default();
    let ended = go_through(&mut outcome, pending, groups, io);
    outcome.report(pending.len(), io);
    ended
}

fn go_through(
    outcome: &mut Outcome,
    pending: &[Pending],
    groups: &[Group],
    io: &Io,
) -> Result<Exit, Failure> {
    for (number, group) in groups.iter().enumerate() {
        io.data(&format!("\n{} of {}", number + 1, groups.len()));
        io.painted_data(&show::group(group, pending, io.data_color()));
        loop {
            match key()? {
                Key::Char('a') => outcome.apply(Decision::Accept, group, pending)?,
                Key::Char('r') => outcome.apply(Decision::Reject, group, pending)?,
                Key::Char('s') => {}
                Key::Char('A') => {
                    for group in &groups[number..] {
                        outcome.apply(Decision::Accept, group, pending)?;
                    }
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
