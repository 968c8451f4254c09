//! The hold-to-run key: whether the space bar is held on the terminal.
//!
//! In: bytes from the terminal, without echo. Out: whether the key is held. A terminal sends repeats of a held key but no
//! event for its release, so a release is noticed only after a while without repeats. Bytes may have waited in a terminal,
//! a multiplexer or a connection. So after a stall of this program or of the bytes only a fresh press counts: one byte
//! after a silence, not followed at once by a second, as buffered repeats are.

use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::termios::{FlushArg, LocalFlags, SetArg, Termios, tcflush, tcgetattr, tcsetattr};
use std::io::stdin;
use std::os::fd::AsFd;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How long the key counts as held after a repeat; repeats come 10 to 30 times a second.
pub const HOLD_TIMEOUT: Duration = Duration::from_millis(600);

/// The same after its press: the first repeat comes after 0.25 to 0.66 s.
const FIRST_TIMEOUT: Duration = Duration::from_millis(750);

/// How long after a press no repeat of it can come.
const ALONE: Duration = Duration::from_millis(100);

/// This program stalled if its last look at the key was longer ago than this: six times the usual.
const STALE: Duration = Duration::from_millis(300);

/// What is known of the key.
#[derive(Clone, Copy, Debug)]
enum State {
    /// It counts as released; the last byte, or the stall, was then.
    Up(Instant),
    /// One byte came then; it may be the first of many that waited.
    Pressed(Instant),
    /// It is held until then, if no repeat comes.
    Held(Instant),
}

/// The hold-to-run key.
#[derive(Debug)]
pub struct HoldKey {
    state: State,
    looked: Instant,
    /// Whether a person must be asked for a fresh press: at first, after a release and after a stall.
    pub asks: bool,
}

impl HoldKey {
    /// Tracks the key from now on; only a fresh press counts.
    pub fn up(now: Instant) -> HoldKey {
        HoldKey {
            state: State::Up(now),
            looked: now,
            asks: true,
        }
    }

    /// Takes in the bytes that were typed since the last look, and returns whether the key is held.
    pub fn look(&mut self, typed: &[u8], now: Instant) -> bool {
        let before = std::mem::replace(&mut self.looked, now);
        let n_presses = typed.iter().filter(|byte| **byte == b' ').count();
        let since = |at: Instant| now.saturating_duration_since(at);
        let (was_held, has_stalled) = (self.is_held(), since(before) > STALE);
        self.state = match self.state {
            // Bytes from before a stall do not show a key that is held now.
            _ if has_stalled => State::Up(now),
            State::Up(at) if n_presses == 0 => State::Up(at),
            State::Up(at)
                if n_presses == 1 && before.saturating_duration_since(at) >= HOLD_TIMEOUT =>
            {
                State::Pressed(now)
            }
            State::Pressed(at) if n_presses == 0 && since(at) < ALONE => State::Pressed(at),
            State::Pressed(at) if n_presses == 0 => State::Held(at + FIRST_TIMEOUT),
            State::Held(_) if n_presses > 0 => State::Held(now + HOLD_TIMEOUT),
            State::Held(until) if now < until => State::Held(until),
            // If the bytes come late rather than not at all, they must not count as a press.
            State::Up(_) | State::Pressed(_) | State::Held(_) => State::Up(now),
        };
        self.asks |= has_stalled || was_held && !self.is_held();
        self.is_held()
    }

    fn is_held(&self) -> bool {
        matches!(self.state, State::Held(_))
    }
}

/// The terminal's settings before keys were watched; `None` while they are not.
static BEFORE: Mutex<Option<Termios>> = Mutex::new(None);

/// Returns the terminal to line input, and discards what was typed; also for exits that skip destructors.
pub fn restore() {
    let before = BEFORE.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(before) = before {
        // If the terminal is gone, there is nothing to restore.
        let _ = tcsetattr(stdin(), SetArg::TCSANOW, &before);
    }
    // If stdin is not a terminal, nobody typed anything.
    let _ = tcflush(stdin(), FlushArg::TCIFLUSH);
}

/// Waits for input or end of input on stdin, at most `most_ms`; returns whether there is any.
pub fn has_input(most_ms: u8) -> bool {
    let stdin = stdin();
    let mut polled = [PollFd::new(stdin.as_fd(), PollFlags::POLLIN)];
    // A signal ends the wait without input.
    poll(&mut polled, PollTimeout::from(most_ms)).is_ok_and(|count| count > 0)
}

/// The terminal while its keys are watched; dropping this restores it.
pub struct Keys;

impl Keys {
    /// Turns off line buffering and echo; fails if stdin is not a terminal. Ctrl-C still works.
    pub fn watch() -> Result<Keys, String> {
        let stdin = stdin();
        let before = tcgetattr(&stdin).map_err(|error| error.to_string())?;
        let mut flags = before.clone();
        let buffered = LocalFlags::ICANON | LocalFlags::ECHO;
        flags.local_flags.remove(buffered);
        let mut kept = BEFORE.lock().unwrap_or_else(PoisonError::into_inner);
        kept.get_or_insert(before);
        drop(kept);
        crate::io::at_exit(restore);
        tcsetattr(&stdin, SetArg::TCSANOW, &flags).map_err(|error| error.to_string())?;
        Ok(Keys)
    }

    /// Returns what was typed since the last call, without waiting; nothing if the terminal is gone.
    pub fn typed(&mut self) -> Vec<u8> {
        let mut bytes = vec![0; 256];
        let read = has_input(0).then(|| nix::unistd::read(stdin(), &mut bytes));
        bytes.truncate(read.and_then(Result::ok).unwrap_or(0));
        bytes
    }
}

impl Drop for Keys {
    fn drop(&mut self) {
        restore();
    }
}

#[cfg(test)]
mod tests;
