//! Resistance to bending, and creases.
//!
//! In: positions and velocities. Out: the acceleration of every particle. On a regular grid the curvature along a
//! thread is a second difference of positions, and the twist of a cell a mixed one (an orthotropic plate), so that
//! moments and forces are sums over neighbouring slots, and no list of hinges exists. Moments grow with the angle
//! between edges up to a right angle, and fall to nothing for a fold that is pressed together.
//!
//! A crease is a rest curvature that is not zero. It follows the bend at a distance, which is internal friction: see [`Friction`].

use crate::layout::{LANES, Layout};
use crate::planes::Planes;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;
use std::f32::consts::PI;

// Keeps coincident particles from dividing zero by zero.
const TINY: f32 = 1e-20;
// Where a bend is much smaller than this, in spacings, its direction is that of the surface's normal.
const BY_NORMAL: f32 = 0.2;
// Share of the present bend by which a crease keeps its side where the normal is uncertain.
const KEEPS_SIDE: f32 = 0.2;

/// How far a bend may be from its rest, and how much of it then stays; bends are angles between edges, radians.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Friction {
    /// Bend up to which a flat cloth springs back wholly.
    pub elastic: f32,
    /// Share of a bend beyond it that stays.
    pub stays: f32,
    /// Farthest that any bend may be from its rest.
    pub farthest: f32,
}

impl Friction {
    /// Converts a crease recovery angle; `None` for a cloth that recovers wholly.
    ///
    /// A fold that is pressed flat bends the cloth at one row of particles by half a turn, or at two by a quarter
    /// each. What stays is right for the mean of both.
    ///
    /// - `spacing_m`: sets which curvature is gentle.
    pub fn new(recovery_deg: f32, spacing_m: f32) -> Option<Friction> {
        let kept = 1.0 - recovery_deg / 180.0;
        if kept <= 0.0 {
            return None;
        }
        let elastic = (GENTLE_PER_M * spacing_m).min(0.5);
        let stays = (kept * PI / (PI - 1.5 * elastic)).min(0.98);
        Some(Friction {
            elastic,
            stays,
            farthest: PI - stays * (PI - elastic),
        })
    }
}

/// Curvature that leaves no crease, 1/m: the residual curvatures of woven cloths (KES: hysteresis by rigidity,
/// 2HB / 2B) lie between 20 and 60.
pub(crate) const GENTLE_PER_M: f32 = 40.0;

/// Bending of one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Bending {
    stride: usize,
    spacing_m: f32,
    /// Acceleration per difference: warp, weft, twist.
    stiffness: [f32; 3],
    friction: Option<Friction>,
    /// By slot: 1 where the neighbour left, right, behind, in front is there.
    near: [Vec<f32>; 4],
    /// By slot: 1 where the cell to the right and in front is whole.
    cell: Vec<f32>,
    /// Rest bends, radians, signed by the side of the cloth that they bend to.
    rest: [Vec<f32>; 3],
    /// Moments of the rest bends: those that the present bend is pulled towards.
    set: [Planes; 3],
    /// Padded by [`Bending::pad`] on both ends.
    points: Planes,
    moments: [Planes; 3],
    acceleration: Planes,
}

impl Bending {
    /// Makes a cloth without creases.
    pub fn new(layout: &Layout, stiffness: [f32; 3], friction: Option<Friction>) -> Bending {
        let (n, stride) = (layout.len(), layout.stride());
        let columns = layout.grid().dimx;
        let there = |slot: usize, ahead: isize| {
            let other = slot as isize + ahead;
            let is_one =
                |slot: isize| slot >= 0 && (slot as usize) < n && layout.is_present(slot as usize);
            // The end of a row is no neighbour of the next one's beginning.
            let wraps =
                ahead.unsigned_abs() == 1 && slot / stride != (other.max(0) as usize) / stride;
            is_one(slot as isize) && is_one(other) && !wraps
        };
        let row = stride as isize;
        let near = [-1, 1, -row, row].map(|ahead| {
            let mark = |slot| if there(slot, ahead) { 1.0 } else { 0.0 };
            (0..n).map(mark).collect()
        });
        let whole = |slot: usize| {
            let right = there(slot, 1) && there(slot, row);
            right && there(slot + 1, row) && slot % stride + 1 < columns
        };
        let pad = stride + 1;
        Bending {
            stride,
            spacing_m: layout.grid().spacing_m,
            stiffness,
            friction,
            near,
            cell: (0..n)
                .map(|slot| if whole(slot) { 1.0 } else { 0.0 })
                .collect(),
            rest: std::array::from_fn(|_| vec![0.0; n]),
            set: std::array::from_fn(|_| Planes::zeros(n)),
            points: Planes::zeros(n + 2 * pad),
            moments: std::array::from_fn(|_| Planes::zeros(n + 2 * pad)),
            acceleration: Planes::zeros(n),
        }
    }

