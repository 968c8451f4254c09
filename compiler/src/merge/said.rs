//! What a stage says: the parts that it lists, and those that extending tasks add beside them.

use fab_grammar::ast::{ComponentOrText, Name, Sayings, Side, Stage};
use std::collections::{BTreeMap, BTreeSet};

/// What a stage says in `system` and in `say`.
///
/// The lists stay as they are written; added parts are kept by the name that they go beside. This way, adding a part
/// takes no search through a list.
#[derive(Default)]
pub(crate) struct Said<'a> {
    /// Every component that it says, in the order of the lists; added ones last.
    names: Vec<&'a str>,
    known: BTreeSet<&'a str>,
    beside: BTreeMap<&'a str, Added<'a>>,
    /// Whether it says a text without a name.
    pub says_text: bool,
}

/// The parts that were added on both sides of another, in the order in which they are said.
#[derive(Default)]
struct Added<'a> {
    before: Vec<Name<'a>>,
    after: Vec<Name<'a>>,
}

impl<'a> Said<'a> {
    /// Returns what a stage says as it is declared.
    pub fn of(stage: Stage<'a>) -> Said<'a> {
        let mut said = Said::default();
        for saying in stage.system().chain(stage.say()).flat_map(Sayings::list) {
            match saying {
                ComponentOrText::Component(name) if said.known.insert(name.text()) => {
                    said.names.push(name.text());
                }
                ComponentOrText::Component(_) => {}
                ComponentOrText::Text(_) => said.says_text = true,
            }
        }
        said
    }

    /// Returns whether it says a component; a component that is left out keeps its place.
    pub fn says(&self, name: &str) -> bool {
        self.known.contains(name)
    }

    /// Returns the components that it says.
    pub fn names(&self) -> impl DoubleEndedIterator<Item = &'a str> {
        self.names.iter().copied()
    }

    /// Adds a part next to another that it says. Parts at one place keep the order in which they are added.
    pub fn add(&mut self, part: Name<'a>, side: Side, beside: &'a str) {
        let added = self.beside.entry(beside).or_default();
        match side {
            Side::Before => added.before.push(part),
            Side::After => added.after.push(part),
        }
        if self.known.insert(part.text()) {
            self.names.push(part.text());
        }
    }

    /// Returns the parts of a list together with those that were added beside them.
    ///
    /// - `placed`: the components whose neighbours are placed already. One that is said twice has them only once.
    pub fn with_added(
        &self,
        list: impl Iterator<Item = ComponentOrText<'a>>,
        placed: &mut BTreeSet<&'a str>,
    ) -> Vec<ComponentOrText<'a>> {
        let mut all = Vec::new();
        for saying in list {
            let ComponentOrText::Component(name) = saying else {
                all.push(saying);
                continue;
            };
            // Added parts may have neighbours of their own, to any depth.
            let mut open = vec![(name, false)];
            while let Some((name, is_next)) = open.pop() {
                match self.beside.get(name.text()) {
                    Some(added) if !is_next && placed.insert(name.text()) => {
                        let later = |name: &Name<'a>| (*name, false);
                        open.extend(added.after.iter().rev().map(later));
                        open.push((name, true));
                        open.extend(added.before.iter().rev().map(later));
                    }
                    _ => all.push(ComponentOrText::Component(name)),
                }
            }
        }
        all
    }
}
