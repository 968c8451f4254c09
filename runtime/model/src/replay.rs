//! `replay:RUN`: answers from the ledgers of earlier runs, byte for byte, and sends nothing.
//!
//! In: the `calls.jsonl` of a run, the folder of a run, or a folder of runs such as a suite's. Out: a [`Model`] that
//! answers the questions asked there. A question matches by its words, pictures, settings and draw; the schema does not
//! count, because it follows from the task and its scene. The last answer to a question counts; if there is none, its
//! last failure.

use crate::calls::ledger::{self, LEDGER_FILE, Question};
use crate::calls::{Calls, FailedCall, LedgerError};
use crate::{Lowering, Model, ModelError, ModelKind, ModelRole, Reply, Request};
use fab_base::difference;
use fab_base::wording::quoted;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use walkdir::WalkDir;

/// The deepest that a ledger may lie below the named folder.
const MAX_DEPTH: usize = 5;

/// How a question ended: with an answer, or with a failed call.
type End = Result<Reply, FailedCall>;

/// The runs that answer in place of the model of one role.
#[derive(Debug)]
pub struct Replay {
    name: String,
    path: PathBuf,
    lowering: Lowering,
    /// Questions with an end, by [`question_key`].
    exchanges: BTreeMap<String, (Question, End)>,
}

impl Replay {
    /// Reads the runs for a role; the name is `replay(MODEL)`, with the model that was asked in that role.
    ///
    /// Fails if a ledger cannot be read, or if there is no answer from a model.
    pub fn load(path: &Path, role: ModelRole) -> Result<Replay, LedgerError> {
        let mut exchanges: BTreeMap<String, (Question, End)> = BTreeMap::new();
        let mut models = BTreeSet::new();
        let role = serde_json::json!(role);
        for file in ledgers(path)? {
            let mut noted = ledger::read_file(&file)?;
            for question in noted.questions {
                if question.request["role"] == role {
                    models.insert(question.model.clone());
                }
                let answered = noted.answered.remove(&question.key).map(Ok);
                let failed = || noted.failed.remove(&question.key).map(Err);
                let Some(end) = answered.or_else(failed) else {
                    continue;
                };
                let key = question_key(&question.request);
                let is_answered = matches!(exchanges.get(&key), Some((_, Ok(_))));
                if end.is_ok() || !is_answered {
                    exchanges.insert(key, (question, end));
                }
            }
        }
        if models.len() > 1 {
            // Equal questions to different models could not be told apart.
            let models = quoted(models);
            let why = format!(
                "it holds answers of several models, {models}; name the folder of one method or run"
            );
            return Err(LedgerError::of(path, &why));
        }
        let mut questions = exchanges.values().map(|(question, _)| question);
        // A task may never ask this role.
        let any = questions.clone().next();
        let own = questions.find(|question| question.request["role"] == role);
        let Some(first) = own.or(any) else {
            return Err(LedgerError::of(path, "it holds no answer from a model"));
        };
        Ok(Replay {
            name: format!("replay({})", first.model),
            path: path.to_owned(),
            lowering: first.lowering,
            exchanges,
        })
    }

    /// Names the recorded question most similar to a request, and what differs first.
    fn nearest(&self, asked: &Value) -> String {
        let questions = self.exchanges.values().map(|(question, _)| question);
        let best = questions.max_by_key(|question| likeness(&question.request, asked));
        let question = best.expect("a replay holds a question");
        let is_other = |name: &str| question.request[name] != asked[name];
        if is_other("role") && is_other("messages") {
            let role = asked["role"].as_str().unwrap_or_default();
            return format!(
                "no {role} model was asked there; name one for that role: `--model {role}=MODEL`"
            );
        }
        let difference =
            difference::first(&without_schema(&question.request), &without_schema(asked));
        format!(
            "the nearest recorded question, of action {}, differs in {}",
            question.request["step"],
            difference.map_or("nothing".to_owned(), |it| it.to_string())
        )
    }
}

/// Finds the ledgers at or below a path, in the order of their names.
fn ledgers(path: &Path) -> Result<Vec<PathBuf>, LedgerError> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut found = Vec::new();
    for entry in WalkDir::new(path).max_depth(MAX_DEPTH).sort_by_file_name() {
        let entry = entry.map_err(|error| LedgerError::of(path, &error.to_string()))?;
        if entry.file_name() == LEDGER_FILE {
            found.push(entry.into_path());
        }
    }
    if found.is_empty() {
        let why = format!("no {LEDGER_FILE} lies in it: no model of a provider was asked there");
        return Err(LedgerError::of(path, &why));
    }
    Ok(found)
}

fn without_schema(request: &Value) -> Value {
    let mut question = request.clone();
    if let Some(fields) = question.as_object_mut() {
        fields.shift_remove("schema");
    }
    question
}

/// Hashes a question without its schema.
fn question_key(request: &Value) -> String {
    fab_base::digest::of(without_schema(request).to_string())
}

/// How much two requests have in common, most important criterion first.
fn likeness(recorded: &Value, asked: &Value) -> [bool; 5] {
    ["role", "start", "step", "messages", "candidate"].map(|name| recorded[name] == asked[name])
}

impl Model for Replay {
    fn name(&self) -> &str {
        &self.name
    }

    fn nature(&self) -> ModelKind {
        // Stand-ins are asked again instead: their answers are in no ledger.
        ModelKind::Model
    }

    fn lowering(&self) -> Lowering {
        self.lowering
    }

    fn shares_answers(&self) -> bool {
        let mut questions = self.exchanges.values();
        questions.all(|(question, _)| question.request["start"].is_null())
    }

    fn ask(&self, request: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let asked =
            serde_json::to_value(request).expect("a request holds strings and finite numbers");
        let Some((_, end)) = self.exchanges.get(&question_key(&asked)) else {
            return Err(ModelError::Unsupported {
                model: self.name.clone(),
                why: format!(
                    "`{}` holds no answer to it: {}",
                    self.path.display(),
                    self.nearest(&asked)
                ),
            });
        };
        match end {
            // A replay buys nothing, so it does not report the original cost.
            Ok(reply) => Ok(Reply {
                cost: None,
                ..reply.clone()
            }),
            Err(failed) => Err(ModelError::Failed {
                model: self.name.clone(),
                fault: failed.fault,
                why: failed.why.clone(),
            }),
        }
    }
}

#[cfg(test)]
mod tests;
