//! Says how one text became another: edits, each of one component, with what caused it.
//!
//! In: two texts, and where their lines come from. Out: [`Edit`]s in order. Lines that change side by side and come
//! from two components are two edits, so that an edit of one component is the same in every text that it is said in.

use super::find::Pending;
use crate::snapshots::{Metadata, Origin};
use serde::Serialize;
use similar::{Algorithm, DiffOp, DiffTag, capture_diff_slices};
use std::collections::BTreeMap;
use std::ops::Range;

/// Unchanged lines that are shown before and after an edit.
const CONTEXT: usize = 2;
/// The longest texts that are compared line by line; the time for it grows with the square. Longer ones are one edit.
const MAX_COMPARED_LINES: usize = 10_000;

/// What caused a change.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Cause {
    /// The component, or what changed in words.
    pub component: String,
    /// The file, where it is known.
    pub file: Option<String>,
    /// The line in it, from 1.
    pub line: Option<u32>,
}

impl Cause {
    /// Says what changed where no component did.
    pub fn in_words(words: String) -> Cause {
        Cause {
            component: words,
            file: None,
            line: None,
        }
    }
}

/// Lines of one component that became others.
#[derive(Clone, Debug, Default)]
pub struct Edit {
    /// Where the lines come from; of lines that were added, where they are now, else where they were.
    pub causes: Vec<Cause>,
    /// The lines that go.
    pub removed: Vec<String>,
    /// The lines that come.
    pub added: Vec<String>,
    /// Lines of the new text before them, of one snapshot.
    pub before: Vec<String>,
    /// Lines of the new text after them.
    pub after: Vec<String>,
}

impl Edit {
    /// Returns what is the same for one edit, wherever it is made.
    pub fn key(&self) -> String {
        let components: Vec<&str> = self
            .causes
            .iter()
            .map(|cause| cause.component.as_str())
            .collect();
        serde_json::json!([components, self.removed, self.added]).to_string()
    }
}

/// A line that changed, and where it comes from.
struct Line<'a> {
    text: &'a str,
    origin: Option<&'a Origin>,
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
            origin: last.filter(|origin| number <= origin.to),
        }
    }

    fn owned(&self, range: Range<usize>) -> Vec<String> {
        let lines = self.lines[range].iter();
        lines.map(|line| (*line).to_owned()).collect()
    }
}

/// Returns the edits of a snapshot whose text changed.
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

/// Returns an edit for each component that lines go from or come from, in the order of the new text.
///
/// The new place of a component says its cause where there is one: what was removed may have moved since.
fn by_component(removed: &[Line<'_>], added: &[Line<'_>]) -> Vec<Edit> {
    let mut edits: Vec<Edit> = Vec::new();
    let mut known: BTreeMap<Option<&str>, usize> = BTreeMap::new();
    let added = added.iter().map(|line| (line, DiffTag::Insert));
    let removed = removed.iter().map(|line| (line, DiffTag::Delete));
    for (line, tag) in added.chain(removed) {
        let component = line.origin.map(|origin| origin.component.as_str());
        let at = *known.entry(component).or_insert_with(|| {
            edits.push(Edit {
                causes: line.origin.map(cause).into_iter().collect(),
                ..Edit::default()
            });
            edits.len() - 1
        });
        let side = match tag {
            DiffTag::Insert => &mut edits[at].added,
            _ => &mut edits[at].removed,
        };
        side.push(line.text.to_owned());
    }
    edits
}

fn cause(origin: &Origin) -> Cause {
    let (file, line) = origin.place.clone().unzip();
    Cause {
        component: origin.component.clone(),
        file,
        line,
    }
}

/// Says in words what changed in a scene: the keys whose values differ.
pub fn scene_causes(pending: &Pending) -> Vec<Cause> {
    let Some((before, after)) = pending.texts() else {
        return Vec::new();
    };
    let parse = |text: &str| serde_json::from_str::<serde_json::Map<_, _>>(text).ok();
    let mut words = Vec::new();
    if let (Some(old), Some(new)) = (parse(before), parse(after)) {
        for (key, value) in &new {
            match old.get(key) {
                None => words.push(format!("{key} added")),
                Some(before) if before == value => {}
                Some(before) if before.is_array() && value.is_array() => {
                    words.push(format!("{key} moved"));
                }
                Some(_) => words.push(format!("{key} changed")),
            }
        }
        let gone = old.keys().filter(|key| !new.contains_key(*key));
        words.extend(gone.map(|key| format!("{key} removed")));
    }
    words.extend(drawn_from(pending));
    words.into_iter().map(Cause::in_words).collect()
}

/// Says whether what a scene or picture was made from changed.
pub fn drawn_from(pending: &Pending) -> Option<String> {
    let before = pending.accepted.as_ref()?.metadata.info.as_ref()?;
    let differs = before.drawn_from != pending.info.drawn_from;
    differs.then(|| "drawn_from changed".to_owned())
}
