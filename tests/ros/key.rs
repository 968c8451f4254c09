//! A key that is held on a terminal.
//!
//! In: nothing. Out: a terminal for a program's stdin, which delivers spaces like a held space bar.

use nix::pty::openpty;
use std::fs::File;
use std::io::Write;
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread;
use std::time::Duration;

/// Repeat interval of a held key.
const REPEAT: Duration = Duration::from_millis(50);

/// The key; dropping it releases it for good.
pub struct Key {
    is_down: Arc<AtomicBool>,
    is_there: Arc<AtomicBool>,
}

impl Key {
    /// Opens a terminal and presses the key.
    pub fn held() -> (Stdio, Key) {
        let pty = openpty(None, None).unwrap();
        let mut keys = File::from(pty.master);
        let key = Key {
            is_down: Arc::new(AtomicBool::new(true)),
            is_there: Arc::new(AtomicBool::new(true)),
        };
        let (is_down, is_there) = (key.is_down.clone(), key.is_there.clone());
        thread::spawn(move || {
            while is_there.load(Relaxed) {
                // The buffer of a terminal that nobody reads any more is full.
                if is_down.load(Relaxed) && keys.write_all(b" ").is_err() {
                    break;
                }
                thread::sleep(REPEAT);
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