    fn pad(&self) -> usize {
        self.stride + 1
    }

    /// Returns the rest bends by slot: along warp and weft, and of twist.
    pub fn rest(&self) -> &[Vec<f32>; 3] {
        &self.rest
    }

    /// Replaces the rest bends.
    pub fn set_rest(&mut self, rest: [Vec<f32>; 3]) {
        self.rest = rest;
    }

    /// Lets creases follow the bends as they are.
    ///
    /// - `share`: how much of what they are too far behind they make up for.
    pub fn crease(&mut self, positions: &Planes, share: f32) {
        let Some(friction) = self.friction else {
            return;
        };
        self.write_points(positions, positions, 0.0);
        let pad = self.pad();
        let [x, y, z] = [&self.points.x, &self.points.y, &self.points.z].map(Vec::as_slice);
        let ways = [pad, self.stride];
        let [left, right, back, front] = &self.near;
        let near = [left, right, back, front].map(Vec::as_slice);
        let [there_warp, there_weft] = [near_both(left, right), near_both(back, front)];
        let families = [
            (Bend::Warp, &there_warp),
            (Bend::Weft, &there_weft),
            (Bend::Twist, &self.cell),
        ];
        for (((bend, there), rest), set) in
            families.into_iter().zip(&mut self.rest).zip(&mut self.set)
        {
            crease_slots(
                [x, y, z],
                ways,
                near,
                bend,
                there,
                rest,
                &mut set.x,
                &mut set.y,
                &mut set.z,
                [self.spacing_m, share],
                friction,
            );
        }
    }

    /// Returns the acceleration by bending, by slot, m/s^2.
    ///
    /// - `lead_secs`: bends are taken where the velocities lead to in this time, which damps them.
    pub fn accelerate(
        &mut self,
        positions: &Planes,
        velocities: &Planes,
        lead_secs: f32,
    ) -> &Planes {
        self.write_points(positions, velocities, lead_secs);
        let ways = [self.pad(), self.stride];
        let per_2 = 1.0 / (self.spacing_m * self.spacing_m);
        {
            let [warp, weft, twist] = &mut self.moments;
            let Planes { x, y, z } = &self.points;
            moments(
                [x, y, z],
                ways,
                [&self.near[0], &self.near[1], &self.near[2], &self.near[3]],
                &self.cell,
                &self.set,
                [warp, weft, twist],
                self.stiffness,
                per_2,
            );
        }
        let [warp, weft, twist] = &self.moments;
        let Planes { x, y, z } = &mut self.acceleration;
        gather([&warp.x, &weft.x, &twist.x], ways, x);
        gather([&warp.y, &weft.y, &twist.y], ways, y);
        gather([&warp.z, &weft.z, &twist.z], ways, z);
        &self.acceleration
    }

    fn write_points(&mut self, positions: &Planes, velocities: &Planes, lead_secs: f32) {
        let pad = self.pad();
        let n = positions.len();
        let Planes { x, y, z } = &mut self.points;
        lead(&mut x[pad..pad + n], &positions.x, &velocities.x, lead_secs);
        lead(&mut y[pad..pad + n], &positions.y, &velocities.y, lead_secs);
        lead(&mut z[pad..pad + n], &positions.z, &velocities.z, lead_secs);
    }
}

