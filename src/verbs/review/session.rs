//! The review on a terminal: one group at a time, one key each.
//!
//! In: pending snapshots, and keys. Out: changed folders, and the decisions. A settled snapshot is written at once, so
//! quitting keeps it; partial acceptances are discarded on quit.

use super::decide::{self, Decision, Decisions};
use super::groups::Kind;
use super::pictures;
use super::show::{self, Extent, View};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use console::{Key, Term};
use std::ops::Range;
use std::path::Path;

const KEYS: &str = "\
a  accept: from now on this is what is compared with
r  reject: what is pending goes, what was accepted stays
s  skip: it stays pending
f  all of the lists and texts, or the first of them
A  accept all that are left
q  quit, as Ctrl-C and Ctrl-D do; what was settled is kept
?  these keys";
const PROMPT: &str = "[a]ccept [r]eject [s]kip [f]ull [A]ccept all left [q]uit [?] ";
/// The character that Ctrl-D sends.
const END_OF_INPUT: char = '\u{4}';

/// A review under way.
pub struct Session<'r> {
    pub decisions: Decisions<'r>,
    /// The folder that gets the pictures of changes.
    pub sheets: &'r Path,
}

impl Session<'_> {
    /// Shows each group in turn and applies the decisions.
    ///
    /// Fails if there is no terminal, or if a folder cannot be changed.
    pub fn run(mut self, io: &Io) -> Result<Exit, Failure> {
        let ended = self.go_through(io);
        self.decisions.outcome().report(io);
        ended
    }

    fn go_through(&mut self, io: &Io) -> Result<Exit, Failure> {
        let groups = self.decisions.groups;
        let mut view = View {
            color: io.data_color(),
            extent: Extent::Folded,
        };
        for (number, group) in groups.iter().enumerate() {
            if group
                .members
                .iter()
                .all(|at| self.decisions.is_settled(*at))
            {
                // Another edit of all these snapshots was rejected.
                continue;
            }
            self.show(number, &view, io)?;
            loop {
                match key()? {
                    Key::Char('a') => self.decide(number..number + 1, Decision::Accept, io)?,
                    Key::Char('r') => self.decide(number..number + 1, Decision::Reject, io)?,
                    Key::Char('s') => {}
                    Key::Char('A') => {
                        self.decide(number..groups.len(), Decision::Accept, io)?;
                        return Ok(Exit::Done);
                    }
                    Key::Char('f') => {
                        view.extent = match view.extent {
                            Extent::Folded => Extent::Full,
                            Extent::Full => Extent::Folded,
                        };
                        self.show(number, &view, io)?;
                        continue;
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

    fn show(&self, number: usize, view: &View, io: &Io) -> Result<(), Failure> {
        let Decisions {
            pending, groups, ..
        } = self.decisions;
        let group = &groups[number];
        io.data(&format!("\n{} of {}", number + 1, groups.len()));
        io.painted_data(&show::group(group, pending, view));
        if group.kind == Kind::Picture {
            let first = &pending[group.members[0]];
            io.data(&pictures::compare(first, &group.id, self.sheets)?.in_words());
        }
        Ok(())
    }

    /// Decides about groups, and applies what that settles.
    fn decide(&mut self, groups: Range<usize>, decision: Decision, io: &Io) -> Result<(), Failure> {
        for group in groups {
            self.decisions.decide(group, decision);
        }
        self.decisions.apply()?;
        match self.decisions.outcome().waiting.len() {
            0 => {}
            count => io.data(&decide::waiting(count)),
        }
        Ok(())
    }
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
