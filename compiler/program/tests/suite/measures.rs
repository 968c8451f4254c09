//! The rows of measures.

use fab_program::measures::{MEASURES, Measure};
use fab_program::{Depends, Length, Point, PointMeasure, samples};

#[test]
fn every_measure_is_made_from_the_arguments_that_its_row_declares() {
    for row in MEASURES {
        for args in samples::of(&row.signature) {
            let measure = row.measure(&args, 100.0);
            if let Measure::Length(length) = measure {
                let json = serde_json::to_string(&length).expect("a length");
                let read: Length = serde_json::from_str(&json).expect("the same length");
                assert_eq!(read, length, "{json}");
            }
        }
    }
}

#[test]
fn a_length_is_its_name_and_its_points_in_json() {
    let point = |name: &str| Point::Keypoint {
        name: name.to_owned(),
    };
    let measure = PointMeasure::new("distance", vec![point("c"), point("d")]);
    let length = Length::OfPoints(measure.expect("a measure of two points"));
    let json = serde_json::to_string(&length).expect("a length");
    let expected = r#"{"length":"distance","a":{"point":"keypoint","name":"c"},"b":{"point":"keypoint","name":"d"}}"#;
    assert_eq!(json, expected);
    assert_eq!(length.uses().keypoints.len(), 2);
    for wrong in [r#"{"length":"count"}"#, &expected.replace("\"b\"", "\"z\"")] {
        assert!(serde_json::from_str::<Length>(wrong).is_err(), "{wrong}");
    }
}
