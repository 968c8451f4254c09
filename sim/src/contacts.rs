//! Contacts with friction: table, other layers of the cloth, the picker's sphere.
//!
//! In: positions, where each particle was when the substep began, pairs in
//! touch. Out: positions corrected once, in place. All contacts look at the same
//! positions, and a particle moves by the mean of what its contacts ask for
//! (Jacobi), so their order has no say beyond rounding.

use crate::params::Params;
use crate::planes::Planes;
use crate::sides::{Side, Sides};
use crate::springs::Direction;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;

// As in `springs`: keeps coincident particles from dividing zero by zero.
const TINY_M2: f32 = 1e-20;
// Particles that one look at the sphere compares with.
const LOOK: usize = 8;
// Pairs that are computed side by side.
const LANES: usize = 8;

/// The picker's sphere during one substep, world frame, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    /// Centre at the end of the substep.
    pub centre: [f32; 3],
    /// Displacement of the centre during the substep.
    pub motion: [f32; 3],
}

/// Pairs in touch during one substep, with all that does not change from sweep to sweep.
///
/// The lists are as long as whole blocks of [`LANES`]; what is beyond `len` counts for nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pairs {
    len: usize,
    /// First and second slots, by rows and by columns.
    by_rows: Ends,
    by_columns: Ends,
    /// From the second to the first particle when the substep began, metres.
    began: Planes,
    /// Share of a correction that each particle moves by: half, or all beside a held one.
    share: Vec<f32>,
}

#[derive(Clone, Debug, Default)]
struct Ends {
    first: Vec<u32>,
    second: Vec<u32>,
}

