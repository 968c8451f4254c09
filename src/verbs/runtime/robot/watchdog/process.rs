//! The client side of the watchdog: the child process, and the heartbeats sent to it.
//!
//! In: heartbeats. Out: lines for the child, and an error if the child is gone, reports that it has stopped the arm, or
//! does not acknowledge in time: one that hangs could not stop the arm. Nothing here waits while the arm moves.

use super::{STOPPED, lines_of};
use fab_arm::supervisor::Watchdog;
use fab_base::outbox::Outbox;
use std::collections::VecDeque;
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Time limit until the watchdog is ready: it connects to the arm's node.
const READY: Duration = Duration::from_secs(30);
/// How long to wait for its end, or for its stop of the arm. If the arm's node does not answer, it continues alone, so that
/// this program can report at once that the arm may move.
const ENDED: Duration = Duration::from_secs(5);
const LOOK: Duration = Duration::from_millis(20);
/// The most lines that wait for a pipe that is full.
const MAX_WAITING: usize = 16;

pub struct Process {
    child: Child,
    /// `None` once its input was closed.
    lines: Option<Outbox<&'static str>>,
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
        let mut stdin = child.stdin.take().expect("stdin is a pipe");
        let stdout = child.stdout.take().expect("stdout is a pipe");
        let messages = lines_of(stdout);
        let ready = messages.recv_timeout(longest);
        let write = move |line: &str| {
            let written = writeln!(stdin, "{line}").and_then(|()| stdin.flush());
            written.map_err(|error| error.to_string())
        };
        let mut process = Process {
            child,
            lines: Some(Outbox::new(MAX_WAITING, write)),
            messages,
            sent: VecDeque::new(),
            has_stopped_arm: false,
            timeout,
        };
        let why = match ready.as_deref() {
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
        let timeout = self.timeout;
        let late = self.sent.front().filter(|(_, at)| at.elapsed() > timeout);
        if let Some((line, _)) = late {
            return Err(format!(
                "the watchdog has not acknowledged `{line}` within {timeout:?}"
            ));
        }
        let sent = self.lines.as_mut().ok_or(GONE)?.send(line);
        sent.map_err(|why| format!("the watchdog is gone: {why}"))?;
        self.sent.push_back((line, Instant::now()));
        Ok(())
    }

    /// Waits for a message, at most `longest`, which acknowledges the first of the lines that were not; returns whether
    /// one came.
    fn heard(&mut self, longest: Duration) -> Result<bool, String> {
        let message = match self.messages.recv_timeout(longest) {
            Ok(message) => message,
            Err(RecvTimeoutError::Timeout) => return Ok(false),
            Err(RecvTimeoutError::Disconnected) => return Err(GONE.to_owned()),
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
        let deadline = Instant::now() + self.timeout;
        while !self.sent.is_empty() {
            if !self.heard(deadline.saturating_duration_since(Instant::now()))? {
                let timeout = self.timeout;
                return Err(format!(
                    "the watchdog does not acknowledge within {timeout:?} that it watches"
                ));
            }
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
        if let Some(lines) = &mut self.lines {
            let _ = lines.send("stop");
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
        self.lines = None;
        let begun = Instant::now();
        while matches!(self.child.try_wait(), Ok(None)) && begun.elapsed() < ENDED {
            std::thread::sleep(LOOK);
        }
    }
}

#[cfg(test)]
mod tests;
