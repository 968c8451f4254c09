//! Moves a cloth of a measured material through one step: the order of all passes.
//!
//! In and out: what the solver keeps, positions, velocities, who is held. A step is many small substeps (Macklin and
//! others 2019). In each, gravity and bending (`bending`) accelerate, diagonals resist shear (`shear`), threads keep their
//! length (`lines`), and contacts push apart (`faces`, the table, the sphere).
//!
//! A cloth that nothing holds or touches, and of which no particle has moved by more than [`CALM_M`] for
//! [`CALM_SECS`], is at rest: what still drives it is weaker than a thousandth of gravity. Nothing else stops a
//! slow particle.

use crate::bending::{Bending, Friction};
use crate::contacts::{Sphere, first_within, sphere_push};
use crate::faces::Faces;
use crate::layout::Layout;
use crate::lines::Lines;
use crate::material::{Material, Stiffness};
use crate::params::Params;
use crate::planes::Planes;
use crate::shear::Shear;
use crate::sides::{Side, Sides};
use crate::snapshot::Texture;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;

/// Farthest that a particle of a cloth at rest has moved, metres.
const CALM_M: f32 = 2e-4;
/// Time in which it has not moved farther, seconds. A particle that gravity's thousandth drives falls 0.2 mm in it.
const CALM_SECS: f32 = 0.2;
// Bends are taken where velocities lead to in this share of a substep: it damps waves of the length of a cell
// within some substeps, and leaves the cloth's motion alone.
const LEAD: f32 = 0.25;
// How often in a step creases follow the bends.
const CREASINGS: u32 = 2;
// Share of the gap between layers by which a particle may pass another layer in a substep before a step has more of them.
const HASTE_SHARE: f32 = 0.3;
// Most passes over all contacts in a substep, and the share of the gap by which layers may be too close in the last.
const MAX_PASSES: u32 = 3;
const CONTACT_PASSES: u32 = 4;
const DEEP: f32 = 0.2;
/// Time in which a crease follows a bend, seconds: a fold sets while it is pressed, and not while it swings by.
const CREASE_SECS: f32 = 0.1;
const TINY_M2: f32 = 1e-20;

/// What moves a cloth of a material.
#[derive(Clone, Debug)]
pub(crate) struct Textile {
    material: Material,
    stiffness: Stiffness,
    substeps: u32,
    /// Substeps of this step by those of a slow one: 1, 2 or 4.
    haste: usize,
    bending: Bending,
    columns: Lines,
    rows: Lines,
    shear: Shear,
    faces: Faces,
    /// Where the cloth was when it began to be calm, and the steps since then.
    calm_at: Planes,
    calm_steps: u32,
    steps_to_rest: u32,
}

impl Textile {
    /// Makes a cloth that has long lain at the given positions, and has the creases of that.
    ///
    /// - `material`: within the bounds of [`Material::check`]; with others the cloth has any number of substeps up
    ///   to the most.
    pub fn new(
        layout: &Layout,
        positions: &Planes,
        material: &Material,
        params: &Params,
    ) -> Textile {
        let spacing_m = layout.grid().spacing_m;
        let substeps = material.substeps(spacing_m, params.step_secs);
        let substeps = substeps.max(params.substeps);
        let substeps = substeps.min(crate::material::MAX_SUBSTEPS);
        let stiffness = material.stiffness(spacing_m);
        let friction = Friction::new(material.crease_recovery_deg, spacing_m);
        let mut bending = Bending::new(layout, stiffness.bend, friction);
        bending.crease(positions, 1.0);
        Textile {
            material: material.clone(),
            stiffness,
            substeps,
            bending,
            columns: Lines::new(layout),
            rows: Lines::new(&layout.transposed()),
            shear: Shear::new(layout, stiffness.shear, params.step_secs / substeps as f32),
            haste: 1,
            faces: Faces::new(layout, material.gap_m(), material.self_friction),
            calm_at: Planes::zeros(layout.len()),
            calm_steps: 0,
            steps_to_rest: (CALM_SECS / params.step_secs).ceil() as u32,
        }
    }

    /// Returns the number of edges and diagonals.
    pub fn constraint_count(&self) -> usize {
        self.columns.count() + self.rows.count() + self.shear.count()
    }

    /// Returns the number of substeps of a step.
    pub fn substeps(&self) -> u32 {
        self.substeps * self.haste as u32
    }

    /// Notes that something outside has changed the cloth.
    pub fn disturb(&mut self) {
        self.calm_steps = 0;
    }

    /// Tells whether the cloth is at rest until something disturbs it.
    pub fn is_at_rest(&self) -> bool {
        self.calm_steps >= self.steps_to_rest
    }

