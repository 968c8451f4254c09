//! A command in a pseudo-terminal: what it shows, keys that are pressed, how the terminal is left.

use nix::pty::{Winsize, openpty};
use nix::sys::termios::{LocalFlags, tcgetattr};
use std::fs::File;
use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Long enough for a loaded machine; nothing is measured.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// A command that waits for keys.
pub struct Session {
    child: Child,
    keys: File,
    shown: Receiver<Vec<u8>>,
    text: String,
}

/// Whether keys are read as lines, and shown as they are typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mode {
    pub is_by_lines: bool,
    pub is_echoed: bool,
}

impl Session {
    /// Starts a command in a terminal of so many columns.
    pub fn start(mut command: Command, columns: u16) -> Session {
        let size = Winsize {
            ws_row: 40,
            ws_col: columns,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        let pty = openpty(&size, None).unwrap();
        let end = || Stdio::from(pty.slave.try_clone().unwrap());
        let child = command
            .env("TERM", "xterm")
            .stdin(end())
            .stdout(end())
            .stderr(end())
            .spawn()
            .unwrap();
        // The far end of a terminal that nobody holds any more fails to read: so the command's own ends are the only ones.
        drop((command, pty.slave));
        let keys = File::from(pty.master);
        let mut screen = keys.try_clone().unwrap();
        let (send, shown) = channel();
        thread::spawn(move || {
            let mut bytes = [0; 4096];
            while let Ok(count @ 1..) = screen.read(&mut bytes) {
                if send.send(bytes[..count].to_vec()).is_err() {
                    break;
                }
            }
        });
        Session {
            child,
            keys,
            shown,
            text: String::new(),
        }
    }

    /// Starts a command as a shell does in a window of its own: Ctrl-C in that terminal is a signal to it.
    #[cfg(target_os = "linux")]
    pub fn in_window(command: &Command) -> Session {
        let mut window = Command::new("setsid");
        window.arg("--ctty").arg(command.get_program());
        window.args(command.get_args());
        if let Some(folder) = command.get_current_dir() {
            window.current_dir(folder);
        }
        for (name, value) in command.get_envs() {
            match value {
                Some(value) => window.env(name, value),
                None => window.env_remove(name),
            };
        }
        Session::start(window, 120)
    }

    /// Waits for words, and returns all that was shown since the last call.
    pub fn until(&mut self, words: &str) -> String {
        loop {
            if let Some(at) = self.text.find(words) {
                let rest = self.text.split_off(at + words.len());
                return std::mem::replace(&mut self.text, rest);
            }
            let bytes = self.shown.recv_timeout(PATIENCE);
            let bytes = bytes.unwrap_or_else(|_| panic!("no `{words}` in:\n{}", self.text));
            self.text.push_str(&plain(&bytes));
        }
    }

    /// Presses a key when it is waited for; before that, the terminal itself would show it, or obey Ctrl-C.
    pub fn press(&mut self, key: &str) {
        for _ in 0..PATIENCE.as_millis() {
            if !self.mode().is_by_lines {
                break;
            }
            thread::sleep(Duration::from_millis(1));
        }
        self.send(key);
    }

    /// Sends bytes at once, e.g. a whole line.
    pub fn send(&mut self, bytes: &str) {
        self.keys.write_all(bytes.as_bytes()).unwrap();
    }

    /// Returns how the terminal takes keys.
    pub fn mode(&self) -> Mode {
        let flags = tcgetattr(&self.keys).unwrap().local_flags;
        Mode {
            is_by_lines: flags.contains(LocalFlags::ICANON),
            is_echoed: flags.contains(LocalFlags::ECHO),
        }
    }

    /// Returns the exit code, and what was shown last.
    pub fn end(self) -> (Option<i32>, String) {
        let (code, shown, _) = self.ended();
        (code, shown)
    }

    /// Returns the exit code, what was shown last, and how the terminal was left.
    pub fn ended(mut self) -> (Option<i32>, String, Mode) {
        loop {
            match self.shown.recv_timeout(PATIENCE) {
                Ok(bytes) => self.text.push_str(&plain(&bytes)),
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {
                    self.child.kill().unwrap();
                    panic!("it does not end after:\n{}", self.text);
                }
            }
        }
        let mode = self.mode();
        let text = std::mem::take(&mut self.text);
        (self.child.wait().unwrap().code(), text, mode)
    }
}

fn plain(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap().replace('\r', "")
}

impl Drop for Session {
    fn drop(&mut self) {
        // A test that failed leaves nobody behind who waits for a key; one that went well has waited for the end already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
