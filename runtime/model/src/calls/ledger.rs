//! The questions, calls and answers of one rollout on disk.
//!
//! In: a run folder. Out: `calls.jsonl`, with one synced line per question, start of a call and end of a call, so no
//! answer is ever bought twice. A call without an end may have been sent, and counts as possibly billed. Pictures are
//! replaced by the hash of their bytes. A rollout that sends nothing leaves no such file. [`crate::replay`] answers from
//! such files.

use super::budget::{Budget, Spent};
use super::{Call, CallEnd, CallRefused, Calls, FailedCall, Fault, Usd};
use crate::{Lowering, Model, Reply, Request};
use fab_base::jsonl::{Appender, Reader};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name of the ledger in a run folder.
pub const LEDGER_FILE: &str = "calls.jsonl";

/// The largest ledger accepted, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// A line of the ledger.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Line {
    /// A question to a model, before its first call.
    Question(Question),
    /// A call is about to be sent.
    Begin {
        call: u64,
        model: String,
        key: String,
        #[serde(rename = "try")]
        number: u32,
        /// The amount reserved.
        at_most: Option<Usd>,
    },
    /// The call was answered.
    Answered { call: u64, reply: Reply },
    /// The call failed.
    Failed {
        call: u64,
        #[serde(flatten)]
        failed: FailedCall,
    },
    /// A question was answered without a call: from a cache, from an earlier run, or by a program.
    Kept { key: String, reply: Reply },
}

/// A question as it was put to a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Question {
    /// [`Request::key`].
    pub key: String,
    pub model: String,
    pub lowering: Lowering,
    /// The request as JSON, with each picture replaced by the SHA-256 of its bytes.
    pub request: Value,
}

/// The contents of a ledger.
#[derive(Clone, Debug, Default)]
pub struct Noted {
    /// The last answer to each question, by its key.
    pub answered: BTreeMap<String, Reply>,
    /// What the calls added up to.
    pub spent: Spent,
    /// Number of failed calls by fault.
    pub faults: BTreeMap<Fault, u32>,
    /// The questions to models, in the order in which they were first asked.
    pub(crate) questions: Vec<Question>,
    /// The last failure of a call for each question, by its key.
    pub(crate) failed: BTreeMap<String, FailedCall>,
    /// Calls so far.
    calls: u64,
    /// Question and reservation of each call that has not ended.
    open: BTreeMap<u64, (String, Option<Usd>)>,
    /// Bytes up to the end of the last whole line.
    whole_bytes: u64,
}

/// Reads the ledger of a run folder; an absent one holds nothing.
///
/// Fails if it cannot be read, or holds a whole line that is not a ledger line.
pub fn read(folder: &Path) -> Result<Noted, LedgerError> {
    let path = folder.join(LEDGER_FILE);
    if path.exists() {
        read_file(&path)
    } else {
        Ok(Noted::default())
    }
}

/// Reads a ledger.
pub(crate) fn read_file(path: &Path) -> Result<Noted, LedgerError> {
    let unreadable = |why: String| LedgerError::of(path, &why);
    let mut noted = Noted::default();
    let mut lines = Reader::open(path, MAX_BYTES).map_err(unreadable)?;
    while let Some(line) = lines.read().map_err(unreadable)? {
        noted.take(line);
    }
    noted.whole_bytes = lines.whole_bytes();
    for (_, at_most) in std::mem::take(&mut noted.open).into_values() {
        noted.spent.count(at_most, Err(&FailedCall::UNRESOLVED));
    }
    Ok(noted)
}

impl Noted {
    fn has(&self, key: &str) -> bool {
        self.questions.iter().any(|question| question.key == key)
    }

    /// Takes a line in.
    fn take(&mut self, line: Line) {
        match line {
            Line::Question(question) => {
                if !self.has(&question.key) {
                    self.questions.push(question);
                }
            }
            Line::Begin {
                call, key, at_most, ..
            } => {
                self.calls = self.calls.max(call);
                self.open.insert(call, (key, at_most));
            }
            Line::Answered { call, reply } => {
                if let Some((key, at_most)) = self.open.remove(&call) {
                    self.spent.count(at_most, Ok(&reply));
                    self.answered.insert(key, reply);
                }
            }
            Line::Failed { call, failed } => {
                if let Some((key, at_most)) = self.open.remove(&call) {
                    self.spent.count(at_most, Err(&failed));
                    *self.faults.entry(failed.fault).or_default() += 1;
                    self.failed.insert(key, failed);
                }
            }
            Line::Kept { key, reply } => {
                self.answered.insert(key, reply);
            }
        }
    }
}

/// Why a ledger cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct LedgerError(String);

impl LedgerError {
    pub(crate) fn of(path: &Path, why: &str) -> LedgerError {
        let file = path.display();
        LedgerError(format!("cannot use the ledger of calls `{file}`: {why}"))
    }
}

