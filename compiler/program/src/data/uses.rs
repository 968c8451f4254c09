//! What a value, a condition or a drawing depends on: worked out once, for all who ask.

use std::collections::BTreeSet;

/// What something depends on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Uses {
    /// Whether it needs the proposed action.
    pub action: bool,
    /// Whether it needs the action before this one.
    pub last: bool,
    /// Whether it needs the pixel that the action before picked.
    pub last_pick: bool,
    /// Whether it needs the pixel that the action before placed on.
    pub last_place: bool,
    /// The keypoints that it needs, by name.
    pub keypoints: BTreeSet<String>,
    /// Whether it asks which step it is, or whether there was an action before.
    pub history: bool,
    /// Whether it asks which points are out of reach.
    pub reach: bool,
}

/// Something that depends on the scene, on the proposed action or on the one before.
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
