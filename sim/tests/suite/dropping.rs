//! The picker that drops: the route of SoftGym's smoothing environment.

use fab_sim::{Aim, DROP_LEG_STEPS, Grid, Params, Route, Simulator};

fn cloth(dimx: usize, dimy: usize) -> Simulator {
    let grid = Grid::new(dimx, dimy, 0.00625).unwrap();
    let mut cloth = Simulator::flat(grid, &Params::with_dropping_picker());
    cloth.set_aim(Aim::Uppermost);
    cloth
}

/// Carries particle `index` by `way`; returns the held particle and the number of steps.
fn carry(cloth: &mut Simulator, index: usize, way: [f32; 2]) -> (Option<usize>, u32) {
    let [x, y, _] = cloth.positions()[index];
    let place = [x + way[0], y + way[1]];
    let done = cloth.pick_and_place([x, y], place, &|| false).unwrap();
    (done.grasped, done.steps)
}

#[test]
fn every_way_takes_a_hundred_steps_whatever_its_length() {
    for way in [[0.02, 0.0], [0.1, -0.2]] {
        let mut cloth = cloth(20, 20);
        let (held, steps) = carry(&mut cloth, 0, way);
        assert_eq!(held, Some(0));
        assert_eq!(steps, 6 * DROP_LEG_STEPS);
    }
}

#[test]
fn the_cloth_hangs_from_near_the_carrying_height_when_it_is_let_go() {
    let mut whole = cloth(20, 20);
    let [x, y, _] = whole.positions()[0];
    let asked = std::cell::Cell::new(0);
    let let_go_after = |steps: u32| {
        asked.set(0);
        move |asked: &std::cell::Cell<u32>| {
            asked.set(asked.get() + 1);
            asked.get() > steps
        }
    };
    // The interruption comes when the sphere is above the place and still closed.
    let stop = let_go_after(4 * DROP_LEG_STEPS);
    whole
        .pick_and_place([x, y], [x + 0.05, y], &|| stop(&asked))
        .unwrap_err();
    let [held_x, _, held_z] = whole.positions()[0];
    let carried_m = Params::with_dropping_picker().picker_lift_height_m;
    // The sphere's radius and skin are between its centre and the surface it came down on.
    assert!((carried_m - held_z).abs() < 0.02, "{held_z}");
    assert!((held_x - (x + 0.05)).abs() < 0.012, "{held_x}");
}

#[test]
fn a_corner_pulled_outward_stretches_a_cloth_that_was_folded_over() {
    // Fold a corner inward by dropping it, then pull it out again in the same way.
    let mut cloth = cloth(30, 30);
    let flat = cloth.positions();
    carry(&mut cloth, 0, [0.06, -0.06]);
    let diagonal_m = |points: &[[f32; 3]]| {
        let (from, to) = (points[0], points[points.len() - 1]);
        (to[0] - from[0]).hypot(to[1] - from[1])
    };
    let folded = diagonal_m(&cloth.positions()) / diagonal_m(&flat);
    carry(&mut cloth, 0, [-0.08, 0.08]);
    let pulled = diagonal_m(&cloth.positions()) / diagonal_m(&flat);
    assert!(folded < 0.85, "{folded}");
    assert!((0.97..1.05).contains(&pulled), "{pulled}, from {folded}");
}

#[test]
fn the_cloth_comes_to_rest_before_the_next_action() {
    let mut cloth = cloth(20, 20);
    carry(&mut cloth, 0, [0.05, -0.05]);
    let before = cloth.digest();
    cloth.settle(50).unwrap();
    let after = cloth.positions();
    assert!(after.iter().all(|point| point[2] < 0.05));
    assert_eq!(
        cloth.digest(),
        before,
        "still moving after the picker went home"
    );
}

#[test]
fn the_other_pickers_hash_is_what_it_was_without_a_choice() {
    let json = serde_json::to_string(&Params::default()).unwrap();
    assert!(!json.contains("picker_route"), "{json}");
    assert_ne!(
        Params::with_dropping_picker().hash(),
        Params::default().hash()
    );
    let text = serde_json::to_string(&Params::with_dropping_picker()).unwrap();
    let read: Params = serde_json::from_str(&text).unwrap();
    assert_eq!(read.picker_route, Route::Drop);
}

#[test]
#[ignore = "long"]
fn the_rim_of_a_crumpled_cloth_is_grasped_from_just_beside_it() {
    // A picture's corner pixel may be beside the cloth: there is only the table, and the rim next to it may be high.
    for seed in 0..6 {
        let mut crumpled = cloth(24, 24);
        crumpled.crumple(seed, &|| false).unwrap();
        crumpled.settle(300).unwrap();
        let points = crumpled.positions();
        for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0f32)] {
            let outermost = (0..points.len())
                .max_by(|&a, &b| (sign * points[a][axis]).total_cmp(&(sign * points[b][axis])));
            let outermost = outermost.unwrap();
            let mut pick = [points[outermost][0], points[outermost][1]];
            pick[axis] += sign * 0.001;
            let mut tried = crumpled.clone();
            let asked = std::cell::Cell::new(0);
            // Until the height to which it would have been lifted.
            let stop = || {
                asked.set(asked.get() + 1);
                asked.get() > 3 * DROP_LEG_STEPS
            };
            tried.pick_and_place(pick, [0.0, 0.0], &stop).unwrap_err();
            let height_m = tried.positions()[outermost][2];
            let was_m = points[outermost][2];
            assert!(height_m > 0.06, "seed {seed}: {height_m}, from {was_m}");
        }
    }
}
