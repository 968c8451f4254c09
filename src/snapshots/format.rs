//! insta's file format: YAML between two `---` lines, then the text; a picture's bytes are in a separate file.
//!
//! In: bytes. Out: a [`Snapshot`], or an error message; and back. Nothing here touches files.

use super::Metadata;
use fab_base::kinds::without_mark;
use serde_json::{Map, Value};

/// The extension of pictures; this is the only supported binary format.
pub const PICTURE: &str = "png";
/// The longest snapshot file without its picture, bytes.
pub const MAX_TEXT_BYTES: u64 = 4 << 20;
/// The longest picture, bytes.
pub const MAX_PICTURE_BYTES: u64 = 32 << 20;
/// The longest front matter, bytes.
const MAX_HEADER_BYTES: usize = 512 << 10;
/// The line before and after the front matter.
const FENCE: &str = "---";

/// A snapshot: metadata and contents.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Describes what the snapshot is of.
    pub metadata: Metadata,
    /// The text or picture.
    pub contents: Contents,
}

/// The contents of a snapshot.
#[derive(Clone, Debug, PartialEq)]
pub enum Contents {
    /// Lines of text. Line-end style and trailing whitespace are ignored.
    Text(String),
    /// A PNG file.
    Picture(Vec<u8>),
}

impl Contents {
    /// Returns whether both are equal by insta's rules.
    pub fn is_same(&self, other: &Contents) -> bool {
        match (self, other) {
            (Contents::Text(one), Contents::Text(other)) => normal(one) == normal(other),
            (Contents::Picture(one), Contents::Picture(other)) => one == other,
            _ => false,
        }
    }
}

/// A parsed snapshot file, without the picture that may belong to it.
#[derive(Debug)]
pub struct Parsed {
    pub metadata: Metadata,
    /// The text; `None` if the contents are a picture beside the file.
    pub text: Option<String>,
}

/// Reads a snapshot file.
pub fn parse(bytes: &[u8]) -> Result<Parsed, String> {
    let text = std::str::from_utf8(without_mark(bytes)).map_err(|error| {
        format!(
            "it is not UTF-8 from byte {} on",
            error.valid_up_to().saturating_add(1)
        )
    })?;
    let mut lines = text.split_inclusive('\n');
    if lines.next().map(str::trim_end) != Some(FENCE) {
        return Err("it does not begin with a line `---`".to_owned());
    }
    let start = text.find('\n').map_or(text.len(), |end| end + 1);
    let mut end = start;
    let mut rest = None;
    for line in lines {
        if line.trim_end() == FENCE {
            rest = Some(end + line.len());
            break;
        }
        end += line.len();
    }
    let rest = rest.ok_or("the line `---` after the metadata is missing")?;
    let mut map = yaml(&text[start..end])?;
    let is_binary = map
        .shift_remove("snapshot_kind")
        .is_some_and(|kind| kind == "binary");
    if is_binary {
        let extension = map.shift_remove("extension");
        if extension.as_ref().and_then(Value::as_str) != Some(PICTURE) {
            let found = extension.map_or("nothing".to_owned(), |value| format!("`{value}`"));
            return Err(format!(
                "of binary snapshots `extension: {PICTURE}` alone is known, and it says {found}"
            ));
        }
    }
    Ok(Parsed {
        metadata: Metadata::of_map(map)?,
        text: (!is_binary).then(|| normal(&text[rest..])),
    })
}

/// Writes a snapshot file, without the bytes of a picture.
pub fn write(snapshot: &Snapshot) -> Result<Vec<u8>, String> {
    let mut map = snapshot
        .metadata
        .to_map()
        .map_err(|error| error.to_string())?;
    if let Contents::Picture(_) = snapshot.contents {
        map.insert("extension".to_owned(), Value::from(PICTURE));
        map.insert("snapshot_kind".to_owned(), Value::from("binary"));
    }
    let options = serde_saphyr::ser_options! { prefer_block_scalars: false };
    let header = match map.is_empty() {
        true => String::new(),
        false => serde_saphyr::to_string_with_options(&map, options)
            .map_err(|error| format!("the metadata cannot be written: {error}"))?,
    };
    let mut file = format!("{FENCE}\n{header}{FENCE}\n");
    if let Contents::Text(text) = &snapshot.contents {
        file.push_str(&normal(text));
        file.push('\n');
    }
    match parse(file.as_bytes()) {
        Ok(_) if file.len() as u64 <= MAX_TEXT_BYTES => Ok(file.into_bytes()),
        Ok(_) => Err(format!("it has more than {MAX_TEXT_BYTES} bytes")),
        Err(why) => Err(why),
    }
}

/// Normalizes text for comparing and writing: line feeds only, no trailing whitespace.
pub fn normal(text: &str) -> String {
    text.trim_end().replace("\r\n", "\n")
}

fn yaml(text: &str) -> Result<Map<String, Value>, String> {
    if text.len() > MAX_HEADER_BYTES {
        return Err(format!(
            "its metadata has more than {MAX_HEADER_BYTES} bytes"
        ));
    }
    if text.trim().is_empty() {
        return Ok(Map::new());
    }
    let options = serde_saphyr::options! {
        budget: serde_saphyr::budget! { max_nodes: 100_000, max_depth: 64, max_aliases: 0, max_anchors: 0 },
        with_snippet: false,
    };
    serde_saphyr::from_str_with_options(text, options)
        .map_err(|error| format!("its metadata is not a YAML map: {error}"))
}