impl Pairs {
    /// Lists the pairs of one substep instead of those of the last.
    ///
    /// - `pairs`: slots by rows.
    pub fn list(&mut self, pairs: &[[u32; 2]], sides: &Sides) {
        self.len = pairs.len();
        let whole = pairs.len().next_multiple_of(LANES);
        self.by_rows.list(pairs, whole, |slot| slot);
        self.by_columns
            .list(pairs, whole, |slot| sides.turned(slot));
        self.began.resize(whole);
        self.share.resize(whole, 0.0);
        let Side {
            began,
            inverse_mass,
            ..
        } = &sides.rows;
        for (k, &[i, j]) in pairs.iter().enumerate() {
            let (i, j) = (i as usize, j as usize);
            let (a, b) = (began.get(i), began.get(j));
            self.began.set(k, [a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
            // This is 1 / (sum of both inverse masses) for sums of 2 and 1, without a division.
            self.share[k] = 1.5 - 0.5 * (inverse_mass[i] + inverse_mass[j]);
        }
    }
}

impl Ends {
    fn list(&mut self, pairs: &[[u32; 2]], whole: usize, slot: impl Fn(u32) -> u32) {
        self.first.clear();
        self.first.extend(pairs.iter().map(|pair| slot(pair[0])));
        self.first.resize(whole, 0);
        self.second.clear();
        self.second.extend(pairs.iter().map(|pair| slot(pair[1])));
        self.second.resize(whole, 0);
    }
}

/// Accumulates corrections of one pass; kept between passes to save allocations.
#[derive(Clone, Debug)]
pub(crate) struct Contacts {
    shift: Planes,
    count: Vec<f32>,
}

impl Contacts {
    /// Makes room for the corrections of a cloth, whichever side is current.
    pub fn new(sides: &Sides) -> Contacts {
        let n = sides
            .rows
            .positions
            .len()
            .max(sides.columns.positions.len());
        Contacts {
            shift: Planes::zeros(n),
            count: vec![0.0; n],
        }
    }

    /// Pushes every touching particle out once, and drags it by friction.
    ///
    /// - `current`: the direction of the sweep before, which tells on which side the positions are current.
    pub fn resolve(
        &mut self,
        sides: &mut Sides,
        current: Direction,
        pairs: &Pairs,
        sphere: Option<Sphere>,
        params: &Params,
    ) {
        let (side, ends) = match current {
            Direction::Forward => (&mut sides.columns, &pairs.by_columns),
            Direction::Backward => (&mut sides.rows, &pairs.by_rows),
        };
        let Side {
            positions,
            began,
            inverse_mass,
        } = side;
        let keep_m = [
            params.self_contact_m,
            params.self_contact_softness,
            params.self_friction,
        ];
        touch_pairs(
            pairs,
            ends,
            [&positions.x, &positions.y, &positions.z],
            [&mut self.shift.x, &mut self.shift.y, &mut self.shift.z],
            &mut self.count,
            keep_m,
        );
        if let Some(sphere) = sphere {
            self.touch_sphere(positions, began, sphere, params);
        }
        let Planes { x, y, z } = positions;
        let shift = &mut self.shift;
        move_by_mean(
            x,
            y,
            z,
            &began.x,
            &began.y,
            inverse_mass,
            [&mut shift.x[..], &mut shift.y[..], &mut shift.z[..]],
            &mut self.count,
            params,
        );
    }

    fn touch_sphere(
        &mut self,
        positions: &Planes,
        began: &Planes,
        sphere: Sphere,
        params: &Params,
    ) {
        let reach = params.picker_radius_m + params.picker_skin_m;
        let mut from = 0;
        while let Some(i) = first_within(
            &positions.x,
            &positions.y,
            &positions.z,
            from,
            sphere.centre,
            reach,
        ) {
            from = i + 1;
            let p = positions.get(i);
            let push = sphere_push(p, began.get(i), sphere, reach, params.table_friction);
            self.add(i, push);
        }
    }

    #[inline]
    fn add(&mut self, particle: usize, shift: [f32; 3]) {
        self.shift.x[particle] += shift[0];
        self.shift.y[particle] += shift[1];
        self.shift.z[particle] += shift[2];
        self.count[particle] += 1.0;
    }
}

/// Returns the push out of the sphere plus friction of a particle at `p` that was at `p0` when the substep began.
#[inline(always)]
pub(crate) fn sphere_push(
    p: [f32; 3],
    p0: [f32; 3],
    sphere: Sphere,
    reach: f32,
    friction: f32,
) -> [f32; 3] {
    let out = [
        p[0] - sphere.centre[0],
        p[1] - sphere.centre[1],
        p[2] - sphere.centre[2],
    ];
    let distance = (dot(out, out) + TINY_M2).sqrt();
    let per_distance = 1.0 / distance;
    let normal = out.map(|d| d * per_distance);
    let slid = [
        p[0] - p0[0] - sphere.motion[0],
        p[1] - p0[1] - sphere.motion[1],
        p[2] - p0[2] - sphere.motion[2],
    ];
    correction(normal, reach - distance, slid, friction)
}

/// Returns the push out of a contact plus Coulomb friction: at most `friction * depth` against the sliding.
#[inline(always)]
fn correction(normal: [f32; 3], depth: f32, slid: [f32; 3], friction: f32) -> [f32; 3] {
    let along_normal = dot(slid, normal);
    let tangent = [
        slid[0] - along_normal * normal[0],
        slid[1] - along_normal * normal[1],
        slid[2] - along_normal * normal[2],
    ];
    let length = (dot(tangent, tangent) + TINY_M2).sqrt();
    let share = friction * depth / length;
    let share = if share < 1.0 { share } else { 1.0 };
    [
        depth * normal[0] - share * tangent[0],
        depth * normal[1] - share * tangent[1],
        depth * normal[2] - share * tangent[2],
    ]
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Adds what every pair in touch asks of its particles, all looking at the same positions.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn touch_pairs(
    pairs: &Pairs,
    ends: &Ends,
    positions: [&[f32]; 3],
    shifts: [&mut [f32]; 3],
    count: &mut [f32],
    [contact_m, softness, friction]: [f32; 3],
) {
    let [x, y, z] = positions;
    let n = x.len();
    let (y, z, count) = (&y[..n], &z[..n], &mut count[..n]);
    let [shift_x, shift_y, shift_z] = shifts;
    let (shift_x, shift_y, shift_z) = (&mut shift_x[..n], &mut shift_y[..n], &mut shift_z[..n]);
    let blocks = ends
        .first
        .chunks_exact(LANES)
        .zip(ends.second.chunks_exact(LANES));
    for (block, (first, second)) in blocks.enumerate() {
        let from = block * LANES;
        let range = from..from + LANES;
        let x0 = &pairs.began.x[range.clone()];
        let y0 = &pairs.began.y[range.clone()];
        let z0 = &pairs.began.z[range.clone()];
        let shares = &pairs.share[range];
        let (mut dx, mut dy, mut dz) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let (i, j) = (first[k] as usize, second[k] as usize);
            dx[k] = x[i] - x[j];
            dy[k] = y[i] - y[j];
            dz[k] = z[i] - z[j];
        }
        let mut distance_2 = [0.0; LANES];
        for k in 0..LANES {
            distance_2[k] = dx[k] * dx[k] + dy[k] * dy[k] + dz[k] * dz[k] + TINY_M2;
        }
        let (mut push_x, mut push_y, mut push_z) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let distance = distance_2[k].sqrt();
            let depth = softness * (contact_m - distance);
            let per_distance = 1.0 / distance;
            let normal = [
                dx[k] * per_distance,
                dy[k] * per_distance,
                dz[k] * per_distance,
            ];
            let slid = [dx[k] - x0[k], dy[k] - y0[k], dz[k] - z0[k]];
            let push = correction(normal, depth, slid, friction);
            push_x[k] = shares[k] * push[0];
            push_y[k] = shares[k] * push[1];
            push_z[k] = shares[k] * push[2];
        }
        for k in 0..LANES.min(pairs.len - from) {
            if distance_2[k] < contact_m * contact_m {
                let (i, j) = (first[k] as usize, second[k] as usize);
                shift_x[i] += push_x[k];
                shift_y[i] += push_y[k];
                shift_z[i] += push_z[k];
                count[i] += 1.0;
                shift_x[j] -= push_x[k];
                shift_y[j] -= push_y[k];
                shift_z[j] -= push_z[k];
                count[j] += 1.0;
            }
        }
    }
}

/// Returns the first particle from `from` on that is nearer to the centre than `reach`.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
pub(crate) fn first_within(
    x: &[f32],
    y: &[f32],
    z: &[f32],
    from: usize,
    centre: [f32; 3],
    reach: f32,
) -> Option<usize> {
    let within = |i: usize| {
        let (dx, dy, dz) = (x[i] - centre[0], y[i] - centre[1], z[i] - centre[2]);
        dx * dx + dy * dy + dz * dz + TINY_M2 < reach * reach
    };
    let n = x.len();
    let (y, z) = (&y[..n], &z[..n]);
    let mut start = from;
    while start + LOOK <= n {
        let (xs, ys, zs) = (
            &x[start..start + LOOK],
            &y[start..start + LOOK],
            &z[start..start + LOOK],
        );
        let mut any = false;
        for k in 0..LOOK {
            let (dx, dy, dz) = (xs[k] - centre[0], ys[k] - centre[1], zs[k] - centre[2]);
            any |= dx * dx + dy * dy + dz * dz + TINY_M2 < reach * reach;
        }
        if any {
            break;
        }
        start += LOOK;
    }
    (start..n).find(|&i| within(i))
}

/// Table contact of one particle: how far it has to rise, and to go back by friction.
#[inline(always)]
fn table_contact(x: f32, y: f32, z: f32, x0: f32, y0: f32, height: f32, friction: f32) -> [f32; 3] {
    let below = height - z;
    let depth = if below > 0.0 { below } else { 0.0 };
    let (slid_x, slid_y) = (x - x0, y - y0);
    let slid = (slid_x * slid_x + slid_y * slid_y + TINY_M2).sqrt();
    let share = friction * depth / slid;
    let share = if share < 1.0 { share } else { 1.0 };
    [-share * slid_x, -share * slid_y, depth]
}

/// Adds the table's contact to the shifts of the others, moves by their mean, and clears them.
// Separate slices, so that the compiler knows that they do not overlap.
#[allow(clippy::too_many_arguments)]
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn move_by_mean(
    x: &mut [f32],
    y: &mut [f32],
    z: &mut [f32],
    x0: &[f32],
    y0: &[f32],
    inverse_mass: &[f32],
    shifts: [&mut [f32]; 3],
    count: &mut [f32],
    params: &Params,
) {
    let n = x.len();
    let (y, z, inverse_mass) = (&mut y[..n], &mut z[..n], &inverse_mass[..n]);
    let (x0, y0, count) = (&x0[..n], &y0[..n], &mut count[..n]);
    let [sx, sy, sz] = shifts;
    let (sx, sy, sz) = (&mut sx[..n], &mut sy[..n], &mut sz[..n]);
    let (height, friction) = (params.table_contact_m, params.table_friction);
    for i in 0..n {
        let shift = table_contact(x[i], y[i], z[i], x0[i], y0[i], height, friction);
        let contacts = count[i] + if shift[2] > 0.0 { 1.0 } else { 0.0 };
        let contacts = if contacts > 1.0 { contacts } else { 1.0 };
        let share = inverse_mass[i] / contacts;
        x[i] += share * (sx[i] + shift[0]);
        y[i] += share * (sy[i] + shift[1]);
        z[i] += share * (sz[i] + shift[2]);
        sx[i] = 0.0;
        sy[i] = 0.0;
        sz[i] = 0.0;
        count[i] = 0.0;
    }
}
