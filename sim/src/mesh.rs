//! The triangles of a cloth: what the camera draws, what covers the table, what goes into a mesh file.
//!
//! In: a [`Mask`], and for a file the particles' positions. Out: corners by
//! particle index, two triangles for every full cell. The simulation itself
//! knows springs and no triangles.

use crate::mask::Mask;
use std::fmt::Write;

/// Says why positions are no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// There are more or fewer positions than the grid has particles, missing ones included.
    #[error("a mesh of this cloth needs {expected} positions, in grid order, and got {got}")]
    WrongCount {
        /// Particles of the whole grid.
        expected: usize,
        /// Positions given.
        got: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("particle {particle} has the coordinate `{value}`; a mesh needs finite metres")]
    NonFinite {
        /// Index of the particle.
        particle: usize,
        /// The value found.
        value: f32,
    },
}

/// Cuts the cloth into triangles, two for every cell with four corners, with diagonals that alternate like a
/// chessboard.
///
/// Returns particle indices, anticlockwise as seen from above when the cloth lies flat: the top faces +Z.
pub fn triangles(mask: &Mask) -> Vec<[usize; 3]> {
    cells(mask).flatten().collect()
}

/// Returns the area of the cloth lying flat and unstretched, square metres: that of its full cells.
pub fn flat_area_m2(mask: &Mask) -> f64 {
    cells(mask).count() as f64 * f64::from(mask.grid().spacing_m).powi(2)
}

/// Writes the cloth as a Wavefront `.obj` text, world frame (z up), metres.
///
/// - `positions`: `[dimy * dimx]` points in grid order; those of missing particles are not read.
///
/// Particles become vertices in grid order, without the missing ones. Texture coordinates run from 0 to 1
/// along +X and +Y of the flat grid, so that an image lies on the cloth as seen from above. Coordinates are
/// written with as many digits as read back to the same bits.
pub fn obj(mask: &Mask, positions: &[[f32; 3]]) -> Result<String, MeshError> {
    let grid = mask.grid();
    if positions.len() != grid.particle_count() {
        return Err(MeshError::WrongCount {
            expected: grid.particle_count(),
            got: positions.len(),
        });
    }
    let mut vertices = String::new();
    let mut texture = String::new();
    let mut vertex_of = vec![0; positions.len()];
    let mut n_vertices = 0;
    for (particle, point) in positions.iter().enumerate() {
        if !mask.has(particle) {
            continue;
        }
        if let Some(&value) = point.iter().find(|value| !value.is_finite()) {
            return Err(MeshError::NonFinite { particle, value });
        }
        n_vertices += 1;
        vertex_of[particle] = n_vertices;
        let [x, y, z] = point;
        line(&mut vertices, format_args!("v {x} {y} {z}"));
        let u = (particle % grid.dimx) as f32 / (grid.dimx - 1) as f32;
        let v = 1.0 - (particle / grid.dimx) as f32 / (grid.dimy - 1) as f32;
        line(&mut texture, format_args!("vt {u} {v}"));
    }
    let mut text = String::from("# Cloth: metres, z up.\no cloth\n");
    text.push_str(&vertices);
    text.push_str(&texture);
    for corners in triangles(mask) {
        let [a, b, c] = corners.map(|corner| vertex_of[corner]);
        line(&mut text, format_args!("f {a}/{a} {b}/{b} {c}/{c}"));
    }
    Ok(text)
}

fn line(text: &mut String, words: std::fmt::Arguments<'_>) {
    writeln!(text, "{words}").expect("writing to a string cannot fail");
}

/// Yields both triangles of every full cell, row by row from the back left.
pub(crate) fn cells(mask: &Mask) -> impl Iterator<Item = [[usize; 3]; 2]> {
    let grid = mask.grid();
    (0..grid.particle_count()).filter_map(move |a| {
        let (ix, iy) = (a % grid.dimx, a / grid.dimx);
        if !mask.has_cell(ix, iy) {
            return None;
        }
        let [b, c, d] = [a + 1, a + grid.dimx + 1, a + grid.dimx];
        Some(if (ix + iy) % 2 == 0 {
            [[a, c, b], [a, d, c]]
        } else {
            [[a, d, b], [b, d, c]]
        })
    })
}
