//! `--events`: what happens in rollouts, as lines of JSON.

use crate::exit::Failure;
use crate::io::Io;
use clap::{Args, ValueHint};
use fab_agent::rollout::event::{Event, Line};
use serde::Serialize;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

#[derive(Args, Clone, Debug, Default)]
pub struct EventArguments {
    /// Write each event of a rollout to FILE as it happens, one line of JSON each; `-` is stdout, and the report then goes
    /// to stderr.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub events: Option<PathBuf>,
}

pub struct EventLog<'io> {
    io: &'io Io,
    begun: Instant,
    to: Destination,
    /// Why the file can no longer be written; locked while a line is written, so that lines come in the order of their times.
    failed: Mutex<Option<io::Error>>,
}

enum Destination {
    Nowhere,
    Stdout,
    File { path: PathBuf, file: File },
}

impl EventArguments {
    /// Returns the same with a path that is valid in every folder.
    pub fn absolute(&self) -> Result<EventArguments, Failure> {
        let mut events = self.events.clone();
        if let Some(path) = events.as_mut().filter(|path| *path != Path::new("-")) {
            *path = std::path::absolute(&path)?;
        }
        Ok(EventArguments { events })
    }

    /// Opens the file; fails if it cannot be made, or if stdout is to have a JSON document as well.
    pub fn open<'io>(&self, json: bool, io: &'io Io) -> Result<EventLog<'io>, Failure> {
        let to = match &self.events {
            None => Destination::Nowhere,
            Some(path) if path == Path::new("-") => {
                if json {
                    let why =
                        "`--events -` and `--json` both write to stdout: give `--events FILE`";
                    return Err(Failure::usage(why));
                }
                Destination::Stdout
            }
            Some(path) => Destination::File {
                file: File::create(path).map_err(|error| Failure::unwritable(path, error))?,
                path: path.clone(),
            },
        };
        Ok(EventLog {
            io,
            begun: Instant::now(),
            to,
            failed: Mutex::default(),
        })
    }
}

impl EventLog<'_> {
    /// Writes an event of the rollout in a run folder.
    pub fn write(&self, run: &Path, event: Event) {
        let mut failed = self.failed.lock().unwrap_or_else(PoisonError::into_inner);
        let line = Line {
            at_s: self.begun.elapsed().as_secs_f64(),
            run: run.display().to_string(),
            event,
        };
        let text = || serde_json::to_string(&line).expect("events have string keys");
        match &self.to {
            Destination::Stdout => self.io.data(&text()),
            Destination::File { file, .. } if failed.is_none() => {
                let mut file = file;
                *failed = writeln!(file, "{}", text()).err();
            }
            Destination::Nowhere | Destination::File { .. } => {}
        }
    }

    /// Prints a result, on stderr if stdout has the events; fails if an event could not be written.
    pub fn result(
        &self,
        json: bool,
        document: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        match &self.to {
            Destination::Stdout => self.io.talk(&text()),
            _ => self.io.either(json, document, text),
        }
        let mut failed = self.failed.lock().unwrap_or_else(PoisonError::into_inner);
        match (&self.to, failed.take()) {
            (Destination::File { path, .. }, Some(error)) => Err(Failure::unwritable(path, error)),
            _ => Ok(()),
        }
    }
}
