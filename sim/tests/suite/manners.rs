//! How the picker goes about one action, on the recorded scene's cloth and on every material.

use crate::shipped;
use fab_sim::{Grid, Manner, Params, SimError, Simulator};

const CLOTHS: [&str; 5] = ["pyflex", "silk", "cotton", "towel", "denim"];

/// Returns the parameters of a cloth, with the picker that puts down and the one that drops.
fn pickers(cloth: &str) -> [Params; 2] {
    [Params::default(), Params::with_dropping_picker()].map(|picker| Params {
        material: shipped::material(cloth),
        ..picker
    })
}

fn square(dim: usize, params: &Params) -> Simulator {
    Simulator::flat(Grid::new(dim, dim, 0.00625).unwrap(), params)
}

fn never() -> bool {
    false
}

/// Carries the corner of a small cloth 45 mm outward; returns its height after so many steps.
fn height_after(steps: u32, manner: &Manner, params: &Params) -> f32 {
    let mut cloth = square(12, params);
    let [x, y, _] = cloth.positions()[0];
    let asked = std::cell::Cell::new(0);
    let stop = || {
        asked.set(asked.get() + 1);
        asked.get() > steps
    };
    let done = cloth.pick_and_place_in(manner, [x, y], [x - 0.04, y + 0.02], &stop, &mut |_| {});
    assert_eq!(done, Err(SimError::Interrupted { steps }));
    cloth.positions()[0][2]
}

#[test]
fn the_held_corner_rises_by_the_lift_and_is_let_go_at_the_height_of_release() {
    // It is grasped in step 181, and with the other picker in step 200, whose ways take 100 steps each.
    let risen = |manner: &Manner, params: &Params, grasped: u32, then: u32| {
        height_after(then, manner, params) - height_after(grasped, manner, params)
    };
    for cloth in CLOTHS {
        let [usual, dropping] = pickers(cloth);
        for up in [0_u32, 4, 14] {
            let lift_m = up as f32 * 0.005;
            let lift = Manner {
                lift_m: Some(lift_m),
                ..Manner::default()
            };
            for rose in [
                risen(&lift, &usual, 181, 181 + up + 5),
                risen(&lift, &dropping, 200, 350),
            ] {
                assert!((rose - lift_m).abs() < 1e-4, "{cloth}, {lift_m}: {rose}");
            }
            let release = Manner {
                release_height_m: Some(0.04),
                ..lift
            };
            // Nine steps across, then up or down to where it is let go.
            let there = 181 + up + 9 + up.abs_diff(8);
            for rose in [
                risen(&release, &usual, 181, there),
                risen(&release, &dropping, 200, 500),
            ] {
                assert!((rose - 0.04).abs() < 1e-4, "{cloth}, {lift_m}: {rose}");
            }
        }
    }
}

#[test]
fn a_drag_leaves_the_held_corner_at_the_height_of_the_table() {
    let drag = Manner {
        lift_m: Some(0.0),
        ..Manner::default()
    };
    for cloth in CLOTHS {
        let [params, _] = pickers(cloth);
        for step in [181, 185, 190] {
            let z = height_after(step, &drag, &params);
            let highest = params.rest_height_m() + 1e-3;
            assert!((-1e-4..highest).contains(&z), "{cloth}, {step}: {z}");
        }
        assert!(height_after(185, &Manner::default(), &params) > 0.015);
    }
}

#[test]
fn half_the_speed_takes_twice_the_steps_while_the_cloth_is_held() {
    let steps = |params: &Params, speed_m_s| {
        let mut cloth = square(12, params);
        let [x, y, _] = cloth.positions()[0];
        let manner = Manner {
            speed_m_s,
            ..Manner::default()
        };
        let done = cloth.pick_and_place_in(&manner, [x, y], [x - 0.04, y], &never, &mut |_| {});
        (done.unwrap().steps, cloth.digest())
    };
    for cloth in CLOTHS {
        let [params, _] = pickers(cloth);
        let (usual, digest) = steps(&params, None);
        assert_eq!(steps(&params, Some(0.5)), (usual, digest), "{cloth}");
        // 50 mm up, 40 mm across, 50 mm down: 28 steps at 5 mm each.
        for (speed_m_s, more) in [(0.25, 28), (0.05, 9 * 28), (1.0, -14)] {
            let (slower, _) = steps(&params, Some(speed_m_s));
            assert_eq!(Some(slower), usual.checked_add_signed(more), "{cloth}");
        }
    }
}

