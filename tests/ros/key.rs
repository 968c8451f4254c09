//! A key that a person holds on a terminal.
//!
//! In: the file with what the program says. Out: a terminal for its stdin, which delivers spaces like a held space bar;
//! the person releases it and presses it again when asked to.

use nix::pty::openpty;
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread;
use std::time::Duration;

/// Repeat interval of a held key, and how long after the press the first repeat comes.
const REPEAT: Duration = Duration::from_millis(50);
const FIRST_REPEAT: Duration = Duration::from_millis(400);

/// How long the person leaves the key when asked to press it.
const UP: Duration = Duration::from_millis(900);

/// How the program asks.
const ASKED: &str = "hold the space bar to ";

/// The key; dropping it releases it for good.
pub struct Key {
    is_down: Arc<AtomicBool>,
    is_there: Arc<AtomicBool>,
}

impl Key {
    /// Opens a terminal and presses the key whenever that is asked for.
    pub fn held(said: PathBuf) -> (Stdio, Key) {
        let pty = openpty(None, None).unwrap();
        let mut keys = File::from(pty.master);
        let key = Key {
            is_down: Arc::new(AtomicBool::new(true)),
            is_there: Arc::new(AtomicBool::new(true)),
        };
        let (is_down, is_there) = (key.is_down.clone(), key.is_there.clone());
        thread::spawn(move || {
            let (mut n_asked, mut was_down) = (0, false);
            while is_there.load(Relaxed) {
                let said = std::fs::read_to_string(&said).unwrap_or_default();
                let n_asked_now = said.matches(ASKED).count();
                if n_asked_now > n_asked {
                    (n_asked, was_down) = (n_asked_now, false);
                    thread::sleep(UP);
                }
                let is_down = n_asked > 0 && is_down.load(Relaxed);
                // The buffer of a terminal that nobody reads any more is full.
                if is_down && keys.write_all(b" ").is_err() {
                    break;
                }
                thread::sleep(match is_down && !was_down {
                    true => FIRST_REPEAT,
                    false => REPEAT,
                });
                was_down = is_down;
            }
        });
        (Stdio::from(pty.slave), key)
    }

    /// Releases the key for a while.
    pub fn let_go_for(&self, pause: Duration) {
        self.is_down.store(false, Relaxed);
        thread::sleep(pause);
        self.is_down.store(true, Relaxed);
    }
}

impl Drop for Key {
    fn drop(&mut self) {
        self.is_there.store(false, Relaxed);
    }
}
