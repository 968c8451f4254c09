//! Calls that leave for a model: noted before they are sent, counted, priced, bounded.
//!
//! In: what a model is about to send, and what came of it. Out: permission, or a refusal because of a cap. A model
//! that sends nothing tells nothing. How a call is made, and which failures are tried again, is left to the model.

pub mod ledger;

mod budget;
mod capped;
mod fault;
mod usage;

pub use budget::{Budget, Caps, Spent};
pub use capped::Capped;
pub use fault::{Billing, Fault};
pub use ledger::{Ledger, LedgerError};
pub use usage::{Usage, Usd};

use crate::Reply;
use std::fmt;

/// Hears of every call before it is sent, and of its end.
///
/// A call is one message over the network; a question that is tried again makes several.
pub trait Calls {
    /// Notes that a call is about to be sent; where this fails it must not be sent.
    ///
    /// What was noted outlives the process, so that a call that never ended is known to have been sent perhaps.
    fn begin(&mut self, call: &Call<'_>) -> Result<(), CallRefused>;

    /// Notes what came of the call that was begun last.
    ///
    /// An answer is kept whole: the same question is never sent again.
    fn end(&mut self, end: &CallEnd<'_>) -> Result<(), CallRefused>;
}

/// A call that is about to be sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Call<'a> {
    /// Name of the model.
    pub model: &'a str,
    /// The question: [`crate::Request::key`].
    pub key: &'a str,
    /// Which try of the question it is, from 1.
    pub number: u32,
    /// The most that it may cost; none where the price is not known.
    pub at_most: Option<Usd>,
}

/// What came of a call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CallEnd<'a> {
    /// An answer; its usage and cost stand in it.
    Answered(&'a Reply),
    /// None.
    Failed {
        /// What went wrong.
        fault: Fault,
        /// The same in words, without any key.
        why: &'a str,
        /// Whether it may have been billed.
        billing: Billing,
        /// What it cost, where the provider said so.
        cost: Option<Usd>,
    },
}

/// Why a call must not be sent, or could not be noted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CallRefused {
    /// A cap on calls or cost is reached.
    #[error("{0}")]
    Budget(String),
    /// The note cannot be written.
    #[error("a call cannot be noted, so it is not sent: {0}")]
    NotNoted(String),
    /// The call was sent, and what came of it cannot be written everywhere.
    #[error(
        "an answer came and could not be kept: {0}; with room to write, `fabc resume` goes on from here"
    )]
    NotKept(String),
    /// An answer that a done step had is not there any more.
    #[error(
        "a step that is done put a question whose answer is not in the ledger of calls: the ledger, the subgoal pictures, the facts about the model or the task changed since; nothing was sent"
    )]
    Lost,
}

/// Hears of calls and keeps nothing: for questions outside of any run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unkept;

impl Calls for Unkept {
    fn begin(&mut self, _: &Call<'_>) -> Result<(), CallRefused> {
        Ok(())
    }

    fn end(&mut self, _: &CallEnd<'_>) -> Result<(), CallRefused> {
        Ok(())
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
