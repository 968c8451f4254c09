//! The person beside the arm, asked on the terminal.
//!
//! In: what is about to move; lines and keys from stdin. Out: confirmation, or not. Questions go to stderr, so that stdout
//! stays data. End of input, an unintelligible answer and an interrupt all mean no, and input that was typed before the
//! question does not count.

use super::hold_key::{self, HoldKey, KeyState, Keys};
use crate::exit::Failure;
use crate::io::Io;
use clap::ValueEnum;
use fab_arm::route::{Act, Segment};
use fab_arm::supervisor::{MotionRequest, Supervisor};
use fab_base::outbox::Outbox;
use fab_world::start::Start;
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Read};
use std::time::{Duration, Instant};

pub const ATTEMPTS: u32 = 10;

pub const MAX_LINE: u64 = 4096;

/// Interval at which an interrupt is checked while waiting for an answer, milliseconds.
const POLL_MS: u8 = 100;

/// The most notes that wait for a terminal that takes none.
const MAX_NOTES: usize = 8;

/// This program stalled if its last look at the key was longer ago than this: six times the usual.
const STALE: Duration = Duration::from_millis(300);

/// What a person is asked before an arm moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Confirm {
    /// Once before each pick and place.
    Each,
    /// Before each part of it.
    Segment,
    /// Nothing.
    None,
}

pub struct TerminalSupervisor {
    confirm: Confirm,
    /// Whether the arm moves only while the space bar is held.
    holds: bool,
    keys: Option<Keys>,
    hold_key: HoldKey,
    polled: Option<Instant>,
    io: Io,
    /// Notes while the arm moves: a terminal that was halted takes none.
    notes: Outbox<String>,
}

impl TerminalSupervisor {
    /// Checks that there is a terminal to ask on; a usage error otherwise.
    pub fn new(confirm: Confirm, holds: bool, io: &Io) -> Result<TerminalSupervisor, Failure> {
        let needs_terminal = holds || confirm != Confirm::None;
        if needs_terminal && !io.has_terminal_input() {
            return Err(Failure::usage(
                "`--confirm` and `--hold-to-run` ask a person before the arm moves, but stdin is not a terminal; use \
                 `--confirm none` without `--hold-to-run`",
            ));
        }
        let notes = io.clone();
        let say = move |note: String| {
            notes.talk(&note);
            Ok(())
        };
        Ok(TerminalSupervisor {
            confirm,
            holds,
            keys: None,
            hold_key: HoldKey::after_stall(Instant::now()),
            polled: None,
            notes: Outbox::new(MAX_NOTES, say),
            io: io.clone(),
        })
    }

    /// Says something without waiting for a terminal that does not take it.
    fn note(&mut self, note: &str) {
        let _ = self.notes.send(note.to_owned());
    }

    fn ask(&mut self, question: &str) -> bool {
        // Line input, until motion needs the key again.
        self.keys = None;
        let io = self.io.clone();
        io.progress("");
        hold_key::discard_typed();
        let question = format!("{question} y or n:");
        let (next, say) = (&mut || typed_line(&io), &mut |text: &str| io.talk(text));
        // Silence means no.
        choose(next, say, &question, yes_or_no).unwrap_or(false)
    }
}

/// Returns the terminal to line input, and discards what was typed before.
pub fn restore() {
    hold_key::restore();
    hold_key::discard_typed();
}

impl Supervisor for TerminalSupervisor {
    fn confirm_cloth(&mut self, start: &Start) -> bool {
        let question = format!("Lay the cloth: {}. Does it lie so?", start.name);
        self.confirm == Confirm::None || self.ask(&question)
    }

    fn confirm(&mut self, request: MotionRequest<'_>) -> bool {
        match (self.confirm, request) {
            (Confirm::Each, MotionRequest::Action { .. })
            | (Confirm::Segment, MotionRequest::Segment(_)) => self.ask(&question(&request)),
            _ => true,
        }
    }

    fn motion_allowed(&mut self) -> bool {
        if !self.holds {
            return true;
        }
        let now = Instant::now();
        let polled = self.polled.replace(now);
        let is_new = self.keys.is_none();
        if is_new {
            self.keys = Keys::watch().ok();
        }
        // Bytes from before the last look do not show a key that is held now.
        if is_new || polled.is_none_or(|at| now.duration_since(at) > STALE) {
            self.note("hold the space bar to move; if you hold it, release it first");
            hold_key::discard_typed();
            self.hold_key = HoldKey::after_stall(now);
        }
        let typed = self.keys.as_mut().map(Keys::typed).unwrap_or_default();
        match self.hold_key.update(&typed, now) {
            KeyState::Held => true,
            KeyState::Released => {
                self.note("paused: hold the space bar to go on");
                false
            }
            KeyState::Up => {
                // A simulated arm's clock does not wait, so the caller would poll in a busy loop.
                hold_key::has_input(20);
                false
            }
        }
    }
}

fn question(request: &MotionRequest<'_>) -> String {
    match request {
        MotionRequest::Action {
            number,
            points,
            segments,
        } => {
            let [pick, place] = points.map(|at| format!("{:.3}, {:.3}, {:.3} m", at.x, at.y, at.z));
            let segments: Vec<String> = segments.iter().map(describe).collect();
            let segments = segments.join("\n  ");
            format!("action {number}: pick at {pick}, place at {place}\n  {segments}\nMove?")
        }
        MotionRequest::Segment(segment) => format!("{}\nMove?", describe(segment)),
    }
}

fn describe(segment: &Segment) -> String {
    let name = segment.name.name();
    match segment.act {
        Act::Move(to) => {
            let to = to.translation.vector;
            format!("{name}: to {:.3}, {:.3}, {:.3} m", to.x, to.y, to.z)
        }
        Act::Hand(opening) => format!("{name}: fingers {opening:?}").to_lowercase(),
    }
}

/// Waits for a line from the terminal; `None` at end of input and on an interrupt.
pub fn typed_line(io: &Io) -> Option<String> {
    while io.is_process() && !hold_key::has_input(POLL_MS) {
        if io.is_interrupted() {
            return None;
        }
    }
    io.read(line_of)
}

/// Reads a line; `None` at the end.
pub fn line_of(lines: &mut dyn BufRead) -> Option<String> {
    let mut bytes = Vec::new();
    match lines.take(MAX_LINE).read_until(b'\n', &mut bytes) {
        Ok(1..) => Some(String::from_utf8_lossy(&bytes).into_owned()),
        _ => None,
    }
}

/// Asks until an answer means something; `None` at the end of input, and after too many other answers.
pub fn choose<T>(
    next: &mut dyn FnMut() -> Option<String>,
    say: &mut dyn FnMut(&str),
    question: &str,
    meant: impl Fn(&str) -> Option<T>,
) -> Option<T> {
    for _ in 0..ATTEMPTS {
        say(question);
        if let Some(found) = meant(&next()?.trim().to_lowercase()) {
            return Some(found);
        }
    }
    None
}

pub fn yes_or_no(answer: &str) -> Option<bool> {
    match answer {
        "y" | "yes" => Some(true),
        "n" | "no" => Some(false),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
