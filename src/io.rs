//! What a command reads and writes: streams, environment, interrupts.
//!
//! In: [`Io::process`] for the process's own streams, or [`Io::in_memory`] for one command run inside a process.
//! Out: what verbs read, write and look up. Data goes to stdout, talk to stderr; a closed pipe is not an error. The working
//! folder and the environment are the process's.

use crate::exit::{Exit, Failure};
use fab_base::files;
use fab_base::interrupt::Interrupt;
use fab_compiler::diag::{Color, visible};
use serde::Serialize;
use std::ffi::{OsStr, OsString};
use std::io::{BufRead, BufReader, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::SystemTime;

/// The surroundings of one command. Cloning shares the streams.
#[derive(Clone)]
pub struct Io {
    streams: Arc<Streams>,
    /// `None` means an interrupt raised by SIGINT and SIGTERM.
    interrupt: Option<Interrupt>,
}

struct Streams {
    stdin: Mutex<Box<dyn BufRead + Send>>,
    stdout: Mutex<Sink>,
    stderr: Mutex<Sink>,
    /// Whether stdin, stdout and stderr are terminals.
    terminals: [bool; 3],
    /// Why data could not be written, if a write failed.
    lost: OnceLock<String>,
}

enum Sink {
    Kept(Vec<u8>),
    To(Box<dyn Write + Send>),
}

impl Sink {
    fn write(&mut self, text: &str) -> std::io::Result<()> {
        match self {
            Sink::Kept(bytes) => bytes.extend(text.as_bytes()),
            Sink::To(writer) => {
                writer.write_all(text.as_bytes())?;
                writer.flush()?;
            }
        }
        Ok(())
    }

    fn kept(&self) -> String {
        match self {
            Sink::Kept(bytes) => String::from_utf8_lossy(bytes).into_owned(),
            Sink::To(_) => String::new(),
        }
    }
}

/// What a command wrote, if [`Io`] captured it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Captured {
    /// Captured data.
    pub stdout: String,
    /// Captured talk.
    pub stderr: String,
}

