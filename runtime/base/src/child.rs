//! A user's program, in any language, that answers line by line.
//!
//! In: a command line, and lines for its stdin. Out: the lines of its stdout, one for each line sent. The program gets
//! its own process group, which is killed when the `Child` is dropped. Whatever it does (hang, die, flood, write half a
//! line), the caller gets an error that names it, and every wait has a limit. What the lines mean is left to the
//! caller.

use crate::interrupt::Interrupt;
use crate::wording::shown;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{self, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// The longest line accepted, bytes.
pub const MAX_LINE_BYTES: usize = 1 << 20;

/// How much of stderr is written to its file, bytes.
const MAX_STDERR_BYTES: usize = 1 << 20;

/// How much of the end of stderr a message quotes, bytes.
const STDERR_BYTES: usize = 600;

/// How much of a line a message quotes, characters.
const EXCERPT_CHARS: usize = 160;

/// How long a program has to exit by itself after its stdin is closed.
const GRACE: Duration = Duration::from_secs(1);

/// How often a wait checks the interrupt and the process.
const TICK: Duration = Duration::from_millis(20);

/// A program and its arguments.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CommandLine {
    /// The program, then its arguments; never empty.
    words: Vec<String>,
    text: String,
}

impl CommandLine {
    /// Splits a command line into words as a shell does; no shell runs it.
    ///
    /// Fails if it has no words, or an unclosed quotation.
    pub fn parse(text: &str) -> Result<CommandLine, String> {
        match shlex::split(text) {
            None => Err(format!("`{text}` has a quotation that does not end")),
            Some(words) if words.is_empty() => Err(
                "it names no program; write a command line, such as `python3 policy.py`".to_owned(),
            ),
            Some(words) => Ok(CommandLine {
                words,
                text: text.to_owned(),
            }),
        }
    }

    /// Returns the words that name existing files: the program's own files, as far as the command line shows.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let paths = self.words.iter().map(Path::new);
        paths.filter(|path| path.is_file())
    }
}

impl fmt::Display for CommandLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Why a program gave no valid answer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChildError {
    /// It did not start, or broke the protocol: the command line, what it did, and the end of its stderr.
    #[error("{0}")]
    Failed(String),
    /// A stop was requested.
    #[error("interrupted")]
    Interrupted,
}

/// What the thread that reads stdout saw.
enum Output {
    Line(Vec<u8>),
    HalfLine(Vec<u8>),
    Flood,
}

/// A running program; killed when this is dropped.
#[derive(Debug)]
pub struct Child {
    command: CommandLine,
    process: process::Child,
    /// Whether its group was killed; the group id may be reused after that.
    is_killed: bool,
    /// `None` once stdin is to be closed.
    stdin: Option<Sender<Vec<u8>>>,
    stdout: Receiver<Output>,
    stderr: Arc<Mutex<Vec<u8>>>,
    stderr_reader: thread::JoinHandle<()>,
}

