//! The review on a terminal: one group at a time, one key each.
//!
//! In: pending snapshots, and keys. Out: changed folders, and the decisions. A settled snapshot is written at once, so
//! quitting keeps it; partial acceptances are discarded on quit.

use super::cost::Pricing;
use super::decide::{self, Decision, OpenDecisions};
use super::find::ReviewItems;
use super::groups::{Group, Kind};
use super::sheets::Sheets;
use super::show::{self, Extent, Layout, View};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use console::{Key, Term};
use std::collections::BTreeSet;

const KEYS: &str = "\
a  accept: from now on this is what is compared with
r  reject: what is pending goes, what was accepted stays
s  skip: it stays pending
d  beside each other, or below
f  all of the lists and texts, or the first of them
A  accept all that are left
q  quit, as Ctrl-C and Ctrl-D do; what was settled is kept
?  these keys";
const PROMPT: &str =
    "[a]ccept [r]eject [s]kip [d] side by side [f]ull [A]ccept all left [q]uit [?] ";
/// A prompt that would wrap is shortened to this.
const SHORT_PROMPT: &str = "a r s d f A q, ? says what they do: ";
/// The character that Ctrl-D sends.
const END_OF_INPUT: char = '\u{4}';
/// The narrowest supported layout; a terminal of unknown width reports 0.
const MIN_COLUMNS: usize = 20;

/// How many snapshots were accepted, rejected, skipped and left.
#[derive(Debug, Default)]
struct Count {
    accepted: usize,
    rejected: usize,
    skipped: BTreeSet<usize>,
    left: usize,
}

/// How a session ended.
enum End {
    Through,
    Quit,
    Interrupted,
}

/// Shows each group in turn and applies the decisions.
///
/// Fails if there is no terminal, or if a folder cannot be changed.
pub fn run(
    found: &mut ReviewItems,
    groups: &[Group],
    pricing: Option<&Pricing>,
    sheets: &mut Sheets,
    layout: Layout,
    io: &Io,
) -> Result<Exit, Failure> {
    let term = Term::stdout();
    let mut session = Session {
        open_decisions: OpenDecisions::of(found.pending.len(), groups),
        found,
        groups,
        pricing,
        sheets,
        term,
        layout,
        extent: Extent::Folded,
        count: Count::default(),
    };
    let ended = session.through(io);
    let Session {
        count,
        open_decisions,
        found,
        ..
    } = &mut session;
    // A snapshot that a later edit settled no longer counts as skipped.
    count
        .skipped
        .retain(|member| !open_decisions.is_settled(*member));
    let decided = count.accepted + count.rejected + count.skipped.len();
    count.left = found.pending.len() - decided;
    match open_decisions.waiting().len() {
        0 => {}
        count => io.data(&format!(
            "{}; partial acceptances of {} are discarded",
            waiting(count),
            if count == 1 { "it" } else { "them" }
        )),
    }
    io.data(&count.in_words());
    match ended? {
        End::Interrupted => Ok(Exit::Interrupted),
        End::Through | End::Quit => Ok(Exit::Done),
    }
}

struct Session<'a> {
    found: &'a mut ReviewItems,
    groups: &'a [Group],
    open_decisions: OpenDecisions,
    pricing: Option<&'a Pricing>,
    sheets: &'a mut Sheets,
    term: Term,
    layout: Layout,
    extent: Extent,
    count: Count,
}

impl Session<'_> {
    fn through(&mut self, io: &Io) -> Result<End, Failure> {
        for number in 0..self.groups.len() {
            let mut members = self.groups[number].members.iter();
            if members.all(|member| self.open_decisions.is_settled(*member)) {
                // Another edit of all these snapshots was rejected.
                continue;
            }
            self.show(number, io)?;
            loop {
                match self.key()? {
                    Key::Char('a') => self.decide(number, Decision::Accept, io)?,
                    Key::Char('r') => self.decide(number, Decision::Reject, io)?,
                    Key::Char('s') => {
                        let members = self.groups[number].members.iter();
                        self.count.skipped.extend(members);
                    }
                    Key::Char('A') => {
                        self.accept_from(number)?;
                        return Ok(End::Through);
                    }
                    Key::Char('d') => {
                        self.layout = self.layout.other();
                        self.show(number, io)?;
                        continue;
                    }
                    Key::Char('f') => {
                        self.extent = match self.extent {
                            Extent::Folded => Extent::Full,
                            Extent::Full => Extent::Folded,
                        };
                        self.show(number, io)?;
                        continue;
                    }
                    Key::Char('q' | END_OF_INPUT) => return Ok(End::Quit),
                    Key::CtrlC => return Ok(End::Interrupted),
                    Key::Char('?') => {
                        io.data(KEYS);
                        continue;
                    }
                    _ => continue,
                }
                break;
            }
        }
        Ok(End::Through)
    }

    fn show(&mut self, number: usize, io: &Io) -> Result<(), Failure> {
        let group = &self.groups[number];
        let columns = usize::from(self.term.size().1).max(MIN_COLUMNS);
        let view = View {
            columns,
            color: io.data_color(),
            layout: self.layout,
            extent: self.extent,
        };
        io.data(&format!("\n{} of {}", number + 1, self.groups.len()));
        io.painted_data(&show::group(
            group,
            &self.found.pending,
            self.pricing,
            &view,
        ));
        if group.kind == Kind::Picture
            && let Some(first) = group.members.first()
        {
            io.data(
                &self
                    .sheets
                    .draw(&group.id, &self.found.pending[*first])?
                    .in_words(),
            );
        }
        Ok(())
    }

    /// Asks for a key, on a line of its own.
    fn key(&mut self) -> Result<Key, Failure> {
        let columns = usize::from(self.term.size().1);
        let prompt = match PROMPT.len() < columns {
            true => PROMPT,
            false => SHORT_PROMPT,
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

    fn decide(&mut self, number: usize, decision: Decision, io: &Io) -> Result<(), Failure> {
        let group = &self.groups[number];
        let settled = self.open_decisions.decide(group, decision);
        self.settle(&settled)?;
        let members = group.members.iter();
        let is_open = |member: &&usize| !self.open_decisions.is_settled(**member);
        match members.filter(is_open).count() {
            0 => {}
            count => io.data(&waiting(count)),
        }
        Ok(())
    }

    /// Accepts a group and all after it.
    fn accept_from(&mut self, number: usize) -> Result<(), Failure> {
        let mut settled = Vec::new();
        for group in &self.groups[number..] {
            settled.extend(self.open_decisions.decide(group, Decision::Accept));
        }
        self.settle(&settled)
    }

    fn settle(&mut self, settled: &[(usize, Decision)]) -> Result<(), Failure> {
        decide::apply(self.found, settled)?;
        for (_, decision) in settled {
            match decision {
                Decision::Accept => self.count.accepted += 1,
                Decision::Reject => self.count.rejected += 1,
            }
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

impl Count {
    fn in_words(&self) -> String {
        let mut words = format!(
            "accepted {}, rejected {}, skipped {}",
            self.accepted,
            self.rejected,
            self.skipped.len()
        );
        if self.left > 0 {
            words.push_str(&format!(", not decided {}", self.left));
        }
        words
    }
}
