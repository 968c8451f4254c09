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
/// - `columns`: from the left; those that are not named have words.
///
/// Widths count characters. A column without any text is left out, and an empty row gives an empty line.
pub fn aligned(columns: &[Align], rows: &[impl AsRef<[String]>]) -> Vec<String> {
    let mut widths: Vec<usize> = Vec::new();
    for row in rows {
        for (column, cell) in row.as_ref().iter().enumerate() {
            widths.resize(widths.len().max(column + 1), 0);
            widths[column] = widths[column].max(cell.chars().count());
        }
    }
    let line = |row: &[String]| {
        let cells = row.iter().zip(&widths).enumerate();
        let cells = cells.filter(|(_, (_, width))| **width > 0);
        let cells = cells.map(|(column, (cell, width))| match columns.get(column) {
            Some(Align::Right) => format!("{cell:>width$}"),
            _ => format!("{cell:<width$}"),
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(|row| line(row.as_ref())).collect()
}

#[cfg(test)]
#[path = "tests/table.rs"]
mod tests;
