//! Interprets HTTP statuses other than success.
//!
//! In: the status, and the body without any key. Out: the fault, and whether the call may be billed. `causes` says why.

use super::wire::error::ErrorBody;
use fab_model::calls::{Billing, Fault};

/// Interprets a status other than success.
pub(super) fn judge(status: u16, error: &ErrorBody) -> (Fault, Billing) {
    let fault = match status {
        // These statuses are unambiguous; a body may only distinguish quota from rate, or a filter from a fault.
        401 => Fault::NotAuthorised,
        402 => Fault::QuotaExhausted,
        408 => Fault::TimedOut,
        403 => among(error, &[Fault::QuotaExhausted, Fault::ContentFiltered])
            .unwrap_or(Fault::NotAuthorised),
        429 => among(error, &[Fault::QuotaExhausted]).unwrap_or(Fault::RateLimited),
        504 => Fault::TimedOut,
        // llama.cpp answers 500 to a picture that its model cannot take; asking again does not help.
        500 if error.says(&["image input is not supported"]) => Fault::BadRequest,
        500..=599 => Fault::ServerFailed,
        409 => Fault::ServerFailed,
        _ => {
            use Fault::{ContentFiltered, NotAuthorised, QuotaExhausted};
            let meant = [QuotaExhausted, ContentFiltered, NotAuthorised];
            among(error, &meant).unwrap_or(Fault::BadRequest)
        }
    };
    let billing = match status {
        _ if fault == Fault::BadRequest => Billing::No,
        // The provider may have done the work before its front end gave up.
        408 | 409 | 500..=502 | 504..=528 | 530..=599 => Billing::Possibly,
        _ => Billing::No,
    };
    (fault, billing)
}

fn among(error: &ErrorBody, meant: &[Fault]) -> Option<Fault> {
    error.fault().filter(|fault| meant.contains(fault))
}

#[cfg(test)]
#[path = "tests/statuses.rs"]
mod tests;
