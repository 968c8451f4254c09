//! Asks a rollout's questions of its models, and none of them twice.
//!
//! In: a model and a request. Out: its reply: either the one already in the rollout's ledger, or a new one, which is
//! then stored there.

use crate::rollout::RunError;
use fab_model::calls::{Budget, CallRefused, Ledger, LedgerError, Spent};
use fab_model::{Model, ModelError, ModelKind, Reply, Request};
use std::collections::BTreeMap;
use std::path::Path;

/// The questions of one rollout; by default, of none: nothing is stored.
#[derive(Debug, Default)]
pub struct Asking<'a> {
    ledger: Option<Ledger<'a>>,
    /// Whether a completed step is being repeated: its answers must be in the ledger, and nothing is sent.
    pub repeats: bool,
}

impl<'a> Asking<'a> {
    /// Stores questions, calls and answers in the run folder.
    pub fn in_folder(folder: &Path, budget: &'a Budget) -> Result<Asking<'a>, LedgerError> {
        Ok(Asking {
            ledger: Some(Ledger::open(folder, budget)?),
            repeats: false,
        })
    }

    /// Returns the model's reply.
    pub fn ask(&mut self, model: &dyn Model, request: &Request) -> Result<Reply, ModelError> {
        let Some(ledger) = &mut self.ledger else {
            return model.ask(request, &mut Ledger::unwritten(&Budget::default()));
        };
        // A stand-in is asked again: it answers the same, and costs nothing.
        if model.nature() == ModelKind::StandIn {
            return model.ask(request, ledger);
        }
        let key = request.key();
        if let Some(reply) = ledger.answered(&key) {
            return Ok(reply.clone());
        }
        if self.repeats {
            return Err(CallRefused::Lost.into());
        }
        ledger.asks(model, request);
        let reply = model.ask(request, ledger)?;
        ledger.keep(&key, &reply)?;
        Ok(reply)
    }

    /// Returns the answer to a question for something other than a model: the one in the ledger, or a new one, which is
    /// then stored.
    ///
    /// - `key`: identical for equal questions.
    pub fn once<E>(
        &mut self,
        key: &str,
        ask: impl FnOnce() -> Result<Reply, E>,
    ) -> Result<Result<Reply, E>, RunError> {
        let Some(ledger) = &mut self.ledger else {
            return Ok(ask());
        };
        if let Some(reply) = ledger.answered(key) {
            return Ok(Ok(reply.clone()));
        }
        if self.repeats {
            return Err(RunError::Calls(CallRefused::Lost));
        }
        let answered = ask();
        if let Ok(reply) = &answered {
            ledger.keep(key, reply).map_err(RunError::Calls)?;
        }
        Ok(answered)
    }

    /// Returns what the calls so far added up to.
    pub fn spent(&self) -> Spent {
        self.ledger.as_ref().map(Ledger::spent).unwrap_or_default()
    }

    /// Returns the number of failed calls by the fault's name.
    pub fn faults(&self) -> BTreeMap<String, u32> {
        let faults = self.ledger.iter().flat_map(Ledger::faults);
        faults
            .map(|(fault, count)| (fault.name().to_owned(), *count))
            .collect()
    }
}