fn lock<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Io {
    /// Returns the process's own streams and signals.
    pub fn process() -> Io {
        let terminals = [
            std::io::stdin().is_terminal(),
            std::io::stdout().is_terminal(),
            std::io::stderr().is_terminal(),
        ];
        let stdin = BufReader::new(std::io::stdin());
        let stdout = Sink::To(Box::new(std::io::stdout()));
        let stderr = Sink::To(Box::new(std::io::stderr()));
        Io::of(stdin, stdout, stderr, terminals, None)
    }

    /// Makes surroundings with empty stdin, captured output and no interrupts.
    pub fn in_memory() -> Io {
        let kept = || Sink::Kept(Vec::new());
        let interrupt = Some(Interrupt::default());
        Io::of(std::io::empty(), kept(), kept(), [false; 3], interrupt)
    }

    fn of(
        stdin: impl BufRead + Send + 'static,
        stdout: Sink,
        stderr: Sink,
        terminals: [bool; 3],
        interrupt: Option<Interrupt>,
    ) -> Io {
        let streams = Arc::new(Streams {
            stdin: Mutex::new(Box::new(stdin)),
            stdout: Mutex::new(stdout),
            stderr: Mutex::new(stderr),
            terminals,
            lost: OnceLock::new(),
        });
        Io { streams, interrupt }
    }

    /// Returns what the command wrote, if output was captured.
    pub fn captured(&self) -> Captured {
        Captured {
            stdout: lock(&self.streams.stdout).kept(),
            stderr: lock(&self.streams.stderr).kept(),
        }
    }

    // --- Output ------------------------------------------------------------------------

    /// Writes data and a line end to stdout. On a terminal, hidden characters of foreign text are made visible;
    /// programs get the bytes as they are.
    pub(crate) fn data(&self, text: &str) {
        if self.streams.terminals[1] {
            self.painted_data(&visible(text))
        } else {
            self.painted_data(text)
        }
    }

    /// Writes data that has the command's own colours; the caller has made its foreign parts visible.
    pub(crate) fn painted_data(&self, text: &str) {
        self.write_data(&format!("{text}\n"));
    }

    fn write_data(&self, text: &str) {
        // A closed pipe (`| head`) means the reader has seen enough, so it is not an error.
        if let Err(error) = lock(&self.streams.stdout).write(text)
            && error.kind() != ErrorKind::BrokenPipe
        {
            self.streams.lost.get_or_init(|| error.to_string());
        }
    }

    pub(crate) fn json(&self, value: &impl Serialize) {
        let text = serde_json::to_string_pretty(value);
        let text = text.expect("a result has string keys and finite numbers");
        self.data(&text);
    }

    /// Writes a result to stdout: as one JSON document if `--json` was given, else as text, unless that is empty.
    pub(crate) fn either(
        &self,
        json: bool,
        document: &impl Serialize,
        text: impl FnOnce() -> String,
    ) {
        if json {
            self.json(document);
            return;
        }
        let text = text();
        if !text.is_empty() {
            self.data(&text);
        }
    }

    /// Writes a line of talk to stderr; hidden characters, such as those of a provider's error, are made visible.
    pub(crate) fn talk(&self, text: &str) {
        self.painted_talk(&visible(text));
    }

    /// Writes talk that has the command's own colours; the caller has made its foreign parts visible.
    pub(crate) fn painted_talk(&self, text: &str) {
        let _ = lock(&self.streams.stderr).write(&format!("{text}\n"));
    }

    /// Shows the progress of a long job in one terminal line, which the next call replaces; an empty text clears it.
    pub(crate) fn progress(&self, text: &str) {
        if self.streams.terminals[2] {
            // Carriage return, text, and "erase to the end of the line".
            let text = visible(text);
            let _ = lock(&self.streams.stderr).write(&format!("\r{text}\x1b[K"));
        }
    }

    /// Clears a terminal on stdout, including its scrollback; does nothing if stdout is not a terminal.
    pub(crate) fn clear(&self) {
        if self.streams.terminals[1] {
            let _ = lock(&self.streams.stdout).write("\x1b[H\x1b[2J\x1b[3J");
        }
    }

    /// Returns why some data could not be written; a closed pipe does not count.
    pub(crate) fn lost(&self) -> Option<&str> {
        self.streams.lost.get().map(String::as_str)
    }

    /// Returns whether talk may be coloured.
    pub(crate) fn talk_color(&self) -> Color {
        self.color(self.streams.terminals[2])
    }

    /// Returns whether data may be coloured.
    pub(crate) fn data_color(&self) -> Color {
        self.color(self.streams.terminals[1])
    }

    fn color(&self, is_terminal: bool) -> Color {
        let refused = self.variable("NO_COLOR").unwrap_or_default();
        if is_terminal && refused.is_empty() {
            Color::Ansi
        } else {
            Color::Plain
        }
    }

    /// Writes a help text or a command-line error.
    pub(crate) fn help(&self, error: &clap::Error) {
        let text = error.render();
        let in_color = |color| match color {
            Color::Ansi => text.ansi().to_string(),
            Color::Plain => text.to_string(),
        };
        if error.use_stderr() {
            let _ = lock(&self.streams.stderr).write(&in_color(self.talk_color()));
        } else {
            self.write_data(&in_color(self.data_color()));
        }
    }

    // --- Input -------------------------------------------------------------------------

    pub(crate) fn read<T>(&self, read: impl FnOnce(&mut dyn BufRead) -> T) -> T {
        read(&mut **lock(&self.streams.stdin))
    }

    /// Returns whether the streams are the process's own.
    pub(crate) fn is_process(&self) -> bool {
        self.interrupt.is_none()
    }

    /// Returns whether the user can be asked: stdin is a terminal.
    pub(crate) fn has_terminal_input(&self) -> bool {
        self.streams.terminals[0]
    }

    /// Returns whether stdin and stdout are both terminals.
    pub(crate) fn is_interactive(&self) -> bool {
        self.streams.terminals[0] && self.streams.terminals[1]
    }

    // --- Surroundings ------------------------------------------------------------------

    pub(crate) fn variable(&self, name: impl AsRef<OsStr>) -> Option<OsString> {
        std::env::var_os(name)
    }

    /// Returns the user's cache folder; `FABC_CACHE_DIR` overrides it.
    pub(crate) fn cache_folder(&self) -> Option<PathBuf> {
        let named = self.variable("FABC_CACHE_DIR");
        let named = named.filter(|value| !value.is_empty()).map(PathBuf::from);
        named.or_else(|| Some(dirs::cache_dir()?.join("fabc")))
    }

    pub(crate) fn now(&self) -> SystemTime {
        SystemTime::now()
    }

    /// Starts to record interrupts, so that work can stop between two of its steps. A second SIGINT ends the process at once.
    pub(crate) fn interrupt(&self) -> Result<Interrupt, Failure> {
        match &self.interrupt {
            Some(interrupt) => Ok(interrupt.clone()),
            None => signals(),
        }
    }

    /// Returns whether the user has interrupted since [`Io::interrupt`] was called.
    pub(crate) fn is_interrupted(&self) -> bool {
        match &self.interrupt {
            Some(interrupt) => interrupt.is_raised(),
            None => RAISED.get().is_some_and(Interrupt::is_raised),
        }
    }
}

/// Writes a file so that a crash leaves either the old content or the new.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    files::write_whole(path, bytes).map_err(|error| Failure::unwritable(path, error))
}

/// The interrupt that SIGINT and SIGTERM raise: a process has only one handler.
static RAISED: OnceLock<Interrupt> = OnceLock::new();

/// Cleanup before the process ends on a second signal, which runs no destructors.
static AT_EXIT: OnceLock<fn()> = OnceLock::new();

/// Registers a cleanup to run before the process ends on a second signal; only the first call counts.
pub(crate) fn at_exit(restore: fn()) {
    AT_EXIT.get_or_init(|| restore);
}

fn signals() -> Result<Interrupt, Failure> {
    static LISTENING: OnceLock<Result<(), String>> = OnceLock::new();
    let interrupt = RAISED.get_or_init(Interrupt::default).clone();
    let raised = interrupt.clone();
    let listening = LISTENING.get_or_init(|| {
        let set = ctrlc::set_handler(move || {
            if raised.is_raised() {
                if let Some(restore) = AT_EXIT.get() {
                    restore();
                }
                std::process::exit(i32::from(Exit::Interrupted.code()));
            }
            raised.raise();
        });
        set.map_err(|error| error.to_string())
    });
    let failed = |why| Failure::environment(format!("cannot listen for interrupts: {why}"));
    listening.as_ref().map_err(failed)?;
    Ok(interrupt)
}

#[cfg(test)]
mod tests;
