//! Calibration points as lines of text.
//!
//! In: CSV with the columns `u,v,x,y,z` and optionally `depth`, in that order or as named by a header line; comments
//! start with `#`. Out: [`Pair`]s, or the line that is wrong. Whether the numbers are plausible is checked later, on
//! all points.

use super::Pair;
use fab_base::files;
use std::path::Path;

/// The most points accepted.
pub const MAX_PAIRS: usize = 400;

/// The longest file accepted.
const MAX_BYTES: u64 = 1 << 20;

/// The names of the columns, in the order assumed without a header line.
const COLUMNS: [&str; 6] = ["u", "v", "x", "y", "z", "depth"];

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
pub fn read_pairs(path: &Path) -> Result<Vec<Pair>, String> {
    let text = files::read_text(path, MAX_BYTES)?;
    parse_pairs(&text).map_err(|error| error.to_string())
}

/// Reads points, one per line.
pub fn parse_pairs(text: &str) -> Result<Vec<Pair>, PairError> {
    let mut pairs = Vec::new();
    let mut columns: Option<Columns> = None;
    for (line, content) in (1..).zip(text.lines()) {
        let wrong = |why: String| PairError { line, why };
        let fields = fields(content);
        if fields.is_empty() {
            continue;
        }
        let is_named = fields[0].starts_with(|c: char| c.is_ascii_alphabetic());
        match &columns {
            None if is_named => {
                columns = Some(Columns::named(&fields).map_err(wrong)?);
                continue;
            }
            None => columns = Some(Columns::usual()),
            Some(_) => {}
        }
        if let Some(columns) = &columns {
            pairs.push(columns.pair(&fields).map_err(wrong)?);
        }
        if pairs.len() > MAX_PAIRS {
            return Err(wrong(format!("there are more than {MAX_PAIRS} points")));
        }
    }
    Ok(pairs)
}

/// Writes a point as a line that [`parse_pairs`] reads, with the same numbers.
pub fn csv_line(pair: &Pair) -> String {
    let numbers = pair.pixel.iter().chain(&pair.base_m).chain(&pair.depth_m);
    let numbers: Vec<String> = numbers.map(f64::to_string).collect();
    numbers.join(",")
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

/// Reads numbers separated by commas or blanks.
pub(super) fn numbers(line: &str) -> Result<Vec<f64>, String> {
    fields(line).into_iter().map(number).collect()
}

fn number(field: &str) -> Result<f64, String> {
    let shown: String = field.chars().take(20).collect();
    match field.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("`{shown}` is no number")),
    }
}

/// Makes a point from `u, v, x, y, z` and optionally a depth.
pub(super) fn pair_of(numbers: &[f64]) -> Result<Pair, String> {
    let n = numbers.len();
    let (5 | 6) = n else {
        return Err(format!(
            "{n} numbers; a point is `u,v,x,y,z`, or `u,v,x,y,z,depth`: a pixel, then metres"
        ));
    };
    Ok(Pair {
        pixel: [numbers[0], numbers[1]],
        base_m: [numbers[2], numbers[3], numbers[4]],
        depth_m: numbers.get(5).copied(),
    })
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
                    "`{shown}` is not a column; the columns are `u`, `v` (pixels), `x`, `y`, `z` and `depth` \
                     (metres, or such as `x_mm`)"
                ));
            };
            if fields.iter().any(|(other, _)| *other == column) {
                return Err(format!("the column `{}` is there twice", COLUMNS[column]));
            }
            fields.push((column, factor));
        }
        let missing = (0..5).find(|column| fields.iter().all(|(it, _)| it != column));
        match missing {
            Some(column) => Err(format!("the column `{}` is missing", COLUMNS[column])),
            None => Ok(Columns { fields }),
        }
    }

    fn pair(&self, texts: &[&str]) -> Result<Pair, String> {
        // A depth may be missing at the end, or left empty.
        let texts = match texts {
            [start @ .., ""] => start,
            _ => texts,
        };
        let mut numbers = [None; COLUMNS.len()];
        if texts.len() > self.fields.len() {
            let (found, most) = (texts.len(), self.fields.len());
            return Err(format!("{found} numbers, and there are {most} columns"));
        }
        for (text, (column, factor)) in texts.iter().zip(&self.fields) {
            let is_left_out = text.is_empty() && COLUMNS[*column] == "depth";
            numbers[*column] = match is_left_out {
                true => None,
                false => Some(number(text)? * factor),
            };
        }
        let present: Vec<f64> = numbers.iter().map_while(|number| *number).collect();
        pair_of(&present)
    }
}
