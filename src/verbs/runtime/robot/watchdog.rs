//! A separate process that stops the arm if the process that moves it sends no heartbeat.
//!
//! In: lines `beat`, `rest` and `stop` on stdin. Out: `ready` once it can stop the arm, each `beat` and `rest` again to
//! acknowledge it, and a line if it stopped the arm. It watches from a `beat` to the next `rest`. It ends with stdin; if
//! that happens while it watches, it stops the arm.

mod process;

use clap::Args;
pub use process::Process;
use std::path::PathBuf;

use super::connect;
use super::terminal::line_of;
use crate::exit::{Exit, Failure};
use crate::io::Io;
use fab_arm::port::Port;
use fab_arm::settings::Settings;
use std::io::{BufReader, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
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
const MAX_WAITING: usize = 64;

pub fn run(arguments: &WatchdogArguments, io: &Io) -> Result<Exit, Failure> {
    let nothing = "it cannot be stopped from outside";
    let settings = connect::settings_of_real(&arguments.robot, nothing)?;
    let mut port = connect::port(&settings, CONNECT_S).map_err(Failure::environment)?;
    let lines = lines_of(std::io::stdin());
    io.data("ready");
    let timeout = Duration::from_secs_f64(settings.tolerance.watchdog_s);
    let mut acknowledge = |line: &str| io.data(line);
    let mut stop = || stop(&mut port, &settings);
    match keep_watch(&lines, timeout, &mut acknowledge, &mut stop) {
        None => Ok(Exit::Done),
        Some(Ok(())) => {
            io.data(STOPPED);
            Ok(Exit::Environment)
        }
        Some(Err(why)) => {
            io.data(&format!("not stopped: {why}"));
            let why = format!("the arm could not be stopped: {why}");
            Err(Failure::environment(why))
        }
    }
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
    let (send, lines) = sync_channel(MAX_WAITING);
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

#[cfg(test)]
mod tests;
