//! Resistance of cells to shear: springs along both diagonals.
//!
//! In: positions, padded. Out: accelerations, added to those of bending. A cell that bends along a diagonal makes both
//! shorter, so both may be shorter by [`SLACK`], and only their difference counts there. All springs are taken at the same
//! positions, so that no direction of the grid comes before another. (Sweeps that pulled one diagonal after the other
//! carried what was left over along the grid: folds from the back slid open where those from the front held.)

use crate::layout::Layout;
use crate::material::MOST_SHEAR;
use crate::planes::Planes;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;

// Share of the spacing by which both diagonals of a cell may be too short: those of one whose edges keep their length while
// it bends by 0.6 radians. Without any, cloth is too stiff on the bias. Without an end of it, cells fold up, and layers
// pass through each other four times as often.
const SLACK: f32 = 0.02;
const TINY_M2: f32 = 1e-20;

/// The diagonals of one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Shear {
    stride: usize,
    rest_m: f32,
    /// Acceleration per length error, 1/s^2.
    stiffness: f32,
    /// By slot: 1 where the diagonal from it to the next row's right neighbour is there, and the one from the slot
    /// to its right to the next row's.
    there: [Vec<f32>; 2],
    /// By slot: how much both diagonals may be shorter, metres; nothing where one is alone.
    slack_m: Vec<f32>,
    /// What each diagonal pulls its first end by, padded.
    pulls: [Planes; 2],
}

impl Shear {
    /// Lists the diagonals of a cloth.
    ///
    /// - `stiffness`: acceleration per length error of a diagonal, 1/s^2.
    pub fn new(layout: &Layout, stiffness: f32) -> Shear {
        let (n, stride) = (layout.len(), layout.stride());
        let present = |slot: usize| slot < n && layout.is_present(slot);
        let there = |slot: usize, [from, to]: [usize; 2]| {
            let is_cell = slot % stride + 1 < layout.grid().dimx;
            is_cell && present(slot + from) && present(slot + to)
        };
        let (down, up) = ([0, stride + 1], [1, stride]);
        let marks = |ends| {
            let mark = |slot| if there(slot, ends) { 1.0 } else { 0.0 };
            (0..n).map(mark).collect()
        };
        let slack_m = SLACK * layout.grid().spacing_m;
        let slack = |slot| {
            let is_whole = there(slot, down) && there(slot, up);
            if is_whole { slack_m } else { 0.0 }
        };
        let padded = n + 2 * (stride + 1);
        Shear {
            stride,
            rest_m: std::f32::consts::SQRT_2 * layout.grid().spacing_m,
            stiffness,
            there: [marks(down), marks(up)],
            slack_m: (0..n).map(slack).collect(),
            pulls: std::array::from_fn(|_| Planes::zeros(padded)),
        }
    }

    /// Returns the number of diagonals.
    pub fn count(&self) -> usize {
        let there = self.there.iter().flatten();
        there.filter(|&&there| there > 0.0).count()
    }

    /// Adds the accelerations of all diagonals, m/s^2.
    ///
    /// - `points`: positions after `stride + 1` values of padding, as [`Bending`](crate::bending::Bending) keeps them.
    /// - `dt`: the substep, which bounds the stiffness.
    pub fn accelerate(&mut self, points: &Planes, dt: f32, to: &mut Planes) {
        let pad = self.stride + 1;
        let stiffness = self.stiffness.min(MOST_SHEAR / (dt * dt));
        let corners = [0, pad, 1, self.stride].map(|ahead| {
            let Planes { x, y, z } = points;
            [x, y, z].map(|plane| &plane[pad + ahead..])
        });
        let n = self.slack_m.len();
        let pulls = self
            .pulls
            .each_mut()
            .map(|Planes { x, y, z }| [x, y, z].map(|plane| &mut plane[pad..pad + n]));
        let [down, up] = &self.there;
        let marks = [down, up, &self.slack_m].map(Vec::as_slice);
        pull(corners, marks, pulls, [stiffness, self.rest_m]);
        let [down, up] = &self.pulls;
        gather([&down.x, &up.x], [pad, self.stride], &mut to.x);
        gather([&down.y, &up.y], [pad, self.stride], &mut to.y);
        gather([&down.z, &up.z], [pad, self.stride], &mut to.z);
    }
}

/// Writes what the diagonals of each cell pull their first ends by.
///
/// - `corners`: both ends of one diagonal, and both of the other.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn pull(
    corners: [[&[f32]; 3]; 4],
    [down, up, slack_m]: [&[f32]; 3],
    [[dx, dy, dz], [ux, uy, uz]]: [[&mut [f32]; 3]; 2],
    [stiffness, rest_m]: [f32; 2],
) {
    let n = down.len();
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz], [ex, ey, ez]] =
        corners.map(|corner| corner.map(|plane| &plane[..n]));
    let (up, slack_m) = (&up[..n], &slack_m[..n]);
    let (dx, dy, dz) = (&mut dx[..n], &mut dy[..n], &mut dz[..n]);
    let (ux, uy, uz) = (&mut ux[..n], &mut uy[..n], &mut uz[..n]);
    for i in 0..n {
        let one = [bx[i] - ax[i], by[i] - ay[i], bz[i] - az[i]];
        let other = [ex[i] - cx[i], ey[i] - cy[i], ez[i] - cz[i]];
        let [length, other_length] =
            [one, other].map(|[x, y, z]| (x * x + y * y + z * z + TINY_M2).sqrt());
        let (differ, both) = (
            0.5 * (length - other_length),
            0.5 * (length + other_length) - rest_m,
        );
        let beyond = both + slack_m[i];
        let short = if beyond < 0.0 { beyond } else { 0.0 };
        let both = if both > 0.0 { both } else { short };
        let pull = stiffness * down[i] * (both + differ) / length;
        dx[i] = pull * one[0];
        dy[i] = pull * one[1];
        dz[i] = pull * one[2];
        let pull = stiffness * up[i] * (both - differ) / other_length;
        ux[i] = pull * other[0];
        uy[i] = pull * other[1];
        uz[i] = pull * other[2];
    }
}

/// Adds up one coordinate of what the diagonals at each particle pull.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn gather([down, up]: [&[f32]; 2], [pad, stride]: [usize; 2], to: &mut [f32]) {
    let n = to.len();
    let (d, ending) = (&down[pad..][..n], &down[pad - stride - 1..][..n]);
    let (u, up_ending) = (&up[pad - 1..][..n], &up[pad - stride..][..n]);
    for i in 0..n {
        to[i] += (d[i] - ending[i]) + (u[i] - up_ending[i]);
    }
}
