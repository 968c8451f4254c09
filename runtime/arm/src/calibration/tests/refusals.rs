//! Tests that wrong points are refused with their values, and mistyped ones named.

use super::*;

type Change = fn(&mut Vec<Pair>);

fn places(pairs: &mut [Pair], change: impl Fn([f64; 3]) -> [f64; 3]) {
    pairs
        .iter_mut()
        .for_each(|pair| pair.base_m = change(pair.base_m));
}

/// Refuses a careful grid with one change.
fn refused(name: &str, change: impl Fn(&mut Vec<Pair>)) -> Refusal {
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
            "point 16 is at",
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
            "point 4 has a number that is not finite",
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
            "(root mean square); at most 4 mm are accepted: point",
        ),
    ];
    for (name, change, words) in cases {
        let refusal = refused(name, change).to_string();
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
fn points_that_contradict_the_others_are_named() {
    let cases: [(&str, Change, &[usize]); 6] = [
        ("a place", |it| it[6].base_m[0] += 0.023, &[7]),
        ("a height", |it| it[9].base_m[2] += 0.05, &[10]),
        ("a corner", |it| it[0].base_m[1] += 0.03, &[1]),
        ("a lost sign", |it| it[3].base_m[1] *= -1.0, &[4]),
        ("a swapped pixel", |it| it[1].pixel.reverse(), &[2]),
        (
            "two points",
            |it| {
                it[2].base_m[1] += 0.03;
                it[13].pixel[0] += 20.0;
            },
            &[3, 14],
        ),
    ];
    for (name, change, expected) in cases {
        let refusal = refused(name, change);
        let lines: Vec<&str> = refusal.why.lines().collect();
        assert_eq!(lines.len(), expected.len(), "{name}: {refusal}");
        for (line, point) in lines.iter().zip(expected) {
            assert!(
                line.starts_with(&format!("point {point} is ")),
                "{name}: {line}"
            );
        }
        assert!(refusal.fit.is_some(), "{name}");
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
            let expected = format!("point {} is ", point + 1);
            let is_named = refusal.why.starts_with(&expected) && refusal.why.lines().count() == 1;
            // Eight points without the wrong one are the fewest that can name it.
            assert!(is_named || n == 3, "{n}: {expected}: {refusal}");
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
            let expected = format!("point {} is ", point + 1);
            assert!(
                refusal.why.starts_with(&expected),
                "{number}: {expected}: {refusal}"
            );
            assert_eq!(refusal.why.lines().count(), 1, "{refusal}");
        }
    }
}

#[test]
fn a_point_below_the_limit_stands_out() {
    let mut pairs = measured_grid(11, 4, 0.8);
    pairs[6].base_m[0] += 0.008;
    let (worst, worst_mm) = make(pairs).unwrap().accuracy.worst();
    assert_eq!(worst, 7);
    assert!((6.0..12.0).contains(&worst_mm), "{worst_mm}");
}

#[test]
fn points_close_together_are_refused_however_well_they_fit() {
    let rows = |apart_px: f64| {
        let truth = Truth::usual();
        let at = |n: u32| {
            [
                120.0 + 400.0 * f64::from(n % 8) / 7.0,
                240.0 + apart_px * (f64::from(n / 8) - 0.5),
            ]
        };
        judged((0..16).map(|n| truth.pair(at(n))).collect())
    };
    rows(180.0).unwrap();
    let refusal = rows(15.0).unwrap_err().to_string();
    assert!(
        refusal.contains(
            "% of the table that the window shows and the arm reaches; at least 40 % are needed"
        ),
        "{refusal}"
    );
    // Two rows 6 cm apart cover too little, and errors of 1 mm show at the corners as well.
    let mut noise = Noise::new(3);
    let rows = (0..16).map(|n| {
        [
            120.0 + 400.0 * f64::from(n % 8) / 7.0,
            222.0 + 36.0 * f64::from(n / 8),
        ]
    });
    let pairs = rows.map(|pixel| noise.measured(&Truth::usual().pair(pixel), 0.001, 0.5));
    let refusal = judged(pairs.collect()).unwrap_err().to_string();
    assert!(
        refusal.contains("the points know the table to"),
        "{refusal}"
    );
}

#[test]
fn only_what_the_arm_reaches_has_to_be_covered() {
    let at = |n: u32| {
        window().pixel_at([
            0.08 + 0.16 * f64::from(n % 3),
            0.1 + 0.26 * f64::from(n / 3),
        ])
    };
    let pairs: Vec<Pair> = (0..12).map(|n| Truth::usual().pair(at(n))).collect();
    let made = make(pairs).unwrap();
    let mut settings = settings();
    let refusal = made.over_table(&settings).unwrap_err().to_string();
    assert!(refusal.contains("the points cover"), "{refusal}");
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
    assert!(
        refusal.why.contains("at most 4 mm are accepted"),
        "{refusal}"
    );
    assert!(refusal.fit.is_some());
    let limited = |limit_mm| {
        let terms = Terms {
            limit_mm,
            ..terms()
        };
        Calibration::make(terms, pairs.clone(), "2026-11-22", None)
    };
    let accuracy = limited(12.0).unwrap().accuracy;
    assert!((4.0..8.0).contains(&accuracy.rms_mm), "{accuracy:?}");
    for limit_mm in [0.0, -1.0, f64::NAN, 21.0] {
        let refusal = limited(limit_mm).unwrap_err();
        assert!(
            refusal.why.contains("larger than 0 and at most 20"),
            "{refusal}"
        );
    }
}
