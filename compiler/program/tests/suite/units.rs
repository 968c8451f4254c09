//! Units: their words, their sizes, and their form in JSON.

use fab_program::units::{DEG, LengthUnit, RAD, UNITS, Unit};

#[test]
fn no_word_means_two_units() {
    let mut words: Vec<&str> = UNITS.iter().flat_map(Unit::words).collect();
    let n_words = words.len();
    words.sort_unstable();
    words.dedup();
    assert_eq!(words.len(), n_words);
}

#[test]
fn degrees_and_radians_convert_as_the_standard_library_does() {
    assert_eq!([DEG.in_deg(), RAD.in_deg()], [1.0, 1_f64.to_degrees()]);
}

#[test]
fn a_unit_of_length_is_its_name_in_json() {
    for unit in UNITS.iter().filter_map(LengthUnit::of) {
        let json = serde_json::to_string(&unit).expect("a name");
        assert_eq!(json, format!("\"{}\"", unit.name));
        let read: LengthUnit = serde_json::from_str(&json).expect("a unit of length");
        assert_eq!(read, unit);
    }
    let error = serde_json::from_str::<LengthUnit>("\"deg\"").expect_err("an angle");
    let message = error.to_string();
    assert!(
        message.starts_with("no unit of length or speed `deg`"),
        "{message}"
    );
}
