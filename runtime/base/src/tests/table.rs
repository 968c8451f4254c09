//! Unit tests of `table`.

use super::{Align, aligned};

#[test]
fn words_begin_and_numbers_end_together() {
    let rows = [["task", "mm"], ["é", "12.5"], ["", ""]].map(|row| row.map(str::to_owned));
    let lines = aligned(&[Align::Left, Align::Right], &rows);
    assert_eq!(lines, ["task    mm", "é     12.5", ""]);
}