fn near_both(a: &[f32], b: &[f32]) -> Vec<f32> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Bend {
    Warp,
    Weft,
    Twist,
}

#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn lead(to: &mut [f32], position: &[f32], velocity: &[f32], secs: f32) {
    for ((to, position), velocity) in to.iter_mut().zip(position).zip(velocity) {
        *to = position + secs * velocity;
    }
}

/// Returns how much faster than the second difference the moment grows: the angle by its sine, as far as a right
/// angle; `square` is the second difference squared, in spacings.
#[inline(always)]
fn growth(square: f32) -> f32 {
    let q = if square < 2.0 { square } else { 2.0 };
    1.0 + q * (1.0 / 6.0 + q * (1.0 / 30.0))
}

/// Writes the moments of all bends, padded.
// Separate slices, so that the compiler knows that they do not overlap.
#[allow(clippy::too_many_arguments)]
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn moments(
    points: [&[f32]; 3],
    [pad, stride]: [usize; 2],
    near: [&[f32]; 4],
    cell: &[f32],
    set: &[Planes; 3],
    moments: [&mut Planes; 3],
    [k_warp, k_weft, k_twist]: [f32; 3],
    per_2: f32,
) {
    let n = cell.len();
    let [left, right, back, front] = near.map(|marks| &marks[..n]);
    let [wx, wy, wz] = [&set[0].x[..n], &set[0].y[..n], &set[0].z[..n]];
    let [fx, fy, fz] = [&set[1].x[..n], &set[1].y[..n], &set[1].z[..n]];
    let [tx, ty, tz] = [&set[2].x[..n], &set[2].y[..n], &set[2].z[..n]];
    let [warp, weft, twist] = moments;
    let (mwx, mwy, mwz) = (
        &mut warp.x[pad..pad + n],
        &mut warp.y[pad..pad + n],
        &mut warp.z[pad..pad + n],
    );
    let (mfx, mfy, mfz) = (
        &mut weft.x[pad..pad + n],
        &mut weft.y[pad..pad + n],
        &mut weft.z[pad..pad + n],
    );
    let (mtx, mty, mtz) = (
        &mut twist.x[pad..pad + n],
        &mut twist.y[pad..pad + n],
        &mut twist.z[pad..pad + n],
    );
    let [x, y, z] = points;
    let (cx, cy, cz) = (&x[pad..][..n], &y[pad..][..n], &z[pad..][..n]);
    let (lx, ly, lz) = (&x[pad - 1..][..n], &y[pad - 1..][..n], &z[pad - 1..][..n]);
    let (rx, ry, rz) = (&x[pad + 1..][..n], &y[pad + 1..][..n], &z[pad + 1..][..n]);
    let (bx, by, bz) = (
        &x[pad - stride..][..n],
        &y[pad - stride..][..n],
        &z[pad - stride..][..n],
    );
    let (ax, ay, az) = (
        &x[pad + stride..][..n],
        &y[pad + stride..][..n],
        &z[pad + stride..][..n],
    );
    let (dx, dy, dz) = (
        &x[pad + stride + 1..][..n],
        &y[pad + stride + 1..][..n],
        &z[pad + stride + 1..][..n],
    );
    bend_threads(
        [cx, cy, cz],
        [[lx, ly, lz], [rx, ry, rz]],
        [left, right],
        [wx, wy, wz],
        [mwx, mwy, mwz],
        [k_warp, per_2],
    );
    bend_threads(
        [cx, cy, cz],
        [[bx, by, bz], [ax, ay, az]],
        [back, front],
        [fx, fy, fz],
        [mfx, mfy, mfz],
        [k_weft, per_2],
    );
    for i in 0..n {
        let k = k_twist * cell[i];
        mtx[i] = k * (cx[i] - rx[i] + (dx[i] - ax[i]) - tx[i]);
        mty[i] = k * (cy[i] - ry[i] + (dy[i] - ay[i]) - ty[i]);
        mtz[i] = k * (cz[i] - rz[i] + (dz[i] - az[i]) - tz[i]);
    }
}

