//! A cloth stops when nothing moves it, and not before.

use super::*;

/// Lets a cloth that nothing holds come down through air so thick that it is never as fast as the speed at which the recorded
/// scene's cloth comes to rest, and expects it flat on the table.
///
/// - `raised`: how high above the table each particle is at first, and where along Y, by its distance from the first row.
fn comes_down(dimensions: [usize; 2], raised: impl Fn(f32) -> [f32; 2]) {
    let [dimx, dimy] = dimensions;
    let grid = Grid::new(dimx, dimy, SPACING_M).unwrap();
    for (name, material) in materials() {
        let thick = Params {
            damping_per_s: 400.0,
            gravity_m_s2: [0.0, 0.0, -1.5],
            ..params(&material)
        };
        let place = |i: usize| {
            let [along, height] = raised((i / dimx) as f32 * SPACING_M);
            let x = (i % dimx) as f32 * SPACING_M;
            [x, -along, thick.rest_height_m() + height]
        };
        let start: Vec<_> = (0..grid.particle_count()).map(place).collect();
        let mut cloth = Simulator::from_positions(grid, &start, &thick).unwrap();
        cloth
            .set_velocities(&vec![[0.0, 0.0, -0.001]; start.len()])
            .unwrap();
        let mut steps = 0;
        while cloth.settle(1).unwrap() == 1 {
            steps += 1;
            let fastest = cloth.velocities().into_iter().flatten();
            let fastest = fastest.fold(0.0f32, |most, v| most.max(v.abs()));
            assert!(fastest < thick.rest_speed_m_s, "{name}: {fastest} m/s");
            assert!(steps < 1500, "{name}: still moves");
        }
        let highest = cloth.positions().iter().map(|p| p[2]).fold(0.0, f32::max);
        assert!(
            highest < thick.rest_height_m() + 1e-4,
            "{name}: {highest} m after {steps} steps"
        );
    }
}

/// It leans on the table by its first row. A cloth that is held never rests, so this one is not.
#[test]
fn a_released_strip_comes_down_however_slowly() {
    let (sin, cos) = 0.5f32.sin_cos();
    comes_down([4, 13], |along| [cos * along, sin * along]);
}

#[test]
fn a_cloth_that_is_let_go_slowly_lands() {
    comes_down([10, 10], |along| [along, 0.02]);
}

/// A strip that is held and let go from the horizontal hangs down in the end as one that hung down from the start, at 1 mm: no
/// particle is stopped for being slow.
#[test]
fn a_released_strip_is_never_still_above_its_hanging_shape() {
    let grid = Grid::new(4, 13, SPACING_M).unwrap();
    for (name, material) in materials() {
        let springy = Material {
            crease_recovery_deg: 180.0,
            ..material
        };
        let tip = |place: &dyn Fn(f32) -> [f32; 2]| {
            let start: Vec<[f32; 3]> = (0..grid.particle_count())
                .map(|i| {
                    let [y, z] = place((i / 4) as f32 * SPACING_M);
                    [(i % 4) as f32 * SPACING_M, -y, 0.5 + z]
                })
                .collect();
            let calm = Params {
                damping_per_s: 4.0,
                ..params(&springy)
            };
            let mut cloth = Simulator::from_positions(grid, &start, &calm).unwrap();
            cloth.hold(&[0, 1, 2, 3, 4, 5, 6, 7]).unwrap();
            for _ in 0..300 {
                cloth.step().unwrap();
            }
            cloth.positions()[50][2]
        };
        let level = tip(&|s| [s, 0.0]);
        let down = tip(&|s| {
            if s < 0.007 {
                [s, 0.0]
            } else {
                [SPACING_M, SPACING_M - s]
            }
        });
        assert!(
            (level - down).abs() < 1e-3,
            "{name}: {level} m and {down} m"
        );
    }
}

/// Folds a corner, and returns the cloth with how many steps it moved after the release; `None` if it moves for more than 3 s.
fn folded(side: usize, material: &Material, carried: f32) -> (Simulator, Option<u32>) {
    let mut cloth = square(side, material);
    let corner = cloth.positions()[0];
    let to = [carried * -corner[0], carried * -corner[1]];
    let (mut was_held, mut since) = (false, 0);
    let mut watch = |cloth: &Simulator| {
        let is_held = !cloth.held().is_empty();
        was_held |= is_held;
        since += u32::from(was_held && !is_held);
    };
    let manner = fab_sim::Manner::default();
    cloth
        .pick_and_place_in(&manner, [corner[0], corner[1]], to, &|| false, &mut watch)
        .unwrap();
    // The picker is on its way home after the release.
    assert!((100..250).contains(&since), "{since}");
    let more = cloth.settle(300 - since).unwrap();
    let rested = (more < 300 - since).then_some(since + more);
    (cloth, rested)
}

/// A fold that is let go rests within 3 s of the release, and then each step leaves it as it is, bit for bit.
#[test]
fn a_released_fold_comes_to_rest() {
    let all = materials();
    let folds = all
        .iter()
        .flat_map(|material| [0.4, 0.5, 0.6].map(|carried| (material, carried)));
    for ((name, material), carried) in folds {
        let (mut cloth, rested) = folded(30, material, carried);
        assert!(rested.is_some(), "{name}, {carried}: still moves after 3 s");
        let digest = cloth.digest();
        cloth.set_rest_shortcut(fab_sim::RestShortcut::Compute);
        run(&mut cloth, 3);
        assert_eq!(cloth.digest(), digest, "{name}");
        // What rests is moved again by a hand.
        cloth.hold(&[0]).unwrap();
        cloth.step_held([0.0, 0.0, 0.005]).unwrap();
        assert_ne!(cloth.digest(), digest, "{name}");
    }
}

/// Of 30 folds of each material, of 24 to 36 particles a side. Measured: 4 of silk move on; three of them rest within 0.8 s
/// more, and one trembles on at the end of its crease. Which do is chance, so the bounds leave room for others.
#[test]
#[ignore = "long"]
fn hardly_a_fold_moves_on_after_three_seconds() {
    for (name, material) in materials() {
        let mut restless = Vec::new();
        for side in [24, 27, 30, 33, 36] {
            for carried in [0.35, 0.4, 0.45, 0.5, 0.55, 0.6] {
                if folded(side, &material, carried).1.is_none() {
                    restless.push((side, carried));
                }
            }
        }
        println!("{name}: still move after 3 s {restless:?}");
        let most = if name == "silk" { 6 } else { 1 };
        assert!(restless.len() <= most, "{name}: {restless:?}");
    }
}
