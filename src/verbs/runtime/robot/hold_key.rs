//! The hold-to-run key: whether the space bar is held on the terminal.
//!
//! In: bytes from the terminal, without echo. Out: whether the key is held, was just released, or is up. A terminal sends
//! repeats of a held key but no event for its release, so a release is noticed only after a while without repeats. Bytes
//! may have waited in a terminal, a multiplexer or a connection. So after a stall of this program or of the bytes only a
//! fresh press counts: one byte after a silence, not followed at once by a second, as buffered repeats are.

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

const SPACE: u8 = b' ';

/// What is known of the hold-to-run key.
#[derive(Debug)]
pub enum HoldKey {
    /// The key counts as released only after a silence; the last byte, or the stall, was then.
    Draining(Instant),
    Up,
    /// One byte came then; it may be the first of many that waited.
    Pressed(Instant),
    /// It is held until then, if no repeat comes.
    Held(Instant),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyState {
    Held,
    /// It was held until this update.
    Released,
    Up,
}

impl HoldKey {
    /// Tracks the key from now on; only a fresh press counts.
    pub fn after_stall(now: Instant) -> HoldKey {
        HoldKey::Draining(now)
    }

    /// Takes in the bytes that were typed since the last update, and returns the state of the key.
    pub fn update(&mut self, typed: &[u8], now: Instant) -> KeyState {
        let n_presses = typed.iter().filter(|byte| **byte == SPACE).count();
        let was_held = matches!(self, HoldKey::Held(_));
        *self = match *self {
            HoldKey::Draining(_) if n_presses > 0 => HoldKey::Draining(now),
            HoldKey::Draining(since) if now.saturating_duration_since(since) < HOLD_TIMEOUT => {
                HoldKey::Draining(since)
            }
            HoldKey::Draining(_) => HoldKey::Up,
            HoldKey::Up if n_presses == 1 => HoldKey::Pressed(now),
            HoldKey::Up if n_presses == 0 => HoldKey::Up,
            HoldKey::Pressed(at) if n_presses == 0 => {
                if now.saturating_duration_since(at) < ALONE {
                    HoldKey::Pressed(at)
                } else {
                    HoldKey::Held(at + FIRST_TIMEOUT)
                }
            }
            HoldKey::Up | HoldKey::Pressed(_) => HoldKey::Draining(now),
            HoldKey::Held(_) if n_presses > 0 => HoldKey::Held(now + HOLD_TIMEOUT),
            HoldKey::Held(until) => HoldKey::Held(until),
        };
        match *self {
            HoldKey::Held(until) if now < until => return KeyState::Held,
            // If the bytes come late rather than not at all, they must not count as a press.
            HoldKey::Held(_) => *self = HoldKey::Draining(now),
            _ => {}
        }
        if was_held {
            KeyState::Released
        } else {
            KeyState::Up
        }
    }
}

/// The terminal's settings before keys were watched; `None` while they are not.
static BEFORE: Mutex<Option<Termios>> = Mutex::new(None);

/// Restores the terminal's settings: for exits that skip destructors.
pub fn restore() {
    let before = BEFORE.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(before) = before {
        // If the terminal is gone, there is nothing to restore.
        let _ = tcsetattr(stdin(), SetArg::TCSANOW, &before);
    }
}

pub fn discard_typed() {
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

/// The terminal while keys are watched; dropping this restores it.
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
