//! Calibration points as lines of text.
//!
//! In: CSV with the columns `u,v,x,y,z`, which a first line may name, as spreadsheets and pandas write it; the name of a
//! printed tag, such as `tag7`, may stand in place of `u,v`; comments start with `#`. Out: [`Pair`]s, or the line that is
//! wrong. Finding tags is left to `fab-vision`; whether the numbers are plausible is checked later, on all points.

use super::Pair;
use fab_base::files;
use fab_picture::Tag;
use std::path::Path;

/// The most points accepted.
pub const MAX_PAIRS: usize = 400;

/// The longest file accepted.
const MAX_BYTES: u64 = 1 << 20;

/// The tags in the camera's picture, or why nobody could look for them.
pub type SeenTags<'a> = Result<&'a [Tag], &'a str>;

/// Returns the tool's position with the arm at rest, metres, base frame, or says why there is none.
pub type ToolReader<'a> = dyn FnMut() -> Result<[f64; 3], String> + 'a;

/// Reads a file of points; fails with the reason.
///
/// - `seen`: the tags in the camera's picture.
pub fn read_pairs(path: &Path, seen: SeenTags<'_>) -> Result<Vec<Pair>, String> {
    parse_pairs(&files::read_text(path, MAX_BYTES)?, seen)
}

/// Reads points, one per line; `seen` are the tags in the camera's picture. The error names the line.
pub fn parse_pairs(text: &str, seen: SeenTags<'_>) -> Result<Vec<Pair>, String> {
    let mut pairs = Vec::new();
    // How many fields stand before the point: pandas writes a table's index first.
    let mut skipped = None;
    for (line, content) in (1..).zip(text.lines()) {
        let wrong = |why: String| format!("line {line}: {why}");
        let fields = fields(content);
        if fields.iter().all(String::is_empty) {
            continue;
        }
        let is_value = |field: &String| field.starts_with("tag") || number(field).is_ok();
        if skipped.is_none() && !fields.iter().any(is_value) {
            skipped = Some(named_columns(&fields).map_err(wrong)?);
            continue;
        }
        let skipped = *skipped.get_or_insert(0);
        let fields = fields.get(skipped..).unwrap_or_default();
        pairs.push(point(fields, seen).map_err(wrong)?);
        if pairs.len() > MAX_PAIRS {
            return Err(wrong(format!("there are more than {MAX_PAIRS} points")));
        }
    }
    Ok(pairs)
}

/// Reads a typed point; with `tool`, only its pixel is typed, and the tool's position is read then.
pub fn typed_pair(
    line: &str,
    seen: SeenTags<'_>,
    tool: Option<&mut ToolReader<'_>>,
) -> Result<Pair, String> {
    let fields = fields(line);
    let Some(tool) = tool else {
        return point(&fields, seen);
    };
    let (pixel, []) = pixel(&fields, seen)? else {
        return Err("a point is typed as `u,v`, or as a tag such as `tag7`".to_owned());
    };
    let base_m = tool()?;
    Ok(Pair { pixel, base_m })
}

/// Writes a point as a line that [`parse_pairs`] reads, with the same numbers.
pub fn csv_line(pair: &Pair) -> String {
    let numbers = pair.pixel.iter().chain(&pair.base_m).map(f64::to_string);
    numbers.collect::<Vec<String>>().join(",")
}

/// Checks a line of names; returns how many fields stand before the columns.
fn named_columns(names: &[String]) -> Result<usize, String> {
    let skipped = usize::from(names.first().is_some_and(String::is_empty));
    let names = names[skipped..].join(",");
    if names.eq_ignore_ascii_case("u,v,x,y,z") {
        return Ok(skipped);
    }
    let shown: String = names.chars().take(60).collect();
    Err(format!(
        "the columns are `u,v,x,y,z` in this order, pixels and metres, and it names `{shown}`"
    ))
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

fn point(fields: &[String], seen: SeenTags<'_>) -> Result<Pair, String> {
    let (pixel, place) = pixel(fields, seen)?;
    let [x, y, z] = place else {
        return Err(not_a_point(fields));
    };
    let base_m = [number(x)?, number(y)?, number(z)?];
    Ok(Pair { pixel, base_m })
}

fn not_a_point(fields: &[String]) -> String {
    format!(
        "{} values; a point is `u,v,x,y,z`: a pixel, or a tag such as `tag7`, then metres",
        fields.len()
    )
}

/// Reads the pixel at the beginning of a line; returns the fields after it as well.
fn pixel<'a>(fields: &'a [String], seen: SeenTags<'_>) -> Result<([f64; 2], &'a [String]), String> {
    match fields {
        [tag, place @ ..] if tag.starts_with("tag") => Ok((tag_pixel(tag, seen)?, place)),
        [u, v, place @ ..] => Ok(([number(u)?, number(v)?], place)),
        _ => Err(not_a_point(fields)),
    }
}

/// Reads a number, also one with a decimal comma.
fn number(field: &str) -> Result<f64, String> {
    match field.replace(',', ".").parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => {
            let shown: String = field.chars().take(20).collect();
            Err(format!("`{shown}` is not a number"))
        }
    }
}

/// Returns the pixel of a tag's middle; fails if the picture does not show the tag, or shows it twice.
fn tag_pixel(name: &str, seen: SeenTags<'_>) -> Result<[f64; 2], String> {
    let shown: String = name.chars().take(20).collect();
    let id = name.strip_prefix("tag").and_then(|id| id.parse().ok());
    let id: usize =
        id.ok_or_else(|| format!("`{shown}` is not a tag; write one such as `tag7`"))?;
    let seen = seen.map_err(|why| format!("`{shown}` is unknown: {why}"))?;
    let same: Vec<&Tag> = seen.iter().filter(|tag| tag.id == id).collect();
    match same[..] {
        [tag] => Ok(tag.middle_px),
        [] => {
            let others: Vec<String> = seen.iter().map(|tag| format!("tag{}", tag.id)).collect();
            Err(format!(
                "the picture does not show `{shown}`; of the family 36h11 it shows: {}",
                if others.is_empty() {
                    "none".to_owned()
                } else {
                    others.join(", ")
                }
            ))
        }
        _ => Err(format!(
            "the picture shows `{shown}` twice; print each number once"
        )),
    }
}
