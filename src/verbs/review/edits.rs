//! Describes how one text became another: edits of one component each, with their causes.
//!
//! In: two snapshots, with the origins of their lines. Out: [`Edit`]s in order. Adjacent changed lines from two
//! components are two edits, so that an edit of one component is the same in every text that contains the component.

use crate::snapshots::{Contents, Origin, Snapshot};
use serde::Serialize;
use similar::{Algorithm, DiffTag, capture_diff_slices};
use std::ops::Range;

/// Unchanged lines shown before and after an edit.
const CONTEXT: usize = 2;

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Cause {
    /// The component, or a description of what changed.
    pub component: String,
    pub file: Option<String>,
    pub line: Option<u32>,
}

/// Changed lines of one component.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Edit {
    /// `None` for lines of no component, such as those of a scene.
    #[serde(skip)]
    component: Option<String>,
    /// Where the lines come from: the new place of added lines, otherwise the old place.
    #[serde(skip)]
    pub causes: Vec<Cause>,
    pub removed: Vec<String>,
    pub added: Vec<String>,
    /// Lines of one snapshot's new text before them.
    #[serde(skip)]
    pub before: Vec<String>,
    /// Lines of the new text after them.
    #[serde(skip)]
    pub after: Vec<String>,
}

impl Edit {
    /// Returns what is equal for the same edit in different texts.
    pub fn key(&self) -> (&Option<String>, &[String], &[String]) {
        (&self.component, &self.removed, &self.added)
    }
}

struct Text<'a> {
    lines: Vec<&'a str>,
    origins: &'a [Origin],
}

impl<'a> Text<'a> {
    /// Returns the lines of a snapshot; a picture has none.
    fn of(snapshot: &'a Snapshot) -> Text<'a> {
        let info = snapshot.metadata.info.as_ref();
        Text {
            lines: match &snapshot.contents {
                Contents::Text(text) => text.lines().collect(),
                Contents::Picture(_) => Vec::new(),
            },
            origins: info.map_or(&[], |info| &info.origin),
        }
    }

    /// Returns the origin of this very line, if it comes from a component.
    fn cause(&self, at: usize) -> Option<Cause> {
        let number = u32::try_from(at).ok()?.checked_add(1)?;
        let mut origins = self.origins.iter();
        let origin = origins.find(|origin| (origin.from..=origin.to).contains(&number))?;
        let (file, first) = origin.place.clone().unzip();
        Some(Cause {
            component: origin.component.clone(),
            file,
            line: first.map(|first| first + (number - origin.from)),
        })
    }

    fn owned(&self, range: Range<usize>) -> Vec<String> {
        let lines = self.lines[range].iter();
        lines.map(|line| (*line).to_owned()).collect()
    }
}

/// Returns the edits between two texts, each once.
pub fn between(before: &Snapshot, after: &Snapshot) -> Vec<Edit> {
    let (old, new) = (Text::of(before), Text::of(after));
    let mut edits: Vec<Edit> = Vec::new();
    for change in capture_diff_slices(Algorithm::Myers, &old.lines, &new.lines) {
        if change.tag() == DiffTag::Equal {
            continue;
        }
        let Range { start, end } = change.new_range();
        let mut found: Vec<Edit> = Vec::new();
        // Added lines first: removed ones of the same component may have moved.
        for at in start..end {
            if let Some(edit) = edit_of(&mut found, &new, at) {
                edit.added.push(new.lines[at].to_owned());
            }
        }
        for at in change.old_range() {
            if let Some(edit) = edit_of(&mut found, &old, at) {
                edit.removed.push(old.lines[at].to_owned());
            }
        }
        if let Some(first) = found.first_mut() {
            first.before = new.owned(start.saturating_sub(CONTEXT)..start);
        }
        if let Some(last) = found.last_mut() {
            last.after = new.owned(end..new.lines.len().min(end + CONTEXT));
        }
        for edit in found {
            match edits.iter_mut().find(|known| known.key() == edit.key()) {
                Some(known) => known.causes.extend(edit.causes),
                None => edits.push(edit),
            }
        }
    }
    edits
}

/// Returns the edit to which a changed line belongs; `None` for a blank line between two texts, which is no edit.
fn edit_of<'e>(found: &'e mut Vec<Edit>, text: &Text<'_>, at: usize) -> Option<&'e mut Edit> {
    let cause = text.cause(at);
    if cause.is_none() && text.lines[at].trim().is_empty() {
        return None;
    }
    let component = cause.as_ref().map(|cause| cause.component.clone());
    let known = found.iter().position(|edit| edit.component == component);
    let at = known.unwrap_or_else(|| {
        found.push(Edit {
            component,
            causes: cause.into_iter().collect(),
            ..Edit::default()
        });
        found.len() - 1
    });
    found.get_mut(at)
}
