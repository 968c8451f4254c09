//! The contradictions that a proof finds.

use fab_program::ActionField;

/// The most choices of one field; a model cannot choose from a longer list.
pub const MAX_CHOICES: usize = 1_000;

/// The most fields of an action.
pub const MAX_FIELDS: usize = 16;

/// The most flaws that are reported.
const MAX_FLAWS: usize = 50;

/// A contradiction in an action space.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// The field.
    pub field: String,
    /// The value as prompts write it; empty if the whole field is flawed.
    pub value: String,
    /// What is wrong: lower case, no full stop.
    pub message: String,
}

/// The flaws found so far.
#[derive(Default)]
pub(super) struct Flaws {
    pub list: Vec<Flaw>,
    /// Whether it makes no sense to try any values.
    pub is_hopeless: bool,
}

impl Flaws {
    pub fn push(&mut self, field: &ActionField, value: &str, message: String) {
        let is_listed = self
            .list
            .iter()
            .any(|flaw| flaw.field == field.name && flaw.value == value);
        if !is_listed && self.list.len() < MAX_FLAWS {
            self.list.push(Flaw {
                field: field.name.clone(),
                value: value.to_owned(),
                message,
            });
        }
    }
}