/// Writes the moments of the bends along one of both threads.
///
/// - `ends`: the neighbours before and behind of each particle of `at`, and in `there` whether they exist.
/// - `set`: moments of the rest bends, divided by the stiffness.
#[inline(always)]
fn bend_threads(
    at: [&[f32]; 3],
    ends: [[&[f32]; 3]; 2],
    there: [&[f32]; 2],
    set: [&[f32]; 3],
    [mx, my, mz]: [&mut [f32]; 3],
    [stiffness, per_2]: [f32; 2],
) {
    let n = mx.len();
    let ([x, y, z], [[x0, y0, z0], [x1, y1, z1]]) = (at, ends);
    for i in 0..n {
        let (ux, uy, uz) = (
            x0[i] - x[i] + (x1[i] - x[i]),
            y0[i] - y[i] + (y1[i] - y[i]),
            z0[i] - z[i] + (z1[i] - z[i]),
        );
        let k = stiffness * there[0][i] * there[1][i];
        let s = k * growth(per_2 * (ux * ux + uy * uy + uz * uz));
        mx[i] = s * ux - k * set[0][i];
        my[i] = s * uy - k * set[1][i];
        mz[i] = s * uz - k * set[2][i];
    }
}

/// Adds up one coordinate of what the moments around each particle ask of it.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn gather([warp, weft, twist]: [&[f32]; 3], [pad, stride]: [usize; 2], to: &mut [f32]) {
    let n = to.len();
    let (w, wl, wr) = (
        &warp[pad..][..n],
        &warp[pad - 1..][..n],
        &warp[pad + 1..][..n],
    );
    let (f, fb, fa) = (
        &weft[pad..][..n],
        &weft[pad - stride..][..n],
        &weft[pad + stride..][..n],
    );
    let (t, tl) = (&twist[pad..][..n], &twist[pad - 1..][..n]);
    let (tb, td) = (&twist[pad - stride..][..n], &twist[pad - stride - 1..][..n]);
    for i in 0..n {
        let along = wl[i] - w[i] + (wr[i] - w[i]);
        let across = fb[i] - f[i] + (fa[i] - f[i]);
        let twisted = t[i] - tl[i] + (td[i] - tb[i]);
        to[i] = -(along + across + twisted);
    }
}

/// Returns the angle between two edges of length 1 from their difference, radians: twice the arc sine of its half
/// (Abramowitz and Stegun 1964, 4.4.45).
#[inline(always)]
fn angle(difference: f32) -> f32 {
    let x = 0.5 * difference;
    let x = if x < 1.0 { x } else { 1.0 };
    let series = 1.570_728_8 + x * (-0.212_114_4 + x * (0.074_261 - 0.018_729_3 * x));
    2.0 * (0.5 * PI - (1.0 - x).sqrt() * series)
}

/// Returns the difference between two edges of length 1 from their angle, at most half a turn: twice the sine of its half.
#[inline(always)]
fn difference(angle: f32) -> f32 {
    let x = 0.5 * angle;
    let q = x * x;
    2.0 * x * (1.0 - q * (1.0 / 6.0 - q * (1.0 / 120.0 - q * (1.0 / 5040.0))))
}

