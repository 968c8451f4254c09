//! Counts where a cloth goes through itself.
//!
//! In: positions. Out: a number; of a real cloth it is 0. Contacts are between particles, so an edge may pass between them
//! where a cloth of a material is crumpled narrowly.

use crate::mask::Mask;
use crate::mesh::triangles;
use std::collections::{BTreeMap, BTreeSet};

/// Returns in how many places an edge along a side goes through a triangle of which it has no corner (Moeller and Trumbore
/// 1997). Diagonals of cells are not looked at.
///
/// - `points`: `[dimy * dimx]` in grid order, metres, finite; those of missing particles are not read.
pub fn crossings(mask: &Mask, points: &[[f32; 3]]) -> usize {
    let grid = mask.grid();
    let triangles = triangles(mask);
    let cubes = |corners: &[usize]| {
        let side_m = 2.0 * grid.spacing_m;
        let place = |axis: usize, end: fn(f32, f32) -> f32, of: f32| {
            let values = corners.iter().map(|&i| points[i][axis]);
            (values.fold(of, end) / side_m).floor() as i32
        };
        let range = |axis: usize| {
            let of = points[corners[0]][axis];
            place(axis, f32::min, of)..=place(axis, f32::max, of)
        };
        let [xs, ys, zs] = [0, 1, 2].map(range);
        let mut all = Vec::new();
        for x in xs {
            for y in ys.clone() {
                all.extend(zs.clone().map(|z| [x, y, z]));
            }
        }
        all
    };
    let mut in_cube: BTreeMap<[i32; 3], Vec<usize>> = BTreeMap::new();
    let mut edges = BTreeSet::new();
    for (number, corners) in triangles.iter().enumerate() {
        for cube in cubes(corners) {
            in_cube.entry(cube).or_default().push(number);
        }
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (corners[a], corners[b])) {
            let (columns, rows) = (
                (a % grid.dimx).abs_diff(b % grid.dimx),
                (a / grid.dimx).abs_diff(b / grid.dimx),
            );
            if columns + rows == 1 {
                edges.insert([a.min(b), a.max(b)]);
            }
        }
    }
    let of_edge = |edge: &[usize; 2]| {
        let near = cubes(edge).into_iter();
        let near = near.filter_map(|cube| in_cube.get(&cube)).flatten();
        let near: BTreeSet<usize> = near.copied().collect();
        let through = near.into_iter().map(|number| triangles[number]);
        through
            .filter(|&corners| pierces(points, *edge, corners))
            .count()
    };
    edges.iter().map(of_edge).sum()
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::grid::Grid;

    #[test]
    fn an_edge_through_a_triangle_counts_and_one_beside_it_does_not() {
        let mask = Mask::full(Grid::new(4, 4, 0.01).unwrap());
        let mut points: Vec<[f32; 3]> = (0..16)
            .map(|i| [(i % 4) as f32 * 0.01, -((i / 4) as f32) * 0.01, 0.0])
            .collect();
        assert_eq!(crossings(&mask, &points), 0);
        // Particle 15 goes over the first cell and under it again.
        points[11] = [0.004, -0.003, 0.01];
        points[15] = [0.004, -0.003, -0.01];
        assert_eq!(crossings(&mask, &points), 3);
        points[15] = [0.004, -0.003, 0.02];
        assert_eq!(crossings(&mask, &points), 0);
    }
}
