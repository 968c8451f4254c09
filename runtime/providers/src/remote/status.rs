//! Interprets HTTP statuses other than success.
//!
//! In: the status, and the body without any key. Out: a [`Refusal`]: the fault, whether the call may be billed, a
//! message, and the wait that the body asks for.

use super::wire::error::ErrorBody;
use fab_model::calls::{Billing, Fault};
use std::time::Duration;

/// Why a provider gave no answer.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Refusal {
    pub fault: Fault,
    pub billing: Billing,
    pub why: String,
    pub wait: Option<Duration>,
}

/// Interprets a status other than success.
pub(super) fn judge(status: u16, body: &[u8]) -> Refusal {
    let error = ErrorBody::of_bytes(body);
    let fault = match status {
        // These statuses are unambiguous; a body may only distinguish quota from rate, or a filter from a fault.
        401 => Fault::NotAuthorised,
        402 => Fault::QuotaExhausted,
        408 => Fault::TimedOut,
        403 => among(&error, &[Fault::QuotaExhausted, Fault::ContentFiltered])
            .unwrap_or(Fault::NotAuthorised),
        429 => among(&error, &[Fault::QuotaExhausted]).unwrap_or(Fault::RateLimited),
        504 => Fault::TimedOut,
        500..=599 => Fault::ServerFailed,
        409 => Fault::ServerFailed,
        _ => {
            let meant = [
                Fault::QuotaExhausted,
                Fault::ContentFiltered,
                Fault::NotAuthorised,
            ];
            among(&error, &meant).unwrap_or(Fault::BadRequest)
        }
    };
    let billing = match status {
        // The provider may have done the work before its front end gave up.
        408 | 409 | 500..=502 | 504..=528 | 530..=599 => Billing::Possibly,
        _ => Billing::No,
    };
    let why = match status {
        300..=399 => {
            "the base URL leads elsewhere, and a key is not sent after a redirection; give the right one".to_owned()
        }
        _ => error.words(),
    };
    Refusal {
        fault,
        billing,
        why: format!("HTTP {status}: {why}"),
        wait: error.wait,
    }
}

fn among(error: &ErrorBody, meant: &[Fault]) -> Option<Fault> {
    error.fault().filter(|fault| meant.contains(fault))
}

#[cfg(test)]
#[path = "tests/statuses.rs"]
mod tests;
