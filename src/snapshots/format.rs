//! insta's file format: YAML between two `---` lines, then the text; a picture's bytes are in a separate file.
//!
//! In: text. Out: a [`Snapshot`], or an error message; and back. Nothing here touches files.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

/// The extension of pictures; this is the only supported binary format.
pub const PICTURE: &str = "png";
/// The line before and after the front matter.
const FENCE: &str = "---";
/// How a line begins with which git marks a merge conflict.
const CONFLICT: &str = "<<<<<<< ";

#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Describes what the snapshot is of.
    pub metadata: Metadata,
    pub contents: Contents,
}

/// The contents of a snapshot.
#[derive(Clone, Debug, PartialEq)]
pub enum Contents {
    /// Lines of text. Line-end style and trailing whitespace are ignored.
    Text(String),
    Picture(Vec<u8>),
}

impl Contents {
    /// Returns whether both are equal by insta's rules.
    pub fn is_same(&self, other: &Contents) -> bool {
        match (self, other) {
            (Contents::Text(one), Contents::Text(other)) => normal(one) == normal(other),
            _ => self == other,
        }
    }
}

impl Snapshot {
    pub fn of(source: &str, description: String, info: Info, contents: Contents) -> Snapshot {
        let metadata = Metadata {
            source: Some(source.to_owned()),
            description: Some(description),
            info: Some(info),
            ..Metadata::default()
        };
        Snapshot { metadata, contents }
    }
}

/// The front matter of a snapshot. Keys that only other tools write are ignored.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Metadata {
    /// The source file, relative to the folder that holds `snapshots/`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// A one-line description for people.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Details written by `fabc`; absent in snapshots that other tools wrote.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "ours")]
    pub info: Option<Info>,
    // Both are set in files of pictures alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    extension: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    snapshot_kind: Option<String>,
}

/// Details that `fabc` writes about a snapshot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Info {
    pub task: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub variant: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stage: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// What the picture shows; only for pictures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<String>,
    /// Estimated tokens; only for prompt texts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tokens: Option<u64>,
    /// Hash of the inputs of a scene or picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawn_from: Option<String>,
    /// Hash of a picture's bytes when it was drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes: Option<String>,
    /// Where the lines of a prompt text come from, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub origin: Vec<Origin>,
}

/// Reads details that `fabc` wrote, which name a task; those of other tools count as none.
fn ours<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Info>, D::Error> {
    let info = Value::deserialize(from)?;
    if !info["task"].is_string() {
        return Ok(None);
    }
    let info = serde_json::from_value(info).map_err(|error| format!("`info`: {error}"));
    info.map(Some).map_err(D::Error::custom)
}

/// Where some lines of a prompt text come from; written `3-6 visual_context lib/folding.fab:28`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Origin {
    /// The first of these lines, from 1.
    pub from: u32,
    pub to: u32,
    /// The component, `STAGE.say`, `check.NAME`, or a word such as `frame`; contains no blanks.
    pub component: String,
    /// The file and line, if known.
    pub place: Option<(String, u32)>,
}

impl From<Origin> for String {
    fn from(origin: Origin) -> String {
        let text = format!("{}-{} {}", origin.from, origin.to, origin.component);
        match origin.place {
            Some((file, line)) => format!("{text} {file}:{line}"),
            None => text,
        }
    }
}

impl TryFrom<String> for Origin {
    type Error = String;

    fn try_from(text: String) -> Result<Origin, String> {
        let parsed = || {
            let mut parts = text.splitn(3, ' ');
            let (from, to) = parts.next()?.split_once('-')?;
            let (from, to) = (from.parse().ok()?, to.parse().ok()?);
            let component = parts.next()?.to_owned();
            let place = match parts.next() {
                Some(place) => {
                    let (file, line) = place.rsplit_once(':')?;
                    Some((file.to_owned(), line.parse().ok()?))
                }
                None => None,
            };
            Some(Origin {
                from,
                to,
                component,
                place,
            })
        };
        parsed().ok_or_else(|| {
            format!("`{text}` is not an origin; one is `FROM-TO COMPONENT FILE:LINE`")
        })
    }
}

/// Reads a snapshot file: its metadata, and its text or `None` if its contents are a picture beside it.
pub fn parse(text: &str) -> Result<(Metadata, Option<String>), String> {
    let text = text.replace("\r\n", "\n") + "\n";
    if let Some(at) = text.lines().position(|line| line.starts_with(CONFLICT)) {
        return Err(format!("line {} begins a merge conflict", at + 1));
    }
    let rest = text.strip_prefix(FENCE);
    let rest = rest.ok_or("it does not begin with a line `---`")?;
    let parts = rest.split_once("\n---\n");
    let (yaml, text) = parts.ok_or("the line `---` after the metadata is missing")?;
    let mut metadata = Metadata::default();
    if !yaml.is_empty() {
        let options = serde_saphyr::options! { with_snippet: false };
        metadata = serde_saphyr::from_str_with_options(yaml, options)
            .map_err(|error| format!("its metadata cannot be read: {error}"))?;
    }
    let extension = metadata.extension.take();
    if metadata.snapshot_kind.take().as_deref() != Some("binary") {
        return Ok((metadata, Some(normal(text))));
    }
    if extension.as_deref() == Some(PICTURE) {
        return Ok((metadata, None));
    }
    Err(format!(
        "of binary snapshots `extension: {PICTURE}` alone is known"
    ))
}

/// Writes a snapshot file, without the bytes of a picture.
pub fn write(snapshot: &Snapshot) -> Result<String, String> {
    let mut metadata = snapshot.metadata.clone();
    let text = match &snapshot.contents {
        Contents::Text(text) => format!("{}\n", normal(text)),
        Contents::Picture(_) => {
            metadata.extension = Some(PICTURE.to_owned());
            metadata.snapshot_kind = Some("binary".to_owned());
            String::new()
        }
    };
    let options = serde_saphyr::ser_options! { prefer_block_scalars: false };
    let header = serde_saphyr::to_string_with_options(&metadata, options)
        .map_err(|error| format!("the metadata cannot be written: {error}"))?;
    Ok(format!("{FENCE}\n{header}{FENCE}\n{text}"))
}

/// Normalizes text for comparing and writing: line feeds only, no trailing whitespace.
fn normal(text: &str) -> String {
    text.trim_end().replace("\r\n", "\n")
}
