//! Tests that each common input mistake is named.

use super::*;

/// A grid with the errors of a careful person, and one change.
fn refused(method: Method, change: impl Fn(&mut Vec<Pair>)) -> String {
    let mut pairs = measured_grid(11, 4, 0.8, 0.001);
    let fine = Calibration::make(terms(method), pairs.clone(), "2026-11-22", None);
    assert!(fine.is_ok(), "{fine:?}");
    change(&mut pairs);
    let refusal = Calibration::make(terms(method), pairs, "2026-11-22", None).unwrap_err();
    refusal.to_string()
}

type Change = fn(&mut Vec<Pair>);

#[test]
#[ignore = "long"]
fn each_slip_is_named() {
    let cases: [(&str, Change, &str); 17] = [
        ("a point", |it| it[6].base_m[0] += 0.023, "point 7 is 2"),
        ("only x", |it| it[6].base_m[0] += 0.023, "only its x is off"),
        ("a height", |it| it[9].base_m[2] += 0.05, "point 10 is 5"),
        (
            "two points",
            |it| {
                it[2].base_m[1] += 0.03;
                it[13].pixel[0] += 20.0;
            },
            "point 14 is",
        ),
        (
            "one swapped pixel",
            |it| it[1].pixel.reverse(),
            "with its column and row swapped it would fit",
        ),
        (
            "one swapped place",
            |it| it[2].base_m.swap(0, 1),
            "with its x and y swapped it would fit",
        ),
        (
            "a lost sign",
            |it| it[3].base_m[1] *= -1.0,
            "with the other sign of its y it would fit",
        ),
        (
            "all swapped pixels",
            |it| it.iter_mut().for_each(|it| it.pixel.reverse()),
            "outside of the picture of 640 x 480 px: are its column and row swapped?",
        ),
        (
            "all swapped places",
            |it| it.iter_mut().for_each(|it| it.base_m.swap(0, 1)),
            "mirror image of the table, which no camera above it sees: with x and y swapped",
        ),
        (
            "all signs",
            |it| it.iter_mut().for_each(|it| it.base_m[0] *= -1.0),
            "with the other sign of x",
        ),
        (
            "both signs",
            |it| {
                it.iter_mut().for_each(|it| {
                    it.base_m[0] *= -1.0;
                    it.base_m[1] *= -1.0;
                })
            },
            "they do not overlap; is a sign missing",
        ),
        (
            "millimetres",
            |it| {
                it.iter_mut()
                    .for_each(|it| it.base_m = it.base_m.map(|m| m * 1000.0))
            },
            "in millimetres it would: write metres (16 of 16 points are so)",
        ),
        (
            "centimetres",
            |it| {
                it.iter_mut()
                    .for_each(|it| it.base_m = it.base_m.map(|m| m * 100.0))
            },
            "in centimetres it would",
        ),
        (
            "one in millimetres",
            |it| it[4].base_m = it[4].base_m.map(|m| m * 1000.0),
            "point 5 is at",
        ),
        ("few", |it| it.truncate(7), "7 distinct points are too few"),
        (
            "the same",
            |it| {
                let one = it[0];
                it.iter_mut().skip(3).for_each(|it| *it = one)
            },
            "3 distinct points",
        ),
        (
            "no number",
            |it| it[3].base_m[1] = f64::NAN,
            "point 4 has a number that is not finite",
        ),
    ];
    for (name, change, wanted) in cases {
        for method in [Method::Plane, Method::Rigid] {
            let said = refused(method, change);
            assert!(said.contains(wanted), "{name}, {method:?}: {said}");
        }
    }
}

#[test]
fn slips_of_depth_are_named() {
    let cases: [(&str, Change, &str); 4] = [
        (
            "none",
            |it| it[3].depth_m = None,
            "needs a depth at every point, and 1 of 16 have none, starting with point 4",
        ),
        (
            "millimetres",
            |it| {
                it.iter_mut()
                    .for_each(|it| it.depth_m = it.depth_m.map(|m| m * 1000.0))
            },
            "are these millimetres?",
        ),
        (
            "no reading",
            |it| it[2].depth_m = Some(0.0),
            "0 means that the camera has no reading there",
        ),
        (
            "another point's",
            |it| it[5].depth_m = it[5].depth_m.map(|m| m - 0.1),
            "point 6 is",
        ),
    ];
    for (name, change, wanted) in cases {
        let said = refused(Method::Rigid, change);
        assert!(said.contains(wanted), "{name}: {said}");
    }
    let mut without = terms(Method::Rigid);
    without.intrinsics = None;
    let pairs = Truth::usual().grid(4, 0.8);
    let refusal = Calibration::make(without, pairs, "2026-11-22", None).unwrap_err();
    assert_eq!(refusal.faults, [Fault::NoIntrinsics]);
}

#[test]
fn points_on_a_line_are_refused_as_that() {
    for method in [Method::Plane, Method::Rigid] {
        let truth = Truth::usual();
        let on_a_line = |n: u32, aside: Option<[f64; 2]>| {
            let along = (0..n).map(|it| [100.0 + 40.0 * f64::from(it), 200.0]);
            let pairs: Vec<Pair> = along.chain(aside).map(|pixel| truth.pair(pixel)).collect();
            Calibration::make(terms(method), pairs, "2026-11-22", None).unwrap_err()
        };
        let refusal = on_a_line(10, None);
        assert!(
            matches!(refusal.faults[..], [Fault::OnALine { .. }]),
            "{refusal}"
        );
        // With one point beside the line, the plane is hardly better determined, and the camera's pose depends on that
        // point alone.
        let refusal = on_a_line(10, Some([300.0, 400.0]));
        let fault = &refusal.faults[0];
        assert!(
            matches!(
                fault,
                Fault::OnALine { .. } | Fault::Spread { .. } | Fault::HangsOn { .. }
            ),
            "{refusal}"
        );
    }
}

#[test]
fn a_slip_below_the_limit_stands_out() {
    let mut pairs = measured_grid(11, 4, 0.8, 0.0);
    pairs[6].base_m[0] += 0.008;
    let made = Calibration::make(terms(Method::Plane), pairs, "2026-11-22", None).unwrap();
    assert_eq!(made.accuracy.outliers(made.terms.limit_mm), [7]);
}

#[test]
fn many_points_with_several_slips_are_sorted_in_time() {
    let mut pairs = measured_grid(2, 18, 0.9, 0.0);
    for index in [5, 50, 150, 300] {
        pairs[index].base_m[1] += 0.2;
    }
    let refusal = Calibration::make(terms(Method::Plane), pairs, "2026-11-22", None).unwrap_err();
    let points: Vec<usize> = refusal
        .faults
        .iter()
        .filter_map(|fault| match fault {
            Fault::Mistake { point, .. } => Some(*point),
            _ => None,
        })
        .collect();
    assert_eq!(points, [6, 51, 151, 301]);
}