impl Child {
    /// Starts a program in the working folder.
    ///
    /// - `stderr`: the file its stderr is appended to, up to 1 MiB.
    pub fn start(command: &CommandLine, stderr: Option<&Path>) -> Result<Child, ChildError> {
        let failed = |why: std::io::Error| {
            ChildError::Failed(format!("`{command}` cannot be started: {why}"))
        };
        let kept = stderr.map(|path| File::options().create(true).append(true).open(path));
        let kept = kept.transpose().map_err(failed)?;
        let [program, arguments @ ..] = command.words.as_slice() else {
            unreachable!("a command line has at least one word");
        };
        let mut process = process::Command::new(program);
        process
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut process, 0);
        let mut process = process.spawn().map_err(failed)?;
        const PIPED: &str = "the stream is a pipe";
        let mut stdin = process.stdin.take().expect(PIPED);
        let (send, lines) = channel::<Vec<u8>>();
        // A program that does not read its stdin must not block the caller.
        thread::spawn(move || {
            while let Ok(line) = lines.recv() {
                if stdin.write_all(&line).and_then(|()| stdin.flush()).is_err() {
                    break;
                }
            }
        });
        let tail = Arc::new(Mutex::new(Vec::new()));
        Ok(Child {
            command: command.clone(),
            stdin: Some(send),
            stdout: read_lines(process.stdout.take().expect(PIPED)),
            stderr_reader: read_errors(
                process.stderr.take().expect(PIPED),
                kept,
                Arc::clone(&tail),
            ),
            stderr: tail,
            is_killed: false,
            process,
        })
    }

    /// Sends a question and returns its answer.
    pub fn ask<A: DeserializeOwned>(
        &mut self,
        question: &impl Serialize,
        limit: Duration,
        interrupt: &Interrupt,
    ) -> Result<A, ChildError> {
        self.send(question)?;
        let line = self.receive(limit, interrupt)?;
        self.read(&line)
    }

    /// Sends a line; fails if the program has already written one that was not asked for.
    ///
    /// Panics if the question holds a path that is not UTF-8.
    pub fn send(&mut self, question: &impl Serialize) -> Result<(), ChildError> {
        match self.stdout.try_recv() {
            Err(TryRecvError::Empty) => {
                self.tell(question);
                Ok(())
            }
            Ok(output) => Err(self.broken(output)),
            Err(TryRecvError::Disconnected) => Err(self.ended()),
        }
    }

    /// Sends a line, even if the program has written something since.
    pub fn tell(&mut self, question: &impl Serialize) {
        let mut line =
            serde_json::to_vec(question).expect("a question has string keys and paths of UTF-8");
        line.push(b'\n');
        // If the program no longer reads, the wait for the answer finds out why.
        if let Some(stdin) = &self.stdin {
            let _ = stdin.send(line);
        }
    }

    /// Waits for the next line.
    pub fn receive(
        &mut self,
        limit: Duration,
        interrupt: &Interrupt,
    ) -> Result<Vec<u8>, ChildError> {
        let begun = Instant::now();
        loop {
            match self.stdout.recv_timeout(TICK) {
                Ok(Output::Line(line)) => return Ok(line),
                Ok(other) => return Err(self.broken(other)),
                Err(RecvTimeoutError::Disconnected) => return Err(self.ended()),
                Err(RecvTimeoutError::Timeout) => {}
            }
            if interrupt.is_raised() {
                return Err(ChildError::Interrupted);
            }
            if matches!(self.process.try_wait(), Ok(Some(_)) | Err(_)) {
                // A process that it started may hold the pipe open, and its last output may still be on the way.
                self.kill();
                return match self.stdout.recv_timeout(GRACE) {
                    Ok(Output::Line(line)) => Ok(line),
                    Ok(other) => Err(self.broken(other)),
                    Err(_) => Err(self.ended()),
                };
            }
            if begun.elapsed() >= limit {
                self.kill();
                let limit_s = limit.as_secs();
                let what = format!("did not answer within {limit_s} s and was killed");
                return Err(self.failed(&what));
            }
        }
    }

    /// Parses an answer.
    pub fn read<A: DeserializeOwned>(&self, line: &[u8]) -> Result<A, ChildError> {
        serde_json::from_slice(line).map_err(|error| self.no_answer(line, error))
    }

    /// Reports a line that is not a valid answer.
    pub fn no_answer(&self, line: &[u8], why: impl fmt::Display) -> ChildError {
        ChildError::Failed(format!(
            "`{}` wrote `{}`, which is not a valid answer: {why}; an answer is one line of JSON",
            self.command,
            excerpt(line)
        ))
    }

    fn broken(&mut self, output: Output) -> ChildError {
        match output {
            Output::Line(line) => ChildError::Failed(format!(
                "`{}` wrote an unexpected line, `{}`: it must write one answer per question",
                self.command,
                excerpt(&line)
            )),
            Output::HalfLine(line) => {
                let what = format!("ended in the middle of the line `{}`", excerpt(&line));
                self.failed(&what)
            }
            Output::Flood => {
                self.kill();
                let what = format!("wrote {MAX_LINE_BYTES} bytes without a newline and was killed");
                self.failed(&what)
            }
        }
    }

    fn ended(&mut self) -> ChildError {
        let status = self.wait(GRACE).map(|status| status.to_string());
        self.kill();
        let how = status.unwrap_or("it closed its stdout and went on".to_owned());
        self.failed(&format!("ended before it answered ({how})"))
    }

    /// Reports what the program did, with the end of its stderr.
    fn failed(&self, what: &str) -> ChildError {
        // Its last output may still be on the way.
        let begun = Instant::now();
        while !self.stderr_reader.is_finished() && begun.elapsed() < GRACE {
            thread::sleep(TICK);
        }
        let tail = self.stderr.lock().unwrap_or_else(PoisonError::into_inner);
        let text = String::from_utf8_lossy(&tail);
        let stderr = match text.trim() {
            "" => String::new(),
            text => format!("; its stderr ends with: {text}"),
        };
        ChildError::Failed(format!("`{}` {what}{stderr}", self.command))
    }

    /// Waits for the program to exit, for at most this long.
    fn wait(&mut self, most: Duration) -> Option<process::ExitStatus> {
        let begun = Instant::now();
        loop {
            match self.process.try_wait() {
                Ok(None) if begun.elapsed() < most => thread::sleep(TICK),
                status => return status.ok().flatten(),
            }
        }
    }

    /// Kills the program and everything that it started.
    fn kill(&mut self) {
        self.stdin = None;
        if std::mem::replace(&mut self.is_killed, true) {
            return;
        }
        #[cfg(unix)]
        if let Ok(group) = i32::try_from(self.process.id()) {
            use nix::sys::signal::{Signal, killpg};
            let _ = killpg(nix::unistd::Pid::from_raw(group), Signal::SIGKILL);
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        self.stdin = None;
        self.wait(GRACE);
        self.kill();
    }
}

