//! Whether a key is held on the terminal: it repeats while it is.
//!
//! In: bytes of the terminal, unechoed while keys are looked for. Out: whether the space bar came lately, and whether it
//! did not any more. A terminal sends no word of a key that is let go, so that this is noticed after [`HELD`] alone.

use std::time::{Duration, Instant};

/// How long a key counts as held after it came; repeats come 10 to 30 times a second, the first after up to 0.66 s.
pub const HELD: Duration = Duration::from_millis(600);

/// The key that is held.
const KEY: u8 = b' ';

/// When the key came last.
#[derive(Debug, Default)]
pub struct Held {
    last: Option<Instant>,
}

/// What is known of the key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// It is held.
    Held,
    /// It was held until now.
    LetGo,
    /// It is not held, as before.
    Up,
}

impl Held {
    /// Takes note of what was typed up to now, and tells whether the key is held.
    pub fn look(&mut self, typed: &[u8], now: Instant) -> Key {
        if typed.contains(&KEY) {
            self.last = Some(now);
        }
        match self.last {
            Some(last) if now.saturating_duration_since(last) < HELD => Key::Held,
            Some(_) => {
                self.last = None;
                Key::LetGo
            }
            None => Key::Up,
        }
    }
}

#[cfg(unix)]
pub use unix::{Keys, forget_typed, has_input, restore};

#[cfg(unix)]
mod unix {
    use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
    use nix::sys::termios::{FlushArg, LocalFlags, SetArg, Termios, tcflush, tcgetattr, tcsetattr};
    use std::io::stdin;
    use std::os::fd::AsFd;
    use std::sync::{Mutex, PoisonError};

    /// How the terminal was before keys were looked for; none while they are not.
    static BEFORE: Mutex<Option<Termios>> = Mutex::new(None);

    /// Has the terminal as it was before keys were looked for: for an end at which nothing is dropped.
    pub fn restore() {
        let before = BEFORE.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(before) = before {
            // Where the terminal is gone, nothing of it is left to be as before.
            let _ = tcsetattr(stdin(), SetArg::TCSANOW, &before);
        }
    }

    /// Forgets what was typed up to now.
    pub fn forget_typed() {
        // Where stdin is no terminal, nobody typed anything.
        let _ = tcflush(stdin(), FlushArg::TCIFLUSH);
    }

    /// Waits until there is something to read on stdin, or its end, but not for long; tells whether there is.
    pub fn has_input(most_ms: u8) -> bool {
        let stdin = stdin();
        let mut polled = [PollFd::new(stdin.as_fd(), PollFlags::POLLIN)];
        // A signal ends the waiting, and says nothing of what is there.
        poll(&mut polled, PollTimeout::from(most_ms)).is_ok_and(|count| count > 0)
    }

    /// The terminal while keys are looked for; it is as before once this is dropped.
    pub struct Keys;

    impl Keys {
        /// Has keys come at once and unseen; says why not where stdin is no terminal. Ctrl-C works as ever.
        pub fn watch() -> Result<Keys, String> {
            let stdin = stdin();
            let before = tcgetattr(&stdin).map_err(|error| error.to_string())?;
            let mut flags = before.clone();
            flags
                .local_flags
                .remove(LocalFlags::ICANON | LocalFlags::ECHO);
            BEFORE
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .get_or_insert(before);
            tcsetattr(&stdin, SetArg::TCSANOW, &flags).map_err(|error| error.to_string())?;
            Ok(Keys)
        }

        /// Returns what was typed since the last call, without waiting; nothing where the terminal is gone.
        pub fn typed(&mut self) -> Vec<u8> {
            let mut bytes = vec![0; 256];
            let count = match has_input(0) {
                true => nix::unistd::read(stdin(), &mut bytes).unwrap_or(0),
                false => 0,
            };
            bytes.truncate(count);
            bytes
        }
    }

    impl Drop for Keys {
        fn drop(&mut self) {
            restore();
        }
    }
}

/// Keys, where this system has no way to see them held.
#[cfg(not(unix))]
pub struct Keys;

#[cfg(not(unix))]
impl Keys {
    /// Says that it cannot be.
    pub fn watch() -> Result<Keys, String> {
        Err("this system has no terminal of that kind".to_owned())
    }

    /// Returns nothing.
    pub fn typed(&mut self) -> Vec<u8> {
        Vec::new()
    }
}

/// Does nothing: no terminal was changed.
#[cfg(not(unix))]
pub fn restore() {}

/// Does nothing: what was typed is not told from what will be.
#[cfg(not(unix))]
pub fn forget_typed() {}

/// Says that there is: whoever reads waits for it.
#[cfg(not(unix))]
pub fn has_input(_: u8) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_held_for_a_while_after_it_came() {
        let start = Instant::now();
        let mut held = Held::default();
        for (typed, after_ms, expected) in [
            (&b""[..], 0, Key::Up),
            (b"yx\n", 0, Key::Up),
            (b"  ", 0, Key::Held),
            (b"", 599, Key::Held),
            (b"x", 600, Key::LetGo),
            (b"x", 601, Key::Up),
            (b"a ", 700, Key::Held),
            (b"", 2000, Key::LetGo),
        ] {
            let now = start + Duration::from_millis(after_ms);
            assert_eq!(held.look(typed, now), expected, "{typed:?} {after_ms}");
        }
    }
}
