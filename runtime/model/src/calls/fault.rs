//! How a call can fail: a closed list with names that journals and recordings use.

use serde::{Deserialize, Serialize};
use std::fmt;

/// What went wrong with a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// Too many calls or tokens for now.
    RateLimited,
    /// The account has no credit, or its limit is used up.
    QuotaExhausted,
    /// The key is missing, wrong, or not allowed to do this.
    NotAuthorised,
    /// The provider says that the request is wrong, or that there is no such model.
    BadRequest,
    /// The model declined to answer.
    Refused,
    /// A filter of the provider removed the question or the answer.
    ContentFiltered,
    /// No complete answer came in time.
    TimedOut,
    /// The connection could not be made; nothing was sent.
    Unreachable,
    /// The connection ended before the answer was complete.
    ConnectionCut,
    /// The provider failed or is overloaded.
    ServerFailed,
    /// The answer was cut off at its maximum length.
    Truncated,
    /// The reply breaks the provider's own interface, for example with invalid JSON.
    InvalidReply,
}

impl Fault {
    /// Every fault.
    pub const ALL: [Fault; 12] = [
        Fault::RateLimited,
        Fault::QuotaExhausted,
        Fault::NotAuthorised,
        Fault::BadRequest,
        Fault::Refused,
        Fault::ContentFiltered,
        Fault::TimedOut,
        Fault::Unreachable,
        Fault::ConnectionCut,
        Fault::ServerFailed,
        Fault::Truncated,
        Fault::InvalidReply,
    ];
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The name that JSON and journals use.
        self.serialize(f)
    }
}

/// Whether a call that gave no answer may have been billed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Billing {
    /// The provider said that it did nothing, or never got the call.
    No,
    /// The provider may have processed it.
    Possibly,
}
