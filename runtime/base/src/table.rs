//! Tables of text: rows of cells become lines with aligned columns.

/// The side of a column to which its cells are moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// For words.
    Left,
    /// For numbers.
    Right,
}

/// Aligns rows in columns, two spaces apart; returns a line for each row, without blanks at its end.
///
/// Widths count characters. An empty row gives an empty line.
pub fn aligned<const N: usize>(columns: [Align; N], rows: &[[String; N]]) -> Vec<String> {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: [usize; N] = std::array::from_fn(|column| width(column).unwrap_or(0));
    let line = |row: &[String; N]| {
        let cells = row.iter().zip(widths).zip(columns);
        let cells = cells.map(|((cell, width), align)| match align {
            Align::Left => format!("{cell:<width$}"),
            Align::Right => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::{Align, aligned};

    #[test]
    fn words_begin_and_numbers_end_together() {
        let rows = [["task", "mm"], ["é", "12.5"], ["", ""]].map(|row| row.map(str::to_owned));
        let lines = aligned([Align::Left, Align::Right], &rows);
        assert_eq!(lines, ["task    mm", "é     12.5", ""]);
    }
}
