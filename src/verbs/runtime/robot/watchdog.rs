//! A separate process that stops the arm if the process that moves it sends no heartbeat, and how that process drives it.
//!
//! In: lines `beat`, `rest` and `stop` on stdin. Out: `ready` once it can stop the arm, each `beat` and `rest` again to
//! acknowledge it, and a line if it stopped the arm. It watches from a `beat` to the next `rest`. It ends with stdin; if
//! that happens while it watches, it stops the arm. [`Process`] is an error if its child is gone, has stopped the arm, or
//! does not acknowledge in time: one that hangs could not stop the arm. Nothing in it waits while the arm moves.

use super::connect;
use super::terminal::line_of;
use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::Args;
use fab_arm::port::Port;
use fab_arm::settings::Settings;
use fab_arm::supervisor::Watchdog;
use std::collections::VecDeque;
use std::io::{BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

#[derive(Args)]
pub struct WatchdogArguments {
    /// The arm's settings; `tolerance.watchdog_s` is the longest time without a heartbeat.
    #[arg(long, value_name = "FILE")]
    pub robot: PathBuf,
}

const ATTEMPTS: u32 = 5;
const CONNECT_S: f64 = 10.0;
/// What it says once it has stopped the arm.
const STOPPED: &str = "stopped: a stop was requested, or the heartbeats ended";
/// Time limit until the watchdog is ready: it connects to the arm's node.
const READY: Duration = Duration::from_secs(30);
/// How long to wait for its end, or for its stop of the arm. If the arm's node does not answer, it continues alone, so that
/// this program can report at once that the arm may move.
const ENDED: Duration = Duration::from_secs(5);
const LOOK: Duration = Duration::from_millis(20);

pub fn run(arguments: &WatchdogArguments, io: &Io) -> Result<Exit, Failure> {
    let nothing = "it cannot be stopped from outside";
    let settings = connect::settings_of_real(&arguments.robot, nothing)?;
    let mut port = connect::port(&settings, CONNECT_S).map_err(Failure::environment)?;
    let lines = lines_of(std::io::stdin());
    io.data("ready");
    let timeout = Duration::from_secs_f64(settings.tolerance.watchdog_s);
    let mut acknowledge = |line: &str| io.data(line);
    let mut stop = || stop(&mut port, &settings);
    let Some(stopped) = keep_watch(&lines, timeout, &mut acknowledge, &mut stop) else {
        return Ok(Exit::Done);
    };
    let stopped = stopped.map_err(|why| format!("not stopped: {why}"));
    io.data(stopped.as_ref().map_or_else(String::as_str, |()| STOPPED));
    stopped.map_err(Failure::environment)?;
    Ok(Exit::Environment)
}

/// Stops the arm; after a failure the next attempt has a new connection.
fn stop(port: &mut Box<dyn Port>, settings: &Settings) -> Result<(), String> {
    let stopped = port.stop().map_err(|error| error.to_string());
    if stopped.is_err()
        && let Ok(again) = connect::port(settings, CONNECT_S)
    {
        *port = again;
    }
    stopped
}

/// Reads lines in a thread of its own; the channel closes at their end.
fn lines_of(source: impl Read + Send + 'static) -> Receiver<String> {
    let (send, lines) = channel();
    thread::spawn(move || {
        let mut source = BufReader::new(source);
        while let Some(line) = line_of(&mut source) {
            if send.send(line.trim().to_owned()).is_err() {
                break;
            }
        }
    });
    lines
}

/// Stops the arm on `stop`, if no heartbeat comes for `timeout` after another, or the lines end before `rest`.
///
/// Returns whether it could be stopped; `None` if there was no need.
fn keep_watch(
    lines: &Receiver<String>,
    timeout: Duration,
    acknowledge: &mut dyn FnMut(&str),
    stop: &mut dyn FnMut() -> Result<(), String>,
) -> Option<Result<(), String>> {
    let mut deadline: Option<Instant> = None;
    loop {
        let line = match deadline {
            None => lines.recv().map_err(|_| RecvTimeoutError::Disconnected),
            Some(at) => lines.recv_timeout(at.saturating_duration_since(Instant::now())),
        };
        match line.as_deref() {
            Ok("beat") => deadline = Some(Instant::now() + timeout),
            Ok("rest") => deadline = None,
            Err(_) if deadline.is_none() => return None,
            Ok("stop") | Err(_) => break,
            Ok(_) => continue,
        }
        if let Ok(line) = line {
            acknowledge(&line);
        }
    }
    let mut stopped = stop();
    for _ in 1..ATTEMPTS {
        stopped = stopped.or_else(|_| stop());
    }
    Some(stopped)
}

/// The process as it is driven by the one that moves the arm.
pub struct Process {
    child: Child,
    /// `None` once it was closed. It never fills: lines are short, and none is sent after one that nobody reads.
    stdin: Option<ChildStdin>,
    messages: Receiver<String>,
    /// Lines that were sent and not acknowledged, with their times.
    sent: VecDeque<(&'static str, Instant)>,
    has_stopped_arm: bool,
    timeout: Duration,
}

impl Process {
    /// Starts it, and waits until it can stop the arm.
    ///
    /// - `timeout_s`: the longest time without a heartbeat, and the longest until one is acknowledged.
    pub fn start(robot: &Path, timeout_s: f64) -> Result<Process, String> {
        let program = std::env::current_exe().map_err(|error| error.to_string())?;
        let mut command = Command::new(program);
        command.args(["robot", "watchdog", "--robot"]).arg(robot);
        Process::spawn(command, READY, Duration::from_secs_f64(timeout_s))
    }

    /// Starts a watchdog command, and waits until it prints `ready`.
    fn spawn(
        mut command: Command,
        longest: Duration,
        timeout: Duration,
    ) -> Result<Process, String> {
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        // Ctrl-C goes to all of a group; the watchdog outlives it.
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let child = command.spawn();
        let mut child =
            child.map_err(|error| format!("the watchdog cannot be started: {error}"))?;
        let stdout = child.stdout.take().expect("stdout is a pipe");
        let mut process = Process {
            stdin: child.stdin.take(),
            child,
            messages: lines_of(stdout),
            sent: VecDeque::new(),
            has_stopped_arm: false,
            timeout,
        };
        let why = match process.messages.recv_timeout(longest).as_deref() {
            Ok("ready") => return Ok(process),
            Err(RecvTimeoutError::Timeout) => {
                // It watches nothing yet, and may hang without noticing that its input has ended.
                let _ = process.child.kill();
                format!("was not ready after {} s", longest.as_secs_f64())
            }
            _ => "cannot stop this arm".to_owned(),
        };
        Err(format!("the watchdog {why}, so that nothing is moved"))
    }

    /// Sends a line without waiting; fails if an earlier one was not acknowledged in time.
    fn send(&mut self, line: &'static str) -> Result<(), String> {
        while self.heard(Duration::ZERO)? {}
        let stdin = self.stdin.as_mut().ok_or(GONE)?;
        writeln!(stdin, "{line}").map_err(|why| format!("{GONE}: {why}"))?;
        self.sent.push_back((line, Instant::now()));
        Ok(())
    }

    /// Waits for a message, at most `longest`, which acknowledges the first of the lines that were not; returns whether
    /// one came. Fails if that line has waited too long.
    fn heard(&mut self, longest: Duration) -> Result<bool, String> {
        let message = match self.messages.recv_timeout(longest) {
            Ok(message) => message,
            Err(RecvTimeoutError::Disconnected) => return Err(GONE.to_owned()),
            Err(RecvTimeoutError::Timeout) => {
                let timeout = self.timeout;
                let late = self.sent.front().filter(|(_, at)| at.elapsed() > timeout);
                return late.map_or(Ok(false), |(line, _)| {
                    Err(format!(
                        "the watchdog has not acknowledged `{line}` within {timeout:?}"
                    ))
                });
            }
        };
        self.has_stopped_arm |= message == STOPPED;
        match self.sent.pop_front() {
            Some((line, _)) if line == message => Ok(true),
            _ => Err(format!("the watchdog says: {message}")),
        }
    }
}

const GONE: &str = "the watchdog is gone";

impl Watchdog for Process {
    fn watch(&mut self) -> Result<(), String> {
        self.send("beat")?;
        while !self.sent.is_empty() {
            self.heard(LOOK)?;
        }
        Ok(())
    }

    fn beat(&mut self) -> Result<(), String> {
        self.send("beat")
    }

    fn rest(&mut self) {
        // A watchdog that is gone does not watch.
        let _ = self.send("rest");
    }

    fn stop(&mut self) -> Result<(), String> {
        if self.has_stopped_arm {
            return Ok(());
        }
        if let Some(stdin) = &mut self.stdin {
            let _ = writeln!(stdin, "stop");
        }
        let deadline = Instant::now() + ENDED;
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.messages.recv_timeout(left) {
                Ok(message) if message == STOPPED => return Ok(()),
                Ok(message) if matches!(message.as_str(), "beat" | "rest") => {}
                Ok(message) => return Err(message),
                Err(RecvTimeoutError::Timeout) => return Err("it does not answer".to_owned()),
                Err(RecvTimeoutError::Disconnected) => return Err("it is gone".to_owned()),
            }
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // Closing stdin ends it; it stops the arm first if it still watches.
        self.stdin = None;
        let begun = Instant::now();
        while matches!(self.child.try_wait(), Ok(None)) && begun.elapsed() < ENDED {
            std::thread::sleep(LOOK);
        }
    }
}

#[cfg(test)]
mod tests;
