//! What callers of the simulator rely on: grasps, errors, interruption, copies.

use fab_sim::{Grid, Manner, Params, SimError, Simulator, StartError};

fn grid(dimx: usize, dimy: usize) -> Grid {
    Grid::new(dimx, dimy, 0.00625).unwrap()
}

fn flat(dimx: usize, dimy: usize) -> Simulator {
    Simulator::flat(grid(dimx, dimy), &Params::default())
}

fn start(points: &[[f32; 3]]) -> Result<Simulator, StartError> {
    Simulator::from_positions(grid(4, 4), points, &Params::default())
}

fn flat_points() -> Vec<[f32; 3]> {
    grid(4, 4).flat_positions(&Params::default())
}

fn never() -> bool {
    false
}

#[test]
fn the_nearest_particle_and_no_other_is_held() {
    let mut cloth = flat(20, 20);
    let points = cloth.positions();
    // A third of a spacing from particle 21 towards particle 22.
    let pick = [points[21][0] + 0.002, points[21][1]];
    let done = cloth.pick_and_place(pick, [0.0, 0.0], &never).unwrap();
    assert_eq!(done.grasped, Some(21));
    assert_eq!(u64::from(done.steps), cloth.steps());
    assert!((done.time_s - cloth.time_s()).abs() < 1e-9);
}

#[test]
fn the_held_particle_keeps_its_offset_to_the_sphere() {
    let mut cloth = flat(20, 20);
    let from = cloth.positions()[0];
    let to = [from[0] + 0.05, from[1] - 0.03];
    let probe = std::cell::Cell::new(0);
    // 178 steps to above the pick point, 10 down, 10 up, 12 across: stops on the way across.
    let mut highest: f32 = 0.0;
    for stop in [200, 203, 206] {
        probe.set(0);
        let interrupted = || {
            probe.set(probe.get() + 1);
            probe.get() > stop
        };
        let mut partial = cloth.clone();
        partial
            .pick_and_place([from[0], from[1]], to, &interrupted)
            .unwrap_err();
        highest = highest.max(partial.positions()[0][2]);
    }
    // It rises by the difference between the sphere's heights, not to the lift height.
    assert!((0.045..0.056).contains(&highest), "{highest}");
    let done = cloth
        .pick_and_place([from[0], from[1]], to, &never)
        .unwrap();
    assert_eq!(done.grasped, Some(0));
}

#[test]
fn a_pick_beside_the_cloth_is_a_missed_grasp() {
    let mut cloth = flat(10, 10);
    let before = cloth.digest();
    let done = cloth
        .pick_and_place([0.3, 0.3], [0.35, 0.3], &never)
        .unwrap();
    assert_eq!(done.grasped, None);
    assert!(done.steps > 100);
    assert_eq!(cloth.digest(), before);
}

#[test]
fn an_interrupted_action_ends_at_once_and_lets_go() {
    let mut cloth = flat(12, 12);
    let asked = std::cell::Cell::new(0);
    let interrupted = || {
        asked.set(asked.get() + 1);
        asked.get() > 230
    };
    let error = cloth
        .pick_and_place([-0.03, 0.03], [0.1, 0.0], &interrupted)
        .unwrap_err();
    assert_eq!(error, SimError::Interrupted { steps: 230 });
    let lifted = cloth.positions()[0];
    cloth.settle(300).unwrap();
    assert!(
        cloth.positions().iter().all(|p| p[2] < 0.03),
        "still held, from {lifted:?}"
    );
}

#[test]
fn targets_beyond_reach_are_refused_before_anything_moves() {
    let mut cloth = flat(6, 6);
    for bad in [[f32::NAN, 0.0], [0.0, f32::INFINITY], [5.0, 0.0]] {
        let error = cloth.pick_and_place([0.0, 0.0], bad, &never).unwrap_err();
        assert!(matches!(error, SimError::OutOfReach { .. }), "{error}");
    }
    assert_eq!(cloth.steps(), 0);
}

#[test]
fn a_state_that_is_not_finite_is_caught_with_its_particle() {
    let mut cloth = flat(5, 5);
    // At this speed, positions exceed 32 bits within a few steps.
    cloth.set_velocities(&[[f32::MAX, 0.0, 0.0]; 25]).unwrap();
    let failed = (0..500).find_map(|_| cloth.step().err()).unwrap();
    let SimError::NonFinite { particle, step, .. } = failed else {
        panic!("{failed}");
    };
    assert!(particle < 25);
    assert_eq!(step, cloth.steps());
    assert!(cloth.step().is_err(), "a broken state stays broken");
}

