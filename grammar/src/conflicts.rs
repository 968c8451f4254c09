//! Finds the markers that a merge leaves in a text.

use crate::fault::{Fault, Problem};
use crate::source::{FileId, Span};

/// Returns a fault for each conflict: the lines from `<<<<<<<` to `>>>>>>>`, or one of these alone.
///
/// Texts of prompts have them as often as the lines between, and a model would read them.
pub(crate) fn find(file: FileId, text: &str) -> Vec<Fault> {
    let mut conflicts: Vec<Vec<Span>> = Vec::new();
    let mut is_open = false;
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let marker = ["<<<<<<<", "|||||||", "=======", ">>>>>>>"]
            .into_iter()
            .find(|marker| begins_with(line, marker));
        let span = Span::new(file, start..start + line.trim_end().len());
        start += line.len();
        match marker {
            Some("<<<<<<<") => {
                conflicts.push(vec![span]);
                is_open = true;
            }
            Some(">>>>>>>") if !is_open => conflicts.push(vec![span]),
            // A row of `=` may underline a title.
            Some(marker) if is_open => {
                conflicts
                    .last_mut()
                    .into_iter()
                    .for_each(|it| it.push(span));
                is_open = marker != ">>>>>>>";
            }
            _ => {}
        }
    }
    let fault = |markers: Vec<Span>| Fault {
        span: markers[0],
        problem: Problem::MergeConflict { markers },
    };
    conflicts.into_iter().map(fault).collect()
}

/// Returns whether a line is a marker, alone or before the name of a branch.
fn begins_with(line: &str, marker: &str) -> bool {
    let rest = line.strip_prefix(marker);
    rest.is_some_and(|rest| rest.starts_with(' ') || rest.trim().is_empty())
}
