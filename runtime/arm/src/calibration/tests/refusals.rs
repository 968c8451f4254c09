//! Tests that wrong calibrations are refused with value and bound, and careful ones accepted.

use super::*;

type Change = fn(&mut Terms, &mut Vec<Pair>);

/// Changes every place.
fn places(pairs: &mut [Pair], change: impl Fn([f64; 3]) -> [f64; 3]) {
    pairs
        .iter_mut()
        .for_each(|pair| pair.base_m = change(pair.base_m));
}

/// Changes every pixel.
fn pixels(pairs: &mut [Pair], change: impl Fn([f64; 2]) -> [f64; 2]) {
    pairs
        .iter_mut()
        .for_each(|pair| pair.pixel = change(pair.pixel));
}

/// Turns every place about the table's middle, and scales it from there.
fn turned(terms: &Terms, pairs: &mut [Pair], turn_deg: f64, scale: [f64; 2]) {
    let [middle_x, middle_y, _] = terms.center_m;
    let (sin, cos) = turn_deg.to_radians().sin_cos();
    places(pairs, |[x, y, z]| {
        let (x, y) = ((x - middle_x) * scale[0], (y - middle_y) * scale[1]);
        [
            middle_x + cos * x - sin * y,
            middle_y + sin * x + cos * y,
            z,
        ]
    });
}

/// Shears every place: x grows with y.
fn sheared(terms: &Terms, pairs: &mut [Pair], shear_deg: f64) {
    let middle_y = terms.center_m[1];
    places(pairs, |[x, y, z]| {
        [x + (y - middle_y) * shear_deg.to_radians().tan(), y, z]
    });
}

/// A picture of another size from the same camera.
fn resized(terms: &mut Terms, factor: f64) {
    let size_px = terms.size_px.map(|side| (f64::from(side) * factor) as u32);
    terms.size_px = size_px;
    if let Some(intrinsics) = &mut terms.intrinsics {
        intrinsics.size_px = size_px;
    }
}

