//! Tests that a moved camera is noticed whatever lies on the table, without false alarms.

#[path = "../../../arm/src/calibration/tests/truth.rs"]
mod truth;

use fab_agent::arm_sight::SIGHT;
use fab_arm::calibration::{Calibration, LIMIT_MM, Moved, Pair, Terms, Window};
use fab_arm::rgbd::{Intrinsics, Shot};
use fab_picture::DepthImage;
use image::{Luma, Rgb, RgbImage};
use truth::{Noise, Truth, terms};

/// A table with grain, stains and a few printed sheets, seen by a camera that was turned and moved a little.
struct Table {
    by: [f64; 2],
    turn_deg: f64,
    light: f64,
    noise: u64,
    cloth: Option<[f64; 3]>,
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

    fn shot(&self) -> Shot {
        let mut noise = Noise::new(self.noise);
        let (sin, cos) = self.turn_deg.to_radians().sin_cos();
        let rgb = RgbImage::from_fn(640, 480, |u, v| {
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
        });
        Shot {
            rgb,
            depth_m: DepthImage::new(640, 480),
            intrinsics: Some(Truth::usual().intrinsics()),
        }
    }
}

fn calibrated(table: &Table) -> Calibration {
    let reference = image::imageops::grayscale(&table.shot().rgb);
    Calibration::make(
        terms(),
        Truth::usual().grid(4, 0.8),
        "2026-11-22",
        Some(reference),
    )
    .unwrap()
}

#[test]
#[ignore = "long"]
fn a_camera_that_stays_is_not_said_to_have_moved() {
    let made = calibrated(&Table::usual());
    for (name, table) in [
        (
            "another picture",
            Table {
                noise: 2,
                ..Table::usual()
            },
        ),
        (
            "darker",
            Table {
                noise: 3,
                light: 0.8,
                ..Table::usual()
            },
        ),
        (
            "brighter",
            Table {
                noise: 4,
                light: 1.2,
                ..Table::usual()
            },
        ),
        (
            "a cloth",
            Table {
                noise: 5,
                cloth: Some([320.0, 240.0, 150.0]),
                ..Table::usual()
            },
        ),
        (
            "a cloth, darker",
            Table {
                noise: 6,
                light: 0.8,
                cloth: Some([250.0, 300.0, 170.0]),
                ..Table::usual()
            },
        ),
        (
            "a trembling",
            Table {
                noise: 7,
                by: [0.3, -0.2],
                ..Table::usual()
            },
        ),
    ] {
        let moved = made.moved(&table.shot(), &SIGHT);
        assert!(
            matches!(moved, Moved::No { by_px, n_marks } if by_px < 0.8 && n_marks >= 20),
            "{name}: {moved:?}"
        );
    }
}

#[test]
#[ignore = "long"]
fn a_moved_camera_is_noticed() {
    let made = calibrated(&Table::usual());
    for (name, table, px) in [
        (
            "right",
            Table {
                noise: 2,
                by: [3.0, 0.0],
                ..Table::usual()
            },
            3.0,
        ),
        (
            "up",
            Table {
                noise: 3,
                by: [0.0, -3.0],
                ..Table::usual()
            },
            3.0,
        ),
        (
            "by fractions",
            Table {
                noise: 4,
                by: [2.2, 1.4],
                ..Table::usual()
            },
            2.61,
        ),
        (
            "far",
            Table {
                noise: 5,
                by: [-24.0, 10.0],
                ..Table::usual()
            },
            26.0,
        ),
        (
            "turned",
            Table {
                noise: 6,
                turn_deg: 0.5,
                ..Table::usual()
            },
            2.96,
        ),
        (
            "turned back",
            Table {
                noise: 7,
                turn_deg: -0.5,
                ..Table::usual()
            },
            2.96,
        ),
        (
            "under a cloth, in the dark",
            Table {
                noise: 8,
                by: [3.0, 0.0],
                light: 0.8,
                cloth: Some([320.0, 240.0, 150.0]),
                ..Table::usual()
            },
            3.0,
        ),
    ] {
        let moved = made.moved(&table.shot(), &SIGHT);
        assert!(
            matches!(moved, Moved::ByPx { by_px, .. } if (by_px - px).abs() < 0.15),
            "{name}: {moved:?}"
        );
        if let Moved::ByPx { turn_deg, .. } = moved {
            assert!(
                (turn_deg - table.turn_deg).abs() < 0.1,
                "{name}: {turn_deg}"
            );
        }
    }
}

