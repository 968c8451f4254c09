//! Resistance of cells to shear: springs along both diagonals.
//!
//! In: positions, padded. Out: accelerations, added to those of bending. All springs are taken at the same positions, so
//! that no direction of the grid comes before another. (Sweeps that pulled one diagonal after the other carried what
//! was left over along the grid: folds from the back slid open where those from the front held.)

use crate::layout::Layout;
use crate::planes::Planes;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;

// Most of a spring's length error that each of its ends gives back in a substep. The diagonals of a cell that is folded up work on
// the same particles along the same line: taken a quarter of a substep ahead, as bends are, their step is stable up to
// a third. At 0.6, silk trembled so much that folds slid open.
const MOST: f32 = 0.33;
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
    /// What each diagonal pulls its first end by, padded.
    pulls: [Planes; 2],
}

impl Shear {
    /// Lists the diagonals of a cloth.
    ///
    /// - `compliance`: length error by acceleration, s^2.
    pub fn new(layout: &Layout, compliance: f32) -> Shear {
        let (n, stride) = (layout.len(), layout.stride());
        let present = |slot: usize| slot < n && layout.is_present(slot);
        let marks = |from: usize, to: usize| {
            let mark = |slot: usize| {
                let is_cell = slot % stride + 1 < layout.grid().dimx;
                let there = is_cell && present(slot + from) && present(slot + to);
                if there { 1.0 } else { 0.0 }
            };
            (0..n).map(mark).collect()
        };
        let padded = n + 2 * (stride + 1);
        Shear {
            stride,
            rest_m: std::f32::consts::SQRT_2 * layout.grid().spacing_m,
            stiffness: 1.0 / compliance,
            there: [marks(0, stride + 1), marks(1, stride)],
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
        let stiffness = self.stiffness.min(MOST / (dt * dt));
        let Planes { x, y, z } = points;
        let ends = [[0, pad], [1, self.stride]];
        for ((there, pulls), [from, end]) in self.there.iter().zip(&mut self.pulls).zip(ends) {
            let [from, end] = [from, end].map(|ahead| {
                let begin = pad + ahead;
                [&x[begin..], &y[begin..], &z[begin..]]
            });
            let n = there.len();
            let Planes { x, y, z } = pulls;
            let pulls = [x, y, z].map(|plane| &mut plane[pad..pad + n]);
            pull(from, end, there, pulls, [stiffness, self.rest_m]);
        }
        let [down, up] = &self.pulls;
        gather([&down.x, &up.x], [pad, self.stride], &mut to.x);
        gather([&down.y, &up.y], [pad, self.stride], &mut to.y);
        gather([&down.z, &up.z], [pad, self.stride], &mut to.z);
    }
}

/// Writes what each diagonal pulls its first end by.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn pull(
    [ax, ay, az]: [&[f32]; 3],
    [bx, by, bz]: [&[f32]; 3],
    there: &[f32],
    [px, py, pz]: [&mut [f32]; 3],
    [stiffness, rest_m]: [f32; 2],
) {
    let n = there.len();
    let (ax, ay, az) = (&ax[..n], &ay[..n], &az[..n]);
    let (bx, by, bz) = (&bx[..n], &by[..n], &bz[..n]);
    let (px, py, pz) = (&mut px[..n], &mut py[..n], &mut pz[..n]);
    for i in 0..n {
        let (dx, dy, dz) = (bx[i] - ax[i], by[i] - ay[i], bz[i] - az[i]);
        let length = (dx * dx + dy * dy + dz * dz + TINY_M2).sqrt();
        let pull = stiffness * there[i] * (1.0 - rest_m / length);
        px[i] = pull * dx;
        py[i] = pull * dy;
        pz[i] = pull * dz;
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
