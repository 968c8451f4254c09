//! Puts the questions of one rollout to its models, and none of them twice.
//!
//! In: a model and a request. Out: its reply: the one that the rollout's ledger holds already, or a new one, which is then
//! in the ledger and, where one is kept, in the recording.

use super::PolicyError;
use fab_model::calls::{Budget, CallRefused, Ledger, LedgerError, Spent, Unkept};
use fab_model::recording::Recorder;
use fab_model::{Model, ModelError, Nature, Reply, Request};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// The questions of one rollout.
#[derive(Debug, Default)]
pub struct Asking<'a> {
    ledger: Option<Ledger<'a>>,
    recorder: Option<&'a Recorder>,
    step: Step,
}

/// What kind of step is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Step {
    /// One that nobody has taken yet.
    #[default]
    New,
    /// One that is done already and only repeated: its answers must be in the ledger, and nothing is sent.
    Repeated,
}

impl<'a> Asking<'a> {
    /// Keeps the calls in the run folder, and the exchanges in the recording, where there is one.
    pub fn in_folder(
        folder: &Path,
        budget: &'a Budget,
        recorder: Option<&'a Recorder>,
    ) -> Result<Asking<'a>, LedgerError> {
        Ok(Asking {
            ledger: Some(Ledger::open(folder, budget)?),
            recorder,
            step: Step::New,
        })
    }

    /// Says what kind of step begins.
    pub fn begin(&mut self, step: Step) {
        self.step = step;
    }

    /// Keeps nothing: for questions outside of any run.
    pub fn unkept() -> Asking<'a> {
        Asking::default()
    }

    /// Returns the model's reply.
    pub fn ask(&mut self, model: &dyn Model, request: &Request) -> Result<Reply, ModelError> {
        let begun = Instant::now();
        let answered = self.answer(model, request);
        let Some(recorder) = self.recorder else {
            return answered;
        };
        recorder.keep(model, request, &answered, begun.elapsed())?;
        answered
    }

    fn answer(&mut self, model: &dyn Model, request: &Request) -> Result<Reply, ModelError> {
        let Some(ledger) = &mut self.ledger else {
            return model.ask(request, &mut Unkept);
        };
        // A stand-in is asked again: it says the same, and costs nothing.
        if model.nature() == Nature::StandIn {
            return model.ask(request, ledger);
        }
        let key = request.key();
        if let Some(reply) = ledger.answered(&key) {
            return Ok(reply.clone());
        }
        if self.step == Step::Repeated {
            return Err(CallRefused::Lost.into());
        }
        let reply = model.ask(request, ledger)?;
        ledger.keep(&key, &reply)?;
        Ok(reply)
    }

    /// Returns the answer to a question that is no model's: the one that the ledger holds, or a new one, which is then in it.
    ///
    /// - `key`: the same for equal questions.
    pub fn once<E>(
        &mut self,
        key: &str,
        ask: impl FnOnce() -> Result<Reply, E>,
    ) -> Result<Result<Reply, E>, PolicyError> {
        let Some(ledger) = &mut self.ledger else {
            return Ok(ask());
        };
        if let Some(reply) = ledger.answered(key) {
            return Ok(Ok(reply.clone()));
        }
        if self.step == Step::Repeated {
            return Err(PolicyError::Calls(CallRefused::Lost));
        }
        let answered = ask();
        if let Ok(reply) = &answered {
            ledger.keep(key, reply).map_err(PolicyError::Calls)?;
        }
        Ok(answered)
    }

    /// Returns what the calls so far came to.
    pub fn spent(&self) -> Spent {
        self.ledger.as_ref().map(Ledger::spent).unwrap_or_default()
    }

    /// Returns how many calls failed, by the name of what went wrong.
    pub fn faults(&self) -> BTreeMap<String, u32> {
        let faults = self.ledger.iter().flat_map(Ledger::faults);
        faults
            .map(|(fault, count)| (fault.name().to_owned(), *count))
            .collect()
    }
}
