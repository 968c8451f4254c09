//! The names of one task, and what each stands for.
//!
//! Keypoints, texts that stages read, and action fields share one space: all can be written in a text.

use crate::ast::{ExprKind, Ident};
use crate::load::Loaded;
use crate::merge::Merged;
use crate::source::FileId;
use fab_program::KeypointShape;
use std::collections::BTreeMap;

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meaning {
    /// A keypoint; no shape where its declaration is wrong.
    Keypoint(Option<KeypointShape>),
    /// What the stage of this number reads.
    Text { stage: usize },
    /// A field of the action.
    Field,
}

/// Every name of a task.
pub(crate) struct Names<'a> {
    known: BTreeMap<&'a str, Meaning>,
    loaded: &'a Loaded,
    seen_from: FileId,
    is_broken: bool,
}

impl<'a> Names<'a> {
    /// Collects the names of a task; the shapes of its keypoints come from the form of their declarations.
    pub fn of(merged: &Merged<'a>, loaded: &'a Loaded) -> Names<'a> {
        let mut known = BTreeMap::new();
        for (stage, part) in merged.stages.iter().enumerate() {
            for read in part.read.iter().filter(|read| read.name.text != "action") {
                known
                    .entry(read.name.text.as_str())
                    .or_insert(Meaning::Text { stage });
            }
        }
        // A field that is missing or misspelt is reported where the action is declared.
        if merged.actions.is_some() {
            known.extend(["pick", "place"].map(|field| (field, Meaning::Field)));
        }
        for field in merged.actions.iter().flat_map(|part| &part.fields) {
            known.insert(&field.name.text, Meaning::Field);
        }
        for keypoint in merged.keypoints.iter() {
            known.insert(
                &keypoint.name.text,
                Meaning::Keypoint(shape(&keypoint.value.kind)),
            );
        }
        Names {
            known,
            loaded,
            seen_from: merged.task.name.span.file,
            is_broken: merged.is_broken,
        }
    }

    /// Returns the names outside of tasks: none.
    pub fn none(loaded: &'a Loaded) -> Names<'a> {
        Names {
            known: BTreeMap::new(),
            loaded,
            seen_from: loaded.entry().id,
            is_broken: false,
        }
    }

    pub fn get(&self, name: &str) -> Option<Meaning> {
        self.known.get(name).copied()
    }

    /// Returns the names whose meaning is wanted, in alphabetical order; of very many names, those among the first.
    pub fn that(&self, wanted: impl Fn(Meaning) -> bool) -> Vec<&'a str> {
        // They are only suggested: a file of unknown names must not be searched once for each.
        const MOST: usize = 1000;
        self.known
            .iter()
            .take(MOST)
            .filter(|(_, meaning)| wanted(**meaning))
            .map(|(name, _)| *name)
            .collect()
    }

    /// Returns whether a name may be declared in a missing task or in something that does not fit.
    pub fn may_be_declared(&self, name: &str) -> bool {
        self.is_broken
            || self
                .loaded
                .visible_from(self.seen_from)
                .any(|file| file.junk_words.contains(name))
    }
}

fn shape(value: &ExprKind) -> Option<KeypointShape> {
    let ExprKind::Call {
        name: Ident { text, .. },
        ..
    } = value
    else {
        return None;
    };
    match text.as_str() {
        "mask" | "closed" | "largest" => Some(KeypointShape::Mask),
        "bounding_box" => Some(KeypointShape::Box),
        "contour" => Some(KeypointShape::Outline),
        "harris" | "shi_tomasi" | "edge_middles" | "along" | "toward" | "points" => {
            Some(KeypointShape::Points)
        }
        "centroid" | "center" => Some(KeypointShape::Point),
        _ => None,
    }
}
