//! Calibration points as lines of text.
//!
//! In: CSV with the columns `u,v,x,y,z`, in that order or as named by a header line, as spreadsheets and pandas write it;
//! the name of a printed tag, such as `tag7`, may stand in place of `u,v`; comments start with `#`. Out: [`Pair`]s, or
//! the line that is wrong. Finding tags is left to `fab-vision`; whether the numbers are plausible is checked later, on
//! all points.

use super::{Pair, ToolReader};
use fab_base::files;
use fab_picture::Tag;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// The most points accepted.
pub const MAX_PAIRS: usize = 400;

/// The longest file accepted.
const MAX_BYTES: u64 = 1 << 20;

/// The names of the columns, in the order assumed without a header line.
const COLUMNS: [&str; 5] = ["u", "v", "x", "y", "z"];

/// Reads a file of points; fails with the reason.
///
/// - `seen`: the tags in the camera's picture.
pub fn read_pairs(path: &Path, seen: SeenTags<'_>) -> Result<Vec<Pair>, String> {
    parse_pairs(&files::read_text(path, MAX_BYTES)?, seen)
}

/// Reads points, one per line; `seen` are the tags in the camera's picture. The error names the line.
pub fn parse_pairs(text: &str, seen: SeenTags<'_>) -> Result<Vec<Pair>, String> {
    let mut pairs = Vec::new();
    let mut columns: Option<Columns> = None;
    for (line, content) in (1..).zip(text.lines()) {
        let wrong = |why: String| format!("line {line}: {why}");
        let fields = fields(content);
        if fields.iter().all(String::is_empty) {
            continue;
        }
        let is_value = |field: &String| field.starts_with("tag") || number(field).is_ok();
        if columns.is_none() && !fields.iter().any(is_value) {
            columns = Some(Columns::named(&fields).map_err(wrong)?);
            continue;
        }
        let columns = columns.get_or_insert_with(Columns::usual);
        pairs.push(columns.pair(&fields, seen).map_err(wrong)?);
        if pairs.len() > MAX_PAIRS {
            return Err(wrong(format!("there are more than {MAX_PAIRS} points")));
        }
    }
    Ok(pairs)
}

/// Reads a typed point; with `place`, which reads the tool's position, only its pixel is typed.
pub(super) fn typed_pair(
    line: &str,
    seen: SeenTags<'_>,
    place: Option<&mut ToolReader<'_>>,
) -> Result<Pair, String> {
    let mut fields = fields(line);
    let Some(place) = place else {
        return Columns::usual().pair(&fields, seen);
    };
    let n_expected = if fields.iter().any(|field| field.starts_with("tag")) {
        1
    } else {
        2
    };
    if fields.len() != n_expected {
        return Err("a point is typed as `u,v`, or as a tag such as `tag7`".to_owned());
    }
    fields.extend(["0"; 3].map(str::to_owned));
    let typed = Columns::usual().pair(&fields, seen)?;
    Ok(Pair {
        base_m: place()?,
        ..typed
    })
}

/// Writes a point as a line that [`parse_pairs`] reads, with the same numbers.
pub fn csv_line(pair: &Pair) -> String {
    let numbers = pair.pixel.iter().chain(&pair.base_m).map(f64::to_string);
    let tag = pair.tag.map(|tag| format!(" # {tag}")).unwrap_or_default();
    numbers.collect::<Vec<String>>().join(",") + &tag
}

/// Splits a line at its separators outside of quotes; drops its comment and the quotes.
///
/// The separator is the first of these that the line has: semicolon, tab, comma; or blanks.
fn fields(line: &str) -> Vec<String> {
    let content = line.split('#').next().unwrap_or_default();
    let content = content.trim_end().trim_start_matches(' ');
    let outside: String = content.split('"').step_by(2).collect();
    let mut separators = [';', '\t', ','].into_iter();
    let separator = separators.find(|it| outside.contains(*it));
    // Spreadsheets add separators for columns that are empty.
    let content = content.trim_end_matches(|letter| separator == Some(letter));
    let mut is_quoted = false;
    let splits = |letter: char| {
        is_quoted ^= letter == '"';
        !is_quoted && separator.map_or(letter.is_whitespace(), |it| it == letter)
    };
    let fields = content.split(splits).map(|field| field.replace('"', ""));
    let fields = fields.map(|field| field.trim().to_owned());
    let is_kept = |field: &String| separator.is_some() || !field.is_empty();
    fields.filter(is_kept).collect()
}

/// Reads a number, also one with a decimal comma.
fn number(field: &str) -> Result<f64, String> {
    match field.replace(',', ".").parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("`{}` is not a number", short(field))),
    }
}

