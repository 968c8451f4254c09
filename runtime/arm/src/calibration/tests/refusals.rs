//! Tests that wrong points are refused with their values, and mistyped ones named.

use super::*;

type Change = fn(&mut Vec<Pair>);

fn places(pairs: &mut [Pair], change: impl Fn([f64; 3]) -> [f64; 3]) {
    pairs
        .iter_mut()
        .for_each(|pair| pair.base_m = change(pair.base_m));
}

/// Refuses a careful grid with one change.
fn refused(name: &str, change: impl Fn(&mut Vec<Pair>)) -> String {
    let mut pairs = measured_grid(11, 4, 0.8);
    change(&mut pairs);
    judged(pairs).expect_err(name)
}

#[test]
fn wrong_points_are_refused_with_value_and_bound() {
    judged(measured_grid(11, 4, 0.8)).unwrap();
    let cases: [(&str, Change, &str); 20] = [
        (
            "too high",
            |it| places(it, |[x, y, z]| [x, y, z + 0.1]),
            "mm from the height in `table.center_m`; at most 10 mm",
        ),
        (
            "too low",
            |it| places(it, |[x, y, z]| [x, y, z - 0.02]),
            "mm from the height in `table.center_m`; at most 10 mm",
        ),
        (
            "too far",
            |it| places(it, |[x, y, z]| [x + 0.1, y, z]),
            "mm from `table.center_m`; at most 50 mm",
        ),
        (
            "tilted",
            |it| places(it, |[x, y, z]| [x, y, z + 0.04 * (x - 0.45)]),
            "mm from the height in `table.center_m`",
        ),
        (
            "mirrored in x",
            |it| places(it, |[x, y, z]| [0.9 - x, y, z]),
            "a mirror image of the table",
        ),
        (
            "mirrored in y",
            |it| places(it, |[x, y, z]| [x, -y, z]),
            "a mirror image of the table",
        ),
        (
            "x and y swapped",
            |it| places(it, |[x, y, z]| [y, x, z]),
            "a mirror image of the table",
        ),
        (
            "a mirrored picture",
            |it| {
                it.iter_mut()
                    .for_each(|it| it.pixel[0] = 640.0 - it.pixel[0])
            },
            "a mirror image of the table",
        ),
        (
            "both signs lost",
            |it| places(it, |[x, y, z]| [-x, -y, z]),
            "mm from `table.center_m`; at most 50 mm",
        ),
        (
            "turned about the base",
            |it| places(it, |[x, y, z]| [-y, x, z]),
            "mm from `table.center_m`; at most 50 mm",
        ),
        (
            "a picture half as large",
            |it| {
                it.iter_mut()
                    .for_each(|it| it.pixel = it.pixel.map(|at| at / 2.0))
            },
            "mm from `table.center_m`; at most 50 mm",
        ),
        (
            "scaled by 1.3",
            |it| places(it, |[x, y, z]| [1.3 * x, 1.3 * y, z]),
            "mm from `table.center_m`; at most 50 mm",
        ),
        (
            "millimetres",
            |it| places(it, |place| place.map(|m| 1000.0 * m)),
            "an arm reaches about a metre",
        ),
        (
            "seven points",
            |it| it.truncate(7),
            "7 distinct points are too few: at least 8",
        ),
        (
            "one place",
            |it| {
                let one = it[0];
                it.iter_mut().for_each(|it| *it = one);
            },
            "1 distinct points are too few",
        ),
        (
            "no number",
            |it| it[3].base_m[1] = f64::NAN,
            "point 4 is at the pixel",
        ),
        (
            "outside",
            |it| it[3].pixel[1] = 481.0,
            "point 4 is at the pixel",
        ),
        ("a line", |it| *it = line(None), "determine no fit"),
        (
            "a line and a point",
            |it| *it = line(Some([300.0, 400.0])),
            "determine",
        ),
        (
            "all careless",
            |it| {
                it.iter_mut()
                    .step_by(2)
                    .for_each(|it| it.base_m[0] += 0.016)
            },
            "(root mean square); at most 4 mm are accepted: without point",
        ),
    ];
    for (name, change, words) in cases {
        let refusal = refused(name, change);
        assert!(refusal.contains(words), "{name}: {refusal}");
    }
}

/// Ten points on a line, and one beside it.
fn line(aside: Option<[f64; 2]>) -> Vec<Pair> {
    let along = (0..10).map(|it| [100.0 + 40.0 * f64::from(it), 200.0]);
    along
        .chain(aside)
        .map(|pixel| Truth::usual().pair(pixel))
        .collect()
}

