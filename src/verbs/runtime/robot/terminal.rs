//! The person beside the arm, asked on the terminal.
//!
//! In: what is about to move; lines and keys from stdin. Out: confirmation, or not. Questions go to stderr, so that stdout
//! stays data. End of input, an unintelligible answer and an interrupt all mean no, and input that was typed before the
//! question does not count.

use super::hold_key::{self, HoldKey, Keys};
use crate::exit::Failure;
use crate::io::Io;
use clap::ValueEnum;
use fab_arm::route::{Act, Segment};
use fab_arm::supervisor::{MotionRequest, Supervisor};
use fab_world::start::Start;
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Read};
use std::time::Instant;

pub const ATTEMPTS: u32 = 10;

pub const MAX_LINE: u64 = 4096;

/// Interval at which an interrupt is checked while waiting for an answer, milliseconds.
const POLL_MS: u8 = 100;

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

/// A person who is asked on the terminal, and may hold a key.
pub struct TerminalSupervisor {
    confirm: Confirm,
    /// Whether the arm moves only while the space bar is held.
    holds: bool,
    /// The key while it is watched.
    key: Option<(Keys, HoldKey)>,
    io: Io,
}

impl TerminalSupervisor {
    /// Checks that there is a terminal to ask on; a usage error otherwise.
    pub fn new(confirm: Confirm, holds: bool, io: &Io) -> Result<TerminalSupervisor, Failure> {
        if !io.has_terminal_input() {
            return Err(Failure::usage(
                "`--confirm` and `--hold-to-run` ask a person before the arm moves, but stdin is not a terminal; use \
                 `--confirm none` without `--hold-to-run`",
            ));
        }
        Ok(TerminalSupervisor {
            confirm,
            holds,
            key: None,
            io: io.clone(),
        })
    }

    fn ask(&mut self, question: &str) -> bool {
        // Line input, until motion needs the key again.
        self.key = None;
        hold_key::restore();
        let io = &self.io;
        io.progress("");
        let (next, say) = (&mut || typed_line(io), &mut |text: &str| io.talk(text));
        // Silence means no.
        choose(next, say, &format!("{question} y or n:"), yes_or_no).unwrap_or(false)
    }
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
        if self.key.is_none() {
            self.key = Keys::watch().ok().map(|keys| (keys, HoldKey::up(now)));
        }
        let Some((keys, key)) = &mut self.key else {
            return false;
        };
        let is_held = key.look(&keys.typed(), now);
        if std::mem::take(&mut key.asks) {
            // A terminal that takes nothing holds this up, and then the watchdog stops the arm.
            self.io
                .talk("hold the space bar to move; if you hold it, release it first");
        }
        if !is_held {
            // A simulated arm's clock does not wait, so the caller would poll in a busy loop.
            hold_key::has_input(20);
        }
        is_held
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
