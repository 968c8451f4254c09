//! Calls to a model over the network: noted before they are sent, counted, priced, limited.
//!
//! In: what a model is about to send, and its result. Out: permission, or a refusal because of a cap. A model that
//! sends nothing reports nothing. How a call is made, and which failures are retried, is up to the model.

pub mod ledger;

mod budget;
mod fault;
mod usage;

pub use budget::{Budget, Caps, Spent};
pub use fault::{Billing, Fault};
pub use ledger::{Ledger, LedgerError};
pub use usage::{Usage, Usd};

use crate::Reply;
use serde::{Deserialize, Serialize};

/// Is told of every call before it is sent, and of its end.
///
/// A call is one message over the network; a retried question makes several.
pub trait Calls {
    /// Notes that a call is about to be sent; if this fails, the call must not be sent.
    ///
    /// The note survives a crash, so a call without an end is known to have possibly been sent.
    fn begin(&mut self, call: &Call<'_>) -> Result<(), CallRefused>;

    /// Notes the result of the last call.
    ///
    /// A complete answer is stored: the same question is never sent again.
    fn end(&mut self, end: CallEnd<'_>) -> Result<(), CallRefused>;
}

/// A call that is about to be sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Call<'a> {
    /// Name of the model.
    pub model: &'a str,
    /// The question: [`crate::Request::key`].
    pub key: &'a str,
    /// The attempt number for this question, from 1.
    pub number: u32,
    /// The most that it may cost; `None` if the price is unknown.
    pub at_most: Option<Usd>,
}

/// The result of a call: an answer, with its usage and cost, or none.
pub type CallEnd<'a> = Result<&'a Reply, &'a FailedCall>;

/// Why a call gave no answer, and what it cost.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailedCall {
    /// What went wrong.
    pub fault: Fault,
    /// The failure in words, without any API key.
    pub why: String,
    /// Whether it may have been billed.
    pub billing: Billing,
    /// What it cost, if the provider said so.
    pub cost: Option<Usd>,
    /// The usage reported by the provider.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub usage: Option<Usage>,
}

impl FailedCall {
    /// A call of which nothing more is known.
    pub(crate) const UNRESOLVED: FailedCall = FailedCall {
        fault: Fault::ConnectionCut,
        why: String::new(),
        billing: Billing::Possibly,
        cost: None,
        usage: None,
    };
}

/// Why a call must not be sent, or could not be noted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CallRefused {
    /// A cap on calls or cost is reached: which one, and how far it is used.
    #[error("{0}")]
    Budget(String),
    /// The user interrupted the wait for calls under way.
    #[error("interrupted")]
    Interrupted,
    /// The ledger cannot be written, or lacks the answer of a completed step: which, and why.
    #[error("{0}")]
    Ledger(String),
}
