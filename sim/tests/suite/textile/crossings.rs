//! Counts where a cloth goes through itself.

use fab_sim::{Grid, Mask, mesh};
use std::collections::{BTreeMap, BTreeSet};

fn minus(a: [f32; 3], b: [f32; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| f64::from(a[axis]) - f64::from(b[axis]))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Returns how many edges along a side go through a triangle of which they have no corner (Moeller and Trumbore 1997).
pub fn crossings(grid: Grid, points: &[[f32; 3]]) -> usize {
    let triangles = mesh::triangles(&Mask::full(grid));
    let side_m = 2.0 * grid.spacing_m;
    let boxes = |corners: &[usize]| {
        let end = |axis: usize, end: fn(f32, f32) -> f32| {
            let values = corners.iter().map(|&i| points[i][axis]);
            (values.reduce(end).unwrap() / side_m).floor() as i32
        };
        let range = |axis: usize| end(axis, f32::min)..=end(axis, f32::max);
        let mut all = Vec::new();
        for x in range(0) {
            for y in range(1) {
                all.extend(range(2).map(|z| [x, y, z]));
            }
        }
        all
    };
    let mut in_box: BTreeMap<[i32; 3], Vec<usize>> = BTreeMap::new();
    for (number, corners) in triangles.iter().enumerate() {
        for place in boxes(corners) {
            in_box.entry(place).or_default().push(number);
        }
    }
    let mut count = 0;
    for i in 0..points.len() {
        let right = (i % grid.dimx + 1 < grid.dimx).then_some(i + 1);
        let front = (i + grid.dimx < points.len()).then_some(i + grid.dimx);
        for j in right.into_iter().chain(front) {
            let near: BTreeSet<usize> = boxes(&[i, j])
                .iter()
                .filter_map(|place| in_box.get(place))
                .flatten()
                .copied()
                .collect();
            count += near
                .into_iter()
                .filter(|&number| pierces(points, [i, j], triangles[number]))
                .count();
        }
    }
    count
}

fn pierces(points: &[[f32; 3]], [i, j]: [usize; 2], corners: [usize; 3]) -> bool {
    if corners.contains(&i) || corners.contains(&j) {
        return false;
    }
    let [a, b, c] = corners.map(|corner| points[corner]);
    let way = minus(points[j], points[i]);
    let (e1, e2, from) = (minus(b, a), minus(c, a), minus(points[i], a));
    let h = cross(way, e2);
    let det = dot(e1, h);
    let u = dot(from, h) / det;
    let q = cross(from, e1);
    let v = dot(way, q) / det;
    let along = dot(e2, q) / det;
    u > 0.0 && v > 0.0 && u + v < 1.0 && (0.0..1.0).contains(&along)
}

#[test]
fn an_edge_through_a_triangle_counts_and_one_beside_it_does_not() {
    let grid = Grid::new(4, 4, 0.01).unwrap();
    let mut points: Vec<[f32; 3]> = (0..16)
        .map(|i| [(i % 4) as f32 * 0.01, -((i / 4) as f32) * 0.01, 0.0])
        .collect();
    assert_eq!(crossings(grid, &points), 0);
    // Particle 15 goes over the first cell and under it again.
    points[11] = [0.004, -0.003, 0.01];
    points[15] = [0.004, -0.003, -0.01];
    assert!(crossings(grid, &points) > 0);
    points[15] = [0.004, -0.003, 0.02];
    assert_eq!(crossings(grid, &points), 0);
}