/// Reads lines in a separate thread, a few ahead of the consumer.
fn read_lines(source: impl Read + Send + 'static) -> Receiver<Output> {
    let (send, lines) = sync_channel(4);
    thread::spawn(move || {
        let mut source = BufReader::new(source);
        loop {
            let mut line = Vec::new();
            let mut limited = source.by_ref().take(MAX_LINE_BYTES as u64);
            let read = limited.read_until(b'\n', &mut line);
            let output = match (read, line.pop()) {
                (Ok(_), Some(b'\n')) => Output::Line(line),
                (Err(_), _) | (_, None) => break,
                (Ok(MAX_LINE_BYTES), Some(_)) => Output::Flood,
                (Ok(_), Some(last)) => {
                    line.push(last);
                    Output::HalfLine(line)
                }
            };
            let is_last = !matches!(output, Output::Line(_));
            if send.send(output).is_err() || is_last {
                break;
            }
        }
    });
    lines
}

/// Reads stderr in a separate thread, into its file and a short tail.
fn read_errors(
    mut source: impl Read + Send + 'static,
    mut file: Option<File>,
    tail: Arc<Mutex<Vec<u8>>>,
) -> thread::JoinHandle<()> {
    thread::spawn(move || {
        let mut buffer = [0; 4096];
        let mut kept = 0;
        while let Ok(count @ 1..) = source.read(&mut buffer) {
            let bytes = &buffer[..count];
            let room = MAX_STDERR_BYTES.saturating_sub(kept);
            if let Some(file) = &mut file {
                // Keep reading even if the file cannot be written: the program must not block.
                let _ = file.write_all(&bytes[..count.min(room)]);
            }
            kept += count;
            let mut tail = tail.lock().unwrap_or_else(PoisonError::into_inner);
            tail.extend_from_slice(bytes);
            let surplus = tail.len().saturating_sub(STDERR_BYTES);
            tail.drain(..surplus);
        }
    })
}

/// Shortens a program's output for a message.
pub fn excerpt(line: &[u8]) -> String {
    // A character has at most four bytes.
    let start = &line[..line.len().min(4 * EXCERPT_CHARS + 4)];
    shown(&String::from_utf8_lossy(start), EXCERPT_CHARS)
}

#[cfg(all(test, unix))]
#[path = "tests/child.rs"]
mod tests;
