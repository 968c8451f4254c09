//! How a call can fail: a closed list with names that journals and ledgers use.

use serde::{Deserialize, Serialize};
use std::fmt;

fab_base::named! {
    /// What went wrong with a call.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
    pub enum Fault {
        /// Too many calls or tokens for now.
        RateLimited = "rate_limited",
        /// The account has no credit, or its limit is used up.
        QuotaExhausted = "quota_exhausted",
        /// The key is missing, wrong, or not allowed to do this.
        NotAuthorised = "not_authorised",
        /// The provider says that the request is wrong, or that there is no such model.
        BadRequest = "bad_request",
        /// The model declined to answer.
        Refused = "refused",
        /// A filter of the provider removed the question or the answer.
        ContentFiltered = "content_filtered",
        /// No complete answer came in time.
        TimedOut = "timed_out",
        /// The connection could not be made; nothing was sent.
        Unreachable = "unreachable",
        /// The connection ended before the answer was complete.
        ConnectionCut = "connection_cut",
        /// The provider failed or is overloaded.
        ServerFailed = "server_failed",
        /// The answer was cut off at its maximum length.
        Truncated = "truncated",
        /// The reply breaks the provider's own interface, for example with invalid JSON.
        InvalidReply = "invalid_reply",
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The name that JSON and journals use.
        f.pad(self.name())
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