    /// Counts a step after which the cloth is where the positions say; returns whether it has come to rest.
    pub fn note_step(&mut self, positions: &Planes, is_free: bool) -> bool {
        if !is_free {
            self.calm_steps = 0;
            return false;
        }
        if self.calm_steps == 0 || positions.differs_beyond(&self.calm_at, CALM_M) {
            self.calm_at.clone_from(positions);
            self.calm_steps = 1;
        } else {
            self.calm_steps += 1;
        }
        self.is_at_rest()
    }

    /// Returns what a snapshot needs to know of creases and rest, by particle.
    pub fn texture(&self, layout: &Layout) -> Texture {
        let n = layout.grid().particle_count();
        let rest = self.bending.rest();
        let mut texture = Texture {
            rest: vec![[0.0; 3]; n],
            calm_at: vec![[0.0; 3]; n],
            calm_steps: self.calm_steps,
        };
        for &slot in layout.slots() {
            let (slot, particle) = (slot as usize, layout.particle(slot as usize));
            texture.rest[particle] = [rest[0][slot], rest[1][slot], rest[2][slot]];
            texture.calm_at[particle] = self.calm_at.get(slot);
        }
        texture
    }

    /// Takes creases and rest over from a snapshot of a cloth of the same grid.
    pub fn set_texture(&mut self, texture: &Texture, layout: &Layout) {
        let mut rest: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0.0; layout.len()]);
        for &slot in layout.slots() {
            let (slot, particle) = (slot as usize, layout.particle(slot as usize));
            for (family, rest) in rest.iter_mut().enumerate() {
                rest[slot] = texture.rest[particle][family];
            }
            self.calm_at.set(slot, texture.calm_at[particle]);
        }
        self.bending.set_rest(rest);
        self.calm_steps = texture.calm_steps;
    }

    /// Begins a step; all that follows in it depends on positions, velocities and creases alone.
    ///
    /// - `shift_m`: how far held particles go in it.
    pub fn begin_step(
        &mut self,
        positions: &Planes,
        velocities: &Planes,
        shift_m: f32,
        params: &Params,
    ) {
        self.faces.forget();
        self.faces.search(positions, positions);
        let dt = params.step_secs / self.substeps as f32;
        let slow = HASTE_SHARE * self.material.gap_m() / dt;
        let soon_m = params.rest_height_m() + 2.0 * self.material.gap_m();
        let fastest = self
            .faces
            .fastest(positions, velocities, params.step_secs, soon_m);
        let still = Planes::zeros(velocities.len());
        // What flies fast may soon be beside another layer, unseen as yet.
        let exceeds = |speed: f32| {
            fastest > 0.6 * speed
                || shift_m > 2.0 * speed * params.step_secs
                || velocities.differs_beyond(&still, 2.0 * speed)
        };
        self.haste = match () {
            () if exceeds(2.0 * slow) => 4,
            () if exceeds(slow) => 2,
            () => 1,
        };
    }

    /// Advances by one substep, with held particles already where they go.
    ///
    /// - `began`: by rows, where every particle was, held ones included.
    pub fn substep(
        &mut self,
        number: u32,
        sides: &mut Sides,
        velocities: &mut Planes,
        sphere: Option<Sphere>,
        params: &Params,
    ) {
        let dt = params.step_secs / self.substeps() as f32;
        let crease_every = self.substeps().div_ceil(CREASINGS);
        if number.is_multiple_of(crease_every) {
            let share = (crease_every as f32 * dt / CREASE_SECS).min(1.0);
            self.bending.crease(&sides.rows.positions, share);
        }
        let acceleration = self
            .bending
            .accelerate(&sides.rows.positions, velocities, LEAD * dt);
        let keep = 1.0 - params.damping_per_s * dt;
        let weight = &sides.rows.inverse_mass;
        let positions = &mut sides.rows.positions;
        for (axis, (position, velocity, acceleration)) in [
            (&mut positions.x, &mut velocities.x, &acceleration.x),
            (&mut positions.y, &mut velocities.y, &acceleration.y),
            (&mut positions.z, &mut velocities.z, &acceleration.z),
        ]
        .into_iter()
        .enumerate()
        {
            launch(
                position,
                velocity,
                acceleration,
                weight,
                params.gravity_m_s2[axis],
                keep,
                dt,
            );
        }
        let per_2 = 1.0 / (dt * dt);
        let [warp, weft] = self.stiffness.stretch.map(|compliance| compliance * per_2);
        self.faces.begin_substep();
        // Once, and first: threads and contacts have the last word.
        self.shear.solve(&mut sides.rows, dt);
        // Layers that land on each other at speed need more than one pass, or one is pushed through the next.
        for pass in 0..MAX_PASSES {
            // Always in this order: where a crumpled cloth cannot have all lengths, taking turns would toss its
            // particles between two places for ever.
            self.columns.solve(&mut sides.rows, weft);
            sides.turn_to_columns();
            self.rows.solve(&mut sides.columns, warp);
            sides.turn_to_rows();
            let side = &mut sides.rows;
            // First, so that the others have the last word: a sphere presses layers together, and not through each
            // other.
            if let Some(sphere) = sphere
                && pass == 0
            {
                let friction = self.material.table_friction;
                touch_sphere(
                    side,
                    sphere,
                    params,
                    friction,
                    params.max_acceleration_m_s2 * dt * dt,
                );
            }
            self.faces.search(&side.positions, &side.began);
            let mut deepest = 0.0;
            for _ in 0..CONTACT_PASSES {
                deepest = self.faces.resolve(&mut side.positions, &side.inverse_mass);
                let Planes { x, y, z } = &mut side.positions;
                touch_table(
                    x,
                    y,
                    z,
                    [&side.began.x, &side.began.y],
                    &side.inverse_mass,
                    params.rest_height_m(),
                    self.material.table_friction,
                );
                if deepest < DEEP * self.material.gap_m() {
                    break;
                }
            }
            if deepest < DEEP * self.material.gap_m() && pass == 0 {
                break;
            }
        }
        let Side {
            positions: Planes { x, y, z },
            began,
            inverse_mass,
        } = &sides.rows;
        take_up(&mut velocities.x, x, &began.x, inverse_mass, dt);
        take_up(&mut velocities.y, y, &began.y, inverse_mass, dt);
        take_up(&mut velocities.z, z, &began.z, inverse_mass, dt);
    }
}

