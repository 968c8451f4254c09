//! How a call can fail: a closed list with names that journals and recordings use.

use serde::{Deserialize, Serialize};

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

    /// Returns the name that JSON and journals use.
    pub fn name(self) -> &'static str {
        match self {
            Fault::RateLimited => "rate_limited",
            Fault::QuotaExhausted => "quota_exhausted",
            Fault::NotAuthorised => "not_authorised",
            Fault::BadRequest => "bad_request",
            Fault::Refused => "refused",
            Fault::ContentFiltered => "content_filtered",
            Fault::TimedOut => "timed_out",
            Fault::Unreachable => "unreachable",
            Fault::ConnectionCut => "connection_cut",
            Fault::ServerFailed => "server_failed",
            Fault::Truncated => "truncated",
            Fault::InvalidReply => "invalid_reply",
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_equal_the_serialised_form() {
        for fault in Fault::ALL {
            assert_eq!(serde_json::json!(fault), serde_json::json!(fault.name()));
        }
    }
}
