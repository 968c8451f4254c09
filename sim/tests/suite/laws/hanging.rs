//! Hanging: sag of soft springs, stretch of stiff ones.

use super::*;

/// Rows of soft springs sag as Hooke's law predicts.
///
/// A sweep moves each of a spring's two free ends by half of `share * error`. So `K` sweeps in each substep of `h`
/// seconds accelerate it by `K * share / (2 h^2) * error`: per unit of mass, the stiffness. A spring next to a held
/// particle moves its free end by all of it, and is twice as stiff. Spring `j` carries the particles below it. This
/// holds to first order in `K * share`.
#[test]
fn a_soft_strip_sags_by_the_weight_below_over_the_stiffness() {
    const ROWS: usize = 8;
    const SUBSTEPS: u32 = 20;
    for (share, tolerance) in [(0.001, 0.01), (0.005, 0.01), (0.02, 0.03)] {
        // Only columns of soft springs have the simple solution. Strong damping makes them hang still soon.
        let params = Params {
            stretch: share,
            shear: 0.0,
            bend: 0.0,
            damping_per_s: 40.0,
            substeps: SUBSTEPS,
            ..sleepless()
        };
        let grid = Grid::new(4, ROWS, 0.005).unwrap();
        let start = upright(grid, 0.16);
        let mut cloth = Simulator::from_positions(grid, &start, &params).unwrap();
        cloth.hold(&back_row(grid)).unwrap();
        run(&mut cloth, 100);
        let end = cloth.positions();
        let h = f64::from(params.step_secs) / f64::from(SUBSTEPS);
        let stiffness = f64::from(params.sweeps) * f64::from(share) / (2.0 * h * h);
        let mut expected = 0.0;
        for row in 1..ROWS {
            let ends_that_move = if row == 1 { 2.0 } else { 1.0 };
            expected += G * (ROWS - row) as f64 / (ends_that_move * stiffness);
            for column in 0..4 {
                let i = row * 4 + column;
                let sag = f64::from(start[i][2] - end[i][2]);
                assert!(
                    (sag / expected - 1.0).abs() < tolerance,
                    "share {share}, row {row}: {sag} m instead of {expected} m"
                );
            }
        }
    }
}

/// Hangs a square from its back row, or from two corners; returns its stretches.
fn hung(dim: usize, held: &[usize], params: Params) -> (f64, Vec<f64>) {
    let grid = grid(dim, dim);
    // Damping makes it hang still soon.
    let params = Params {
        damping_per_s: 5.0,
        ..params
    };
    let mut cloth = Simulator::from_positions(grid, &upright(grid, 0.6), &params).unwrap();
    cloth.hold(held).unwrap();
    run(&mut cloth, 150);
    let points = cloth.positions();
    let front = points[dim * dim - 1 - dim / 2];
    let length = f64::from((dim - 1) as f32 * SPACING_M);
    (
        f64::from(points[0][2] - front[2]) / length - 1.0,
        stretches(grid, &points),
    )
}

#[test]
fn a_sheet_that_hangs_from_a_side_gains_little_of_its_length() {
    for (name, params) in [("asleep", Params::default()), ("awake", sleepless())] {
        let (longer, edges) = hung(50, &(0..50).collect::<Vec<_>>(), params);
        // About 2 %; the edges at the top carry all the weight.
        assert!((0.002..0.03).contains(&longer), "{name}: {longer}");
        let most = edges[edges.len() - 1];
        assert!(most < 0.15, "{name}: the longest edge gained {most}");
    }
}

/// The remaining stretch of stiff springs comes from gravity in one substep, so it is proportional to the square of
/// dt.
#[test]
fn stretch_falls_with_the_square_of_the_substep() {
    const DIM: usize = 20;
    // The sleeping rule would stop the cloth in the air.
    let with = |substeps: u32, held: &[usize]| {
        let params = Params {
            substeps,
            ..sleepless()
        };
        let (_, edges) = hung(DIM, held, params);
        [edges[edges.len() * 99 / 100], edges[edges.len() - 1]]
    };
    let side: Vec<usize> = (0..DIM).collect();
    // Measured slopes, p99 and maximum: 1.99 and 1.99 from a side; 1.97 and 1.88 from two corners, where with 2
    // substeps the corner's edges stretch by 65 %, which is not a small strain.
    for (held, low) in [(&side[..], 1.9), (&[0, DIM - 1][..], 1.8)] {
        let stretch = [2, 4, 8, 16].map(|substeps| with(substeps, held));
        for (k, name) in ["p99", "maximum"].into_iter().enumerate() {
            let slope = slope_of(stretch.map(|both| both[k]));
            assert!((low..2.1).contains(&slope), "{name}: {slope}, {stretch:?}");
        }
    }
}

/// Returns the slope of the least-squares line through logarithms of values, each at half the substep of the one
/// before.
fn slope_of(values: [f64; 4]) -> f64 {
    let logs = values.map(f64::log2);
    let offsets = [1.5, 0.5, -0.5, -1.5];
    let products = offsets.iter().zip(logs).map(|(x, y)| x * y);
    products.sum::<f64>() / offsets.iter().map(|x| x * x).sum::<f64>()
}
