//! Tests of what the fingers hold.

use super::*;

const SETTINGS: FingerSettings = FingerSettings {
    count: 2,
    open: 0.0,
    closed: 6400.0,
    cloth: Some(200.0),
    tolerance: 100.0,
};

#[test]
fn finger_positions_decide_what_the_hand_holds() {
    let without = FingerSettings {
        cloth: None,
        ..SETTINGS
    };
    let aborted = Outcome::Ended(Ending::Aborted);
    let done = Outcome::Ended(Ending::Succeeded);
    for (settings, outcome, found, expected) in [
        (
            SETTINGS,
            done,
            [6390.0, 6350.0],
            Some(HandContents::Nothing),
        ),
        (
            SETTINGS,
            done,
            [6100.0, 6150.0],
            Some(HandContents::Something),
        ),
        (
            SETTINGS,
            aborted,
            [5000.0, 5200.0],
            Some(HandContents::Something),
        ),
        (
            SETTINGS,
            Outcome::TimedOut,
            [5000.0, 5200.0],
            Some(HandContents::Something),
        ),
        // One finger stuck open means that nothing is held, whatever the other does.
        (SETTINGS, done, [0.0, 6400.0], None),
        (SETTINGS, done, [6100.0, 40.0], None),
        (SETTINGS, aborted, [0.0, 0.0], None),
        (SETTINGS, done, [6250.0, 6250.0], None),
        (without, done, [6390.0, 6350.0], Some(HandContents::Unknown)),
        (
            without,
            aborted,
            [5000.0, 5200.0],
            Some(HandContents::Unknown),
        ),
        (without, Outcome::TimedOut, [5000.0, 5200.0], None),
    ] {
        let judged = classify(&settings, Opening::Closed, outcome, &found);
        assert_eq!(judged.ok(), expected, "{outcome:?} at {found:?}");
    }
}