/// Each changes terms or points that are right.
const WRONG: [(&str, Change); 46] = [
    ("the plane 0.1 m too high", |_, it| {
        places(it, |[x, y, z]| [x, y, z + 0.1])
    }),
    ("0.2 m too high", |_, it| {
        places(it, |[x, y, z]| [x, y, z + 0.2])
    }),
    ("0.1 m too low", |_, it| {
        places(it, |[x, y, z]| [x, y, z - 0.1])
    }),
    ("0.2 m too low", |_, it| {
        places(it, |[x, y, z]| [x, y, z - 0.2])
    }),
    ("8 mm too high", |_, it| {
        places(it, |[x, y, z]| [x, y, z + 0.008])
    }),
    ("0.1 m too far in x", |_, it| {
        places(it, |[x, y, z]| [x + 0.1, y, z])
    }),
    ("0.2 m too near in x", |_, it| {
        places(it, |[x, y, z]| [x - 0.2, y, z])
    }),
    ("0.1 m off in y", |_, it| {
        places(it, |[x, y, z]| [x, y - 0.1, z])
    }),
    ("0.14 m off along a diagonal", |_, it| {
        places(it, |[x, y, z]| [x + 0.1, y + 0.1, z])
    }),
    ("sheared by 45 degrees", |terms, it| {
        sheared(terms, it, 45.0)
    }),
    ("sheared by -45 degrees", |terms, it| {
        sheared(terms, it, -45.0)
    }),
    ("sheared by 10 degrees", |terms, it| {
        sheared(terms, it, 10.0)
    }),
    ("sheared by 4 degrees", |terms, it| sheared(terms, it, 4.0)),
    ("scaled by 1.3 about the middle", |terms, it| {
        turned(terms, it, 0.0, [1.3; 2])
    }),
    ("scaled by 1.3 about the base", |_, it| {
        places(it, |[x, y, z]| [x * 1.3, y * 1.3, z])
    }),
    ("scaled by 0.77 about the middle", |terms, it| {
        turned(terms, it, 0.0, [0.77; 2])
    }),
    ("scaled by 1.1 about the middle", |terms, it| {
        turned(terms, it, 0.0, [1.1; 2])
    }),
    ("x scaled by 1.3", |terms, it| {
        turned(terms, it, 0.0, [1.3, 1.0])
    }),
    ("y scaled by 1.3", |terms, it| {
        turned(terms, it, 0.0, [1.0, 1.3])
    }),
    ("x scaled by 1.06", |terms, it| {
        turned(terms, it, 0.0, [1.06, 1.0])
    }),
    ("scaled by 1.3 along a diagonal", |terms, it| {
        turned(terms, it, 45.0, [1.0; 2]);
        turned(terms, it, -45.0, [1.3, 1.0]);
    }),
    ("pixels of a picture half as large", |_, it| {
        pixels(it, |[u, v]| [u / 2.0, v / 2.0])
    }),
    ("pixels of a picture 0.8 times as large", |_, it| {
        pixels(it, |[u, v]| [u * 0.8, v * 0.8])
    }),
    ("pixels of a picture 0.9 times as large", |_, it| {
        pixels(it, |[u, v]| [u * 0.9, v * 0.9])
    }),
    ("pixels of a picture twice as large", |_, it| {
        pixels(it, |[u, v]| [u * 2.0, v * 2.0])
    }),
    ("a picture twice as large, stated so", |terms, it| {
        resized(terms, 2.0);
        pixels(it, |[u, v]| [u * 2.0, v * 2.0]);
    }),
    ("pixels of the window", |_, it| {
        pixels(it, |[u, v]| [u - 80.0, v])
    }),
    ("a wide picture squeezed", |_, it| {
        pixels(it, |[u, v]| [u * 0.75, v])
    }),
    ("mirrored in x", |_, it| {
        places(it, |[x, y, z]| [0.9 - x, y, z])
    }),
    ("mirrored in y", |_, it| places(it, |[x, y, z]| [x, -y, z])),
    ("x and y swapped", |_, it| places(it, |[x, y, z]| [y, x, z])),
    ("a mirrored picture", |_, it| {
        pixels(it, |[u, v]| [640.0 - u, v])
    }),
    ("turned by 90 degrees", |terms, it| {
        turned(terms, it, 90.0, [1.0; 2])
    }),
    ("turned by -90 degrees", |terms, it| {
        turned(terms, it, -90.0, [1.0; 2])
    }),
    ("turned by 7 degrees", |terms, it| {
        turned(terms, it, 7.0, [1.0; 2])
    }),
    ("turned by 180 degrees", |terms, it| {
        turned(terms, it, 180.0, [1.0; 2])
    }),
    ("turned by 90 degrees about the base", |_, it| {
        places(it, |[x, y, z]| [-y, x, z])
    }),
    ("another focal length stated", |terms, _| {
        terms.intrinsics.as_mut().unwrap().focal_px = [780.0, 782.6];
    }),
    ("a focal length stated for one direction", |terms, _| {
        terms.intrinsics.as_mut().unwrap().focal_px = [660.0, 602.0];
    }),
    ("a table tilted by 2 degrees", |terms, it| {
        let middle_x = terms.center_m[0];
        places(it, |[x, y, z]| [x, y, z + 0.035 * (x - middle_x)]);
    }),
    ("no height stated", |terms, _| terms.height_m = None),
    ("no direction stated", |terms, _| terms.up_deg = None),
    ("no intrinsics stated", |terms, _| terms.intrinsics = None),
    ("nothing stated of the camera", |terms, _| {
        (terms.intrinsics, terms.height_m, terms.up_deg) = (None, None, None);
    }),
    ("a point in millimetres", |_, it| {
        it[8].base_m = it[8].base_m.map(|m| m * 1000.0)
    }),
    ("seven points", |_, it| it.truncate(7)),
];

#[test]
fn wrong_calibrations_are_refused_with_value_and_bound() {
    let right = measured_grid(11, 4, 0.8);
    make(terms(), right.clone()).unwrap();
    let mut all = String::new();
    for (name, change) in WRONG {
        let (mut terms, mut pairs) = (terms(), right.clone());
        change(&mut terms, &mut pairs);
        let refusal = make(terms, pairs).expect_err(name);
        all += &format!("{name}:\n{refusal}\n\n");
    }
    insta::assert_snapshot!(all);
}

