//! The person beside the arm, asked on the terminal.
//!
//! In: what is about to move, lines and keys of stdin. Out: leave to do it, or not. Questions go to stderr, so that stdout
//! stays data. Where stdin ends, no answer is understood, or the program is asked to end, there is no leave; and none by
//! what was typed before the question.

use super::held::{self, Held, Key, Keys};
use crate::cli::robot::Confirm;
use crate::exit::Failure;
use crate::{output, setting};
use fab_arm::route::{Act, Segment};
use fab_arm::supervisor::{Asked, Supervisor};
use fab_world::start::Start;
use std::io::{BufRead, IsTerminal, Read};
use std::time::{Duration, Instant};

/// How often a question is put again where the answer is none of the offered ones.
const TRIES: u32 = 10;

/// The longest line that is read, bytes.
pub const MAX_LINE: u64 = 4096;

/// How long an end that is asked for may go unnoticed while an answer is waited for, milliseconds.
const LOOK_MS: u8 = 100;

/// How long keys may have gone unseen for those that lie there to count as typed now.
const UNSEEN: Duration = Duration::from_millis(300);

/// Whether a key has to be held while the arm moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldToRun {
    /// The space bar.
    Space,
    /// None.
    Off,
}

/// Asks on the terminal.
pub struct Terminal {
    confirm: Confirm,
    hold: HoldToRun,
    keys: Option<Keys>,
    held: Held,
    /// When keys were looked for last.
    looked: Option<Instant>,
}

impl Terminal {
    /// Makes sure that there is somebody to ask, before anything else; wrong usage where there is no terminal.
    pub fn new(confirm: Confirm, hold: HoldToRun) -> Result<Terminal, Failure> {
        let needs = match (confirm, hold) {
            (Confirm::None, HoldToRun::Off) => None,
            (Confirm::None, HoldToRun::Space) => Some("`--hold-to-run` waits for a key"),
            _ => Some("`--confirm` asks before the arm moves"),
        };
        if let Some(needs) = needs
            && !std::io::stdin().is_terminal()
        {
            return Err(Failure::usage(format!(
                "{needs}, and stdin is no terminal; `--confirm none` without `--hold-to-run` needs none"
            )));
        }
        if hold == HoldToRun::Space {
            Keys::watch().map_err(|why| {
                Failure::usage(format!("`--hold-to-run` cannot see keys here: {why}"))
            })?;
        }
        Ok(Terminal {
            confirm,
            hold,
            keys: None,
            held: Held::default(),
            looked: None,
        })
    }

    /// Has typed lines shown and read as ever, until motion asks for the key again.
    pub fn let_go(&mut self) {
        self.keys = None;
        self.held = Held::default();
    }

    fn ask(&mut self, question: &str) -> bool {
        self.let_go();
        output::progress("");
        held::forget_typed();
        leave(
            &mut typed_line,
            &mut output::talk,
            &format!("{question} y or n:"),
        )
    }
}

/// Has typed lines shown and read as ever, and forgets what was typed before.
pub fn be_as_before() {
    held::restore();
    held::forget_typed();
}

impl Supervisor for Terminal {
    fn lays_cloth(&mut self, start: &Start) -> bool {
        match self.confirm {
            Confirm::None => true,
            Confirm::Each | Confirm::Segment => {
                self.ask(&format!("Lay the cloth: {}. Does it lie so?", start.name))
            }
        }
    }

    fn allows(&mut self, asked: Asked<'_>) -> bool {
        match (self.confirm, asked) {
            (Confirm::Each, Asked::Action { .. }) | (Confirm::Segment, Asked::Segment(_)) => {
                self.ask(&question(&asked))
            }
            _ => true,
        }
    }

    fn is_holding(&mut self) -> bool {
        if self.hold == HoldToRun::Off {
            return true;
        }
        let now = Instant::now();
        let looked = self.looked.replace(now);
        let is_new = self.keys.is_none();
        if is_new {
            self.keys = Keys::watch().ok();
        }
        // What was typed while nobody looked says nothing of a key that is held now: one that is comes again at once.
        if is_new || looked.is_none_or(|at| now.duration_since(at) > UNSEEN) {
            output::talk("hold the space bar to move");
            held::forget_typed();
            self.held = Held::default();
        }
        let typed = self.keys.as_mut().map(Keys::typed).unwrap_or_default();
        match self.held.look(&typed, now) {
            Key::Held => true,
            Key::LetGo => {
                output::talk("paused: hold the space bar to go on");
                false
            }
            Key::Up => {
                // A simulated arm's clock does not wait for anybody, and whoever looks again at once would only burn time.
                held::has_input(20);
                false
            }
        }
    }
}

fn question(asked: &Asked<'_>) -> String {
    match asked {
        Asked::Action {
            number,
            points: [pick, place],
            segments,
        } => {
            let at = |x: f64, y: f64, z: f64| format!("{x:.3}, {y:.3}, {z:.3} m");
            let pick = at(pick.x, pick.y, pick.z);
            let place = at(place.x, place.y, place.z);
            let segments: Vec<String> = segments.iter().map(in_words).collect();
            let segments = segments.join("\n  ");
            format!("action {number}: pick at {pick}, place at {place}\n  {segments}\nMove?")
        }
        Asked::Segment(segment) => format!("{}\nMove?", in_words(segment)),
    }
}

fn in_words(segment: &Segment) -> String {
    let name = segment.name.text();
    match segment.act {
        Act::Move(to) => {
            let to = to.translation.vector;
            format!("{name}: to {:.3}, {:.3}, {:.3} m", to.x, to.y, to.z)
        }
        Act::Hand(opening) => format!("{name}: fingers {opening:?}").to_lowercase(),
    }
}

/// Waits for a line of the terminal; none at its end, and where the program is asked to end.
pub fn typed_line() -> Option<String> {
    while !held::has_input(LOOK_MS) {
        if setting::is_interrupted() {
            return None;
        }
    }
    line_of(&mut std::io::stdin().lock())
}

/// Reads a line; none at the end.
pub fn line_of(lines: &mut dyn BufRead) -> Option<String> {
    let mut bytes = Vec::new();
    match lines.take(MAX_LINE).read_until(b'\n', &mut bytes) {
        Ok(1..) => Some(String::from_utf8_lossy(&bytes).into_owned()),
        _ => None,
    }
}

/// Puts a question until it is answered by y or n; none at the end, or after too many other answers, is no.
fn leave(
    next: &mut dyn FnMut() -> Option<String>,
    say: &mut dyn FnMut(&str),
    question: &str,
) -> bool {
    say(question);
    for _ in 0..TRIES {
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

    #[test]
    fn only_a_yes_gives_leave() {
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
            let allowed = leave(&mut || line_of(&mut lines), &mut say, "Move?");
            assert_eq!(allowed, expected, "{typed:?}");
            assert_eq!(said[0], "Move?");
        }
        let many = "x\n".repeat(TRIES as usize) + "y\n";
        let mut lines = many.as_bytes();
        assert!(!leave(&mut || line_of(&mut lines), &mut |_| {}, "Move?"));
    }
}
