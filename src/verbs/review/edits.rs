//! Describes how one text became another: edits of one component each, with their causes.
//!
//! In: two texts, and the origins of their lines. Out: [`Edit`]s in order. Adjacent changed lines from two components
//! are two edits, so that an edit of one component is the same in every text that contains the component.

use super::find::Pending;
use crate::snapshots::{Metadata, Origin};
use serde::Serialize;
use similar::{Algorithm, DiffOp, DiffTag, capture_diff_slices};
use std::collections::BTreeMap;
use std::ops::Range;

/// Unchanged lines shown before and after an edit.
const CONTEXT: usize = 2;
/// The longest texts that are compared line by line, since the time grows with the square. Longer texts are one edit.
const MAX_COMPARED_LINES: usize = 10_000;

/// The cause of a change.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Cause {
    /// The component, or a description of what changed.
    pub component: String,
    /// The file, if known.
    pub file: Option<String>,
    /// The line in it, from 1.
    pub line: Option<u32>,
}

impl Cause {
    /// Makes a cause that is no component.
    pub fn in_words(words: String) -> Cause {
        Cause {
            component: words,
            file: None,
            line: None,
        }
    }
}

/// Changed lines of one component, with the blank lines between texts beside them.
#[derive(Clone, Debug, Default)]
pub struct Edit {
    /// Identical for the same edit in different texts; ignores blank lines between texts.
    pub key: String,
    /// Where the lines come from: the new place of added lines, otherwise the old place.
    pub causes: Vec<Cause>,
    pub removed: Vec<String>,
    pub added: Vec<String>,
    /// Lines of one snapshot's new text before them.
    pub before: Vec<String>,
    /// Lines of the new text after them.
    pub after: Vec<String>,
}

/// A changed line and its origin.
struct Line<'a> {
    text: &'a str,
    /// Its number in its text, from 1.
    number: u32,
    origin: Option<&'a Origin>,
}

impl<'a> Line<'a> {
    /// Returns whether it only separates two texts.
    fn is_spacing(&self) -> bool {
        self.origin.is_none() && self.text.trim().is_empty()
    }

    fn component(&self) -> Option<&'a str> {
        self.origin.map(|origin| origin.component.as_str())
    }

    /// Returns the origin of this very line, if it comes from a component.
    fn cause(&self) -> Option<Cause> {
        let origin = self.origin?;
        let (file, first) = origin.place.clone().unzip();
        Some(Cause {
            component: origin.component.clone(),
            file,
            line: first.map(|first| first.saturating_add(self.number - origin.from)),
        })
    }
}

/// A text's lines, and where they come from.
struct Lines<'a> {
    lines: Vec<&'a str>,
    /// In order of their first lines.
    origins: Vec<&'a Origin>,
}

impl<'a> Lines<'a> {
    fn of(text: &'a str, metadata: &'a Metadata) -> Lines<'a> {
        let info = metadata.info.iter();
        let mut origins: Vec<&Origin> = info.flat_map(|info| &info.origin).collect();
        origins.sort_by_key(|origin| origin.from);
        Lines {
            lines: text.lines().collect(),
            origins,
        }
    }

    fn some(&self, range: Range<usize>) -> Vec<Line<'a>> {
        range.map(|at| self.line(at)).collect()
    }

    fn line(&self, at: usize) -> Line<'a> {
        let number = u32::try_from(at + 1).unwrap_or(u32::MAX);
        let after = self.origins.partition_point(|origin| origin.from <= number);
        let last = after.checked_sub(1).map(|at| self.origins[at]);
        Line {
            text: self.lines[at],
            number,
            origin: last.filter(|origin| number <= origin.to),
        }
    }

    fn owned(&self, range: Range<usize>) -> Vec<String> {
        let lines = self.lines[range].iter();
        lines.map(|line| (*line).to_owned()).collect()
    }
}

/// Returns the edits of a snapshot with a changed text.
pub fn edits(pending: &Pending) -> Vec<Edit> {
    let (Some((before, after)), Some(accepted)) = (pending.texts(), &pending.accepted) else {
        return Vec::new();
    };
    let old = Lines::of(before, &accepted.metadata);
    let new = Lines::of(after, &pending.proposed.metadata);
    let count = new.lines.len();
    let changes = match old.lines.len().max(count) > MAX_COMPARED_LINES {
        true => vec![DiffOp::Replace {
            old_index: 0,
            old_len: old.lines.len(),
            new_index: 0,
            new_len: count,
        }],
        false => capture_diff_slices(Algorithm::Myers, &old.lines, &new.lines),
    };
    let mut edits = Vec::new();
    for change in changes {
        if change.tag() == DiffTag::Equal {
            continue;
        }
        let Range { start, end } = change.new_range();
        let mut found = by_component(&old.some(change.old_range()), &new.some(start..end));
        if let Some(first) = found.first_mut() {
            first.before = new.owned(start.saturating_sub(CONTEXT)..start);
        }
        if let Some(last) = found.last_mut() {
            last.after = new.owned(end..count.min(end + CONTEXT));
        }
        edits.append(&mut found);
    }
    edits
}

/// Returns one edit for each component with added or removed lines, in the order of the new text.
///
/// The cause is the component's new place if it has one, since removed lines may have moved. A blank line between two
/// texts belongs to the line before it, or else to the one after it.
fn by_component(removed: &[Line<'_>], added: &[Line<'_>]) -> Vec<Edit> {
    let mut edits: Vec<Edit> = Vec::new();
    let mut known: BTreeMap<Option<&str>, usize> = BTreeMap::new();
    // Blank lines are an edit of their own only if nothing else changed beside them.
    let is_only_spacing = removed.iter().chain(added).all(Line::is_spacing);
    let is_own = |line: &Line<'_>| is_only_spacing || !line.is_spacing();
    for line in added.iter().chain(removed).filter(|line| is_own(line)) {
        known.entry(line.component()).or_insert_with(|| {
            edits.push(Edit {
                causes: line.cause().into_iter().collect(),
                ..Edit::default()
            });
            edits.len() - 1
        });
    }
    let mut own: Vec<[Vec<&str>; 2]> = vec![Default::default(); edits.len()];
    for (side, lines) in [removed, added].into_iter().enumerate() {
        let first = lines.iter().find(|line| is_own(line));
        let mut at = first.map_or(0, |line| known[&line.component()]);
        for line in lines {
            if is_own(line) {
                at = known[&line.component()];
                own[at][side].push(line.text);
            }
            let edit = &mut edits[at];
            let lines = [&mut edit.removed, &mut edit.added];
            lines[side].push(line.text.to_owned());
        }
    }
    for (edit, [removed, added]) in edits.iter_mut().zip(own) {
        let causes = edit.causes.iter();
        let components: Vec<&str> = causes.map(|cause| cause.component.as_str()).collect();
        edit.key = serde_json::json!([components, removed, added]).to_string();
    }
    edits
}
