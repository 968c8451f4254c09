//! Tests of the estimate of an untouched cloth's score.

use super::*;

#[test]
fn a_sheet_folded_in_half_is_a_quarter_of_its_side_away_on_average() {
    let cloth = Cloth {
        dimx: 55,
        dimy: 45,
        spacing_m: 0.00625,
        start: ClothStart::Flat,
        material: None,
    };
    let corner = |right| ClothPoint::Particle { right, front: 0.0 };
    let fold = Fold {
        pick: corner(0.0),
        place: corner(1.0),
        fraction: 1.0,
    };
    // Half of the sheet moves by 0 to its whole side, so by half of it on average.
    let side_m = 54.0 * 0.00625;
    assert!((distance_m(&cloth, &[fold]) - side_m / 4.0).abs() < side_m / 50.0);
}
