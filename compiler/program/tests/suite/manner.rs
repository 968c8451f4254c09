//! How a motion is made: a row for each value.

use fab_program::{MANNERS, Manner};

#[test]
fn every_row_states_a_value_of_its_own() {
    let mut manner = Manner::default();
    assert!(manner.is_default() && manner.stated().next().is_none());
    for (index, arg) in MANNERS.iter().enumerate() {
        manner = manner.with(arg.name, index as f64);
    }
    let stated: Vec<f64> = manner.stated().map(|(_, value)| value).collect();
    assert_eq!(stated, [0.0, 1.0, 2.0, 3.0]);
    let json = serde_json::to_string(&manner).expect("numbers");
    assert_eq!(
        json,
        r#"{"lift_m":0.0,"speed_m_s":1.0,"release_height_m":2.0,"press_m":3.0}"#
    );
    assert_eq!(
        serde_json::to_string(&Manner::default()).expect("nothing"),
        "{}"
    );
}
