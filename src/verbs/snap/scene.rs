//! A pinned scene: what the camera saw once, so that prompts can be rendered again without a camera.
//!
//! In: a program, and what was seen. Out: JSON that a person can read and edit, and a [`SceneView`] of it. Its hash
//! identifies what was seen: cloth, camera, picker, keypoints, and the actions before its step.

use crate::sources;
use fab_base::digest;
use fab_program::facts::ExecutedAction;
use fab_program::scene::SceneView;
use fab_program::{PixelPoint, Program, Proposal, Subgoals, Value, pins_folder};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PinnedScene {
    /// Hash of what was seen.
    pub seen_of: String,
    /// Always null, for the task's own start.
    pub start: (),
    pub step: u32,
    pub last: Option<PinnedAction>,
    pub points: BTreeMap<String, Vec<PixelPoint>>,
    /// The number of pixels of each mask.
    pub areas: BTreeMap<String, f64>,
}

/// The previous action of a pinned scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PinnedAction {
    pub fields: BTreeMap<String, Value>,
    pub pick: PixelPoint,
    pub place: PixelPoint,
}

/// A scene that is pinned.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Moment {
    /// Its name in the snapshots.
    pub name: &'static str,
    pub step: u32,
}

impl Moment {
    /// Returns the moments of a task: the start, and if a prompt looks back, the second step.
    pub fn of(program: &Program) -> Vec<Moment> {
        let moment = |name, step| Moment { name, step };
        let mut moments = vec![moment("start", 1)];
        if program.looks_back() && program.horizon > 1 {
            moments.push(moment("later", 2));
        }
        moments
    }

    /// Returns the hash of everything that a scene of this moment depends on.
    pub fn seen_of(&self, program: &Program) -> String {
        let folds = match &program.subgoals {
            Some(Subgoals::Demonstrate { folds }) => folds.as_slice(),
            _ => &[],
        };
        let before = folds.len().min(self.step as usize - 1);
        let what = serde_json::json!({
            "cloth": program.cloth,
            "camera": program.camera,
            "picker": program.picker,
            "keypoints": program.keypoints,
            "start": null,
            "step": self.step,
            "folds": folds[..before],
        });
        short_hash(what.to_string())
    }
}

impl PinnedScene {
    /// Parses a scene; the error says what is wrong with the text.
    pub fn parse(text: &str) -> Result<PinnedScene, String> {
        let scene: PinnedScene = serde_json::from_str(text).map_err(|error| error.to_string())?;
        if scene.step == 0 {
            return Err("its `step` is 0, and steps are counted from 1".to_owned());
        }
        Ok(scene)
    }

    /// Formats the scene, one line per keypoint.
    pub fn text(&self) -> String {
        format!(
            "{{\n  \"seen_of\": {},\n  \"start\": {},\n  \"step\": {},\n  \"last\": {},\n  \"points\": {},\n  \"areas\": {}\n}}\n",
            json(&self.seen_of),
            json(&self.start),
            json(&self.step),
            json(&self.last),
            block(&self.points),
            block(&self.areas)
        )
    }

    /// Returns the previous action, with its fields in the program's order.
    pub fn last(&self, program: &Program) -> Option<ExecutedAction> {
        let last = self.last.as_ref()?;
        let names = program.actions.iter().map(|field| field.name.clone());
        let fields = names.filter_map(|name| last.fields.get(&name).cloned().map(|it| (name, it)));
        Some(ExecutedAction {
            proposal: Proposal {
                fields: fields.collect(),
            },
            pick: last.pick,
            place: last.place,
        })
    }
}

/// Formats a map, one line per key.
fn block(map: &BTreeMap<String, impl Serialize>) -> String {
    if map.is_empty() {
        return "{}".to_owned();
    }
    let lines = map.iter();
    let lines = lines.map(|(key, value)| format!("    {}: {}", json(key), json(value)));
    format!("{{\n{}\n  }}", lines.collect::<Vec<String>>().join(",\n"))
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("a scene has string keys and finite numbers")
}

impl SceneView for PinnedScene {
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
        self.points.get(keypoint).cloned()
    }

    fn distance_px(&self, _: &str, _: PixelPoint) -> Option<f64> {
        None
    }

    fn area_px(&self, mask: &str) -> Option<f64> {
        self.areas.get(mask).copied()
    }
}

/// Returns hashes of the subgoal pictures beside the task that can be read, in order: the author's, or the pinned ones.
pub fn hashes_of_pictures(program: &Program, folder: &Path) -> Vec<String> {
    let files: Vec<PathBuf> = match &program.subgoals {
        None => Vec::new(),
        Some(Subgoals::Images { images }) => images
            .iter()
            .map(|image| PathBuf::from(&image.file.path))
            .collect(),
        Some(Subgoals::Demonstrate { folds }) => {
            let mut pins = PathBuf::from(pins_folder(&program.title()));
            if !folder.join(&pins).exists() {
                pins = PathBuf::from(pins_folder(&program.task));
            }
            let names = (0..=folds.len()).map(|number| format!("{number}.png"));
            names.map(|name| pins.join(name)).collect()
        }
    };
    let hash = |path: &PathBuf| {
        let path = sources::inside(folder, &folder.join(path)).ok()?;
        Some(short_hash(sources::read_bounded(&path).ok()?))
    };
    files.iter().filter_map(hash).collect()
}

/// Returns the first 16 hex digits of the SHA-256 of bytes.
pub fn short_hash(bytes: impl AsRef<[u8]>) -> String {
    digest::of(bytes)[..16].to_owned()
}

#[cfg(test)]
mod tests;
