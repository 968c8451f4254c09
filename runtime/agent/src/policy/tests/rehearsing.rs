//! Unit tests of `policy::rehearsing`.

use super::*;

#[test]
fn revisions_together_lose_no_more_than_a_hundredth_of_the_best() {
    let admitted = |measures: [f64; 3]| {
        let mut highest = Some(0.9);
        measures.map(|measure| admits(&mut highest, Some(measure)))
    };
    assert_eq!(admitted([0.894, 0.888, 0.895]), [true, false, true]);
    assert_eq!(admitted([0.95, 0.93, 0.945]), [true, false, true]);
    assert!(admits(&mut None, None));
}
