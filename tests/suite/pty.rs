//! A command in a pseudo-terminal: its output, pressed keys, and the terminal's final state.

use nix::pty::{Winsize, openpty};
use nix::sys::termios::{LocalFlags, tcgetattr};
use std::fs::File;
use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Long enough for a loaded machine; no time is measured.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// A command that waits for keys.
pub struct Session {
    child: Child,
    keys: File,
    shown: Receiver<Vec<u8>>,
    text: String,
}

/// Whether the terminal reads lines and echoes keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mode {
    pub is_by_lines: bool,
    pub is_echoed: bool,
}

impl Session {
    /// Starts a command in a terminal of this width.
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
        // Reading the far end fails once nobody holds the terminal, so only the command may hold its ends.
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

    /// Starts a command like a shell in a new window: Ctrl-C in that terminal sends it a signal.
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

    /// Waits for a text, and returns everything shown since the last call.
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

    /// Presses a key once the command waits for it; before that, the terminal itself would echo it, or handle Ctrl-C.
    pub fn press(&mut self, key: &str) {
        for _ in 0..PATIENCE.as_millis() {
            if !self.mode().is_by_lines {
                break;
            }
            thread::sleep(Duration::from_millis(1));
        }
        self.send(key);
    }

    /// Sends the command a signal, e.g. `STOP`.
    #[cfg(target_os = "linux")]
    pub fn signal(&self, name: &str) {
        let mut kill = Command::new("kill");
        kill.args([&format!("-{name}"), &self.child.id().to_string()]);
        assert!(kill.status().unwrap().success());
    }

    /// Sends bytes at once, e.g. a whole line.
    pub fn send(&mut self, bytes: &str) {
        self.keys.write_all(bytes.as_bytes()).unwrap();
    }

    /// Returns how the terminal handles keys.
    pub fn mode(&self) -> Mode {
        let flags = tcgetattr(&self.keys).unwrap().local_flags;
        Mode {
            is_by_lines: flags.contains(LocalFlags::ICANON),
            is_echoed: flags.contains(LocalFlags::ECHO),
        }
    }

    /// Returns the exit code and the final output.
    pub fn end(self) -> (Option<i32>, String) {
        let (code, shown, _) = self.ended();
        (code, shown)
    }

    /// Returns the exit code, the final output, and the terminal's final state.
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
        // A failed test must not leave a process waiting for a key; a successful one has already waited for the end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
