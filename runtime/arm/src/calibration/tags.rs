//! Printed tags that stand for pixels.
//!
//! In: the tags found in the camera's picture, or why none were looked for, and a name such as `tag7`. Out: the pixel of
//! that tag's middle. Finding tags is left to `fab-vision`.

use fab_picture::Tag;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The tags in the camera's picture, or why nobody could look for them.
pub type SeenTags<'a> = Result<&'a [Tag], &'a str>;

/// The middle of a tag, written `tag7`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct TagName(pub usize);

impl TagName {
    /// Returns the tag's pixel; fails if the picture does not show the tag, or shows it twice.
    pub(super) fn pixel(&self, seen: SeenTags<'_>) -> Result<[f64; 2], String> {
        let seen = seen.map_err(|why| format!("`{self}` is unknown: {why}"))?;
        let mut same = seen.iter().filter(|tag| tag.id == self.0);
        match (same.next(), same.next()) {
            (Some(tag), None) => Ok(tag.middle_px),
            (Some(_), Some(_)) => Err(format!(
                "the picture shows `{self}` twice; print each number once"
            )),
            (None, _) => {
                let seen: Vec<String> =
                    seen.iter().map(|tag| TagName(tag.id).to_string()).collect();
                let seen = match seen[..] {
                    [] => "no tag of the family 36h11".to_owned(),
                    _ => seen.join(", "),
                };
                Err(format!(
                    "the picture does not show `{self}`; it shows {seen}"
                ))
            }
        }
    }
}

impl fmt::Display for TagName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tag{}", self.0)
    }
}

impl FromStr for TagName {
    type Err = String;

    fn from_str(text: &str) -> Result<TagName, String> {
        let number = text.strip_prefix("tag").and_then(|id| id.parse().ok());
        number.map(TagName).ok_or_else(|| {
            let shown: String = text.chars().take(40).collect();
            format!("`{shown}` is not a tag; write one such as `tag7`")
        })
    }
}

impl TryFrom<String> for TagName {
    type Error = String;

    fn try_from(text: String) -> Result<TagName, String> {
        text.parse()
    }
}

impl From<TagName> for String {
    fn from(name: TagName) -> String {
        name.to_string()
    }
}
