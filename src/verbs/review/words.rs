//! Describes changes that belong to no component's line: of a scene, and of a picture's inputs.
//!
//! In: a pending scene or picture, and the accepted one. Out: causes without a place.

use super::edits::Cause;
use super::find::Pending;
use serde_json::{Map, Value};

/// Describes what changed in a scene: each keypoint's points, each mask's pixel count, and the cloth and camera.
pub fn scene_causes(pending: &Pending) -> Vec<Cause> {
    let parse = |text: &str| serde_json::from_str::<Map<String, Value>>(text).ok();
    let maps = pending
        .texts()
        .and_then(|(before, after)| Some([parse(before)?, parse(after)?]));
    let mut words = Vec::new();
    for (key, [before, after]) in maps.iter().flat_map(|[old, new]| changes(old, new)) {
        match (
            before.and_then(Value::as_object),
            after.and_then(Value::as_object),
        ) {
            (Some(old), Some(new)) if key == "points" => words.extend(each(old, new, points)),
            (Some(old), Some(new)) if key == "areas" => words.extend(each(old, new, area)),
            _ => words.push(match key {
                "seen_of" => "seen of another cloth, camera, picker or other keypoints".to_owned(),
                "start" => "another start".to_owned(),
                "step" => "another step".to_owned(),
                "last" => "another action before".to_owned(),
                key => changed(key, before, after),
            }),
        }
    }
    words.into_iter().map(Cause::in_words).collect()
}

/// Reports whether a picture's inputs changed.
pub fn drawn_from(pending: &Pending) -> Option<Cause> {
    let before = pending.accepted.as_ref()?.metadata.info.as_ref()?;
    let differs = before.drawn_from != pending.info.drawn_from;
    let words = "drawn from another scene, other layers or another fold";
    differs.then(|| Cause::in_words(words.to_owned()))
}

/// Returns the keys with different values, in the order of the new map, and both values.
fn changes<'m>(
    old: &'m Map<String, Value>,
    new: &'m Map<String, Value>,
) -> Vec<(&'m str, [Option<&'m Value>; 2])> {
    let gone = old.keys().filter(|key| !new.contains_key(*key));
    let keys = new.keys().chain(gone);
    keys.map(|key| (key.as_str(), [old.get(key), new.get(key)]))
        .filter(|(_, [before, after])| before != after)
        .collect()
}

/// Describes the difference of each key's values.
fn each(
    old: &Map<String, Value>,
    new: &Map<String, Value>,
    say: fn(&str, &Value, &Value) -> String,
) -> Vec<String> {
    let changes = changes(old, new).into_iter();
    changes
        .map(|(key, [before, after])| match (before, after) {
            (Some(before), Some(after)) => say(key, before, after),
            _ => changed(key, before, after),
        })
        .collect()
}

fn points(keypoint: &str, before: &Value, after: &Value) -> String {
    match (before.as_array(), after.as_array()) {
        (Some(before), Some(after)) if before.len() == after.len() => format!("{keypoint} moved"),
        (Some(before), Some(after)) => {
            let noun = if before.len() == 1 { "point" } else { "points" };
            format!("{keypoint}: {} {noun}, now {}", before.len(), after.len())
        }
        _ => format!("{keypoint} changed"),
    }
}

fn area(mask: &str, before: &Value, after: &Value) -> String {
    match (before.as_f64(), after.as_f64()) {
        (Some(before), Some(after)) => format!("{mask}: {before} pixels, now {after}"),
        _ => format!("{mask} changed"),
    }
}

fn changed(key: &str, before: Option<&Value>, after: Option<&Value>) -> String {
    let what = match (before, after) {
        (None, _) => "added",
        (_, None) => "removed",
        _ => "changed",
    };
    format!("{key} {what}")
}
