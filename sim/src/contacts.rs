//! Contacts with friction: table, other layers of the cloth, the picker's sphere.
//!
//! In: positions, where each particle was when the substep began, pairs in
//! touch. Out: positions corrected once, in place. All contacts look at the same
//! positions, and a particle moves by the mean of what its contacts ask for
//! (Jacobi), so their order has no say beyond rounding.

use crate::neighbours::Pair;
use crate::params::Params;
use crate::planes::Planes;

// As in `springs`: keeps coincident particles from dividing zero by zero.
const TINY_M2: f32 = 1e-20;

/// The picker's sphere during one substep, world frame, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    /// Centre at the end of the substep.
    pub centre: [f32; 3],
    /// Displacement of the centre during the substep.
    pub motion: [f32; 3],
}

/// Accumulates corrections of one pass; kept between passes to save allocations.
#[derive(Clone, Debug)]
pub(crate) struct Contacts {
    shift: Planes,
    count: Vec<f32>,
}

impl Contacts {
    /// Makes room for the corrections of `n_particles`.
    pub fn new(n_particles: usize) -> Contacts {
        Contacts {
            shift: Planes::zeros(n_particles),
            count: vec![0.0; n_particles],
        }
    }

    /// Pushes every touching particle out once, and drags it by friction.
    ///
    /// - `began`: positions at the start of the substep; friction opposes the displacement since then.
    /// - `inverse_mass`: 1 for a free particle, 0 for the held one.
    pub fn resolve(
        &mut self,
        positions: &mut Planes,
        began: &Planes,
        inverse_mass: &[f32],
        pairs: &[Pair],
        sphere: Option<Sphere>,
        params: &Params,
    ) {
        self.touch_table(positions, began, params);
        for pair in pairs {
            let (i, j) = pair.indices();
            self.touch_pair(positions, began, inverse_mass, i, j, params);
        }
        if let Some(sphere) = sphere {
            self.touch_sphere(positions, began, sphere, params);
        }
        apply(&mut positions.x, &self.shift.x, &self.count, inverse_mass);
        apply(&mut positions.y, &self.shift.y, &self.count, inverse_mass);
        apply(&mut positions.z, &self.shift.z, &self.count, inverse_mass);
    }

    /// Starts the pass: every particle's shift and count are written, for particles off the table with zeros.
    fn touch_table(&mut self, positions: &Planes, began: &Planes, params: &Params) {
        let n = positions.len();
        let (x, y, z) = (&positions.x[..n], &positions.y[..n], &positions.z[..n]);
        let (x0, y0) = (&began.x[..n], &began.y[..n]);
        let shift_x = &mut self.shift.x[..n];
        let shift_y = &mut self.shift.y[..n];
        let shift_z = &mut self.shift.z[..n];
        let count = &mut self.count[..n];
        for i in 0..n {
            let below = params.table_contact_m - z[i];
            let depth = if below > 0.0 { below } else { 0.0 };
            let slid_x = x[i] - x0[i];
            let slid_y = y[i] - y0[i];
            let slid = (slid_x * slid_x + slid_y * slid_y + TINY_M2).sqrt();
            let share = params.table_friction * depth / slid;
            let share = if share < 1.0 { share } else { 1.0 };
            shift_x[i] = -share * slid_x;
            shift_y[i] = -share * slid_y;
            shift_z[i] = depth;
            count[i] = if below > 0.0 { 1.0 } else { 0.0 };
        }
    }

    #[inline]
    fn touch_pair(
        &mut self,
        positions: &Planes,
        began: &Planes,
        inverse_mass: &[f32],
        i: usize,
        j: usize,
        params: &Params,
    ) {
        let a = positions.get(i);
        let b = positions.get(j);
        let apart = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let distance_2 = dot(apart, apart) + TINY_M2;
        if distance_2 >= params.self_contact_m * params.self_contact_m {
            return;
        }
        let distance = distance_2.sqrt();
        let depth = params.self_contact_softness * (params.self_contact_m - distance);
        let per_distance = 1.0 / distance;
        let normal = apart.map(|d| d * per_distance);
        let a0 = began.get(i);
        let b0 = began.get(j);
        let slid = [
            (a[0] - a0[0]) - (b[0] - b0[0]),
            (a[1] - a0[1]) - (b[1] - b0[1]),
            (a[2] - a0[2]) - (b[2] - b0[2]),
        ];
        let push = correction(normal, depth, slid, params.self_friction);
        // Two free particles share the correction; beside the held one, the free particle takes all. This
        // is 1 / (sum of both inverse masses) for sums of 2 and 1, without a division.
        let share = 1.5 - 0.5 * (inverse_mass[i] + inverse_mass[j]);
        self.add(i, push.map(|p| p * share));
        self.add(j, push.map(|p| -p * share));
    }

    fn touch_sphere(
        &mut self,
        positions: &Planes,
        began: &Planes,
        sphere: Sphere,
        params: &Params,
    ) {
        let reach = params.picker_radius_m + params.picker_skin_m;
        for i in 0..positions.len() {
            let p = positions.get(i);
            let out = [
                p[0] - sphere.centre[0],
                p[1] - sphere.centre[1],
                p[2] - sphere.centre[2],
            ];
            let distance_2 = dot(out, out) + TINY_M2;
            if distance_2 >= reach * reach {
                continue;
            }
            let distance = distance_2.sqrt();
            let per_distance = 1.0 / distance;
            let normal = out.map(|d| d * per_distance);
            let p0 = began.get(i);
            let slid = [
                p[0] - p0[0] - sphere.motion[0],
                p[1] - p0[1] - sphere.motion[1],
                p[2] - p0[2] - sphere.motion[2],
            ];
            let push = correction(normal, reach - distance, slid, params.table_friction);
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

/// Returns the push out of a contact plus Coulomb friction: at most `friction * depth` against the sliding.
#[inline]
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

#[inline]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn apply(plane: &mut [f32], shift: &[f32], count: &[f32], inverse_mass: &[f32]) {
    let n = plane.len();
    let (shift, count, inverse_mass) = (&shift[..n], &count[..n], &inverse_mass[..n]);
    for i in 0..n {
        let contacts = if count[i] > 1.0 { count[i] } else { 1.0 };
        plane[i] += inverse_mass[i] * shift[i] / contacts;
    }
}
