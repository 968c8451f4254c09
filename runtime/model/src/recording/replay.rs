//! `replay:FILE`: answers from a recording, byte for byte, and sends nothing.

use super::{Exchange, Outcome, RecordingError, difference, question_key, read};
use crate::calls::Calls;
use crate::{Lowering, Model, ModelError, ModelKind, ModelRole, Reply, Request};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A recording in place of the model of one role.
#[derive(Debug)]
pub struct Replay {
    name: String,
    path: PathBuf,
    nature: ModelKind,
    lowering: Lowering,
    exchanges: Vec<Exchange>,
    /// Index of the exchange that answers a question; its schema may differ.
    by_key: BTreeMap<String, usize>,
}

impl Replay {
    /// Reads a recording for a role; the name is `replay(MODEL)`, with the model that was recorded in that role.
    ///
    /// Fails if the file is not a recording, or holds no exchange.
    pub fn load(path: &Path, role: ModelRole) -> Result<Replay, RecordingError> {
        let exchanges = read(path)?.exchanges;
        if exchanges.is_empty() {
            return Err(RecordingError {
                path: path.to_owned(),
                why: "it holds no exchange".to_owned(),
            });
        }
        let role = serde_json::json!(role);
        let mut own: Vec<&Exchange> = exchanges
            .iter()
            .filter(|it| it.request["role"] == role)
            .collect();
        if own.is_empty() {
            own.extend(&exchanges);
        }
        let models: BTreeSet<&str> = own.iter().map(|it| it.model.as_str()).collect();
        let models: Vec<&str> = models.into_iter().collect();
        let is_stand_in = own.iter().any(|it| it.nature == ModelKind::StandIn);
        // One model has one lowering; with several models the first decides, and the others' questions differ by name.
        let lowering = own.first().map_or(Lowering::PIXELS, |it| it.lowering);
        let mut by_key = BTreeMap::new();
        for (index, exchange) in exchanges.iter().enumerate() {
            // If a question was asked again after a failure, the last answer counts.
            let is_failure = matches!(exchange.outcome, Outcome::Failure { .. });
            let key = question_key(&exchange.request);
            if !is_failure || !by_key.contains_key(&key) {
                by_key.insert(key, index);
            }
        }
        Ok(Replay {
            name: format!("replay({})", models.join(", ")),
            path: path.to_owned(),
            nature: match is_stand_in {
                true => ModelKind::StandIn,
                false => ModelKind::Model,
            },
            lowering,
            by_key,
            exchanges,
        })
    }
}

impl Model for Replay {
    fn name(&self) -> &str {
        &self.name
    }

    fn nature(&self) -> ModelKind {
        self.nature
    }

    fn lowering(&self) -> Lowering {
        self.lowering
    }

    fn shares_answers(&self) -> bool {
        let mut requests = self.exchanges.iter().map(|it| &it.request);
        requests.all(|request| request["start"].is_null())
    }

    fn ask(&self, request: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let key =
            serde_json::to_value(request).expect("a request holds strings and finite numbers");
        let Some(index) = self.by_key.get(&question_key(&key)) else {
            return Err(ModelError::Unsupported {
                model: self.name.clone(),
                why: format!(
                    "`{}` holds no answer to it: {}",
                    self.path.display(),
                    difference::nearest(&self.exchanges, request)
                ),
            });
        };
        match &self.exchanges[*index].outcome {
            // A replay buys nothing, so it does not report the original cost.
            Outcome::Reply(reply) => Ok(Reply {
                cost: None,
                ..reply.clone()
            }),
            Outcome::Failure {
                fault: Some(fault),
                why,
            } => Err(ModelError::Failed {
                model: self.name.clone(),
                fault: *fault,
                why: why.clone(),
            }),
            Outcome::Failure { fault: None, why } => Err(ModelError::Unsupported {
                model: self.name.clone(),
                why: why.clone(),
            }),
        }
    }
}
