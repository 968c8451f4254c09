//! A separate process that stops the arm if the process that moves it sends no heartbeat.
//!
//! In: lines `watch`, `beat`, `rest` and `stop` on stdin. Out: `ready` once it can stop the arm, each of the first three
//! lines again to acknowledge it, and a line if it stopped the arm. It ends with stdin; if that happens while it watches,
//! it stops the arm.

mod process;

use clap::Args;
pub use process::Process;
use std::path::PathBuf;

use super::connect;
use super::terminal::line_of;
use crate::exit::{Exit, Failure};
use crate::io::Io;
use fab_arm::port::Port;
use fab_arm::settings::{DriverKind, Settings};
use std::io::{BufReader, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

#[derive(Args)]
pub struct WatchdogArguments {
    /// The arm's settings.
    #[arg(long, value_name = "FILE")]
    pub robot: PathBuf,
    /// The longest time without a heartbeat, seconds.
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub timeout: f64,
}

fn seconds(text: &str) -> Result<f64, String> {
    let read = text.parse().ok().filter(|it| (0.05..=60.0).contains(it));
    read.ok_or_else(|| "write seconds, 0.05 to 60".to_owned())
}

const ATTEMPTS: u32 = 5;
/// What it says once it has stopped the arm.
const STOPPED: &str = "stopped: a stop was requested, or the heartbeats ended";
const MAX_WAITING: usize = 64;

type Stop = Box<dyn FnMut() -> Result<(), String>>;

pub fn run(arguments: &WatchdogArguments, io: &Io) -> Result<Exit, Failure> {
    let settings = Settings::load(&arguments.robot)?;
    let mut stop = stopper(&settings).map_err(Failure::environment)?;
    let lines = lines_of(std::io::stdin());
    io.data("ready");
    let timeout = Duration::from_secs_f64(arguments.timeout);
    let mut acknowledge = |line: &str| io.data(line);
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

/// Connects to the arm, and returns a function that stops it.
fn stopper(settings: &Settings) -> Result<Stop, String> {
    const CONNECT_S: f64 = 10.0;
    if settings.driver == DriverKind::Simulated {
        return Err("an arm that this program simulates cannot be stopped from outside".to_owned());
    }
    let settings = settings.clone();
    let connect = move || connect::port(&settings, CONNECT_S);
    let mut port = connect()?;
    Ok(Box::new(move || {
        let stopped = port.stop().map_err(|error| error.to_string());
        // Reconnect for the next attempt.
        if stopped.is_err()
            && let Ok(again) = connect()
        {
            port = again;
        }
        stopped
    }))
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

/// Stops the arm on `stop`, if no heartbeat comes for `timeout` after `watch`, or the lines end before `rest`.
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
        match (line.as_deref(), deadline) {
            (Ok("watch"), _) | (Ok("beat"), Some(_)) => deadline = Some(Instant::now() + timeout),
            (Ok("rest"), _) => deadline = None,
            (Err(_), None) => return None,
            (Ok("stop"), _) | (Err(_), Some(_)) => return Some(stopped(stop)),
            // A heartbeat while it does not watch, or an unknown line.
            (Ok(_), _) => continue,
        }
        if let Ok(line) = line {
            acknowledge(&line);
        }
    }
}

fn stopped(stop: &mut dyn FnMut() -> Result<(), String>) -> Result<(), String> {
    let mut last = stop();
    for _ in 1..ATTEMPTS {
        last = last.or_else(|_| stop());
    }
    last
}

#[cfg(test)]
mod tests;
