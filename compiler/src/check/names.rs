//! The names of one task, and the meaning of each.
//!
//! Keypoints, texts that stages read, and action fields share one namespace: all can be used in a text.

use crate::diag::{Report, Reported};
use crate::merge::{Merged, declared_twice};
use fab_grammar::ast::{Expr, Name};
use fab_program::{EXTRACTORS, KeypointShape};
use std::collections::{BTreeMap, BTreeSet};

/// The meaning of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meaning {
    /// A keypoint; without a shape if its declaration is wrong.
    Keypoint(Option<KeypointShape>),
    /// A text that the stage with this index reads.
    Text { stage: usize },
    /// A field of the action.
    Field,
    /// Declared twice, which was reported.
    DuplicateNames(Reported),
}

/// Every name of a task.
pub(crate) struct Names<'a> {
    meanings: BTreeMap<&'a str, Meaning>,
}

impl<'a> Names<'a> {
    /// Collects the names of a task and reports those with two meanings. A keypoint's shape follows from the call in
    /// its declaration.
    pub fn of(merged: &Merged<'a>, report: &mut Report) -> Names<'a> {
        let keypoints = merged.keypoints.iter().map(|keypoint| {
            let meaning = Meaning::Keypoint(shape(keypoint.value()));
            (keypoint.name(), "keypoint", meaning)
        });
        let fields = merged.actions().into_iter().flat_map(|part| part.fields());
        let fields = fields.map(|field| (field.name(), "field", Meaning::Field));
        let texts = merged.stages.iter().enumerate().flat_map(|(stage, part)| {
            // A stage with two `read` lines gets its own error.
            let mut seen = BTreeSet::from(["action"]);
            let names = part.read().map(|read| read.name());
            let names = names.filter(move |name| seen.insert(name.text()));
            names.map(move |name| (name, "text", Meaning::Text { stage }))
        });
        let mut meanings = BTreeMap::new();
        let mut declared: BTreeMap<&str, (Name<'_>, &str)> = BTreeMap::new();
        for (name, kind, meaning) in keypoints.chain(fields).chain(texts) {
            let (first, first_kind) = *declared.entry(name.text()).or_insert((name, kind));
            let meaning = if first.span() == name.span() {
                meaning
            } else {
                let kind = if kind == first_kind { kind } else { "name" };
                let diagnostic = declared_twice(kind, name.text(), first.span(), name.span());
                Meaning::DuplicateNames(report.error(diagnostic))
            };
            meanings.insert(name.text(), meaning);
        }
        // A missing or misspelt field is reported at the action's declaration.
        if merged.actions().is_some() {
            for field in ["pick", "place"] {
                meanings.entry(field).or_insert(Meaning::Field);
            }
        }
        Names { meanings }
    }

    /// Makes the empty set of names for checks outside of tasks.
    pub fn none() -> Names<'a> {
        Names {
            meanings: BTreeMap::new(),
        }
    }

    /// Returns the proof of an error if the name is declared twice.
    pub fn one_meaning(&self, name: &str) -> Result<(), Reported> {
        match self.get(name) {
            Some(Meaning::DuplicateNames(reported)) => Err(reported),
            _ => Ok(()),
        }
    }

    pub fn get(&self, name: &str) -> Option<Meaning> {
        self.meanings.get(name).copied()
    }

    /// Returns the names whose meaning passes the test, in alphabetical order; only the first 1000 names are
    /// searched.
    pub fn that(&self, fits: impl Fn(Meaning) -> bool) -> Vec<&'a str> {
        // These are only suggestions. Searching all names for each unknown one would take quadratic time.
        const MOST: usize = 1000;
        let some = self.meanings.iter().take(MOST);
        some.filter(|(_, meaning)| fits(**meaning))
            .map(|(name, _)| *name)
            .collect()
    }
}

fn shape(value: Expr<'_>) -> Option<KeypointShape> {
    let Expr::Call(call) = value else {
        return None;
    };
    let mut rows = EXTRACTORS.iter();
    let row = rows.find(|row| row.call.signature.name == call.name().text());
    row.map(|row| row.gives)
}
