//! Tests of `hold_key`.

use super::*;

/// The states of the key after bytes that came at these times, milliseconds after a stall.
fn states(typed: &[(u64, &str)]) -> Vec<KeyState> {
    let stall = Instant::now();
    let mut key = HoldKey::after_stall(stall);
    let update = |(after_ms, bytes): &(u64, &str)| {
        key.update(bytes.as_bytes(), stall + Duration::from_millis(*after_ms))
    };
    typed.iter().map(update).collect()
}

#[test]
fn only_a_fresh_press_holds_the_key() {
    use KeyState::{Held, Released, Up};
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
            &[Up, Up, Up, Held, Held, Released][..],
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
            &[Up, Up, Held, Held, Held, Held, Released],
        ),
        (
            "a key that is held all through a stall",
            &[(10, " "), (60, " "), (600, " "), (1100, " "), (1600, " ")],
            &[Up, Up, Up, Up, Up],
        ),
        (
            "repeats that waited, all at once",
            &[(600, ""), (700, "    "), (850, ""), (1000, "")],
            &[Up, Up, Up, Up],
        ),
        (
            "repeats that waited, one after the other",
            &[(600, ""), (700, " "), (705, " "), (710, " "), (900, "")],
            &[Up, Up, Up, Up, Up],
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
            &[Up, Up, Held, Released, Up, Up, Up],
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
            &[Up, Up, Held, Released, Up, Up, Held],
        ),
        (
            "other keys",
            &[(600, ""), (700, "yx\n"), (900, "")],
            &[Up, Up, Up],
        ),
    ] {
        assert_eq!(states(typed), expected, "{told}");
    }
}
