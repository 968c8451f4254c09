//! The client side of the watchdog: the child process, and the heartbeats sent to it.
//!
//! In: heartbeats. Out: lines for the child, and an error if the child is gone or reports that it has stopped the arm.

use super::lines_of;
use crate::io::Io;
use fab_arm::supervisor::Watchdog;
use std::io::Write;
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Time limit until the watchdog is ready: it connects to the arm's node.
const READY: Duration = Duration::from_secs(30);
/// How long to wait for its end. It takes longer only if the arm's node does not answer; then it continues alone, so that
/// this program can report at once that the arm may move.
const ENDED: Duration = Duration::from_secs(5);
/// Interval between two checks for its end.
const LOOK: Duration = Duration::from_millis(20);

/// A watchdog that is another process of this program.
pub struct Process {
    child: Child,
    stdin: Option<ChildStdin>,
    messages: Receiver<String>,
}

impl Process {
    /// Starts it, and waits until it can stop the arm; the error says why it cannot.
    ///
    /// - `timeout_s`: the longest time without a heartbeat, seconds.
    pub fn start(robot: &Path, timeout_s: f64, io: &Io) -> Result<Process, String> {
        let program = io.program().map_err(|error| error.to_string())?;
        let mut command = Command::new(program);
        command
            .args(["robot", "watchdog", "--robot"])
            .arg(robot)
            .args(["--timeout", &timeout_s.to_string()]);
        Process::spawn(command, READY)
    }

    /// Starts a watchdog command, and waits until it prints `ready`.
    fn spawn(mut command: Command, longest: Duration) -> Result<Process, String> {
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        // Ctrl-C goes to all of a group; the watchdog outlives it.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command
            .spawn()
            .map_err(|error| format!("the watchdog cannot be started: {error}"))?;
        let stdin = child.stdin.take();
        let stdout = child.stdout.take().expect("stdout is a pipe");
        let messages = lines_of(stdout);
        let ready = messages.recv_timeout(longest);
        let mut process = Process {
            child,
            stdin,
            messages,
        };
        let nothing = "so that nothing is moved";
        match ready.as_deref() {
            Ok("ready") => Ok(process),
            Err(RecvTimeoutError::Timeout) => {
                // It watches nothing yet, and may hang without noticing that its input has ended.
                let _ = process.child.kill();
                let secs = longest.as_secs_f64();
                Err(format!(
                    "the watchdog was not ready after {secs} s, {nothing}"
                ))
            }
            _ => Err(format!("the watchdog cannot stop this arm, {nothing}")),
        }
    }

    fn write(&mut self, line: &str) -> Result<(), String> {
        if let Ok(message) = self.messages.try_recv() {
            return Err(format!("the watchdog says: {message}"));
        }
        let gone = |error: std::io::Error| format!("the watchdog is gone: {error}");
        match &mut self.stdin {
            Some(stdin) => writeln!(stdin, "{line}")
                .and_then(|()| stdin.flush())
                .map_err(gone),
            None => Err("the watchdog is gone".to_owned()),
        }
    }
}

impl Watchdog for Process {
    fn watch(&mut self) -> Result<(), String> {
        self.write("watch")
    }

    fn beat(&mut self) -> Result<(), String> {
        self.write("beat")
    }

    fn rest(&mut self) {
        // A watchdog that is gone does not watch.
        let _ = self.write("rest");
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

#[cfg(all(test, unix))]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use std::thread;

    /// Another program in the watchdog's place.
    fn played(script: &str) -> Result<Process, String> {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        Process::spawn(command, Duration::from_secs(2))
    }

    #[test]
    #[ignore = "long"]
    fn one_that_is_never_ready_is_no_watchdog() {
        for (script, words) in [
            ("exit 2", "the watchdog cannot stop this arm"),
            ("echo cannot; cat", "the watchdog cannot stop this arm"),
            ("exec sleep 600", "the watchdog was not ready after 2 s"),
        ] {
            let begun = Instant::now();
            let why = played(script).map(drop).unwrap_err();
            assert!(
                why.starts_with(words) && why.ends_with("nothing is moved"),
                "{why}"
            );
            assert!(
                begun.elapsed() < Duration::from_secs(60),
                "it waited for `{script}`"
            );
        }
    }

    #[test]
    fn it_hears_each_line_and_that_they_end() {
        let folder = tempfile::tempdir().unwrap();
        let heard = folder.path().join("heard");
        let script = format!("echo ready; cat > '{}'; echo end >> '{0}'", heard.display());
        let mut process = played(&script).unwrap();
        process.watch().unwrap();
        process.beat().unwrap();
        process.rest();
        drop(process);
        // The client waits until the child exits, which is after the end of its input.
        let heard = std::fs::read_to_string(heard).unwrap();
        assert_eq!(heard, "watch\nbeat\nrest\nend\n");
    }

    #[test]
    #[ignore = "long"]
    fn one_that_goes_on_with_stopping_the_arm_is_left_to_it() {
        let process = played("echo ready; exec sleep 60").unwrap();
        let begun = Instant::now();
        drop(process);
        assert!(begun.elapsed() < Duration::from_secs(50));
    }

    #[test]
    fn one_that_is_gone_or_has_stopped_the_arm_ends_the_motion() {
        let ended = |script: &str| {
            let mut process = played(script).unwrap();
            let begun = Instant::now();
            loop {
                match process.beat() {
                    Err(why) => return why,
                    Ok(()) if begun.elapsed() > Duration::from_secs(60) => {
                        panic!("`{script}` is heard")
                    }
                    Ok(()) => thread::sleep(Duration::from_millis(5)),
                }
            }
        };
        assert!(ended("echo ready; exec 0<&-; exit 0").starts_with("the watchdog is gone"));
        let why = ended(
            "echo ready; read line; echo 'stopped: there was no sign of life'; cat > /dev/null",
        );
        assert_eq!(why, "the watchdog says: stopped: there was no sign of life");
    }
}
