//! The front matter of a snapshot: what it is of, and where its lines come from.
//!
//! In and out: the map of the YAML front matter. Unknown keys are kept.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::fmt;

/// The front matter of a snapshot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// The source file, relative to the folder that holds `snapshots/`.
    pub source: Option<String>,
    /// A one-line description for people.
    pub description: Option<String>,
    /// Details written by `fabc`; absent in snapshots that other tools wrote.
    pub info: Option<Info>,
    /// All other keys, unchanged.
    pub others: Map<String, Value>,
}

/// Details that `fabc` writes about a snapshot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Info {
    /// The task.
    pub task: String,
    /// The variant; absent for the task itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variant: Option<String>,
    /// The stage; absent for scenes and pictures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stage: Option<String>,
    /// The pinned scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// What the picture shows; only for pictures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture: Option<String>,
    /// Estimated tokens; only for prompt texts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tokens: Option<u64>,
    /// Hash of the inputs of a scene or picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drawn_from: Option<String>,
    /// Hash of a picture's bytes when it was drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bytes: Option<String>,
    /// Where the lines of a prompt text come from, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub origin: Vec<Origin>,
    /// All other keys, unchanged.
    #[serde(flatten)]
    pub others: Map<String, Value>,
}

/// Where some lines of a prompt text come from; written `3-6 visual_context lib/folding.fab:28`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Origin {
    /// The first of these lines, from 1.
    pub from: u32,
    /// The last of these lines.
    pub to: u32,
    /// The component, `STAGE.say`, `check.NAME`, or a word such as `frame`; contains no blanks.
    pub component: String,
    /// The file and line, if known.
    pub place: Option<(String, u32)>,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{} {}", self.from, self.to, self.component)?;
        match &self.place {
            Some((file, line)) => write!(f, " {file}:{line}"),
            None => Ok(()),
        }
    }
}

impl From<Origin> for String {
    fn from(origin: Origin) -> String {
        origin.to_string()
    }
}

impl TryFrom<String> for Origin {
    type Error = String;

    fn try_from(text: String) -> Result<Origin, String> {
        parsed(&text).ok_or_else(|| {
            format!("`{text}` is not an origin; one is `FROM-TO COMPONENT FILE:LINE`")
        })
    }
}

fn parsed(text: &str) -> Option<Origin> {
    let mut parts = text.splitn(3, ' ');
    let (from, to) = parts.next()?.split_once('-')?;
    let (from, to) = (from.parse().ok()?, to.parse().ok()?);
    let component = parts
        .next()
        .filter(|component| !component.is_empty())?
        .to_owned();
    let place = match parts.next() {
        Some(place) => {
            let (file, line) = place.rsplit_once(':')?;
            Some((file.to_owned(), line.parse().ok()?))
        }
        None => None,
    };
    (1 <= from && from <= to).then_some(Origin {
        from,
        to,
        component,
        place,
    })
}

impl Metadata {
    /// Reads the map of a front matter; the error names the invalid value.
    pub(super) fn of_map(mut map: Map<String, Value>) -> Result<Metadata, String> {
        let mut words = |key: &str| match map.shift_remove(key) {
            None | Some(Value::Null) => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(other) => Err(format!("`{key}` is to be text, and is `{other}`")),
        };
        let (source, description) = (words("source")?, words("description")?);
        let is_ours = map.get("info").is_some_and(|info| info["task"].is_string());
        let info = match is_ours.then(|| map.shift_remove("info")).flatten() {
            Some(info) => {
                Some(serde_json::from_value(info).map_err(|error| format!("`info`: {error}"))?)
            }
            None => None,
        };
        Ok(Metadata {
            source,
            description,
            info,
            others: map,
        })
    }

    /// Returns the map to write.
    pub(super) fn to_map(&self) -> Result<Map<String, Value>, serde_json::Error> {
        let mut map = Map::new();
        let words = [("source", &self.source), ("description", &self.description)];
        for (key, text) in words {
            if let Some(text) = text {
                map.insert(key.to_owned(), Value::from(text.as_str()));
            }
        }
        if let Some(info) = &self.info {
            map.insert("info".to_owned(), serde_json::to_value(info)?);
        }
        map.extend(self.others.clone());
        Ok(map)
    }
}
