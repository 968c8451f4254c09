//! The review on a terminal: one group at a time, one key each.
//!
//! In: pending snapshots, and keys. Out: changed folders, and the decisions. A settled snapshot is written at once, so
//! quitting keeps it; partial acceptances are discarded on quit.

use super::decide::{self, Decision, Decisions, Selection};
use super::find::Pending;
use super::groups::{Group, Kind};
use super::pictures::Sheets;
use super::show::{self, Extent, View};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::price::Price;
use console::{Key, Term};
use std::collections::{BTreeMap, BTreeSet};

const KEYS: &str = "\
a  accept: from now on this is what is compared with
r  reject: what is pending goes, what was accepted stays
s  skip: it stays pending
f  all of the lists and texts, or the first of them
A  accept all that are left
q  quit, as Ctrl-C and Ctrl-D do; what was settled is kept
?  these keys";
const PROMPT: &str = "[a]ccept [r]eject [s]kip [f]ull [A]ccept all left [q]uit [?] ";
/// A prompt that would wrap is shortened to this.
const SHORT_PROMPT: &str = "a r s f A q, ? says what they do: ";
/// The character that Ctrl-D sends.
const END_OF_INPUT: char = '\u{4}';
/// The narrowest supported layout; a terminal of unknown width reports 0.
const MIN_COLUMNS: usize = 20;

/// A review under way.
pub struct Session<'a> {
    pub pending: &'a [Pending],
    pub groups: &'a [Group],
    pub price: Option<&'a Price>,
    pub sheets: &'a mut Sheets,
    decisions: Decisions<'a>,
    settled: BTreeMap<usize, Decision>,
    skipped: BTreeSet<usize>,
    term: Term,
    extent: Extent,
}

impl<'a> Session<'a> {
    /// Starts a review of groups of pending snapshots.
    pub fn of(
        pending: &'a [Pending],
        groups: &'a [Group],
        price: Option<&'a Price>,
        sheets: &'a mut Sheets,
    ) -> Session<'a> {
        Session {
            pending,
            groups,
            price,
            sheets,
            decisions: Decisions::about(groups),
            settled: BTreeMap::new(),
            skipped: BTreeSet::new(),
            term: Term::stdout(),
            extent: Extent::Folded,
        }
    }

    /// Shows each group in turn and applies the decisions.
    ///
    /// Fails if there is no terminal, or if a folder cannot be changed.
    pub fn run(mut self, io: &Io) -> Result<Exit, Failure> {
        let ended = self.go_through(io);
        let all = 0..self.pending.len();
        let count = all.filter(|at| self.decisions.is_waiting(*at)).count();
        if count > 0 {
            let them = if count == 1 { "it" } else { "them" };
            let waiting = waiting(count);
            io.data(&format!(
                "{waiting}; partial acceptances of {them} are discarded"
            ));
        }
        let of = |decision| self.settled.values().filter(|it| **it == decision).count();
        // A snapshot that another edit settled no longer counts as skipped.
        let skipped = self.skipped.iter();
        let n_skipped = skipped.filter(|at| !self.settled.contains_key(at)).count();
        let mut words = format!(
            "accepted {}, rejected {}, skipped {n_skipped}",
            of(Decision::Accept),
            of(Decision::Reject),
        );
        let n_left = self.pending.len() - self.settled.len() - n_skipped;
        if n_left > 0 {
            words.push_str(&format!(", not decided {n_left}"));
        }
        io.data(&words);
        ended
    }

    fn go_through(&mut self, io: &Io) -> Result<Exit, Failure> {
        for (number, group) in self.groups.iter().enumerate() {
            let mut members = group.members.iter();
            if members.all(|member| self.settled.contains_key(member)) {
                // Another edit of all these snapshots was rejected.
                continue;
            }
            self.show(number, io)?;
            loop {
                match self.key()? {
                    Key::Char('a') => self.decide(number..number + 1, Decision::Accept, io)?,
                    Key::Char('r') => self.decide(number..number + 1, Decision::Reject, io)?,
                    Key::Char('s') => self.skipped.extend(&group.members),
                    Key::Char('A') => {
                        self.decide(number..self.groups.len(), Decision::Accept, io)?;
                        return Ok(Exit::Done);
                    }
                    Key::Char('f') => {
                        self.extent = match self.extent {
                            Extent::Folded => Extent::Full,
                            Extent::Full => Extent::Folded,
                        };
                        self.show(number, io)?;
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

    fn show(&mut self, number: usize, io: &Io) -> Result<(), Failure> {
        let group = &self.groups[number];
        let view = View {
            columns: usize::from(self.term.size().1).max(MIN_COLUMNS),
            color: io.data_color(),
            extent: self.extent,
        };
        io.data(&format!("\n{} of {}", number + 1, self.groups.len()));
        io.painted_data(&show::group(group, self.pending, self.price, &view));
        if group.kind == Kind::Picture {
            let first = &self.pending[group.members[0]];
            io.data(&self.sheets.draw(&group.id, first)?.in_words());
        }
        Ok(())
    }

    /// Asks for a key, on a line of its own.
    fn key(&mut self) -> Result<Key, Failure> {
        let columns = usize::from(self.term.size().1);
        let prompt = if PROMPT.len() < columns {
            PROMPT
        } else {
            SHORT_PROMPT
        };
        self.term.write_str(prompt)?;
        self.term.flush()?;
        let key = self.term.read_key_raw()?;
        let echo = match key {
            Key::Char(letter) if !letter.is_control() => letter.to_string(),
            _ => String::new(),
        };
        self.term.write_line(&echo)?;
        Ok(key)
    }

    /// Decides about groups, and applies what that settles.
    fn decide(
        &mut self,
        numbers: std::ops::Range<usize>,
        decision: Decision,
        io: &Io,
    ) -> Result<(), Failure> {
        for number in numbers.clone() {
            self.decisions.decide(Selection::Group(number), decision);
        }
        let members = self.groups[numbers].iter().flat_map(|it| &it.members);
        let members: BTreeSet<usize> = members.copied().collect();
        for at in &members {
            if let Some(decision) = self.decisions.of(*at)
                && !self.settled.contains_key(at)
            {
                decide::apply(&self.pending[*at], decision)?;
                self.settled.insert(*at, decision);
            }
        }
        let left = members.iter().filter(|at| !self.settled.contains_key(at));
        match left.count() {
            0 => {}
            count => io.data(&waiting(count)),
        }
        Ok(())
    }
}

/// Reports snapshots of which only some edits are accepted.
pub fn waiting(count: usize) -> String {
    match count {
        1 => "1 snapshot waits until its other edits are decided".to_owned(),
        _ => format!("{count} snapshots wait until their other edits are decided"),
    }
}
