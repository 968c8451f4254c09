//! The names of one task, and what each stands for.
//!
//! Keypoints, texts that stages read, and action fields share one space: all can be written in a text.

use crate::diag::Reported;
use crate::load::Loaded;
use crate::merge::Merged;
use fab_grammar::FileId;
use fab_grammar::ast::Expr;
use fab_program::{EXTRACTORS, KeypointShape};
use std::collections::BTreeMap;

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meaning {
    /// A keypoint; no shape where its form does not say one: its declaration is wrong then.
    Keypoint(Option<KeypointShape>),
    /// What the stage of this number reads.
    Text { stage: usize },
    /// A field of the action.
    Field,
}

/// Every name of a task.
pub(crate) struct Names<'a> {
    known: BTreeMap<&'a str, Meaning>,
    seen_from: FileId,
    missing_base: Option<Reported>,
}

impl<'a> Names<'a> {
    /// Collects the names of a task; the shapes of its keypoints come from the form of their declarations.
    pub fn of(merged: &Merged<'a>) -> Names<'a> {
        let mut known = BTreeMap::new();
        for (stage, part) in merged.stages.iter().enumerate() {
            for read in part.read().filter(|read| read.name().text() != "action") {
                known
                    .entry(read.name().text())
                    .or_insert(Meaning::Text { stage });
            }
        }
        // A field that is missing or misspelt is reported where the action is declared.
        if merged.actions.is_some() {
            known.extend(["pick", "place"].map(|field| (field, Meaning::Field)));
        }
        for field in merged.actions.into_iter().flat_map(|part| part.fields()) {
            known.insert(field.name().text(), Meaning::Field);
        }
        for keypoint in merged.keypoints.iter() {
            known.insert(
                keypoint.name().text(),
                Meaning::Keypoint(shape(keypoint.value())),
            );
        }
        Names {
            known,
            seen_from: merged.task.name().span().file,
            missing_base: merged.missing_base,
        }
    }

    /// Returns the names outside of tasks: none.
    pub fn none(seen_from: FileId) -> Names<'a> {
        Names {
            known: BTreeMap::new(),
            seen_from,
            missing_base: None,
        }
    }

    pub fn get(&self, name: &str) -> Option<Meaning> {
        self.known.get(name).copied()
    }

    /// Returns the names with such a meaning, in alphabetical order; of very many names, those among the first.
    pub fn that(&self, fits: impl Fn(Meaning) -> bool) -> Vec<&'a str> {
        // They are only suggested: a file of unknown names must not be searched once for each.
        const MOST: usize = 1000;
        let some = self.known.iter().take(MOST);
        some.filter(|(_, meaning)| fits(**meaning))
            .map(|(name, _)| *name)
            .collect()
    }

    /// Returns the proof of the error in which an unknown name may be declared: a missing task, or what does not fit.
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
