//! Why points do not make a calibration.
//!
//! In: the faults found by the checks. Out: all of them, one per line, and the fit that they refer to.

use super::fault::Fault;
use super::fit::Fit;

/// Why points were refused.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// What is wrong; at least one.
    pub faults: Vec<Fault>,
    /// The fit of the points that agree, if there is one, as a reference for the others.
    pub fit: Option<Box<Fit>>,
}

impl std::error::Error for Refusal {}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let faults: Vec<String> = self.faults.iter().map(Fault::to_string).collect();
        f.write_str(&faults.join("\n"))
    }
}

impl From<Fault> for Refusal {
    fn from(fault: Fault) -> Refusal {
        Refusal {
            faults: vec![fault],
            fit: None,
        }
    }
}