#[test]
fn a_route_that_never_arrives_is_bounded() {
    let params = Params {
        picker_travel_m: 2e-5,
        ..Params::default()
    };
    let mut cloth = Simulator::flat(grid(3, 3), &params);
    let error = cloth
        .pick_and_place([0.0, 0.0], [0.1, 0.0], &never)
        .unwrap_err();
    assert_eq!(error, SimError::EndlessRoute);
}

#[test]
fn starts_that_are_no_cloth_are_refused_by_particle_and_value() {
    assert!(start(&flat_points()).is_ok());
    assert_eq!(
        start(&flat_points()[1..]).unwrap_err(),
        StartError::WrongCount {
            expected: 16,
            got: 15
        }
    );
    let with = |particle: usize, point: [f32; 3]| {
        let mut points = flat_points();
        points[particle] = point;
        start(&points).unwrap_err()
    };
    assert!(matches!(
        with(3, [0.0, f32::NAN, 0.0]),
        StartError::NonFinite { particle: 3, .. }
    ));
    assert_eq!(
        with(5, [0.0, 0.0, -0.01]),
        StartError::BelowTable {
            particle: 5,
            z_m: -0.01
        }
    );
    assert_eq!(
        with(0, [3.0, 0.0, 0.01]),
        StartError::TooFar {
            particle: 0,
            value_m: 3.0
        }
    );
    let stretched = with(15, [0.1, -0.1, 0.005]);
    let StartError::OverStretched {
        particle,
        neighbour,
        rest_m,
        ..
    } = stretched
    else {
        panic!("{stretched}");
    };
    assert_eq!((particle, neighbour, rest_m), (11, 15, 0.00625));
}

#[test]
fn a_copy_goes_on_exactly_as_the_original() {
    let mut original = flat(14, 14);
    original
        .pick_and_place([-0.04, 0.04], [0.0, 0.0], &never)
        .unwrap();
    let mut copy = original.clone();
    for cloth in [&mut original, &mut copy] {
        cloth
            .pick_and_place([0.04, 0.04], [0.0, 0.0], &never)
            .unwrap();
    }
    assert_eq!(original.digest(), copy.digest());
}

#[test]
fn the_parameter_hash_changes_with_any_parameter() {
    let params = Params::default();
    // The recorded scene's cloth keeps its bits.
    assert_eq!(params.hash(), "8bd2005a2873ca64");
    let other = Params {
        self_friction: 0.5,
        ..Params::default()
    };
    assert_ne!(params.hash(), other.hash());
}

#[test]
fn parameters_read_back_as_written() {
    let params = Params {
        bend: 0.3,
        ..Params::default()
    };
    let text = serde_json::to_string(&params).unwrap();
    assert_eq!(serde_json::from_str::<Params>(&text).unwrap(), params);
    assert!(serde_json::from_str::<Params>(r#"{"bent": 1}"#).is_err());
}

#[test]
fn a_watched_motion_is_the_same_and_is_shown_step_by_step() {
    let grid = Grid::new(20, 20, 0.00625).unwrap();
    let corner = Simulator::flat(grid, &Params::default()).positions()[0];
    let (from, to) = ([corner[0], corner[1]], [0.02, -0.01]);
    let mut plain = Simulator::flat(grid, &Params::default());
    let done = plain.pick_and_place(from, to, &|| false).unwrap();
    let mut watched = Simulator::flat(grid, &Params::default());
    let mut shown = Vec::new();
    let again = watched
        .pick_and_place_in(&Manner::default(), from, to, &|| false, &mut |cloth| {
            shown.push((cloth.steps(), cloth.marker()));
        })
        .unwrap();
    assert_eq!((again, watched.digest()), (done.clone(), plain.digest()));
    let steps: Vec<u64> = shown.iter().map(|(step, _)| *step).collect();
    assert_eq!(steps, (1..=u64::from(done.steps)).collect::<Vec<_>>());
    // It is at the held corner while it holds, and comes from and goes home.
    let holding: Vec<_> = shown.iter().filter(|(_, marker)| marker.holds).collect();
    let [first, last] = [holding[0], holding[holding.len() - 1]].map(|(_, marker)| marker.tip);
    let near = |tip: [f32; 3], at: [f32; 2]| (tip[0] - at[0]).hypot(tip[1] - at[1]) < 0.02;
    assert!(near(first, from) && near(last, to), "{first:?} {last:?}");
    assert!(!shown[0].1.holds && !shown[shown.len() - 1].1.holds);
}
