//! Tests that a moved camera is noticed whatever lies on the table, without false alarms.

#[path = "../../../arm/src/calibration/tests/truth.rs"]
mod truth;

use fab_agent::arm_sight::SIGHT;
use fab_arm::calibration::{Calibration, LIMIT_MM, Pair, Terms};
use fab_arm::rgbd::Intrinsics;
use image::imageops::{self, FilterType};
use image::{Luma, Rgb, RgbImage};
use truth::{Noise, Truth};

/// Middle and side of a cloth in the picture, pixels, if one lies there.
type Cloth = Option<[f64; 3]>;

/// A table with grain, stains and a few printed sheets, seen by a camera that was turned and moved a little.
struct Table {
    by: [f64; 2],
    turn_deg: f64,
    light: f64,
    noise: u64,
    cloth: Cloth,
    is_plain: bool,
}

impl Table {
    fn usual() -> Table {
        Table {
            by: [0.0; 2],
            turn_deg: 0.0,
            light: 1.0,
            noise: 1,
            cloth: None,
            is_plain: false,
        }
    }

    fn level(&self, [x, y]: [f64; 2]) -> f64 {
        if self.is_plain {
            return 120.0;
        }
        let soft = |cell: f64, seed: u64| {
            let (column, row) = ((x / cell).floor(), (y / cell).floor());
            let at = |right: f64, down: f64| {
                let key =
                    (column + right) as i64 as u64 ^ ((row + down) as i64 as u64).rotate_left(20);
                Noise::new(key.wrapping_mul(77).wrapping_add(seed)).uniform()
            };
            let ease = |share: f64| share * share * (3.0 - 2.0 * share);
            let (u, v) = (ease(x / cell - column), ease(y / cell - row));
            let top = at(0.0, 0.0) * (1.0 - u) + at(1.0, 0.0) * u;
            let bottom = at(0.0, 1.0) * (1.0 - u) + at(1.0, 1.0) * u;
            top * (1.0 - v) + bottom * v - 0.5
        };
        120.0 + 50.0 * soft(31.0, 1) + 40.0 * soft(9.0, 2) + 15.0 * soft(4.0, 3)
    }

    fn picture(&self) -> RgbImage {
        let mut noise = Noise::new(self.noise);
        let (sin, cos) = self.turn_deg.to_radians().sin_cos();
        RgbImage::from_fn(640, 480, |u, v| {
            let (u, v) = (f64::from(u) - 320.0, f64::from(v) - 240.0);
            let at = [
                cos * u + sin * v + 320.0 - self.by[0],
                -sin * u + cos * v + 240.0 - self.by[1],
            ];
            let level = match self.cloth {
                Some([x, y, side]) if (at[0] - x).abs() < side && (at[1] - y).abs() < side => 230.0,
                _ => self.level(at),
            };
            let level = level * self.light + 2.0 * noise.normal();
            Rgb([level.clamp(0.0, 255.0) as u8; 3])
        })
    }
}

/// Calibrates with the picture of a table.
fn calibrated(table: &Table) -> Calibration {
    let truth = Truth::usual();
    let reference = imageops::grayscale(&table.picture());
    Calibration::make(
        truth.terms(),
        truth.grid(4, 0.8),
        "2026-11-22",
        Some(reference),
    )
    .unwrap()
}

#[test]
#[ignore = "long"]
fn a_camera_that_stays_is_not_said_to_have_moved() {
    let made = calibrated(&Table::usual());
    let cases: [(&str, f64, Cloth, [f64; 2]); 6] = [
        ("another picture", 1.0, None, [0.0; 2]),
        ("darker", 0.8, None, [0.0; 2]),
        ("brighter", 1.2, None, [0.0; 2]),
        ("a cloth", 1.0, Some([320.0, 240.0, 150.0]), [0.0; 2]),
        (
            "a cloth, darker",
            0.8,
            Some([250.0, 300.0, 170.0]),
            [0.0; 2],
        ),
        ("a trembling", 1.0, None, [0.3, -0.2]),
    ];
    for (noise, (name, light, cloth, by)) in (2..).zip(cases) {
        let table = Table {
            noise,
            light,
            cloth,
            by,
            ..Table::usual()
        };
        let moved = made.check_camera(&table.picture(), &SIGHT);
        assert_eq!(moved, Ok(()), "{name}");
    }
}

