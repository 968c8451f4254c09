//! Whether a key is held on the terminal: it repeats while it is.
//!
//! In: bytes of the terminal, unechoed while keys are looked for. Out: whether the space bar came lately. A terminal
//! sends no word of a key that is let go, so that this is noticed after [`HELD`] alone.

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

impl Held {
    /// Takes note of what was typed up to now, and tells whether the key is held.
    pub fn is_held(&mut self, typed: &[u8], now: Instant) -> bool {
        if typed.contains(&KEY) {
            self.last = Some(now);
        }
        self.last
            .is_some_and(|last| now.saturating_duration_since(last) < HELD)
    }
}

#[cfg(unix)]
pub use unix::Keys;

#[cfg(unix)]
mod unix {
    use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
    use nix::sys::termios::{LocalFlags, SetArg, Termios, tcgetattr, tcsetattr};
    use std::io::stdin;
    use std::os::fd::AsFd;

    /// The terminal while keys are looked for; it is as before once this is dropped.
    pub struct Keys {
        before: Termios,
    }

    impl Keys {
        /// Has keys come at once and unseen; says why not where stdin is no terminal. Ctrl-C works as ever.
        pub fn watch() -> Result<Keys, String> {
            let stdin = stdin();
            let before = tcgetattr(&stdin).map_err(|error| error.to_string())?;
            let mut flags = before.clone();
            flags
                .local_flags
                .remove(LocalFlags::ICANON | LocalFlags::ECHO);
            tcsetattr(&stdin, SetArg::TCSANOW, &flags).map_err(|error| error.to_string())?;
            Ok(Keys { before })
        }

        /// Returns what was typed since the last call, without waiting; nothing where the terminal is gone.
        pub fn typed(&mut self) -> Vec<u8> {
            let stdin = stdin();
            let mut polled = [PollFd::new(stdin.as_fd(), PollFlags::POLLIN)];
            let ready = poll(&mut polled, PollTimeout::ZERO);
            let is_ready = polled[0]
                .revents()
                .is_some_and(|it| it.contains(PollFlags::POLLIN));
            let mut bytes = vec![0; 256];
            let count = match ready.is_ok() && is_ready {
                true => nix::unistd::read(&stdin, &mut bytes).unwrap_or(0),
                false => 0,
            };
            bytes.truncate(count);
            bytes
        }
    }

    impl Drop for Keys {
        fn drop(&mut self) {
            // Where the terminal is gone, nothing of it is left to be as before.
            let _ = tcsetattr(stdin(), SetArg::TCSANOW, &self.before);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_held_for_a_while_after_it_came() {
        let start = Instant::now();
        let after = |millis| start + Duration::from_millis(millis);
        let mut held = Held::default();
        assert!(!held.is_held(b"", start));
        assert!(!held.is_held(b"yx\n", start));
        assert!(held.is_held(b"  ", start));
        assert!(held.is_held(b"", after(599)));
        assert!(!held.is_held(b"x", after(600)));
        assert!(held.is_held(b"a ", after(700)));
    }
}
