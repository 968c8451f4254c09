//! The variables of a task's templates: one name for each value, one value for each name.

use fab_program::Placeholder;
use std::collections::BTreeMap;

/// The longest name made from a value's source, bytes; a number may be appended.
const MAX_NAME_BYTES: usize = 48;

/// The variables named so far.
#[derive(Default)]
pub(crate) struct Variables {
    /// By the value's JSON.
    names: BTreeMap<String, String>,
    /// For each taken name, the number that the next variable of that name tries.
    taken: BTreeMap<String, u32>,
}

impl Variables {
    /// Returns the name of a value's variable; a new name is made from the value's source text.
    pub fn name(&mut self, value: &Placeholder, written: &str) -> String {
        let key = serde_json::to_string(value).expect("a value has string keys and finite numbers");
        if let Some(name) = self.names.get(&key) {
            return name.clone();
        }
        let words = written
            .split(|character: char| !character.is_ascii_alphanumeric() && character != '_')
            .filter(|word| !word.is_empty());
        let mut base = words.collect::<Vec<_>>().join("_");
        base.truncate(MAX_NAME_BYTES);
        if !base.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_') {
            base.insert(0, '_');
        }
        let mut name = base.clone();
        while self.taken.contains_key(&name) {
            let number = self.taken.entry(base.clone()).or_insert(2);
            name = format!("{base}_{number}");
            *number += 1;
        }
        self.taken.insert(name.clone(), 2);
        self.names.insert(key, name.clone());
        name
    }
}
