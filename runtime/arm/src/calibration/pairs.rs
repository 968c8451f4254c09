//! Calibration points as lines of text.
//!
//! In: CSV with the columns `u,v,x,y,z`, in that order or as named by a header line, as spreadsheets and pandas write it;
//! a printed tag, such as `tag7`, may stand in place of `u,v`; comments start with `#`. Out: [`Pair`]s, or the line that
//! is wrong.
//! Whether the numbers are plausible is checked later, on all points.

use super::{Pair, SeenTags, TagName};
use fab_base::files;
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
pub fn read_pairs(path: &Path, seen: SeenTags<'_>) -> Result<Vec<Pair>, String> {
    let text = files::read_text(path, MAX_BYTES)?;
    parse_pairs(&text, seen).map_err(|error| error.to_string())
}

/// Reads points, one per line; `seen` are the tags in the camera's picture.
pub fn parse_pairs(text: &str, seen: SeenTags<'_>) -> Result<Vec<Pair>, PairError> {
    let mut pairs = Vec::new();
    let mut columns: Option<Columns> = None;
    for (line, content) in (1..).zip(text.lines()) {
        let wrong = |why: String| PairError { line, why };
        let fields = fields(content);
        // Excel may say the separator in a line of its own.
        if fields.iter().all(String::is_empty) || content.starts_with("sep=") {
            continue;
        }
        let is_value = |field: &String| is_tag(field) || number(field).is_ok();
        match &columns {
            None if !fields.iter().any(is_value) => {
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
    seen: SeenTags<'_>,
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
    let shown: String = field.chars().take(20).collect();
    match field.replace(',', ".").parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("`{shown}` is not a number")),
    }
}

/// What the index of a table is called that is no column of points: pandas writes one first.
const INDEX: [&str; 3] = ["", "index", "unnamed: 0"];

/// The meaning and unit of each column.
struct Columns {
    /// How many fields stand before them.
    skipped: usize,
    /// For each field of a line: the column, and the factor to pixels or metres.
    fields: Vec<(usize, f64)>,
}

impl Columns {
    fn usual() -> Columns {
        Columns {
            skipped: 0,
            fields: (0..COLUMNS.len()).map(|column| (column, 1.0)).collect(),
        }
    }

    fn pixel() -> Columns {
        Columns {
            skipped: 0,
            fields: vec![(0, 1.0), (1, 1.0)],
        }
    }

    fn named(names: &[String]) -> Result<Columns, String> {
        let mut fields = Vec::new();
        let is_index = |name: &String| INDEX.contains(&name.to_ascii_lowercase().as_str());
        let skipped = usize::from(names.first().is_some_and(is_index));
        for name in &names[skipped..] {
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
            None => Ok(Columns { skipped, fields }),
        }
    }

    fn pair(&self, texts: &[String], seen: SeenTags<'_>) -> Result<Pair, String> {
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
        texts: &[String],
        seen: SeenTags<'_>,
    ) -> Result<([Option<f64>; 5], Option<TagName>), String> {
        let mut numbers = [None; COLUMNS.len()];
        let mut tag = None;
        let mut columns = self.fields.iter();
        for text in texts.iter().skip(self.skipped) {
            let too_many = || {
                format!(
                    "{} numbers, and there are {} columns",
                    texts.len() - self.skipped,
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