/// Lets the rest bends of one family follow, and writes their moments divided by the stiffness.
// Separate slices, so that the compiler knows that they do not overlap.
#[allow(clippy::too_many_arguments)]
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn crease_slots(
    [x, y, z]: [&[f32]; 3],
    [pad, stride]: [usize; 2],
    near: [&[f32]; 4],
    bend: Bend,
    there: &[f32],
    rest: &mut [f32],
    sx: &mut [f32],
    sy: &mut [f32],
    sz: &mut [f32],
    [spacing_m, follows]: [f32; 2],
    friction: Friction,
) {
    let per = 1.0 / spacing_m;
    let (is_warp, is_twist) = (bend == Bend::Warp, bend == Bend::Twist);
    let steep = friction.farthest / friction.elastic;
    let (elastic, stays, farthest) = (friction.elastic, friction.stays, friction.farthest);
    // The least rest of a bend; the greatest is that of the bend to the other side.
    let least = |bend: f32| {
        let beyond = bend - elastic;
        let slope = if beyond > 0.0 { stays } else { steep };
        let rest = slope * beyond;
        let free = bend - farthest;
        if rest > free { rest } else { free }
    };
    let sets = (sx.as_chunks_mut::<LANES>().0.iter_mut())
        .zip(sy.as_chunks_mut::<LANES>().0)
        .zip(sz.as_chunks_mut::<LANES>().0);
    let rests = rest
        .as_chunks_mut::<LANES>()
        .0
        .iter_mut()
        .zip(sets)
        .enumerate();
    for (block, (rest, ((sx, sy), sz))) in rests {
        let from = block * LANES;
        let there = lanes(there, from);
        let (left, right) = (lanes(near[0], from), lanes(near[1], from));
        let (back, front) = (lanes(near[2], from), lanes(near[3], from));
        let all = |from: usize| [lanes(x, from), lanes(y, from), lanes(z, from)];
        let from = from + pad;
        let (c, l, r) = (all(from), all(from - 1), all(from + 1));
        let (b, a, d) = (
            all(from - stride),
            all(from + stride),
            all(from + stride + 1),
        );
        // Written at once when all lanes are known, so that the compiler sees that they do not depend on each other.
        let mut new = [*rest, *sx, *sy, *sz];
        for k in 0..LANES {
            let mut u = [0.0; 3];
            let mut along = [0.0; 3];
            let mut across = [0.0; 3];
            for axis in 0..3 {
                let (c, l, r) = (c[axis][k], l[axis][k], r[axis][k]);
                let (b, a, d) = (b[axis][k], a[axis][k], d[axis][k]);
                let straight = if is_warp {
                    l - c + (r - c)
                } else {
                    b - c + (a - c)
                };
                u[axis] = per * if is_twist { c - r + (d - a) } else { straight };
                along[axis] = per
                    * if is_twist {
                        r - a
                    } else {
                        left[k] * (c - l) + right[k] * (r - c)
                    };
                across[axis] = per
                    * if is_twist {
                        d - c
                    } else {
                        back[k] * (c - b) + front[k] * (a - c)
                    };
            }
            let normal = [
                along[1] * across[2] - along[2] * across[1],
                along[2] * across[0] - along[0] * across[2],
                along[0] * across[1] - along[1] * across[0],
            ];
            let normal_2 = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
            let per_normal = 1.0 / (normal_2 + TINY).sqrt();
            let size = (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]).sqrt();
            let up = (u[0] * normal[0] + u[1] * normal[1] + u[2] * normal[2]) * per_normal;
            let before = new[0][k];
            let bias = if before > 0.0 {
                KEEPS_SIDE
            } else if before < 0.0 {
                -KEEPS_SIDE
            } else {
                0.0
            };
            let side = if up + bias * size < 0.0 { -1.0 } else { 1.0 };
            let now = side * angle(size);
            let low = least(now);
            let high = -least(-now);
            let kept = if before < low { low } else { before };
            let kept = if kept > high { high } else { kept };
            let kept = (before + follows * (kept - before)) * there[k];
            let difference = difference(kept);
            let grown = if is_twist {
                difference
            } else {
                difference * growth(difference * difference)
            };
            let way = [
                side * u[0] + BY_NORMAL * normal[0] * per_normal,
                side * u[1] + BY_NORMAL * normal[1] * per_normal,
                side * u[2] + BY_NORMAL * normal[2] * per_normal,
            ];
            let way_2 = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
            let share = spacing_m * grown / (way_2 + TINY).sqrt();
            new[0][k] = kept;
            new[1][k] = share * way[0];
            new[2][k] = share * way[1];
            new[3][k] = share * way[2];
        }
        [*rest, *sx, *sy, *sz] = new;
    }
}

/// Returns the values of a plane from a slot on.
#[inline(always)]
fn lanes(plane: &[f32], from: usize) -> [f32; LANES] {
    std::array::from_fn(|k| plane[from..from + LANES][k])
}
