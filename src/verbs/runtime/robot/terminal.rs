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

/// How often a question is repeated after an unintelligible answer.
const ATTEMPTS: u32 = 10;

/// The longest line that is read, bytes.
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

/// Whether a key must be held while the arm moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldToRun {
    /// The space bar.
    Space,
    /// None.
    Off,
}

/// A supervisor that asks on the terminal.
pub struct TerminalSupervisor {
    confirm: Confirm,
    hold: HoldToRun,
    keys: Option<Keys>,
    hold_key: HoldKey,
    /// When keys were polled last.
    polled: Option<Instant>,
    io: Io,
    /// Notes while the arm moves: a terminal that was halted takes none.
    notes: Outbox<String>,
}

impl TerminalSupervisor {
    /// Checks that there is a terminal to ask on; a usage error otherwise.
    pub fn new(confirm: Confirm, hold: HoldToRun, io: &Io) -> Result<TerminalSupervisor, Failure> {
        let needs = match (confirm, hold) {
            (Confirm::None, HoldToRun::Off) => None,
            (Confirm::None, HoldToRun::Space) => Some("`--hold-to-run` waits for a key"),
            _ => Some("`--confirm` asks before the arm moves"),
        };
        if let Some(needs) = needs
            && !io.has_terminal_input()
        {
            return Err(Failure::usage(format!(
                "{needs}, but stdin is not a terminal; use `--confirm none` without `--hold-to-run`"
            )));
        }
        if hold == HoldToRun::Space {
            Keys::watch().map_err(|why| {
                Failure::usage(format!("`--hold-to-run` cannot see keys here: {why}"))
            })?;
        }
        Ok(TerminalSupervisor {
            confirm,
            hold,
            keys: None,
            hold_key: HoldKey::after_stall(Instant::now()),
            polled: None,
            notes: {
                let io = io.clone();
                Outbox::new(MAX_NOTES, move |note: String| {
                    io.talk(&note);
                    Ok(())
                })
            },
            io: io.clone(),
        })
    }

    /// Returns the terminal to line input, until motion needs the key again.
    pub fn release_keys(&mut self) {
        self.keys = None;
    }

    /// Says something without waiting for a terminal that does not take it.
    fn note(&mut self, note: &str) {
        let _ = self.notes.send(note.to_owned());
    }

    fn ask(&mut self, question: &str) -> bool {
        self.release_keys();
        let io = self.io.clone();
        io.progress("");
        hold_key::discard_typed();
        ask_yes_no(
            &mut || typed_line(&io),
            &mut |text| io.talk(text),
            &format!("{question} y or n:"),
        )
    }
}

/// Returns the terminal to line input, and discards what was typed before.
pub fn restore() {
    hold_key::restore();
    hold_key::discard_typed();
}

impl Supervisor for TerminalSupervisor {
    fn confirm_cloth(&mut self, start: &Start) -> bool {
        match self.confirm {
            Confirm::None => true,
            Confirm::Each | Confirm::Segment => {
                self.ask(&format!("Lay the cloth: {}. Does it lie so?", start.name))
            }
        }
    }

    fn confirm(&mut self, request: MotionRequest<'_>) -> bool {
        match (self.confirm, request) {
            (Confirm::Each, MotionRequest::Action { .. })
            | (Confirm::Segment, MotionRequest::Segment(_)) => self.ask(&question(&request)),
            _ => true,
        }
    }

    fn motion_allowed(&mut self) -> bool {
        if self.hold == HoldToRun::Off {
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
            points: [pick, place],
            segments,
        } => {
            let at = |x: f64, y: f64, z: f64| format!("{x:.3}, {y:.3}, {z:.3} m");
            let pick = at(pick.x, pick.y, pick.z);
            let place = at(place.x, place.y, place.z);
            let segments: Vec<String> = segments.iter().map(describe).collect();
            let segments = segments.join("\n  ");
            format!("action {number}: pick at {pick}, place at {place}\n  {segments}\nMove?")
        }
        MotionRequest::Segment(segment) => format!("{}\nMove?", describe(segment)),
    }
}

fn describe(segment: &Segment) -> String {
    let name = segment.name.text();
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

/// Asks until the answer is y or n. End of input, or too many other answers, mean no.
fn ask_yes_no(
    next: &mut dyn FnMut() -> Option<String>,
    say: &mut dyn FnMut(&str),
    question: &str,
) -> bool {
    say(question);
    for _ in 0..ATTEMPTS {
        let Some(answer) = next() else {
            return false;
        };
        match answer.trim().to_lowercase().as_str() {
            "y" | "yes" => return true,
            "n" | "no" => return false,
            _ => say("y or n:"),
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use std::sync::mpsc::{Receiver, channel};

    /// A stderr that takes nothing until it is released.
    struct Halted(Receiver<()>);

    impl Write for Halted {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            let _ = self.0.recv();
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_terminal_that_takes_nothing_holds_up_no_motion() {
        let (release, halted) = channel();
        let io = Io::in_memory().with_stderr(Halted(halted));
        let supervisor = TerminalSupervisor::new(Confirm::None, HoldToRun::Off, &io);
        let Ok(mut supervisor) = supervisor else {
            panic!("it asks nobody");
        };
        let (sender, done) = channel();
        std::thread::spawn(move || {
            for _ in 0..100 {
                supervisor.note("paused: hold the space bar to go on");
            }
            sender.send(())
        });
        assert_eq!(done.recv_timeout(Duration::from_secs(60)), Ok(()));
        drop(release);
    }

    #[test]
    fn only_a_yes_confirms() {
        for (typed, expected) in [
            ("y\n", true),
            (" YES \n", true),
            ("what\n\nyes", true),
            ("n\ny\n", false),
            ("", false),
            ("perhaps\n", false),
        ] {
            let mut said = Vec::new();
            let mut say = |text: &str| said.push(text.to_owned());
            let mut lines = typed.as_bytes();
            let allowed = ask_yes_no(&mut || line_of(&mut lines), &mut say, "Move?");
            assert_eq!(allowed, expected, "{typed:?}");
            assert_eq!(said[0], "Move?");
        }
        let many = "x\n".repeat(ATTEMPTS as usize) + "y\n";
        let mut lines = many.as_bytes();
        assert!(!ask_yes_no(
            &mut || line_of(&mut lines),
            &mut |_| {},
            "Move?"
        ));
    }
}
