//! Unit tests of `calls::usage`.

use super::*;

#[test]
fn sums_are_exact_and_never_wrap() {
    let tenth = Usd::from_dollars(0.1).expect("an amount");
    assert_eq!(
        (0..10).map(|_| tenth).sum::<Usd>(),
        Usd::from_nano(1_000_000_000)
    );
    let most = Usd::from_nano(u64::MAX);
    assert_eq!(most + tenth, most);
}

#[test]
fn what_is_no_amount_is_refused() {
    for dollars in [-0.01, f64::NAN, f64::INFINITY, 1e30] {
        assert_eq!(Usd::from_dollars(dollars), None, "{dollars}");
    }
    assert_eq!(Usd::from_dollars(1e-10), Some(Usd::from_nano(1)));
    assert_eq!(Usd::from_dollars(0.0), Some(Usd::ZERO));
}
