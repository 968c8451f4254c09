//! Unit tests of `corner_fold`.

use super::*;

#[test]
fn a_corner_of_the_default_cloth_stays_from_about_80_mm_on() {
    let interrupt = Interrupt::default();
    let mut corner = CornerFold::new(Params::default(), 0.00625).expect("a cloth");
    let stays_mm = corner.stays_mm(&interrupt).expect("a simulated cloth");
    assert!(stays_mm.is_some_and(|mm| mm < 10.0), "{stays_mm:?}");
    let smallest = corner.smallest(&interrupt).expect("a simulated cloth");
    // Carried 70 mm it goes back, and 80 mm it stays: measured without this search.
    assert!(
        matches!(smallest, SmallestFold::From { mm: 71..=82 }),
        "{smallest:?}"
    );
}
