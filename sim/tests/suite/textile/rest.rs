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

/// A fold that is let go rests within 3 s, and then each step leaves it as it is, bit for bit.
///
/// Of 30 folds of silk, of 24 to 36 particles a side, one trembles on at the end of its crease, and none of cotton.
#[test]
fn a_released_fold_comes_to_rest() {
    let all = materials();
    let folds = all
        .iter()
        .flat_map(|material| [0.4, 0.5, 0.6].map(|carried| (material, carried)));
    for ((name, material), carried) in folds {
        let mut cloth = square(30, material);
        let corner = cloth.positions()[0];
        let to = [carried * -corner[0], carried * -corner[1]];
        cloth
            .pick_and_place([corner[0], corner[1]], to, &|| false)
            .unwrap();
        let steps = cloth.settle(300).unwrap();
        assert!(steps < 300, "{name}, {carried}: still moves after 3 s");
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
