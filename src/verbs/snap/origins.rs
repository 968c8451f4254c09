//! The origins of a pinned prompt's lines, as recorded in its snapshot.

use crate::snapshots::Origin;
use crate::verbs::render::page::ShownStage;

/// Returns the origins of a page's lines; merges those that are consecutive in the file.
pub fn of(shown: &ShownStage) -> Vec<Origin> {
    let mut origins: Vec<Origin> = Vec::new();
    for (line, number) in shown.lines().iter().zip(1u32..) {
        let Some(origin) = &line.origin else {
            continue;
        };
        let component = origin.source.replace(' ', "_");
        let place = origin.place.as_ref();
        let place = place.map(|place| (place.file.clone(), place.line));
        if let Some(before) = origins.last_mut()
            && before.to + 1 == number
            && before.component == component
            && follows(before, place.as_ref())
        {
            before.to = number;
            continue;
        }
        origins.push(Origin {
            from: number,
            to: number,
            component,
            place,
        });
    }
    origins
}

/// Returns whether a line directly follows `before` in its file.
fn follows(before: &Origin, place: Option<&(String, u32)>) -> bool {
    match (&before.place, place) {
        (None, None) => true,
        (Some((file, line)), Some((next_file, next_line))) => {
            file == next_file && line + (before.to - before.from) + 1 == *next_line
        }
        _ => false,
    }
}
