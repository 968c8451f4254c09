//! Everything a command accesses beyond its arguments: streams, working folder, environment, interrupts.
//!
//! In: [`Io::process`] for the process's own surroundings, or [`Io::new`] for one command run inside a process. Out:
//! what verbs read, write and look up. Data goes to stdout, talk to stderr; a closed pipe is not an error.
//!
//! Not covered: what third-party libraries read themselves (proxy variables, certificates), the environment of programs
//! that a command starts, which is the process's, and raw keys of a terminal, which only the process's own streams have.

use crate::exit::{Exit, Failure};
use fab_base::files;
use fab_base::interrupt::Interrupt;
use fab_compiler::diag::{Color, is_hidden, visible};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::io::{BufRead, BufReader, Cursor, ErrorKind, IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::SystemTime;

/// Width of help texts if no terminal reports its own, columns.
const HELP_COLUMNS: usize = 100;

/// The surroundings of one command. Cloning shares the streams.
#[derive(Clone)]
pub struct Io {
    streams: Arc<Streams>,
    folder: Option<PathBuf>,
    /// `None` means the process's variables.
    variables: Option<Arc<BTreeMap<OsString, OsString>>>,
    /// `None` means an interrupt raised by SIGINT and SIGTERM.
    interrupt: Option<Interrupt>,
    /// `None` means the running program.
    program: Option<PathBuf>,
}

struct Streams {
    stdin: Mutex<Box<dyn BufRead + Send>>,
    stdout: Mutex<Sink>,
    stderr: Mutex<Sink>,
    /// Whether stdin, stdout and stderr are terminals.
    terminals: [bool; 3],
    /// Whether these are the process's own streams.
    is_process: bool,
    /// Why data could not be written, if a write failed.
    lost: OnceLock<String>,
}

enum Sink {
    Kept(Vec<u8>),
    To(Box<dyn Write + Send>),
}

impl Sink {
    fn write(&mut self, text: &str) -> std::io::Result<()> {
        let writer = self.writer();
        writer.write_all(text.as_bytes())?;
        writer.flush()
    }

    fn writer(&mut self) -> &mut dyn Write {
        match self {
            Sink::Kept(bytes) => bytes,
            Sink::To(writer) => writer,
        }
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

/// Writes the hidden characters of a JSON document, which are all inside of its strings, as JSON escapes them.
fn json_shown(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut result = String::with_capacity(text.len());
    for character in text.chars() {
        if is_hidden(character) {
            result.push_str(&format!("\\u{:04x}", u32::from(character)));
        } else {
            result.push(character);
        }
    }
    Cow::Owned(result)
}

fn lock<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Io {
    /// Returns the process's own streams, folder, environment, clock and signals.
    pub fn process() -> Io {
        Io {
            streams: Arc::new(Streams {
                stdin: Mutex::new(Box::new(BufReader::new(std::io::stdin()))),
                stdout: Mutex::new(Sink::To(Box::new(std::io::stdout()))),
                stderr: Mutex::new(Sink::To(Box::new(std::io::stderr()))),
                terminals: [
                    std::io::stdin().is_terminal(),
                    std::io::stdout().is_terminal(),
                    std::io::stderr().is_terminal(),
                ],
                is_process: true,
                lost: OnceLock::new(),
            }),
            folder: None,
            variables: None,
            interrupt: None,
            program: None,
        }
    }

    /// Makes surroundings with empty stdin, captured output, no variables and no interrupts.
    ///
    /// The command works in `folder`: relative paths on its command line start there.
    pub fn new(folder: impl Into<PathBuf>) -> Io {
        Io {
            streams: Arc::new(Streams {
                stdin: Mutex::new(Box::new(Cursor::new(Vec::new()))),
                stdout: Mutex::new(Sink::Kept(Vec::new())),
                stderr: Mutex::new(Sink::Kept(Vec::new())),
                terminals: [false; 3],
                is_process: false,
                lost: OnceLock::new(),
            }),
            folder: Some(folder.into()),
            variables: Some(Arc::default()),
            interrupt: Some(Interrupt::default()),
            program: None,
        }
    }

    /// Returns the same surroundings with `bytes` on stdin.
    pub fn with_stdin(self, bytes: impl Into<Vec<u8>>) -> Io {
        *lock(&self.streams.stdin) = Box::new(Cursor::new(bytes.into()));
        self
    }

    /// Returns the same surroundings, writing talk to a stream instead of capturing it.
    pub fn with_stderr(self, writer: impl Write + Send + 'static) -> Io {
        *lock(&self.streams.stderr) = Sink::To(Box::new(writer));
        self
    }

    /// Returns the same surroundings with one more environment variable.
    pub fn with_variable(mut self, name: impl Into<OsString>, value: impl Into<OsString>) -> Io {
        let variables = self
            .variables
            .get_or_insert_with(|| Arc::new(std::env::vars_os().collect()));
        Arc::make_mut(variables).insert(name.into(), value.into());
        self
    }

    /// Returns the same surroundings with another program to start as a helper process.
    pub fn with_program(mut self, program: impl Into<PathBuf>) -> Io {
        self.program = Some(program.into());
        self
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
            self.painted_data(&visible(text));
        } else {
            self.painted_data(text);
        }
    }

    /// Does the same as [`Io::data`] for a text with the command's own colours, whose foreign parts are visible.
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

    /// Writes one JSON document to stdout.
    pub(crate) fn json(&self, value: &serde_json::Value) {
        let text = serde_json::to_string_pretty(value).expect("a JSON value can be written");
        self.painted_data(&json_shown(&text));
    }

    /// Writes a verb's result: as JSON if `--json` was given, otherwise as text.
    pub(crate) fn report(
        &self,
        json: bool,
        to_json: impl FnOnce() -> serde_json::Value,
        to_text: impl FnOnce() -> String,
    ) {
        if json {
            self.json(&to_json());
        } else {
            self.data(&to_text());
        }
    }

    /// Writes a line of talk to stderr; hidden characters, such as those of a provider's error, are made visible.
    pub(crate) fn talk(&self, text: &str) {
        self.painted_talk(&visible(text));
    }

    /// Does the same as [`Io::talk`] for a text with the command's own colours, whose foreign parts are visible.
    pub(crate) fn painted_talk(&self, text: &str) {
        let _ = lock(&self.streams.stderr).write(&format!("{text}\n"));
    }

    /// Shows the progress of a long job in one terminal line, which the next call replaces; does nothing without a
    /// terminal.
    ///
    /// An empty text clears the line.
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
        let refused = self
            .variable("NO_COLOR")
            .is_some_and(|value| !value.is_empty());
        if is_terminal && !refused {
            Color::Ansi
        } else {
            Color::Plain
        }
    }

    /// Sets the width of a command's help.
    pub(crate) fn command(&self, command: clap::Command) -> clap::Command {
        if self.is_process() {
            command
        } else {
            command.term_width(HELP_COLUMNS)
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

    /// Reads from stdin.
    pub(crate) fn read<T>(&self, read: impl FnOnce(&mut dyn BufRead) -> T) -> T {
        read(&mut **lock(&self.streams.stdin))
    }

    /// Returns stdin as a stream that can be moved to another thread.
    pub(crate) fn input(&self) -> Input {
        Input(self.clone())
    }

    /// Returns stdout as a stream.
    pub(crate) fn output(&self) -> Output<'_> {
        Output(self)
    }

    /// Returns whether the streams are the process's own.
    pub(crate) fn is_process(&self) -> bool {
        self.streams.is_process
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

    /// Returns a variable of the environment.
    pub(crate) fn variable(&self, name: impl AsRef<OsStr>) -> Option<OsString> {
        match &self.variables {
            None => std::env::var_os(name),
            Some(variables) => variables.get(name.as_ref()).cloned(),
        }
    }

    /// Returns the user's cache folder; `FABC_CACHE_DIR` overrides it.
    pub(crate) fn cache_folder(&self) -> Option<PathBuf> {
        let named = self.variable("FABC_CACHE_DIR");
        let named = named.filter(|value| !value.is_empty()).map(PathBuf::from);
        named.or_else(|| {
            let folder = self.user_folder(dirs::cache_dir, "XDG_CACHE_HOME", ".cache")?;
            Some(folder.join("fabc"))
        })
    }

    /// Returns one of the user's folders: the system's, or the one that the command's own environment names.
    pub(crate) fn user_folder(
        &self,
        of_process: fn() -> Option<PathBuf>,
        variable: &str,
        in_home: &str,
    ) -> Option<PathBuf> {
        if self.is_process() {
            return of_process();
        }
        let named = self.variable(variable).map(PathBuf::from);
        named.or_else(|| Some(PathBuf::from(self.variable("HOME")?).join(in_home)))
    }

    /// Returns the current time.
    pub(crate) fn now(&self) -> SystemTime {
        SystemTime::now()
    }

    /// Returns the program to start as a helper process.
    pub(crate) fn program(&self) -> std::io::Result<PathBuf> {
        match &self.program {
            Some(program) => Ok(program.clone()),
            None => std::env::current_exe(),
        }
    }

    /// Starts to record interrupts, so that work can stop between two of its steps.
    ///
    /// A second SIGINT ends the process at once.
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

    /// Returns the same surroundings in another working folder.
    pub(crate) fn within(&self, folder: &Path) -> Io {
        Io {
            folder: Some(folder.to_owned()),
            ..self.clone()
        }
    }

    /// Runs `work` with this working folder, on a separate thread if the process's working folder is another one.
    pub(crate) fn in_folder<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
        let Some(folder) = &self.folder else {
            return Ok(work());
        };
        let entered = folder::with(folder, work);
        entered.map_err(|error| {
            Failure::environment(format!(
                "the folder `{}` cannot be entered: {error}",
                folder.display()
            ))
        })
    }
}

/// Writes a file so that a crash leaves either the old content or the new.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    files::write_whole(path, bytes).map_err(|error| Failure::unwritable(path, error))
}

/// Stdin as a stream.
pub(crate) struct Input(Io);

impl Read for Input {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.0.read(|stdin| stdin.read(buffer))
    }
}