#[test]
#[ignore = "long"]
fn pictures_of_another_kind_are_noticed() {
    let made = calibrated(&Table::usual());
    let mut shot = Table::usual().shot();
    shot.rgb = RgbImage::new(1280, 720);
    let moved = made.moved(&shot, &SIGHT);
    assert!(
        matches!(&moved, Moved::Changed { what } if what == "its pictures have 1280 x 720 px, and had 640 x 480"),
        "{moved:?}"
    );
    let changes: [fn(&mut Intrinsics); 4] = [
        |it| it.focal_px[1] += 3.0,
        |it| it.middle_px[0] -= 1.0,
        |it| it.distortion = vec![0.1],
        |it| it.size_px = [1280, 720],
    ];
    for change in changes {
        let mut shot = Table::usual().shot();
        change(shot.intrinsics.as_mut().unwrap());
        assert!(matches!(made.moved(&shot, &SIGHT), Moved::Changed { .. }));
    }
    let mut shot = Table::usual().shot();
    shot.intrinsics = None;
    assert!(matches!(made.moved(&shot, &SIGHT), Moved::No { .. }));
}

#[test]
#[ignore = "long"]
fn what_cannot_be_seen_is_not_claimed() {
    let made = calibrated(&Table::usual());
    let why = |moved: Moved| match moved {
        Moved::Unsure { why } => why,
        other => panic!("{other:?}"),
    };
    let covered = Table {
        cloth: Some([320.0, 240.0, 600.0]),
        ..Table::usual()
    };
    assert!(why(made.moved(&covered.shot(), &SIGHT)).contains("0 are found again"));
    let elsewhere = Table {
        by: [1000.0, 500.0],
        ..Table::usual()
    };
    assert!(why(made.moved(&elsewhere.shot(), &SIGHT)).contains("the camera was moved far"));
    let plain = Table {
        is_plain: true,
        ..Table::usual()
    };
    let on_plain = calibrated(&plain);
    assert_eq!(on_plain.marks(&SIGHT), [0, 12]);
    assert!(
        why(on_plain.moved(&plain.shot(), &SIGHT))
            .contains("shows 0 places that can be found again")
    );
    let without = Calibration {
        reference: None,
        ..made.clone()
    };
    assert!(why(without.moved(&Table::usual().shot(), &SIGHT)).contains("`--image PNG`"));
    assert!(made.marks(&SIGHT)[0] >= 40, "{:?}", made.marks(&SIGHT));
    // A larger picture is compared at the same width.
    let twice = image::imageops::resize(
        made.reference.as_ref().unwrap(),
        1280,
        960,
        image::imageops::FilterType::Triangle,
    );
    let mut large = made.clone();
    (large.terms.size_px, large.terms.window) = ([1280, 960], Window::from([160, 0, 960]));
    large.terms.intrinsics = None;
    large.reference = Some(twice.clone());
    let shifted = RgbImage::from_fn(1280, 960, |u, v| {
        let Luma([level]) = *twice.get_pixel(u.saturating_sub(6), v);
        Rgb([level; 3])
    });
    let shot = Shot {
        rgb: shifted,
        depth_m: DepthImage::new(1280, 960),
        intrinsics: None,
    };
    let moved = large.moved(&shot, &SIGHT);
    assert!(
        matches!(moved, Moved::ByPx { by_px, .. } if (by_px - 6.0).abs() < 0.6),
        "{moved:?}"
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
    made.reference = Some(image::imageops::grayscale(&squares(0)));
    for by in [0, 3, 12, 24] {
        let shot = Shot {
            rgb: squares(by),
            ..Table::usual().shot()
        };
        let moved = made.moved(&shot, &SIGHT);
        assert!(matches!(moved, Moved::Unsure { .. }), "{by}: {moved:?}");
    }
}
