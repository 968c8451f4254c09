//! Says how one text became another: edits, each of one component, with what caused it.
//!
//! In: two texts, and where their lines come from. Out: [`Edit`]s in order. Lines that change side by side and come
//! from two components are two edits, so that an edit of one component is the same in every text that it is said in.

use super::find::Pending;
use crate::snapshots::{Metadata, Origin};
use serde::Serialize;
use similar::{Algorithm, DiffTag, capture_diff_slices};

/// Unchanged lines that are shown before and after an edit.
const CONTEXT: usize = 2;

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
#[derive(Clone, Debug)]
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

/// Returns the edits of a snapshot whose text changed.
pub fn edits(pending: &Pending) -> Vec<Edit> {
    let (Some((before, after)), Some(accepted)) = (pending.texts(), &pending.accepted) else {
        return Vec::new();
    };
    let old: Vec<&str> = before.lines().collect();
    let new: Vec<&str> = after.lines().collect();
    let mut edits = Vec::new();
    for change in capture_diff_slices(Algorithm::Myers, &old, &new) {
        if change.tag() == DiffTag::Equal {
            continue;
        }
        let removed: Vec<Line<'_>> = change
            .old_range()
            .map(|at| line(old[at], at, &accepted.metadata))
            .collect();
        let added: Vec<Line<'_>> = change
            .new_range()
            .map(|at| line(new[at], at, &pending.proposed.metadata))
            .collect();
        let start = change.new_range().start;
        let end = change.new_range().end;
        let owned = |lines: &[&str]| lines.iter().map(|line| (*line).to_owned()).collect();
        let around: [Vec<String>; 2] = [
            owned(&new[start.saturating_sub(CONTEXT)..start]),
            owned(&new[end..new.len().min(end + CONTEXT)]),
        ];
        edits.extend(by_component(&removed, &added, &around));
    }
    edits
}

fn line<'a>(text: &'a str, at: usize, metadata: &'a Metadata) -> Line<'a> {
    let number = u32::try_from(at + 1).unwrap_or(u32::MAX);
    let origins = metadata.info.iter().flat_map(|info| &info.origin);
    Line {
        text,
        origin: origins
            .into_iter()
            .find(|origin| (origin.from..=origin.to).contains(&number)),
    }
}

fn by_component(
    removed: &[Line<'_>],
    added: &[Line<'_>],
    [before, after]: &[Vec<String>; 2],
) -> Vec<Edit> {
    let component = |line: &Line<'_>| line.origin.map(|origin| origin.component.clone());
    let mut components = Vec::new();
    for line in added.iter().chain(removed) {
        let component = component(line);
        if !components.contains(&component) {
            components.push(component);
        }
    }
    let of = |lines: &[Line<'_>], wanted: &Option<String>| -> Vec<String> {
        lines
            .iter()
            .filter(|line| component(line) == *wanted)
            .map(|line| line.text.to_owned())
            .collect()
    };
    let mut edits: Vec<Edit> = components
        .iter()
        .map(|wanted| {
            let origins = added.iter().chain(removed).filter_map(|line| line.origin);
            // The new place says it where there is one: the file that was removed from may have moved.
            let origin = origins
                .into_iter()
                .find(|origin| Some(&origin.component) == wanted.as_ref());
            Edit {
                causes: origin.map(cause).into_iter().collect(),
                removed: of(removed, wanted),
                added: of(added, wanted),
                before: Vec::new(),
                after: Vec::new(),
            }
        })
        .collect();
    if let Some(first) = edits.first_mut() {
        first.before.clone_from(before);
    }
    if let Some(last) = edits.last_mut() {
        last.after.clone_from(after);
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
