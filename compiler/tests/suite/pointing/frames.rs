//! Written points read back, for random sizes, units and orders.

use super::{frame, in_frame, known, numbers, program};
use crate::common::Known;
use fab_program::PixelPoint;
use fab_program::pointing::{CoordinateUnit, Order, Pointing};
use fab_program::reply;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn a_pixel_that_is_written_reads_back_in_every_frame_with_enough_steps(
        side in 1_u32..=1000, more in 0_u32..=600, at in (0.0..1.0_f64, 0.0..1.0_f64),
        unit in 0..4_usize, order in 0..2_usize,
    ) {
        let frame = frame(CoordinateUnit::ALL[unit], Order::ALL[order], side, side + more);
        let pixel = PixelPoint::new((at.0 * f64::from(side)) as i32, (at.1 * f64::from(side)) as i32);
        let [first, second] = numbers(&frame.write(pixel));
        let (x, y) = match frame.order {
            Order::Xy => (first, second),
            Order::Yx => (second, first),
        };
        prop_assert_eq!(frame.pixel(x, y), pixel, "{:?} {}", frame, frame.write(pixel));
    }

    #[test]
    fn an_offered_point_reads_back_however_coarse_the_frame(
        side in 1_u32..=4096, sent in 1_u32..=4096, shift in 0..3_i32,
        at in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 1..12),
        unit in 0..4_usize, order in 0..2_usize, are_marks: bool,
    ) {
        let frame = frame(CoordinateUnit::ALL[unit], Order::ALL[order], side, sent);
        let pointing = if are_marks { Pointing::Marks(frame) } else { Pointing::Frame(frame) };
        // Neighbours are included, because a coarse frame writes them alike.
        let pixel = |part: f64| (part * f64::from(side)) as i32;
        let offered: Vec<PixelPoint> = at
            .iter()
            .map(|(x, y)| (pixel(*x), pixel(*y)))
            .flat_map(|(u, v)| [PixelPoint::new(u, v), PixelPoint::new(u + shift, v)])
            .collect();
        let points = vec![("corners", offered.clone()), ("center", offered[..1].to_vec())];
        let known = Known { points, ..known() };
        let notation = in_frame(&known, pointing).notation(program());
        for point in offered {
            let stated = notation.stated(point);
            let answer = format!("Pick Point = {stated}\nPlace Point = {stated}");
            let reading = reply::read_action_in(program(), &notation, &answer).unwrap();
            prop_assert_eq!(reading.value.point("pick"), Some(point), "{} {:?}", answer, frame);
            prop_assert!(reading.repairs.is_empty(), "{:?}", reading.repairs);
        }
    }

    #[test]
    fn a_place_is_written_within_half_a_step_of_where_it_is(
        side in 1_u32..=4096, sent in 1_u32..=4096, at in 0.0..1.0_f64, unit in 0..4_usize,
    ) {
        let frame = frame(CoordinateUnit::ALL[unit], Order::Xy, side, sent);
        let pixel = PixelPoint::new((at * f64::from(side)) as i32, 0);
        let [x, y] = numbers(&frame.write(pixel));
        let steps = match frame.unit {
            CoordinateUnit::Pixels => f64::from(sent),
            CoordinateUnit::Fraction | CoordinateUnit::Percent | CoordinateUnit::PerMille => 1000.0,
        };
        let half_a_step = 0.5 * f64::from(side) / steps;
        let away = (frame.read(x, y)[0] - (f64::from(pixel.u) + 0.5)).abs();
        prop_assert!(away <= half_a_step * (1.0 + 1e-9), "{away} of {half_a_step}");
    }

    #[test]
    fn no_answer_makes_a_frame_panic(
        reply in ".{0,200}", unit in 0..4_usize, order in 0..2_usize, are_marks: bool,
    ) {
        let frame = frame(CoordinateUnit::ALL[unit], Order::ALL[order], 224, 448);
        let pointing = if are_marks { Pointing::Marks(frame) } else { Pointing::Frame(frame) };
        let known = known();
        let notation = in_frame(&known, pointing).notation(program());
        let begins = ["", "Pick Point = ", "Pick Point = {\"point\": [", "pick: <point x=\"", "Pick Point: #"];
        for begin in begins {
            let _ = reply::read_action_in(program(), &notation, &format!("{begin}{reply}"));
        }
    }
}

#[test]
fn each_frame_writes_a_pixel_in_its_own_way() {
    let pixel = PixelPoint::new(41, 167);
    let rows = [
        (CoordinateUnit::Pixels, 224, ["(41, 167)", "[167, 41]"]),
        (CoordinateUnit::Pixels, 448, ["(82, 334)", "[334, 82]"]),
        (CoordinateUnit::Pixels, 112, ["(20, 83)", "[83, 20]"]),
        (
            CoordinateUnit::Fraction,
            224,
            ["(0.185, 0.748)", "[0.748, 0.185]"],
        ),
        (
            CoordinateUnit::Percent,
            224,
            ["(18.5, 74.8)", "[74.8, 18.5]"],
        ),
        (CoordinateUnit::PerMille, 224, ["(185, 748)", "[748, 185]"]),
    ];
    for (unit, sent, expected) in rows {
        let written = Order::ALL.map(|order| frame(unit, order, 224, sent).write(pixel));
        assert_eq!(written, expected, "{unit:?} {sent}");
    }
    let outside =
        frame(CoordinateUnit::Fraction, Order::Xy, 224, 224).write(PixelPoint::new(-3, 300));
    assert_eq!(outside, "(-0.011, 1.342)");
}

#[test]
fn a_pixel_is_at_its_centre_in_the_picture_that_is_sent() {
    let pixel = PixelPoint::new(41, 167);
    for (sent, centre) in [
        (224, [41.5, 167.5]),
        (448, [83.0, 335.0]),
        (112, [20.75, 83.75]),
    ] {
        let frame = frame(CoordinateUnit::PerMille, Order::Yx, 224, sent);
        assert_eq!(frame.in_sent_picture(pixel), centre, "{sent}");
    }
}

#[test]
fn a_picture_of_as_many_pixels_as_steps_loses_none() {
    for unit in [
        CoordinateUnit::Fraction,
        CoordinateUnit::Percent,
        CoordinateUnit::PerMille,
    ] {
        let frame = frame(unit, Order::Xy, 1000, 1000);
        for pixel in (0..1000).map(|number| PixelPoint::new(number, 999 - number)) {
            let [x, y] = numbers(&frame.write(pixel));
            assert_eq!(frame.pixel(x, y), pixel, "{unit:?} {x} {y}");
        }
    }
}

#[test]
fn the_edges_of_a_picture_are_its_first_and_last_pixel() {
    for unit in [
        CoordinateUnit::Fraction,
        CoordinateUnit::Percent,
        CoordinateUnit::PerMille,
    ] {
        let full = match unit {
            CoordinateUnit::Fraction => 1.0,
            CoordinateUnit::Percent => 100.0,
            _ => 1000.0,
        };
        for order in Order::ALL {
            let frame = frame(unit, order, 224, 224);
            assert_eq!(frame.pixel(0.0, full), PixelPoint::new(0, 223), "{unit:?}");
            let beyond = frame.pixel(-0.1 * full, 1.2 * full);
            assert_eq!(beyond, PixelPoint::new(-23, 268), "{unit:?}");
        }
    }
}
