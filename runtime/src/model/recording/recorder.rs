//! Writes a recording while rollouts run.

use super::{Exchange, Line, Outcome, RecordingError, SCHEMA, read};
use crate::calls::CallRefused;
use crate::model::{Model, ModelError, Reply, Request};
use std::collections::BTreeSet;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// A recording that is being written; several rollouts may share it.
#[derive(Debug)]
pub struct Recorder {
    path: PathBuf,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    file: File,
    /// Bytes up to the end of the last whole line.
    whole_bytes: u64,
    /// Questions whose answer is in the file.
    answered: BTreeSet<String>,
}

impl Recorder {
    /// Opens a recording; one that exists is added to.
    ///
    /// Fails where the file is there and no recording, or cannot be written.
    pub fn open(path: &Path) -> Result<Recorder, RecordingError> {
        let wrong = |error: std::io::Error| RecordingError {
            path: path.to_owned(),
            why: error.to_string(),
        };
        let file = OpenOptions::new().create(true).append(true).open(path);
        let file = file.map_err(wrong)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                return Err(RecordingError {
                    path: path.to_owned(),
                    why: "another fabc is writing it".to_owned(),
                });
            }
            // Not every file system has locks; without them the user takes care.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        let lines = read(path)?;
        file.set_len(lines.whole_bytes).map_err(wrong)?;
        let answered = lines
            .exchanges
            .into_iter()
            .filter(|exchange| matches!(exchange.outcome, Outcome::Reply(_)))
            .map(|exchange| exchange.key);
        let mut state = State {
            whole_bytes: lines.whole_bytes,
            file,
            answered: answered.collect(),
        };
        if lines.whole_bytes == 0 {
            let first = Line::Recording {
                schema: SCHEMA,
                fabc: env!("CARGO_PKG_VERSION").to_owned(),
            };
            state.append(&first).map_err(wrong)?;
        }
        Ok(Recorder {
            path: path.to_owned(),
            state: Mutex::new(state),
        })
    }

    /// Writes an exchange, unless its answer is in the recording already.
    ///
    /// Fails where it cannot be written: a rollout whose recording has a gap could not be replayed.
    pub fn keep(
        &self,
        model: &dyn Model,
        request: &Request,
        answered: &Result<Reply, ModelError>,
        took: Duration,
    ) -> Result<(), CallRefused> {
        let outcome = match answered {
            Ok(reply) => Outcome::Reply(reply.clone()),
            // What was never sent is no exchange.
            Err(ModelError::NotSent(_) | ModelError::Interrupted) => return Ok(()),
            Err(ModelError::Failed { fault, why, .. }) => Outcome::Failure {
                fault: Some(*fault),
                why: why.clone(),
            },
            Err(ModelError::Unsupported { why, .. }) => Outcome::Failure {
                fault: None,
                why: why.clone(),
            },
        };
        let key = request.key();
        // An answer is written whole or not at all, so a lock that was held in a panic guards a sound file.
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if state.answered.contains(&key) {
            return Ok(());
        }
        let line = Line::Exchange(Exchange {
            key: key.clone(),
            model: model.name().to_owned(),
            nature: model.nature(),
            lowering: model.lowering(),
            request: serde_json::to_value(request)
                .expect("a request holds strings and finite numbers"),
            outcome,
            took_s: took.as_secs_f64(),
        });
        state.append(&line).map_err(|error| {
            CallRefused::NotKept(format!("cannot write `{}`: {error}", self.path.display()))
        })?;
        if answered.is_ok() {
            state.answered.insert(key);
        }
        Ok(())
    }
}

impl State {
    fn append(&mut self, line: &Line) -> std::io::Result<()> {
        let mut text = serde_json::to_string(line)?;
        text.push('\n');
        let written = self.file.write_all(text.as_bytes());
        let written = written.and_then(|()| self.file.sync_data());
        match &written {
            Ok(()) => self.whole_bytes += text.len() as u64,
            // A part of a line would damage the next one.
            Err(_) => drop(self.file.set_len(self.whole_bytes)),
        }
        written
    }
}