#[test]
fn a_point_that_contradicts_the_others_is_named() {
    let cases: [(&str, Change, usize); 5] = [
        ("a place", |it| it[6].base_m[0] += 0.023, 7),
        ("a height", |it| it[9].base_m[2] += 0.05, 10),
        ("a corner", |it| it[0].base_m[1] += 0.03, 1),
        ("a lost sign", |it| it[3].base_m[1] *= -1.0, 4),
        ("a swapped pixel", |it| it[1].pixel.reverse(), 2),
    ];
    for (name, change, point) in cases {
        let refusal = refused(name, change);
        let words = format!("without point {point} the others agree to 0.");
        assert!(refusal.contains(&words), "{name}: {refusal}");
    }
}

#[test]
fn a_mistyped_point_is_named_among_any_number() {
    for (n, seed) in [(3, 1), (4, 2), (5, 3)] {
        let grid = measured_grid(seed, n, 0.9);
        for point in 0..grid.len() {
            let mut pairs = grid.clone();
            pairs[point].base_m[point % 2] += 0.1;
            let refusal = make(pairs).unwrap_err();
            let expected = format!("without point {} the", point + 1);
            assert!(refusal.contains(&expected), "{n}: {expected}: {refusal}");
        }
    }
}

/// Slips of the keyboard: a decimal point, a digit, a sign.
#[test]
fn a_slip_of_the_keyboard_is_named() {
    let slips: [fn(&mut Pair); 6] = [
        |it| it.base_m[0] *= 0.1,
        |it| it.base_m[1] = -it.base_m[1] + 0.05,
        |it| it.base_m[0] += 1.0,
        |it| it.pixel[0] = (it.pixel[0] / 10.0).floor(),
        |it| it.pixel[1] = 479.0 - it.pixel[1] / 3.0,
        |it| it.base_m[2] += 0.1,
    ];
    for point in 0..16 {
        for (number, slip) in slips.iter().enumerate() {
            let refusal = refused("a slip", |it| slip(&mut it[point]));
            // A place beyond the arm's reach, or a pixel beyond the picture, is named as such.
            let expected = [
                format!("without point {} the", point + 1),
                format!("point {} is at", point + 1),
            ];
            assert!(
                expected.iter().any(|it| refusal.contains(it)),
                "{number}: {expected:?}: {refusal}"
            );
        }
    }
}

#[test]
fn points_close_together_are_refused_however_well_they_fit() {
    let rows = |apart_px: f64| {
        let at = |n: u32| {
            [
                120.0 + 400.0 * f64::from(n % 8) / 7.0,
                240.0 + apart_px * (f64::from(n / 8) - 0.5),
            ]
        };
        let mut noise = Noise::new(3);
        let pairs = (0..16).map(|n| noise.measured(&Truth::usual().pair(at(n)), 0.0005, 0.3));
        judged(pairs.collect())
    };
    rows(360.0).unwrap();
    let refusal = rows(36.0).unwrap_err();
    assert!(
        refusal.contains("the points know the table to"),
        "{refusal}"
    );
}

#[test]
fn only_what_the_arm_reaches_has_to_be_covered() {
    let at = |n: u32| {
        pixel_at(
            WINDOW,
            [
                0.08 + 0.17 * f64::from(n % 3),
                0.1 + 0.26 * f64::from(n / 3),
            ],
        )
    };
    let mut noise = Noise::new(3);
    let pairs = (0..12).map(|n| noise.measured(&Truth::usual().pair(at(n)), 0.0005, 0.3));
    let made = make(pairs.collect()).unwrap();
    let mut settings = settings();
    let refusal = made.over_table(&settings).unwrap_err();
    assert!(refusal.contains("at the corner"), "{refusal}");
    // The left of the picture is where y is large.
    settings.workspace.min_m[1] = 0.0;
    made.over_table(&settings).unwrap();
}

#[test]
fn a_limit_is_kept_and_may_be_raised() {
    let mut noise = Noise::new(5);
    let grid = Truth::usual().grid(4, 0.8);
    let pairs: Vec<Pair> = grid
        .iter()
        .map(|it| noise.measured(it, 0.004, 0.5))
        .collect();
    let refusal = make(pairs.clone()).unwrap_err();
    assert!(refusal.contains("at most 4 mm are accepted"), "{refusal}");
    let limited = |limit_mm| {
        let terms = Terms {
            limit_mm,
            ..terms()
        };
        Calibration::make(terms, pairs.clone(), "2026-11-22", None)
    };
    let left_out_mm = limited(12.0).unwrap().left_out_rms_mm();
    assert!((4.0..12.0).contains(&left_out_mm), "{left_out_mm}");
    for limit_mm in [0.0, -1.0, f64::NAN, 21.0] {
        let refusal = limited(limit_mm).unwrap_err();
        assert!(
            refusal.contains("larger than 0 and at most 20"),
            "{refusal}"
        );
    }
}
