//! Asks a rollout's questions, and none of them twice.
//!
//! In: a model and a request, or a question to a program. Out: its reply: either the one already in the rollout's
//! ledger, or a new one, which is then stored there.

use fab_model::calls::{CallRefused, Ledger};
use fab_model::{Model, ModelError, ModelKind, Reply, Request};

/// Says that a ledger lacks the answer of a completed step.
const LOST: &str = "a completed step asks a question whose answer is not in the ledger of calls: the ledger, the subgoal \
                    pictures, the facts about the model or the task changed since; nothing was sent";

/// The questions of one rollout.
#[derive(Debug)]
pub struct Asking<'a> {
    /// The questions, calls and answers so far.
    pub ledger: Ledger<'a>,
    /// Whether a completed step is being repeated: its answers must be in the ledger, and nothing is sent.
    pub repeats: bool,
}

impl<'a> Asking<'a> {
    /// Begins with the answers of a ledger.
    pub fn of(ledger: Ledger<'a>) -> Asking<'a> {
        Asking {
            ledger,
            repeats: false,
        }
    }

    /// Returns the model's reply.
    pub fn ask(&mut self, model: &dyn Model, request: &Request) -> Result<Reply, ModelError> {
        // A stand-in is asked again: it answers the same, and costs nothing.
        if model.nature() == ModelKind::StandIn {
            return model.ask(request, &mut self.ledger);
        }
        self.once(&request.key(), |ledger| {
            ledger.asks(model, request);
            model.ask(request, ledger)
        })?
    }

    /// Returns the answer to a question: the one in the ledger, or a new one, which is then stored.
    ///
    /// - `key`: identical for equal questions.
    ///
    /// Fails if the answer is lost, or cannot be stored.
    pub fn once<E>(
        &mut self,
        key: &str,
        ask: impl FnOnce(&mut Ledger<'a>) -> Result<Reply, E>,
    ) -> Result<Result<Reply, E>, CallRefused> {
        if let Some(reply) = self.ledger.answered(key) {
            return Ok(Ok(reply.clone()));
        }
        if self.repeats {
            return Err(CallRefused::Ledger(LOST.to_owned()));
        }
        let answered = ask(&mut self.ledger);
        if let Ok(reply) = &answered {
            self.ledger.keep(key, reply)?;
        }
        Ok(answered)
    }
}
