//! Tests of `sheets.rs`.

use super::*;

#[test]
fn sheets_lie_around_the_cloth_and_are_no_two_alike() {
    let half_diagonal_m = 0.306_25 / 2.0 * 2.0_f64.sqrt();
    for step in 0..1000 {
        let angle = f64::from(step) * 0.006_3;
        let rim = [half_diagonal_m * angle.cos(), half_diagonal_m * angle.sin()];
        assert_eq!(printed(rim), None);
    }
    let of = |[x, y]: [f64; 2]| {
        let at = |step: i64| (step as f64 - 1.5) * SQUARE_M;
        let squares = (0..16).map(|index| printed([x + at(index % 4), y + at(index / 4)]));
        squares.collect::<Option<Vec<u8>>>()
    };
    let sheets: Vec<_> = MIDDLES_M.into_iter().map(of).collect();
    for (index, sheet) in sheets.iter().enumerate() {
        assert!(sheet.is_some(), "sheet {index} has a hole");
        assert!(
            !sheets[..index].contains(sheet),
            "sheet {index} is there twice"
        );
    }
}