/// Accelerates one coordinate of free particles, and moves it as if nothing touched them.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn launch(
    position: &mut [f32],
    velocity: &mut [f32],
    acceleration: &[f32],
    weight: &[f32],
    gravity: f32,
    keep: f32,
    dt: f32,
) {
    let n = velocity.len();
    let position = &mut position[..n];
    let (acceleration, weight) = (&acceleration[..n], &weight[..n]);
    for i in 0..n {
        velocity[i] = weight[i] * (keep * velocity[i] + dt * (gravity + acceleration[i]));
        position[i] += weight[i] * dt * velocity[i];
    }
}

/// Takes up into the velocities how particles were corrected since [`launch`].
///
/// - `began`: where the substep began.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn take_up(velocity: &mut [f32], position: &[f32], began: &[f32], weight: &[f32], dt: f32) {
    let n = velocity.len();
    let (position, began, weight) = (&position[..n], &began[..n], &weight[..n]);
    let per_dt = 1.0 / dt;
    for i in 0..n {
        let launched = began[i] + weight[i] * dt * velocity[i];
        velocity[i] += weight[i] * (position[i] - launched) * per_dt;
    }
}

/// Lifts particles to the table's surface, and drags them by friction.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn touch_table(
    x: &mut [f32],
    y: &mut [f32],
    z: &mut [f32],
    [x0, y0]: [&[f32]; 2],
    weight: &[f32],
    height_m: f32,
    friction: f32,
) {
    let n = x.len();
    let (y, z, weight) = (&mut y[..n], &mut z[..n], &weight[..n]);
    let (x0, y0) = (&x0[..n], &y0[..n]);
    for i in 0..n {
        let below = height_m - z[i];
        let depth = if below > 0.0 { below } else { 0.0 };
        let (slid_x, slid_y) = (x[i] - x0[i], y[i] - y0[i]);
        let slid = (slid_x * slid_x + slid_y * slid_y + TINY_M2).sqrt();
        let share = friction * depth / slid;
        let share = weight[i] * if share < 1.0 { share } else { 1.0 };
        x[i] -= share * slid_x;
        y[i] -= share * slid_y;
        z[i] += weight[i] * depth;
    }
}

/// Pushes particles out of the sphere, each by at most `most_m`: a hand that gives way.
fn touch_sphere(side: &mut Side, sphere: Sphere, params: &Params, friction: f32, most_m: f32) {
    let reach = params.picker_radius_m + params.rest_height_m();
    let mut from = 0;
    while let Some(i) = {
        let Planes { x, y, z } = &side.positions;
        first_within(x, y, z, from, sphere.centre, reach)
    } {
        from = i + 1;
        let p = side.positions.get(i);
        let push = sphere_push(p, side.began.get(i), sphere, reach, friction);
        let length = (push[0] * push[0] + push[1] * push[1] + push[2] * push[2]).sqrt();
        let share = if length > most_m {
            most_m / length
        } else {
            1.0
        };
        let share = share * side.inverse_mass[i];
        side.positions
            .set(i, [0, 1, 2].map(|axis| p[axis] + share * push[axis]));
    }
}
