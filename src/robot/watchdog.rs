//! A process of its own that stops the arm when the one that moves it gives no sign of life.
//!
//! In: lines `watch`, `beat` and `rest` on stdin. Out: `ready` once it could stop the arm, and a line when it had to. It is
//! at its end when stdin is; where that comes while it watches, the arm is stopped.

mod process;

pub use process::Process;

use crate::cli::robot::WatchdogArguments;
use crate::exit::{Exit, Failure};
use crate::output;
use fab_arm::settings::Settings;
use std::io::{BufRead, BufReader, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// How often stopping is tried.
const TRIES: u32 = 5;
/// The longest line that is read, bytes.
const MAX_LINE: u64 = 256;

/// Stops the arm, from whichever state.
type Stop = Box<dyn FnMut() -> Result<(), String>>;

/// Keeps watch until stdin ends.
pub fn run(arguments: &WatchdogArguments) -> Result<Exit, Failure> {
    let settings = Settings::load(&arguments.robot).map_err(Failure::environment)?;
    let mut stop = stopper(&settings).map_err(Failure::environment)?;
    let lines = lines_of(std::io::stdin());
    output::data("ready");
    let timeout = Duration::from_secs_f64(arguments.timeout);
    match keep(&lines, timeout, &mut stop) {
        Ended::AtRest => Ok(Exit::Done),
        Ended::Stopped => {
            output::data("stopped: there was no sign of life");
            Ok(Exit::Environment)
        }
        Ended::NotStopped(why) => {
            output::data(&format!("not stopped: {why}"));
            Err(Failure::environment(format!(
                "there is no sign of life, and the arm could not be stopped: {why}"
            )))
        }
    }
}

/// Returns what stops the arm, connected to it already.
#[cfg(feature = "ros")]
fn stopper(settings: &Settings) -> Result<Stop, String> {
    use fab_arm::port::Port;
    const CONNECT_S: f64 = 10.0;
    let Some(ros) = settings.ros.clone() else {
        return Err("an arm that this program simulates cannot be stopped from outside".to_owned());
    };
    let model = settings.model.clone();
    let connect =
        move || fab_arm_ros::connect(&ros, &model, CONNECT_S).map_err(|error| error.to_string());
    let mut port = connect()?;
    Ok(Box::new(move || {
        let stopped = port.stop().map_err(|error| error.to_string());
        // Another connection for the next try.
        if stopped.is_err()
            && let Ok(again) = connect()
        {
            port = again;
        }
        stopped
    }))
}

/// Says why nothing can be stopped.
#[cfg(not(feature = "ros"))]
fn stopper(settings: &Settings) -> Result<Stop, String> {
    Err(match settings.ros {
        Some(_) => {
            "this program was built without the feature `ros`, and cannot stop an arm".to_owned()
        }
        None => "an arm that this program simulates cannot be stopped from outside".to_owned(),
    })
}

/// How a watch ended.
#[derive(Debug, PartialEq)]
enum Ended {
    AtRest,
    Stopped,
    NotStopped(String),
}

/// Reads lines in a thread of its own; the channel closes at their end.
fn lines_of(source: impl Read + Send + 'static) -> Receiver<String> {
    let (send, lines) = channel();
    thread::spawn(move || {
        let mut source = BufReader::new(source);
        loop {
            let mut bytes = Vec::new();
            let read = source.by_ref().take(MAX_LINE).read_until(b'\n', &mut bytes);
            let line = String::from_utf8_lossy(&bytes).trim().to_owned();
            if !matches!(read, Ok(1..)) || send.send(line).is_err() {
                break;
            }
        }
    });
    lines
}

/// Keeps watch: stops the arm where no beat came for `timeout` since `watch`, or the lines end before `rest`.
fn keep(
    lines: &Receiver<String>,
    timeout: Duration,
    stop: &mut dyn FnMut() -> Result<(), String>,
) -> Ended {
    let mut deadline: Option<Instant> = None;
    loop {
        let line = match deadline {
            None => lines.recv().map_err(|_| RecvTimeoutError::Disconnected),
            Some(at) => lines.recv_timeout(at.saturating_duration_since(Instant::now())),
        };
        match (line.as_deref(), deadline) {
            (Ok("watch"), _) | (Ok("beat"), Some(_)) => deadline = Some(Instant::now() + timeout),
            (Ok("rest"), _) => deadline = None,
            // What is not understood is no sign of life.
            (Ok(_), _) => {}
            (Err(_), None) => return Ended::AtRest,
            (Err(_), Some(_)) => return stopped(stop),
        }
    }
}

fn stopped(stop: &mut dyn FnMut() -> Result<(), String>) -> Ended {
    let mut last = String::new();
    for _ in 0..TRIES {
        match stop() {
            Ok(()) => return Ended::Stopped,
            Err(why) => last = why,
        }
    }
    Ended::NotStopped(last)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use std::io::{Write, pipe};

    /// Long enough that no loaded machine takes it for silence.
    const LONG: Duration = Duration::from_secs(600);
    const SHORT: Duration = Duration::from_millis(60);

    /// What comes of lines that end after the last, and how often the arm was stopped.
    fn kept(typed: &'static str, timeout: Duration) -> (Ended, u32) {
        let mut n_stops = 0;
        let ended = keep(&lines_of(typed.as_bytes()), timeout, &mut || {
            n_stops += 1;
            Ok(())
        });
        (ended, n_stops)
    }

    #[test]
    fn lines_that_end_while_it_watches_stop_the_arm() {
        for typed in ["watch\n", "watch\nbeat\nbeat", "rest\nwatch\nhello\n"] {
            assert_eq!(kept(typed, LONG), (Ended::Stopped, 1), "{typed:?}");
        }
        for typed in ["", "beat\n", "watch\nbeat\nrest\n", "watch\nrest\nbeat\n"] {
            assert_eq!(kept(typed, LONG), (Ended::AtRest, 0), "{typed:?}");
        }
    }

    #[test]
    fn silence_while_it_watches_stops_the_arm() {
        for typed in ["watch\n", "watch\nbeat\nnoise\n"] {
            let (reader, mut writer) = pipe().unwrap();
            writer.write_all(typed.as_bytes()).unwrap();
            let begun = Instant::now();
            let ended = keep(&lines_of(reader), SHORT, &mut || Ok(()));
            assert_eq!(ended, Ended::Stopped, "{typed:?}");
            assert!(begun.elapsed() >= SHORT);
            drop(writer);
        }
    }

    #[test]
    fn stopping_is_tried_again() {
        let mut n_tries = 0;
        let ended = keep(&lines_of("watch".as_bytes()), LONG, &mut || {
            n_tries += 1;
            match n_tries {
                3 => Ok(()),
                _ => Err("no answer".to_owned()),
            }
        });
        assert_eq!((ended, n_tries), (Ended::Stopped, 3));
        let ended = keep(&lines_of("watch".as_bytes()), LONG, &mut || {
            Err("no answer".to_owned())
        });
        assert_eq!(ended, Ended::NotStopped("no answer".to_owned()));
    }
}
