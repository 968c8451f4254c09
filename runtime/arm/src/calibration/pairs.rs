//! Calibration points as lines of text.
//!
//! In: CSV with the columns `u,v,x,y,z`, in that order or as named by a header line; a printed tag, such as `tag7`, may stand in place of `u,v`; comments start with `#`. Out: [`Pair`]s, or the line that is wrong.
//! Whether the numbers are plausible is checked later, on all points.

use super::{Pair, TagName};
use fab_base::files;
use fab_picture::Tag;
use std::path::Path;

/// The most points accepted.
pub const MAX_PAIRS: usize = 400;

/// The longest file accepted.
const MAX_BYTES: u64 = 1 << 20;

/// The names of the columns, in the order assumed without a header line.
const COLUMNS: [&str; 5] = ["u", "v", "x", "y", "z"];

/// Why points could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {why}")]
pub struct PairError {
    /// The line, from 1.
    pub line: usize,
    /// What is wrong.
    pub why: String,
}

/// Reads a file of points; fails with the reason.
///
/// - `seen`: the tags in the camera's picture.
pub fn read_pairs(path: &Path, seen: &[Tag]) -> Result<Vec<Pair>, String> {
    let text = files::read_text(path, MAX_BYTES)?;
    parse_pairs(&text, seen).map_err(|error| error.to_string())
}

/// Reads points, one per line; `seen` are the tags in the camera's picture.
pub fn parse_pairs(text: &str, seen: &[Tag]) -> Result<Vec<Pair>, PairError> {
    let mut pairs = Vec::new();
    let mut columns: Option<Columns> = None;
    for (line, content) in (1..).zip(text.lines()) {
        let wrong = |why: String| PairError { line, why };
        let fields = fields(content);
        if fields.is_empty() {
            continue;
        }
        let is_named =
            fields[0].starts_with(|c: char| c.is_ascii_alphabetic()) && !is_tag(fields[0]);
        match &columns {
            None if is_named => {
                columns = Some(Columns::named(&fields).map_err(wrong)?);
                continue;
            }
            None => columns = Some(Columns::usual()),
            Some(_) => {}
        }
        if let Some(columns) = &columns {
            pairs.push(columns.pair(&fields, seen).map_err(wrong)?);
        }
        if pairs.len() > MAX_PAIRS {
            return Err(wrong(format!("there are more than {MAX_PAIRS} points")));
        }
    }
    Ok(pairs)
}

/// Reads a typed point; with `place`, which reads the tool's position, only its pixel is typed.
pub(super) fn typed_pair(
    line: &str,
    seen: &[Tag],
    place: Option<&mut super::ToolReader<'_>>,
) -> Result<Pair, String> {
    let fields = fields(line);
    let Some(place) = place else {
        return Columns::usual().pair(&fields, seen);
    };
    let ([Some(u), Some(v), ..], tag) = Columns::pixel().read(&fields, seen)? else {
        return Err("a point is typed as `u,v`, or as a tag such as `tag7`".to_owned());
    };
    Ok(Pair {
        pixel: [u, v],
        base_m: place()?,
        tag,
    })
}

/// Writes a point as a line that [`parse_pairs`] reads, with the same numbers.
pub fn csv_line(pair: &Pair) -> String {
    let numbers: Vec<String> = pair
        .pixel
        .iter()
        .chain(&pair.base_m)
        .map(f64::to_string)
        .collect();
    let tag = pair.tag.map(|tag| format!(" # {tag}")).unwrap_or_default();
    numbers.join(",") + &tag
}

fn is_tag(field: &str) -> bool {
    field.starts_with("tag")
}

/// Splits a line at commas, or at blanks if it has none; drops its comment.
fn fields(line: &str) -> Vec<&str> {
    let content = line.split('#').next().unwrap_or_default().trim();
    match content {
        "" => Vec::new(),
        _ if content.contains(',') => content.split(',').map(str::trim).collect(),
        _ => content.split_whitespace().collect(),
    }
}

fn number(field: &str) -> Result<f64, String> {
    let shown: String = field.chars().take(20).collect();
    match field.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("`{shown}` is not a number")),
    }
}

/// The meaning and unit of each column.
struct Columns {
    /// For each field of a line: the column, and the factor to pixels or metres.
    fields: Vec<(usize, f64)>,
}

impl Columns {
    fn usual() -> Columns {
        Columns {
            fields: (0..COLUMNS.len()).map(|column| (column, 1.0)).collect(),
        }
    }

    fn pixel() -> Columns {
        Columns {
            fields: vec![(0, 1.0), (1, 1.0)],
        }
    }

    fn named(names: &[&str]) -> Result<Columns, String> {
        let mut fields = Vec::new();
        for name in names {
            let lower = name.to_ascii_lowercase();
            let (stem, unit) = lower.split_once('_').unwrap_or((&lower, ""));
            let column = COLUMNS.iter().position(|column| *column == stem);
            let factor = match (column, unit) {
                (Some(0 | 1), "" | "px") | (Some(2..), "" | "m") => Some(1.0),
                (Some(2..), "mm") => Some(0.001),
                _ => None,
            };
            let (Some(column), Some(factor)) = (column, factor) else {
                let shown: String = name.chars().take(20).collect();
                return Err(format!(
                    "`{shown}` is not a column; the columns are `u`, `v` (pixels), `x`, `y` and `z` (metres, \
                     or such as `x_mm`)"
                ));
            };
            if fields.iter().any(|(other, _)| *other == column) {
                return Err(format!("the column `{}` is there twice", COLUMNS[column]));
            }
            fields.push((column, factor));
        }
        let missing = (0..COLUMNS.len()).find(|column| fields.iter().all(|(it, _)| it != column));
        match missing {
            Some(column) => Err(format!("the column `{}` is missing", COLUMNS[column])),
            None => Ok(Columns { fields }),
        }
    }

    fn pair(&self, texts: &[&str], seen: &[Tag]) -> Result<Pair, String> {
        let (numbers, tag) = self.read(texts, seen)?;
        match numbers {
            [Some(u), Some(v), Some(x), Some(y), Some(z)] => Ok(Pair {
                pixel: [u, v],
                base_m: [x, y, z],
                tag,
            }),
            _ => {
                let n = numbers.iter().flatten().count();
                Err(format!(
                    "{n} numbers; a point is `u,v,x,y,z`: a pixel, or a tag such as `tag7`, then metres"
                ))
            }
        }
    }

    /// Reads the fields of a line, in the order of [`COLUMNS`].
    fn read(
        &self,
        texts: &[&str],
        seen: &[Tag],
    ) -> Result<([Option<f64>; 5], Option<TagName>), String> {
        let mut numbers = [None; COLUMNS.len()];
        let mut tag = None;
        let mut columns = self.fields.iter();
        for text in texts {
            let too_many = || {
                format!(
                    "{} numbers, and there are {} columns",
                    texts.len(),
                    self.fields.len()
                )
            };
            let (column, factor) = columns.next().ok_or_else(too_many)?;
            if !is_tag(text) {
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
        Ok((numbers, tag))
    }
}