/// Returns the beginning of a text, for a message.
fn short(text: &str) -> String {
    text.chars().take(40).collect()
}

/// The meaning and unit of each column.
struct Columns {
    /// Whether a table's index stands before them: pandas writes one first.
    has_index: bool,
    /// For each field of a line: the column, and the factor to pixels or metres.
    fields: Vec<(usize, f64)>,
}

impl Columns {
    fn usual() -> Columns {
        Columns {
            has_index: false,
            fields: (0..COLUMNS.len()).map(|column| (column, 1.0)).collect(),
        }
    }

    fn named(names: &[String]) -> Result<Columns, String> {
        let has_index = names.first().is_some_and(String::is_empty);
        let column = |name: &String| {
            let lower = name.to_ascii_lowercase();
            let (stem, unit) = lower.split_once('_').unwrap_or((&lower, ""));
            let column = COLUMNS.iter().position(|column| *column == stem);
            match (column, unit) {
                (Some(column @ 0..2), "" | "px") | (Some(column @ 2..), "" | "m") => {
                    Ok((column, 1.0))
                }
                (Some(column @ 2..), "mm") => Ok((column, 0.001)),
                _ => Err(format!(
                    "`{}` is not a column; the columns are `u`, `v` (pixels), `x`, `y` and `z` (metres, or such as `x_mm`)",
                    short(name)
                )),
            }
        };
        let names = &names[usize::from(has_index)..];
        let fields: Vec<(usize, f64)> = names.iter().map(column).collect::<Result<_, String>>()?;
        for (column, name) in COLUMNS.iter().enumerate() {
            match fields.iter().filter(|(it, _)| *it == column).count() {
                0 => return Err(format!("the column `{name}` is missing")),
                1 => {}
                _ => return Err(format!("the column `{name}` is there twice")),
            }
        }
        Ok(Columns { has_index, fields })
    }

    fn pair(&self, texts: &[String], seen: SeenTags<'_>) -> Result<Pair, String> {
        let texts = &texts[usize::from(self.has_index).min(texts.len())..];
        let mut numbers = [None; COLUMNS.len()];
        let mut tag = None;
        let mut columns = self.fields.iter();
        for text in texts {
            let (column, factor) = columns.next().ok_or_else(|| {
                format!(
                    "{} numbers, and there are {} columns",
                    texts.len(),
                    COLUMNS.len()
                )
            })?;
            if !text.starts_with("tag") {
                numbers[*column] = Some(number(text)? * factor);
                continue;
            }
            let name: TagName = text.parse()?;
            if (*column, columns.next().map(|(next, _)| *next)) != (0, Some(1)) {
                return Err(format!(
                    "`{name}` stands in place of the columns `u` and `v`, in this order"
                ));
            }
            let [u, v] = name.pixel(seen)?;
            (numbers[0], numbers[1]) = (Some(u), Some(v));
            tag = Some(name);
        }
        if let [Some(u), Some(v), Some(x), Some(y), Some(z)] = numbers {
            return Ok(Pair {
                pixel: [u, v],
                base_m: [x, y, z],
                tag,
            });
        }
        Err(format!(
            "{} numbers; a point is `u,v,x,y,z`: a pixel, or a tag such as `tag7`, then metres",
            numbers.iter().flatten().count()
        ))
    }
}

/// The tags in the camera's picture, or why nobody could look for them.
pub type SeenTags<'a> = Result<&'a [Tag], &'a str>;

/// The middle of a printed tag, written `tag7`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct TagName(pub usize);

impl TagName {
    /// Returns the tag's pixel; fails if the picture does not show the tag, or shows it twice.
    fn pixel(&self, seen: SeenTags<'_>) -> Result<[f64; 2], String> {
        let seen = seen.map_err(|why| format!("`{self}` is unknown: {why}"))?;
        let same: Vec<&Tag> = seen.iter().filter(|tag| tag.id == self.0).collect();
        match same[..] {
            [tag] => Ok(tag.middle_px),
            [] if seen.is_empty() => Err(format!(
                "the picture does not show `{self}`; it shows no tag of the family 36h11"
            )),
            [] => {
                let seen: Vec<String> =
                    seen.iter().map(|tag| TagName(tag.id).to_string()).collect();
                Err(format!(
                    "the picture does not show `{self}`; it shows {}",
                    seen.join(", ")
                ))
            }
            _ => Err(format!(
                "the picture shows `{self}` twice; print each number once"
            )),
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
        let unknown = || format!("`{}` is not a tag; write one such as `tag7`", short(text));
        number.map(TagName).ok_or_else(unknown)
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
