//! Placeholder until the proof of the action space is merged.

use crate::program::Program;

/// Where an action space contradicts itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Flaw {
    /// The field.
    pub field: String,
}

impl std::fmt::Display for Flaw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "`{}`", self.field)
    }
}

/// Returns where the action space contradicts itself.
pub fn flaws(_program: &Program) -> Vec<Flaw> {
    Vec::new()
}
