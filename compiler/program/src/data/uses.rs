//! What a value, a condition or a drawing depends on, computed in one place.

use std::collections::BTreeSet;

/// What something depends on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Uses {
    /// Whether it needs the proposed action.
    pub action: bool,
    /// The fields of either action that it reads, by name.
    pub fields: BTreeSet<String>,
    /// Whether it needs the previous action.
    pub last: bool,
    /// Whether it needs the pixel at which the previous action picked.
    pub last_pick: bool,
    /// The keypoints that it needs, by name.
    pub keypoints: BTreeSet<String>,
    /// Whether it asks for the number of the step, or whether there was a previous action.
    pub history: bool,
    /// Whether it asks which points are unreachable.
    pub reach: bool,
}

impl Uses {
    /// Adds a field of the proposed action.
    pub(crate) fn add_field(&mut self, name: &str) {
        self.action = true;
        self.fields.insert(name.to_owned());
    }

    /// Adds a field of the previous action.
    pub(crate) fn add_last_field(&mut self, name: &str) {
        self.last = true;
        self.fields.insert(name.to_owned());
    }
}

/// Something that depends on the scene, on the proposed action or on the previous one.
pub trait Depends {
    /// Adds what it depends on.
    fn add_uses(&self, uses: &mut Uses);

    /// Returns what it depends on.
    fn uses(&self) -> Uses {
        let mut uses = Uses::default();
        self.add_uses(&mut uses);
        uses
    }
}

impl<T: Depends> Depends for [T] {
    fn add_uses(&self, uses: &mut Uses) {
        self.iter().for_each(|part| part.add_uses(uses));
    }
}
