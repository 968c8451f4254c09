//! Angles and numbers are the same on every machine.

use fab_program::exact::{cos_deg, normalised_deg, vector_of, written};

#[test]
fn eighths_of_a_turn_are_symmetric_and_right_angles_exact() {
    assert_eq!(vector_of(0.0), [1.0, 0.0]);
    assert_eq!(vector_of(90.0), [0.0, -1.0]);
    assert_eq!(vector_of(180.0), [-1.0, 0.0]);
    assert_eq!(vector_of(270.0), [0.0, 1.0]);
    let [right, down] = vector_of(45.0);
    assert_eq!(right, -down);
    assert_eq!(vector_of(225.0), [-right, right]);
    assert!((right * right + down * down - 1.0).abs() < 1e-15);
    assert_eq!(cos_deg(60.0), 0.5);
    assert_eq!(cos_deg(120.0), -0.5);
    // The cosine of nearly a right angle is a small sine, exact in all its digits.
    let rest = 90.0 - 89.999_999;
    assert!((cos_deg(89.999_999) / f64::to_radians(rest) - 1.0).abs() < 1e-15);
}

#[test]
fn angles_are_brought_into_one_turn() {
    assert_eq!(normalised_deg(-90.0), 270.0);
    assert_eq!(normalised_deg(720.0), 0.0);
    assert_eq!(normalised_deg(-1e-20), 0.0);
    assert!(normalised_deg(-0.0).is_sign_positive());
}

#[test]
fn numbers_are_written_without_needless_zeros() {
    assert_eq!(written(50.0, 1), "50");
    assert_eq!(written(0.25, 4), "0.25");
    assert_eq!(written(-0.001, 2), "0");
    assert_eq!(written(100.0, 0), "100");
}
