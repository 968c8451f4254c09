//! Text whose parts have meanings, wrapped to a width and coloured if wanted.

use console::measure_text_width;
use fab_program::invisible::is_hidden;

/// The meaning of a part of a line; the signs before the line convey it too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    Plain,
    Head,
    Faint,
    Removed,
    RemovedWord,
    Added,
    AddedWord,
}

/// A character and its meaning.
type Cell = (char, Style);

/// A line, as the characters to show.
#[derive(Clone, Debug, Default)]
pub struct Line(Vec<Cell>);

impl Line {
    /// Makes a line with one meaning.
    pub fn of(text: &str, style: Style) -> Line {
        let mut line = Line::default();
        line.push(text, style);
        line
    }

    /// Adds a part; control characters are replaced by visible signs.
    pub fn push(&mut self, text: &str, style: Style) {
        for letter in text.chars() {
            match letter {
                '\t' => self.0.extend([(' ', style); 4]),
                '\0'..='\u{1f}' => {
                    let sign = char::from_u32(0x2400 + u32::from(letter));
                    self.0.push((sign.unwrap_or('\u{fffd}'), style));
                }
                letter if is_hidden(letter) => self.0.push(('\u{fffd}', style)),
                letter => self.0.push((letter, style)),
            }
        }
    }

    /// Returns rows of at most `columns`, broken at blanks after the first word if possible.
    ///
    /// Later rows are indented like the first plus `more`, at most half of the columns.
    pub fn wrapped(&self, columns: usize, more: usize) -> Vec<Line> {
        let indent = (leading(&self.0) + more).min(columns / 2);
        let mut rows = Vec::new();
        let mut rest = self.0.as_slice();
        let mut margin = 0;
        loop {
            let (row, tail) = rest.split_at(end_of_row(rest, columns - margin));
            let mut line = Line::default().padded(margin);
            line.0.extend(row);
            rows.push(line);
            if tail.is_empty() {
                return rows;
            }
            (rest, margin) = (tail, indent);
        }
    }

    /// Returns its width, columns.
    pub fn width(&self) -> usize {
        self.0.iter().map(|cell| width_of(cell.0)).sum()
    }

    /// Pads it with blanks to a width.
    pub fn padded(mut self, columns: usize) -> Line {
        let missing = columns.saturating_sub(self.width());
        self.0
            .extend(std::iter::repeat_n((' ', Style::Plain), missing));
        self
    }

    /// Appends another line.
    pub fn followed_by(mut self, other: &Line) -> Line {
        self.0.extend(&other.0);
        self
    }

    /// Returns it for the terminal, without trailing blanks.
    pub fn painted(&self, color: fab_compiler::diag::Color) -> String {
        let mut text = String::new();
        let mut now = Style::Plain;
        let last = self.0.iter().rposition(|cell| cell.0 != ' ');
        for (letter, style) in &self.0[..last.map_or(0, |last| last + 1)] {
            if color == fab_compiler::diag::Color::Ansi && *style != now {
                text.push_str("\x1b[0m");
                text.push_str(code(*style));
                now = *style;
            }
            if is_hidden(*letter) {
                text.extend(letter.escape_unicode());
            } else {
                text.push(*letter);
            }
        }
        if now != Style::Plain {
            text.push_str("\x1b[0m");
        }
        text
    }
}

/// Returns how many of these characters fit into a row.
fn end_of_row(cells: &[Cell], columns: usize) -> usize {
    let mut width = 0;
    let fits = cells
        .iter()
        .take_while(|cell| {
            width += width_of(cell.0);
            width <= columns
        })
        .count();
    if fits == cells.len() {
        return fits;
    }
    let first = leading(&cells[..fits]);
    let blank = cells[..fits].iter().rposition(|cell| cell.0 == ' ');
    match blank.filter(|blank| *blank > first) {
        Some(blank) => blank + 1,
        // A character wider than the column is shown anyway.
        None => fits.max(1),
    }
}

/// Returns the number of leading blanks.
fn leading(cells: &[Cell]) -> usize {
    cells.iter().take_while(|cell| cell.0 == ' ').count()
}

fn width_of(letter: char) -> usize {
    match letter {
        ' '..='~' => 1,
        letter => measure_text_width(letter.encode_utf8(&mut [0; 4])),
    }
}

fn code(style: Style) -> &'static str {
    match style {
        Style::Plain => "",
        Style::Head => "\x1b[1m",
        Style::Faint => "\x1b[2m",
        Style::Removed => "\x1b[31m",
        Style::RemovedWord => "\x1b[1;4;31m",
        Style::Added => "\x1b[32m",
        Style::AddedWord => "\x1b[1;4;32m",
    }
}
