//! Calibration points as lines of text.
//!
//! In: CSV with the columns `u,v,x,y,z`, which a first line may name; the name of a printed tag, such as `tag7`, may
//! stand in place of `u,v`; comments start with `#`. Out: [`Pair`]s, or the line that is wrong. Finding tags is left to
//! `fab-vision`; whether the numbers are plausible is checked later, on all points.

use super::Pair;
use fab_base::files;
use fab_picture::Tag;
use std::path::Path;

/// The most points accepted.
pub const MAX_PAIRS: usize = 400;

/// The longest file accepted.
const MAX_BYTES: u64 = 1 << 20;

/// The columns of a file.
const COLUMNS: [&str; 5] = ["u", "v", "x", "y", "z"];

/// What a point is.
const FORM: &str = "a point is `u,v,x,y,z`: a pixel, or a tag such as `tag7`, then metres";

/// The tags in the camera's picture, or why nobody could look for them.
pub type SeenTags<'a> = Result<&'a [Tag], &'a str>;

/// Reads a file of points; fails with the reason.
///
/// - `seen`: the tags in the camera's picture.
pub fn read_pairs(path: &Path, seen: SeenTags<'_>) -> Result<Vec<Pair>, String> {
    parse_pairs(&files::read_text(path, MAX_BYTES)?, seen)
}

/// Reads points, one per line; `seen` are the tags in the camera's picture. The error names the line.
pub fn parse_pairs(text: &str, seen: SeenTags<'_>) -> Result<Vec<Pair>, String> {
    let lines = (1..).zip(text.lines().map(fields));
    let mut lines = lines.filter(|(_, fields)| !fields.is_empty());
    let mut lines = lines.by_ref().peekable();
    lines.next_if(|(_, names)| *names == COLUMNS);
    let pairs = lines
        .map(|(line, fields)| point(&fields, seen).map_err(|why| format!("line {line}: {why}")));
    let pairs: Vec<Pair> = pairs.collect::<Result<_, String>>()?;
    if pairs.len() > MAX_PAIRS {
        return Err(format!("there are more than {MAX_PAIRS} points"));
    }
    Ok(pairs)
}

/// Reads the pixel of a point, or the tag whose middle it is.
pub fn parse_pixel(line: &str, seen: SeenTags<'_>) -> Result<[f64; 2], String> {
    match pixel(&fields(line), seen)? {
        (pixel, []) => Ok(pixel),
        _ => Err("a pixel is typed as `u,v`, or as a tag such as `tag7`".to_owned()),
    }
}

/// Writes a point as a line that [`parse_pairs`] reads, with the same numbers.
pub fn csv_line(pair: &Pair) -> String {
    let numbers = pair.pixel.iter().chain(&pair.base_m).map(f64::to_string);
    numbers.collect::<Vec<String>>().join(",")
}

/// Splits a line at commas, semicolons and blanks, without its comment.
fn fields(line: &str) -> Vec<&str> {
    let content = line.split('#').next().unwrap_or_default();
    let fields = content.split([',', ';', ' ', '\t', '\r']);
    fields.filter(|field| !field.is_empty()).collect()
}

fn point(fields: &[&str], seen: SeenTags<'_>) -> Result<Pair, String> {
    let (pixel, [x, y, z]) = pixel(fields, seen)? else {
        return Err(format!("{} values; {FORM}", fields.len()));
    };
    let base_m = [number(x)?, number(y)?, number(z)?];
    Ok(Pair { pixel, base_m })
}

/// Reads the pixel at the beginning of a line; returns the fields after it as well.
fn pixel<'a, 't>(
    fields: &'a [&'t str],
    seen: SeenTags<'_>,
) -> Result<([f64; 2], &'a [&'t str]), String> {
    match fields {
        [tag, place @ ..] if tag.starts_with("tag") => Ok((tag_pixel(tag, seen)?, place)),
        [u, v, place @ ..] => Ok(([number(u)?, number(v)?], place)),
        _ => Err(format!("{} values; {FORM}", fields.len())),
    }
}

fn number(field: &str) -> Result<f64, String> {
    let number = field.parse::<f64>().ok();
    let number = number.filter(|number| number.is_finite());
    number.ok_or_else(|| {
        let shown: String = field.chars().take(20).collect();
        format!("`{shown}` is not a number; {FORM}")
    })
}

/// Returns the pixel of a tag's middle; fails unless the picture shows the tag once.
fn tag_pixel(name: &str, seen: SeenTags<'_>) -> Result<[f64; 2], String> {
    let name: String = name.chars().take(20).collect();
    let seen = seen.map_err(|why| format!("`{name}` is unknown: {why}"))?;
    let named = |tag: &Tag| format!("tag{}", tag.id);
    let mut same = seen.iter().filter(|tag| named(tag) == name);
    if let (Some(tag), None) = (same.next(), same.next()) {
        return Ok(tag.middle_px);
    }
    let shown: Vec<String> = seen.iter().map(named).collect();
    Err(format!(
        "the picture does not show `{name}` once; of the family 36h11 it shows: {}",
        if shown.is_empty() {
            "none".to_owned()
        } else {
            shown.join(", ")
        }
    ))
}