#[test]
#[ignore = "long"]
fn a_moved_camera_is_noticed() {
    let made = calibrated(&Table::usual());
    let cloth = Some([320.0, 240.0, 150.0]);
    let cases: [(&str, [f64; 2], f64, Cloth, f64); 7] = [
        ("right", [3.0, 0.0], 0.0, None, 3.0),
        ("up", [0.0, -3.0], 0.0, None, 3.0),
        ("by fractions", [2.2, 1.4], 0.0, None, 2.6),
        ("far", [-24.0, 10.0], 0.0, None, 26.0),
        // Half of the marks are farther than about 200 px from the middle.
        ("turned", [0.0; 2], 0.5, None, 1.9),
        ("turned back", [0.0; 2], -0.5, None, 1.9),
        ("under a cloth", [3.0, 0.0], 0.0, cloth, 3.0),
    ];
    for (noise, (name, by, turn_deg, cloth, px)) in (2..).zip(cases) {
        let table = Table {
            noise,
            by,
            turn_deg,
            cloth,
            ..Table::usual()
        };
        let why = made.check_camera(&table.picture(), &SIGHT).unwrap_err();
        let (_, number) = why
            .split_once("it was moved since it was calibrated, by ")
            .expect(&why);
        let by_px: f64 = number.split(' ').next().unwrap().parse().unwrap();
        assert!((by_px - px).abs() < 0.4, "{name}: {why}");
    }
}

#[test]
#[ignore = "long"]
fn what_cannot_be_seen_is_not_claimed() {
    let made = calibrated(&Table::usual());
    let why =
        |made: &Calibration, picture: &RgbImage| made.check_camera(picture, &SIGHT).unwrap_err();
    let usual = Table::usual().picture();
    let sizes = "its pictures have 1280 x 720 px, and had 640 x 480 when it was calibrated";
    assert_eq!(why(&made, &RgbImage::new(1280, 720)), sizes);
    let covered = Table {
        cloth: Some([320.0, 240.0, 600.0]),
        ..Table::usual()
    };
    assert!(why(&made, &covered.picture()).contains("0 are found again"));
    let elsewhere = Table {
        by: [1000.0, 500.0],
        ..Table::usual()
    };
    // By chance enough marks may seem to be found again, far off.
    let said = why(&made, &elsewhere.picture());
    assert!(
        said.contains("moved far") || said.starts_with("it was moved"),
        "{said}"
    );
    let plain = Table {
        is_plain: true,
        ..Table::usual()
    };
    let nothing = why(&calibrated(&plain), &plain.picture());
    assert!(
        nothing.contains("of 0 places of the calibration's picture 0 are found again"),
        "{nothing}"
    );
    let mut without = made;
    without.reference = None;
    assert!(why(&without, &usual).contains("`--image PNG`"));
}

#[test]
#[ignore = "long"]
fn a_larger_picture_is_compared_at_the_same_width() {
    let reference = imageops::grayscale(&Table::usual().picture());
    let twice = imageops::resize(&reference, 1280, 960, FilterType::Triangle);
    let mut large = calibrated(&Table::usual());
    (large.terms.size_px, large.reference) = ([1280, 960], Some(twice.clone()));
    let shifted = RgbImage::from_fn(1280, 960, |u, v| {
        let Luma([level]) = *twice.get_pixel(u.saturating_sub(6), v);
        Rgb([level; 3])
    });
    let why = large.check_camera(&shifted, &SIGHT).unwrap_err();
    assert!(
        why.contains("by 6.0 px") || why.contains("by 5.9 px"),
        "{why}"
    );
}

#[test]
#[ignore = "long"]
fn what_looks_the_same_all_over_is_no_mark() {
    let squares = |by: u32| {
        RgbImage::from_fn(640, 480, |u, v| {
            let is_light = ((u + 640 - by) / 12 + v / 12).is_multiple_of(2);
            Rgb([if is_light { 180 } else { 90 }; 3])
        })
    };
    let mut made = calibrated(&Table::usual());
    made.reference = Some(imageops::grayscale(&squares(0)));
    for by in [0, 3, 12, 24] {
        let why = made.check_camera(&squares(by), &SIGHT).unwrap_err();
        assert!(why.contains("cannot be said"), "{by}: {why}");
    }
}