/// Errors of 1 mm and half a pixel, a direction 3 degrees off, a tape's centimetre, a focal length 1 % off, a window a few pixels off.
#[test]
fn careful_calibrations_are_accepted() {
    let mut most = [0.0_f64; 12];
    for seed in 0..100 {
        let (truth, mut noise) = (Truth::usual(), Noise::new(seed + 1));
        let pairs = truth.grid(4, 0.8);
        let pairs: Vec<Pair> = pairs
            .iter()
            .map(|pair| noise.measured(pair, 0.001, 0.5))
            .collect();
        let mut terms = terms();
        let mut within = |most: f64| (2.0 * noise.uniform() - 1.0) * most;
        terms.height_m = terms.height_m.map(|height_m| height_m + within(0.01));
        terms.up_deg = terms.up_deg.map(|up_deg| up_deg + within(3.0));
        let focal = 1.0 + within(0.01);
        let intrinsics = terms.intrinsics.as_mut().unwrap();
        intrinsics.focal_px = intrinsics.focal_px.map(|px| px * focal);
        terms.center_m[0] += within(0.02);
        terms.center_m[1] += within(0.02);
        terms.center_m[2] += within(0.001);
        let made = make(terms, pairs).unwrap_or_else(|refusal| panic!("{seed}: {refusal}"));
        for (most, check) in most.iter_mut().zip(&made.accuracy.checks) {
            *most = most.max(check.value / check.bound);
        }
    }
    assert!(most.iter().all(|share| *share < 0.9), "{most:?}");
    // Of their bounds: 0.6 of 2 degrees of shear, 1 of 3 % of stretch.
    assert!(most[4] < 0.3 && most[5] < 0.34, "{most:?}");
}

/// A grid with the errors of a careful person, and one change.
fn refused(change: impl Fn(&mut Vec<Pair>)) -> Refusal {
    let mut pairs = measured_grid(11, 4, 0.8);
    change(&mut pairs);
    make(terms(), pairs).unwrap_err()
}

fn outliers(refusal: &Refusal) -> Vec<usize> {
    let number = |fault: &Fault| match fault {
        Fault::Outlier { point, .. } => Some(*point),
        _ => None,
    };
    refusal.faults.iter().filter_map(number).collect()
}

type Slip = fn(&mut Vec<Pair>);

#[test]
fn points_that_contradict_the_others_are_named() {
    let cases: [(&str, Slip, &[usize]); 6] = [
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
        let refusal = refused(change);
        assert_eq!(outliers(&refusal), expected, "{name}: {refusal}");
        assert!(refusal.fit.is_some(), "{name}");
    }
    let refusal = refused(|it| it[3].base_m[1] = f64::NAN);
    assert_eq!(refusal.faults, [Fault::NotFinite { point: 4 }]);
    // Every other point is off: no few points are to blame.
    let refusal = refused(|it| {
        it.iter_mut()
            .step_by(2)
            .for_each(|it| it.base_m[0] += 0.012)
    });
    assert!(outliers(&refusal).is_empty(), "{refusal}");
}

#[test]
fn a_slip_below_the_limit_stands_out() {
    let mut pairs = measured_grid(11, 4, 0.8);
    pairs[6].base_m[0] += 0.008;
    let made = make(terms(), pairs).unwrap();
    assert_eq!(made.accuracy.outliers(made.terms.limit_mm), [7]);
}

#[test]
#[ignore = "long"]
fn slips_among_many_points_are_found_in_time() {
    let mut pairs = measured_grid(2, 12, 0.9);
    let slips = [5, 50, 140];
    for index in slips {
        pairs[index].base_m[1] += 0.2;
    }
    let refusal = make(terms(), pairs).unwrap_err();
    assert_eq!(outliers(&refusal), slips.map(|index| index + 1));
}

#[test]
fn points_on_a_line_are_refused_as_that() {
    let truth = Truth::usual();
    let on_a_line = |n: u32, aside: Option<[f64; 2]>| {
        let along = (0..n).map(|it| [100.0 + 40.0 * f64::from(it), 200.0]);
        let pairs = along.chain(aside).map(|pixel| truth.pair(pixel));
        make(terms(), pairs.collect()).unwrap_err().faults
    };
    assert_eq!(on_a_line(10, None), [Fault::Undetermined]);
    let refused = on_a_line(10, Some([300.0, 400.0]));
    assert!(
        matches!(refused[..], [Fault::Undetermined | Fault::HangsOn { .. }]),
        "{refused:?}"
    );
}
