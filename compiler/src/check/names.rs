//! The names of one task, and the meaning of each.
//!
//! Keypoints, texts that stages read, and action fields share one namespace: all can be used in a text.

use crate::diag::Reported;
use crate::load::Loaded;
use crate::merge::Merged;
use fab_grammar::FileId;
use fab_grammar::ast::Expr;
use fab_program::{EXTRACTORS, KeypointShape};
use std::collections::BTreeMap;

/// The meaning of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meaning {
    /// A keypoint; without a shape if its declaration is wrong.
    Keypoint(Option<KeypointShape>),
    /// A text that the stage of this number reads.
    Text { stage: usize },
    /// A field of the action.
    Field,
}

/// Every name of a task.
pub(crate) struct Names<'a> {
    meanings: BTreeMap<&'a str, Meaning>,
    seen_from: FileId,
    missing_base: Option<Reported>,
}

impl<'a> Names<'a> {
    /// Collects the names of a task; the call in a keypoint's declaration gives its shape.
    pub fn of(merged: &Merged<'a>) -> Names<'a> {
        let mut meanings = BTreeMap::new();
        for (stage, part) in merged.stages.iter().enumerate() {
            for read in part.read().filter(|read| read.name().text() != "action") {
                meanings
                    .entry(read.name().text())
                    .or_insert(Meaning::Text { stage });
            }
        }
        // A missing or misspelt field is reported at the action's declaration.
        if merged.actions.is_some() {
            meanings.extend(["pick", "place"].map(|field| (field, Meaning::Field)));
        }
        for field in merged.actions.into_iter().flat_map(|part| part.fields()) {
            meanings.insert(field.name().text(), Meaning::Field);
        }
        for keypoint in merged.keypoints.iter() {
            meanings.insert(
                keypoint.name().text(),
                Meaning::Keypoint(shape(keypoint.value())),
            );
        }
        Names {
            meanings,
            seen_from: merged.task.name().span().file,
            missing_base: merged.missing_base,
        }
    }

    /// Makes the empty set of names for checks outside of tasks.
    pub fn none(seen_from: FileId) -> Names<'a> {
        Names {
            meanings: BTreeMap::new(),
            seen_from,
            missing_base: None,
        }
    }

    pub fn get(&self, name: &str) -> Option<Meaning> {
        self.meanings.get(name).copied()
    }

    /// Returns the names with such a meaning, in alphabetical order; only the first names are searched.
    pub fn that(&self, fits: impl Fn(Meaning) -> bool) -> Vec<&'a str> {
        // They are only suggestions, and searching all names for each unknown one would take quadratic time.
        const MOST: usize = 1000;
        let some = self.meanings.iter().take(MOST);
        some.filter(|(_, meaning)| fits(**meaning))
            .map(|(name, _)| *name)
            .collect()
    }

    /// Returns the proof of an error that may hide the declaration of an unknown name: a missing task, or a part that
    /// did not parse.
    pub fn hidden(&self, name: &str, loaded: &Loaded<'_>) -> Option<Reported> {
        let in_file = || {
            let mut files = loaded.visible_from(self.seen_from);
            let file = files.find(|file| file.unparsed_words.contains(name))?;
            loaded.fault(file.id)
        };
        self.missing_base.or_else(in_file)
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
