//! Writes a recording while rollouts run.

use super::{Exchange, Line, Outcome, RecordingError, SCHEMA, read};
use crate::calls::CallRefused;
use crate::{Model, ModelError, Reply, Request};
use fab_base::jsonl::Appender;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// A recording in progress; several rollouts may share it.
#[derive(Debug)]
pub struct Recorder {
    path: PathBuf,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    file: Appender,
    /// Questions whose answer is in the file.
    answered: BTreeSet<String>,
}

impl Recorder {
    /// Opens a recording; an existing one is appended to.
    ///
    /// Fails if the file exists but is not a recording, or cannot be written.
    pub fn open(path: &Path) -> Result<Recorder, RecordingError> {
        let wrong = |error: std::io::Error| RecordingError {
            path: path.to_owned(),
            why: error.to_string(),
        };
        let mut file = Appender::open(path).map_err(wrong)?;
        if !file.lock() {
            return Err(RecordingError {
                path: path.to_owned(),
                why: "another fabc is writing it".to_owned(),
            });
        }
        let lines = read(path)?;
        file.keep(lines.whole_bytes);
        let answered = lines
            .exchanges
            .into_iter()
            .filter(|exchange| matches!(exchange.outcome, Outcome::Reply(_)))
            .map(|exchange| exchange.key);
        let mut state = State {
            file,
            answered: answered.collect(),
        };
        if lines.whole_bytes == 0 {
            let first = Line::Recording {
                schema: SCHEMA,
                fabc: env!("CARGO_PKG_VERSION").to_owned(),
            };
            state.file.append(&first).map_err(wrong)?;
        }
        Ok(Recorder {
            path: path.to_owned(),
            state: Mutex::new(state),
        })
    }

    /// Writes an exchange, unless its answer is already in the recording.
    ///
    /// Fails if it cannot be written: a rollout whose recording has a gap could not be replayed.
    pub fn keep(
        &self,
        model: &dyn Model,
        request: &Request,
        answered: &Result<Reply, ModelError>,
        took: Duration,
    ) -> Result<(), CallRefused> {
        let outcome = match answered {
            Ok(reply) => Outcome::Reply(reply.clone()),
            // A question that was never sent is not an exchange.
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
        // An answer is written whole or not at all, so after a panic the poisoned lock still guards a sound file.
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
        state.file.append(&line).map_err(|error| {
            CallRefused::NotKept(format!("cannot write `{}`: {error}", self.path.display()))
        })?;
        if answered.is_ok() {
            state.answered.insert(key);
        }
        Ok(())
    }
}
