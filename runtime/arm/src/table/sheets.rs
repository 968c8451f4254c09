//! Printed sheets around the cloth on a simulated table, which make a moved camera detectable.
//!
//! In: a point on the table. Out: what is printed there. The sheets are grey, so that a colour mask ignores them, and
//! lie outside the area of a cloth in the middle of the table.

/// Centres of the sheets, metres, world frame.
const MIDDLES_M: [[f64; 2]; 12] = [
    [-0.36, -0.36],
    [-0.12, -0.37],
    [0.12, -0.37],
    [0.36, -0.36],
    [-0.37, -0.12],
    [0.37, -0.12],
    [-0.37, 0.12],
    [0.37, 0.12],
    [-0.36, 0.36],
    [-0.12, 0.37],
    [0.12, 0.37],
    [0.36, 0.36],
];

/// Squares along a side of a sheet, and the side of one, metres.
const SQUARES: i64 = 4;
const SQUARE_M: f64 = 0.012;

/// Returns the grey printed at a place of the table; `None` outside the sheets.
///
/// - `place_m`: metres, world frame.
pub(super) fn printed([x_m, y_m]: [f64; 2]) -> Option<u8> {
    let half_m = SQUARES as f64 * SQUARE_M / 2.0;
    MIDDLES_M.iter().zip(0i64..).find_map(|([mx, my], sheet)| {
        let square = [x_m - mx, y_m - my].map(|off_m| ((off_m + half_m) / SQUARE_M).floor() as i64);
        let is_on = square.iter().all(|it| (0..SQUARES).contains(it));
        is_on.then(|| grey(sheet, square))
    })
}

/// Derives a grey from a square's position.
fn grey(sheet: i64, [column, row]: [i64; 2]) -> u8 {
    let place = ((sheet * SQUARES + row) * SQUARES + column) as u64;
    // Fibonacci hashing: the upper bits of a product with 2^64 over the golden ratio.
    (place.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 56) as u8
}

#[cfg(test)]
mod tests;
