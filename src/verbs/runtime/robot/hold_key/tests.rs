//! Tests of `hold_key`.

use super::*;

/// Whether the key is held after bytes that came at these times, milliseconds after it was first watched. In between, the
/// program looks every 50 ms.
fn held(typed: &[(u64, &str)]) -> Vec<bool> {
    let begun = Instant::now();
    let (mut key, mut looked) = (HoldKey::up(begun), 0);
    let mut look =
        |at_ms: u64, bytes: &str| key.look(bytes.as_bytes(), begun + Duration::from_millis(at_ms));
    let states = typed.iter().map(|(at_ms, bytes)| {
        while looked + 50 < *at_ms {
            looked += 50;
            look(looked, "");
        }
        looked = *at_ms;
        look(*at_ms, bytes)
    });
    states.collect()
}

#[test]
fn only_a_fresh_press_holds_the_key() {
    for (told, typed, expected) in [
        (
            "a press after a silence",
            &[
                (600, ""),
                (700, "x "),
                (750, ""),
                (800, ""),
                (1449, ""),
                (1450, ""),
            ][..],
            &[false, false, false, true, true, false][..],
        ),
        (
            "repeats of a press",
            &[
                (600, ""),
                (700, " "),
                (900, ""),
                (1360, " "),
                (1400, "  "),
                (1999, ""),
                (2000, ""),
            ],
            &[false, false, true, true, true, true, false],
        ),
        (
            "a key that is held all through a stall",
            &[(10, " "), (60, " "), (600, " "), (1100, " "), (1600, " ")],
            &[false, false, false, false, false],
        ),
        (
            "repeats that waited, all at once",
            &[(600, ""), (700, "    "), (850, ""), (1000, "")],
            &[false, false, false, false],
        ),
        (
            "repeats that waited, one after the other",
            &[(600, ""), (700, " "), (705, " "), (710, " "), (900, "")],
            &[false, false, false, false, false],
        ),
        (
            "repeats that come after the key was taken for released",
            &[
                (600, ""),
                (700, " "),
                (800, ""),
                (1500, ""),
                (1550, " "),
                (1600, " "),
                (1700, ""),
            ],
            &[false, false, true, false, false, false, false],
        ),
        (
            "a second press",
            &[
                (600, ""),
                (700, " "),
                (800, ""),
                (1500, ""),
                (2100, ""),
                (2200, " "),
                (2300, ""),
            ],
            &[false, false, true, false, false, false, true],
        ),
        (
            "other keys",
            &[(600, ""), (700, "yx\n"), (900, "")],
            &[false, false, false],
        ),
    ] {
        assert_eq!(held(typed), expected, "{told}");
    }
}

#[test]
fn bytes_of_a_stall_do_not_hold_the_key() {
    let (before, after) = ([(700, " "), (850, "")], [(2000, "  "), (2050, " ")]);
    let mut key = HoldKey::up(Instant::now());
    let begun = key.looked;
    let mut look = |at_ms: u64, bytes: &str| {
        let held = key.look(bytes.as_bytes(), begun + Duration::from_millis(at_ms));
        (held, std::mem::take(&mut key.asks))
    };
    assert_eq!(look(0, ""), (false, true), "it is asked for at first");
    for at_ms in (50..=650).step_by(50) {
        assert_eq!(look(at_ms, ""), (false, false));
    }
    assert_eq!(
        before.map(|(at_ms, bytes)| look(at_ms, bytes)),
        [(false, false), (true, false)]
    );
    assert_eq!(
        after.map(|(at_ms, bytes)| look(at_ms, bytes)),
        [(false, true), (false, false)]
    );
}