/// The ledger of a rollout in progress.
#[derive(Debug)]
pub struct Ledger<'b> {
    /// `None`: nothing is written.
    path: Option<PathBuf>,
    file: Option<Appender>,
    budget: &'b Budget,
    noted: Noted,
    /// The question that the next call or stored answer is for, unless it has its line.
    asked: Option<Question>,
    /// The call in progress: its number, and what is reserved for it.
    open: Option<(u64, Option<Usd>)>,
}

impl<'b> Ledger<'b> {
    /// Opens the ledger of a run folder, which may hold calls of an earlier part of the same rollout.
    ///
    /// - `budget`: already includes those earlier calls.
    pub fn open(folder: &Path, budget: &'b Budget) -> Result<Ledger<'b>, LedgerError> {
        let mut ledger = Ledger::unwritten(budget);
        ledger.path = Some(folder.join(LEDGER_FILE));
        ledger.noted = read(folder)?;
        Ok(ledger)
    }

    /// Makes a ledger without a file, for questions outside any run: their calls count towards the budget.
    pub fn unwritten(budget: &'b Budget) -> Ledger<'b> {
        Ledger {
            path: None,
            file: None,
            budget,
            noted: Noted::default(),
            asked: None,
            open: None,
        }
    }

    /// Returns the stored answer to a question.
    pub fn answered(&self, key: &str) -> Option<&Reply> {
        self.noted.answered.get(key)
    }

    /// Returns what the rollout's calls added up to.
    pub fn spent(&self) -> Spent {
        self.noted.spent
    }

    /// Returns the number of failed calls by fault.
    pub fn faults(&self) -> &BTreeMap<Fault, u32> {
        &self.noted.faults
    }

    /// Says which question the next call or stored answer is for; its line is written with them.
    pub fn asks(&mut self, model: &dyn Model, request: &Request) {
        let json = serde_json::to_value(request);
        let question = Question {
            key: request.key(),
            model: model.name().to_owned(),
            lowering: model.lowering(),
            request: json.expect("a request holds strings and finite numbers"),
        };
        self.asked = Some(question).filter(|it| !self.noted.has(&it.key));
    }

    /// Stores an answer that cost no call, so a resumed rollout does not depend on its source.
    pub fn keep(&mut self, key: &str, reply: &Reply) -> Result<(), CallRefused> {
        if self.noted.answered.contains_key(key) {
            return Ok(());
        }
        self.write_question()?;
        self.write(Line::Kept {
            key: key.to_owned(),
            reply: reply.clone(),
        })
    }

    fn write_question(&mut self) -> Result<(), CallRefused> {
        let question = self.asked.take();
        question.map_or(Ok(()), |question| self.write(Line::Question(question)))
    }

    fn write(&mut self, line: Line) -> Result<(), CallRefused> {
        self.append(&line).map_err(|why| {
            CallRefused::Ledger(format!(
                "a call cannot be recorded, so it is not sent: {why}"
            ))
        })?;
        self.noted.take(line);
        Ok(())
    }

    fn append(&mut self, line: &Line) -> Result<(), String> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        let unwritable = |error| format!("cannot write `{}`: {error}", path.display());
        let file = match &mut self.file {
            Some(file) => file,
            absent => {
                let mut file = Appender::open(path).map_err(unwritable)?;
                file.keep(self.noted.whole_bytes);
                absent.insert(file)
            }
        };
        file.append(line).map_err(unwritable)
    }
}

impl Calls for Ledger<'_> {
    fn begin(&mut self, call: &Call<'_>) -> Result<(), CallRefused> {
        self.budget.reserve(call.at_most)?;
        let number = self.noted.calls + 1;
        let line = Line::Begin {
            call: number,
            model: call.model.to_owned(),
            key: call.key.to_owned(),
            number: call.number,
            at_most: call.at_most,
        };
        // Before anything is written, so that a panic gives back what is reserved.
        self.open = Some((number, call.at_most));
        let begun = self.write_question().and_then(|()| self.write(line));
        if begun.is_err() {
            self.open = None;
            self.budget.end(call.at_most, None);
        }
        begun
    }

    fn end(&mut self, end: CallEnd<'_>) -> Result<(), CallRefused> {
        let Some((call, at_most)) = self.open.take() else {
            return Ok(());
        };
        self.budget.end(at_most, Some(end));
        let line = match end.cloned() {
            Ok(reply) => Line::Answered { call, reply },
            Err(failed) => Line::Failed {
                call,
                failed: failed.clone(),
            },
        };
        let written = self.append(&line);
        self.noted.take(line);
        written.map_err(|why| {
            CallRefused::Ledger(format!(
                "the answer arrived but could not be stored: {why}; once that is fixed, `fabc resume` continues from here"
            ))
        })
    }
}

impl Drop for Ledger<'_> {
    fn drop(&mut self) {
        // Threads that wait for this call must not wait for a panicked one.
        if let Some((_, at_most)) = self.open.take() {
            let unresolved = Err(&FailedCall::UNRESOLVED);
            self.budget.end(at_most, Some(unresolved));
        }
    }
}

#[cfg(test)]
#[path = "ledger/tests.rs"]
mod tests;