#[test]
fn manners_that_say_what_is_usual_change_no_bit() {
    let end = |params: &Params, manner: &Manner| {
        let mut cloth = square(14, params);
        let done = cloth.pick_and_place_in(manner, [-0.04, 0.04], [0.02, 0.0], &never, &mut |_| {});
        (done.unwrap(), cloth.digest())
    };
    let usual = Manner {
        lift_m: Some(0.05),
        speed_m_s: Some(0.5),
        release_height_m: Some(0.0),
        press_m: Some(0.0),
    };
    for cloth in CLOTHS {
        let [params, _] = pickers(cloth);
        assert_eq!(
            end(&params, &usual),
            end(&params, &Manner::default()),
            "{cloth}"
        );
    }
}

/// Folds a cloth in half; returns its mean height within 6 cm of the crease, metres.
fn crease_height(params: &Params, manner: &Manner) -> f32 {
    let mut cloth = square(40, params);
    let half = cloth.positions()[39][0];
    let (pick, place) = ([-half, 0.0], [half - 0.02, 0.0]);
    let done = cloth.pick_and_place_in(manner, pick, place, &never, &mut |_| {});
    assert!(done.unwrap().grasped.is_some());
    cloth.settle(1000).unwrap();
    let points = cloth.positions();
    let crease = points.iter().map(|p| p[0]).fold(1.0, f32::min);
    assert!((crease + 0.01).abs() < 0.02, "no fold: {crease}");
    let near = points.iter().map(|p| (p[0], p[2]));
    let near = near.filter(|(x, _)| *x < crease + 0.06);
    near.clone().map(|(_, z)| z).sum::<f32>() / near.count() as f32
}

fn press_flattens(name: &str, params: &Params, carries: Manner) {
    let [loose, pressed] =
        [None, Some(0.25)].map(|press_m| crease_height(params, &Manner { press_m, ..carries }));
    assert!(
        pressed < 0.95 * loose,
        "{name}: from {loose} m to {pressed} m"
    );
}

#[test]
fn a_pressed_crease_stays_flatter() {
    let stiff = Params {
        bend: 2.0,
        ..Params::default()
    };
    press_flattens("pyflex", &stiff, Manner::default());
}

/// Carried low and slowly, so that they do not pleat.
///
/// Measured, the mean height within 6 cm of the crease: silk 2.9 to 2.3 mm, cotton 4.1 to 2.6, towel 6.5 to 5.4, denim 9.1 to 8.2;
/// the recorded scene's cloth above 12.6 to 11.6.
#[test]
#[ignore = "long"]
fn a_pressed_crease_of_a_material_stays_flatter() {
    let carries = Manner {
        lift_m: Some(0.03),
        speed_m_s: Some(0.1),
        ..Manner::default()
    };
    for cloth in &CLOTHS[1..] {
        press_flattens(cloth, &pickers(cloth)[0], carries);
    }
}

#[test]
fn every_manner_ends_with_an_open_picker_at_home() {
    let values = [None, Some(0.0), Some(0.04), Some(0.3)];
    for (number, cloth) in CLOTHS.into_iter().enumerate() {
        // Each manner on the recorded scene's cloth and on one material.
        let rounds = match number {
            0 => 0..8,
            _ => 2 * number - 2..2 * number,
        };
        for (index, route) in pickers(cloth).iter().enumerate() {
            for round in rounds.clone() {
                let manner = Manner {
                    lift_m: values[(round + index) % 4],
                    speed_m_s: [None, Some(0.1), Some(1.0)][round % 3],
                    release_height_m: values[(round / 2) % 4],
                    press_m: values[(3 * round + 1) % 4],
                };
                let mut square = square(10, route);
                let done = square.pick_and_place_in(
                    &manner,
                    [-0.02, 0.02],
                    [0.02, 0.01],
                    &never,
                    &mut |_| {},
                );
                assert!(done.unwrap().grasped.is_some(), "{cloth}, {manner:?}");
                assert!(square.held().is_empty());
                assert_eq!(square.sphere(), route.picker_home_m);
            }
        }
    }
}

#[test]
fn numbers_out_of_bounds_in_a_manner_are_refused_before_anything_moves() {
    let mut cloth = square(6, &Params::default());
    for value in [f32::NAN, -0.01, 20.0] {
        let lift_m = Some(value);
        let manners = [
            Manner {
                lift_m,
                ..Manner::default()
            },
            Manner {
                speed_m_s: lift_m,
                ..Manner::default()
            },
            Manner {
                press_m: lift_m,
                ..Manner::default()
            },
        ];
        for manner in manners {
            let error = cloth.pick_and_place_in(&manner, [0.0; 2], [0.02; 2], &never, &mut |_| {});
            let error = error.unwrap_err().to_string();
            assert!(error.contains(&format!("is `{value}`, outside")), "{error}");
        }
    }
    assert_eq!(cloth.steps(), 0);
}