/// Stdout as a stream.
pub(crate) struct Output<'io>(&'io Io);

impl Write for Output<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        lock(&self.0.streams.stdout).writer().write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        lock(&self.0.streams.stdout).writer().flush()
    }
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
    match listening {
        Ok(()) => Ok(interrupt),
        Err(why) => Err(Failure::environment(format!(
            "cannot listen for interrupts: {why}"
        ))),
    }
}

/// Runs work in another working folder than the process's.
mod folder {
    use std::cell::Cell;
    use std::path::{Path, PathBuf};
    use std::sync::{Mutex, PoisonError};

    /// Runs work on a thread whose working folder is shared only with the threads that it starts.
    #[cfg(target_os = "linux")]
    pub fn with<T: Send>(folder: &Path, work: impl FnOnce() -> T + Send) -> std::io::Result<T> {
        use nix::sched::{CloneFlags, unshare};

        let tried = std::thread::scope(|scope| {
            // As large as the stack of a main thread.
            let builder = std::thread::Builder::new().stack_size(8 << 20);
            let thread =
                builder.spawn_scoped(scope, move || match unshare(CloneFlags::CLONE_FS) {
                    Ok(()) => Ok(std::env::set_current_dir(folder).map(|()| work())),
                    // Docker forbids it unless a container is privileged.
                    Err(_) => Err(work),
                })?;
            let done = thread.join();
            std::io::Result::Ok(done.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        })?;
        match tried {
            Ok(done) => done,
            Err(work) => in_turn(folder, work),
        }
    }

    /// Runs work in another working folder while no other work does.
    #[cfg(not(target_os = "linux"))]
    pub fn with<T: Send>(folder: &Path, work: impl FnOnce() -> T + Send) -> std::io::Result<T> {
        in_turn(folder, work)
    }

    static ENTERED: Mutex<()> = Mutex::new(());

    thread_local! {
        /// Whether this thread has its turn already.
        static HAS_TURN: Cell<bool> = const { Cell::new(false) };
    }

    /// Returns to the earlier folder when dropped, even after a panic.
    struct Return {
        folder: PathBuf,
        had_turn: bool,
    }

    impl Drop for Return {
        fn drop(&mut self) {
            // The earlier folder may have been deleted; then there is nobody to report it to.
            let _ = std::env::set_current_dir(&self.folder);
            HAS_TURN.set(self.had_turn);
        }
    }

    /// Changes the process's only working folder for a while.
    fn in_turn<T>(folder: &Path, work: impl FnOnce() -> T) -> std::io::Result<T> {
        let had_turn = HAS_TURN.get();
        let _turn = (!had_turn).then(|| ENTERED.lock().unwrap_or_else(PoisonError::into_inner));
        let _return = Return {
            folder: std::env::current_dir()?,
            had_turn,
        };
        std::env::set_current_dir(folder)?;
        HAS_TURN.set(true);
        Ok(work())
    }

    #[cfg(test)]
    mod tests {
        #![allow(clippy::unwrap_used)]

        use super::in_turn;
        use std::env::current_dir;

        #[test]
        fn a_folder_can_be_entered_from_within_another_and_is_left_after_a_panic() {
            let before = current_dir().unwrap();
            let [outer, inner] = [(), ()].map(|()| tempfile::tempdir().unwrap());
            let real = |folder: &tempfile::TempDir| folder.path().canonicalize().unwrap();
            let seen = in_turn(outer.path(), || {
                let within = in_turn(inner.path(), || current_dir().unwrap()).unwrap();
                (within, current_dir().unwrap())
            });
            assert_eq!(seen.unwrap(), (real(&inner), real(&outer)));
            let panicked =
                std::panic::catch_unwind(|| in_turn(outer.path(), || panic!("on purpose")));
            assert!(panicked.is_err());
            assert_eq!(current_dir().unwrap(), before);
        }
    }
}

#[cfg(test)]
mod tests;
