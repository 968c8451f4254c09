//! The rows of extractors.

use fab_program::vocabulary::ArgValue;
use fab_program::{EXTRACTORS, Extractor, samples};

#[test]
fn every_extractor_is_made_from_the_arguments_that_its_row_declares() {
    for row in EXTRACTORS {
        for args in samples::of(&row.call.signature) {
            let extractor = (row.call.make)(&args);
            assert_eq!(extractor.shape(), row.gives, "{}", row.call.signature.name);
            // Each keypoint that the call names is in what it makes.
            let named = args
                .0
                .iter()
                .filter(|(_, it)| matches!(it, ArgValue::Name(_)));
            let json = serde_json::to_string(&extractor).expect("an extractor");
            assert_eq!(json.matches("\"name\"").count(), named.count(), "{json}");
        }
    }
}

#[test]
fn rows_tell_what_their_keypoint_is_taken_from() {
    let that = |holds: fn(&Extractor) -> bool| -> Vec<&str> {
        let made = EXTRACTORS.iter().map(|row| {
            let args = &samples::of(&row.call.signature)[0];
            (row.call.signature.name, (row.call.make)(args))
        });
        made.filter(|(_, it)| holds(it))
            .map(|(name, _)| name)
            .collect()
    };
    assert_eq!(
        that(Extractor::needs_depth),
        ["mask", "harris", "shi_tomasi"]
    );
    assert_eq!(
        that(|it| it.refines() == Some("name")),
        ["closed", "largest"]
    );
}

#[test]
fn rows_of_one_name_give_one_shape() {
    for row in EXTRACTORS {
        let name = row.call.signature.name;
        let mut alike = EXTRACTORS
            .iter()
            .filter(|other| other.call.signature.name == name);
        assert!(alike.all(|other| other.gives == row.gives), "{name}");
    }
}

#[test]
fn degrees_of_a_hue_stay_whole() {
    let args = |hue: [f64; 2]| {
        let mut args = samples::of(&EXTRACTORS[1].call.signature)[0].clone();
        args.0[0].1 = ArgValue::Between(hue.map(f64::to_radians));
        args
    };
    let hue_deg = |extractor| match extractor {
        Extractor::ColorMask { hue_deg, .. } => hue_deg,
        other => panic!("{other:?}"),
    };
    for deg in 0..360 {
        let hue = [f64::from(deg), 360.0 - f64::from(deg)];
        assert_eq!(hue_deg((EXTRACTORS[1].call.make)(&args(hue))), hue);
    }
}
