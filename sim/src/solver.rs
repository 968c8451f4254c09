//! Moves the cloth through one step: the order of all passes.
//!
//! In: positions, velocities, which particle is held, where the sphere goes.
//! Out: the same, one step later. Each substep predicts free flight, then
//! alternates spring sweeps and contact passes, then derives velocities from
//! what really moved (position-based dynamics, Müller et al. 2007). Who moves
//! the sphere is the picker's business.

use crate::contacts::{Contacts, Pairs, Sphere};
use crate::layout::Layout;
use crate::motion::{all_finite, derive_velocities, fly};
use crate::neighbours::Neighbours;
use crate::params::Params;
use crate::planes::Planes;
use crate::springs::{Direction, Springs};

// A sphere that stays farther than this from the cloth's bounding box for a whole step is left out of the
// step. No particle moves as far in 0.01 s unless it flies at 2 m/s.
const SPHERE_MARGIN_M: f32 = 0.02;

// A particle at most this far above its resting height is on the table, metres.
const TABLE_REACH_M: f32 = 1e-4;

/// Tells whether a step changed anything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Outcome {
    /// The cloth moved, or the sphere was in play.
    Moved,
    /// Every position and velocity is as before, bit for bit, and the sphere was out of play; the next
    /// such step would do the same.
    Still,
}

/// A particle whose position is not a finite number, and where in a step that was noticed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Broken {
    pub particle: usize,
    pub place: &'static str,
}

/// The cloth's state and the room to advance it.
#[derive(Clone, Debug)]
pub(crate) struct Solver {
    layout: Layout,
    positions: Planes,
    velocities: Planes,
    inverse_mass: Vec<f32>,
    /// Slots of the held particles.
    held: Vec<usize>,
    params: Params,
    springs: Springs,
    contacts: Contacts,
    neighbours: Neighbours,
    pairs: Pairs,
    /// By slot: 1 for a particle of a pair in touch, else 0.
    layered: Vec<f32>,
    /// Positions when the substep began.
    began: Planes,
    /// State when the step began.
    before: Planes,
    velocities_before: Planes,
}

impl Solver {
    /// Puts a cloth at the given positions, at rest.
    ///
    /// - `points`: one for each particle of the grid; those of missing particles are not read.
    pub fn new(layout: Layout, points: &[[f32; 3]], params: &Params) -> Solver {
        let n = layout.len();
        let mut positions = Planes::zeros(n);
        for &slot in layout.slots() {
            positions.set(slot as usize, points[layout.particle(slot as usize)]);
        }
        Solver {
            velocities: Planes::zeros(n),
            inverse_mass: layout.free(),
            held: Vec::new(),
            params: params.clone(),
            springs: Springs::new(&layout, params),
            contacts: Contacts::new(n),
            neighbours: Neighbours::new(&layout, params.self_contact_m),
            pairs: Pairs::default(),
            layered: vec![0.0; n],
            began: positions.clone(),
            before: positions.clone(),
            velocities_before: Planes::zeros(n),
            positions,
            layout,
        }
    }

    /// Returns the position of every particle of the grid; a missing one is at the origin.
    pub fn points(&self) -> Vec<[f32; 3]> {
        self.by_particle(&self.positions)
    }

    /// Returns the velocity of every particle of the grid; that of a missing one is zero.
    pub fn velocities(&self) -> Vec<[f32; 3]> {
        self.by_particle(&self.velocities)
    }

    /// Returns the held particles.
    pub fn held(&self) -> Vec<usize> {
        self.held
            .iter()
            .map(|&slot| self.layout.particle(slot))
            .collect()
    }

    /// Moves every particle; the places of missing ones are not read.
    pub fn set_positions(&mut self, points: &[[f32; 3]]) {
        for &slot in self.layout.slots() {
            let point = points[self.layout.particle(slot as usize)];
            self.positions.set(slot as usize, point);
        }
    }

    /// Sets the velocity of every particle; those of missing ones are not read.
    pub fn set_velocities(&mut self, velocities: &[[f32; 3]]) {
        for &slot in self.layout.slots() {
            let velocity = velocities[self.layout.particle(slot as usize)];
            self.velocities.set(slot as usize, velocity);
        }
    }

    fn by_particle(&self, planes: &Planes) -> Vec<[f32; 3]> {
        let mut points = vec![[0.0; 3]; self.layout.grid().particle_count()];
        for &slot in self.layout.slots() {
            points[self.layout.particle(slot as usize)] = planes.get(slot as usize);
        }
        points
    }

    /// Returns the number of springs.
    pub fn spring_count(&self) -> usize {
        self.springs.count()
    }

    /// Returns the particle nearest to `centre`, if it is within `capture_m`; of equals, the first.
    pub fn nearest(&self, centre: [f32; 3], capture_m: f32) -> Option<usize> {
        let mut best = None;
        let mut best_2 = f32::INFINITY;
        for &slot in self.layout.slots() {
            let [x, y, z] = self.positions.get(slot as usize);
            let (dx, dy, dz) = (x - centre[0], y - centre[1], z - centre[2]);
            let distance_2 = dx * dx + dy * dy + dz * dz;
            if distance_2 <= capture_m * capture_m && distance_2 < best_2 {
                best = Some(self.layout.particle(slot as usize));
                best_2 = distance_2;
            }
        }
        best
    }

    /// Returns the uppermost of the particles at a point of the table; where none is as near as particles are
    /// in the flat cloth, the nearest as seen from above.
    pub fn uppermost(&self, [x_m, y_m]: [f32; 2]) -> Option<usize> {
        let reach_2 = 0.5 * self.layout.grid().spacing_m * self.layout.grid().spacing_m;
        let order = |slot: usize| {
            let [x, y, z] = self.positions.get(slot);
            let aside_2 = (x - x_m) * (x - x_m) + (y - y_m) * (y - y_m);
            if aside_2 <= reach_2 { -z } else { aside_2 }
        };
        let slots = self.layout.slots().iter().map(|&slot| slot as usize);
        let first = slots.min_by(|&a, &b| order(a).total_cmp(&order(b)));
        first.map(|slot| self.layout.particle(slot))
    }

    /// Returns a particle if it is within `capture_m` of `centre`.
    pub fn within(&self, particle: usize, centre: [f32; 3], capture_m: f32) -> Option<usize> {
        let [x, y, z] = self.positions.get(self.layout.slot(particle));
        let (dx, dy, dz) = (x - centre[0], y - centre[1], z - centre[2]);
        (dx * dx + dy * dy + dz * dz <= capture_m * capture_m).then_some(particle)
    }

    /// Fixes particles, which then move by a step's `shift` alone, and frees all others.
    pub fn hold(&mut self, particles: &[usize]) {
        self.held.clear();
        self.held
            .extend(particles.iter().map(|&particle| self.layout.slot(particle)));
        self.inverse_mass = self.layout.free();
        for &slot in &self.held {
            self.inverse_mass[slot] = 0.0;
            self.velocities.set(slot, [0.0; 3]);
        }
        self.springs.set_inverse_mass(&self.inverse_mass);
    }

    /// Advances by one step while the sphere's centre goes straight from `from` to `to`, and the held
    /// particle with it.
    ///
    /// A step in which nothing touches or holds the cloth and no particle outruns the rest speed is undone. A
    /// settled cloth so becomes exactly still, instead of trembling on by rounding errors.
    ///
    /// Fails on the first particle whose position is not a finite number.
    pub fn step(
        &mut self,
        from: [f32; 3],
        to: [f32; 3],
        shift: [f32; 3],
    ) -> Result<Outcome, Broken> {
        let sphere_in_play = self.sphere_may_touch(from, to);
        self.before.clone_from(&self.positions);
        self.velocities_before.clone_from(&self.velocities);
        for substep in 0..self.params.substeps {
            let sphere = self.sphere_at(from, to, substep);
            // PyFleX moves a held particle the whole way before the first substep; going along with the
            // sphere keeps replays of Double Straight together (20 recordings: 21.0 mm, at worst 27,
            // instead of 25.5 mm, at worst 57).
            let done = (substep + 1) as f32 / self.params.substeps as f32;
            for &held in &self.held {
                let at = self.before.get(held);
                self.positions
                    .set(held, [0, 1, 2].map(|axis| at[axis] + done * shift[axis]));
            }
            self.substep(substep, sphere_in_play.then_some(sphere))?;
        }
        let rest_m = self.params.rest_speed_m_s * self.params.step_secs;
        // A cloth that hangs may be slow because it swings and turns; one that lies may not.
        if sphere_in_play
            || !self.held.is_empty()
            || self.positions.differs_beyond(&self.before, rest_m)
        {
            return Ok(Outcome::Moved);
        }
        self.positions.clone_from(&self.before);
        self.velocities.clone_from(&self.velocities_before);
        Ok(Outcome::Still)
    }

    /// Tells whether the sphere, on this way, comes near enough to the cloth to be part of a step.
    pub fn sphere_may_touch(&self, from: [f32; 3], to: [f32; 3]) -> bool {
        let reach = self.params.picker_radius_m + self.params.picker_skin_m + SPHERE_MARGIN_M;
        let planes = [&self.positions.x, &self.positions.y, &self.positions.z];
        (0..3).all(|axis| {
            let low = from[axis].min(to[axis]) - reach;
            let high = from[axis].max(to[axis]) + reach;
            let (mut above, mut below) = (false, false);
            for &slot in self.layout.slots() {
                let value = planes[axis][slot as usize];
                above |= value >= low;
                below |= value <= high;
            }
            above && below
        })
    }

    /// Fails on the first particle whose position is not a finite number.
    fn check_finite(&self, place: &'static str) -> Result<(), Broken> {
        let Planes { x, y, z } = &self.positions;
        if all_finite(x) && all_finite(y) && all_finite(z) {
            return Ok(());
        }
        let is_broken = |slot: &&u32| {
            let point = self.positions.get(**slot as usize);
            point.iter().any(|value| !value.is_finite())
        };
        match self.layout.slots().iter().find(is_broken) {
            Some(&slot) => Err(Broken {
                particle: self.layout.particle(slot as usize),
                place,
            }),
            None => Ok(()),
        }
    }

    fn sphere_at(&self, from: [f32; 3], to: [f32; 3], substep: u32) -> Sphere {
        let share = 1.0 / self.params.substeps as f32;
        let done = (substep + 1) as f32 * share;
        let way = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
        Sphere {
            centre: [0, 1, 2].map(|axis| from[axis] + done * way[axis]),
            motion: way.map(|w| w * share),
        }
    }

    fn substep(&mut self, substep: u32, sphere: Option<Sphere>) -> Result<(), Broken> {
        let dt = self.params.step_secs / self.params.substeps as f32;
        self.began.clone_from(&self.positions);
        self.predict(dt);
        self.check_finite("after free flight")?;
        let touching = self.neighbours.find(&self.positions);
        self.pairs.list(touching, &self.began, &self.inverse_mass);
        self.layered.fill(0.0);
        for &slot in touching.iter().flatten() {
            self.layered[slot as usize] = 1.0;
        }
        for sweep in 0..self.params.sweeps {
            let direction = match (sweep + substep) % 2 {
                0 => Direction::Forward,
                _ => Direction::Backward,
            };
            self.springs.sweep(&mut self.positions, direction);
            self.contacts.resolve(
                &mut self.positions,
                &self.began,
                &self.inverse_mass,
                &self.pairs,
                sphere,
                &self.params,
            );
        }
        self.check_finite("after springs and contacts")?;
        self.finish(dt);
        Ok(())
    }

    /// Moves free particles as if nothing touched them.
    fn predict(&mut self, dt: f32) {
        let keep = 1.0 - self.params.damping_per_s * dt;
        let [x, y, z] = self.params.gravity_m_s2.map(|gravity| gravity * dt);
        let weight = &self.inverse_mass;
        fly(
            &mut self.positions.x,
            &self.velocities.x,
            weight,
            dt,
            keep,
            x,
        );
        fly(
            &mut self.positions.y,
            &self.velocities.y,
            weight,
            dt,
            keep,
            y,
        );
        fly(
            &mut self.positions.z,
            &self.velocities.z,
            weight,
            dt,
            keep,
            z,
        );
    }

    /// Derives velocities from the substep's displacement, limits their change, and puts slow particles to sleep
    /// where the table or another layer bears them; in the air nothing would hold them.
    fn finish(&mut self, dt: f32) {
        let max_change = self.params.max_acceleration_m_s2 * dt;
        let sleep_2 = self.params.sleep_speed_m_s * self.params.sleep_speed_m_s;
        let Planes { x, y, z } = &mut self.positions;
        let v = &mut self.velocities;
        let velocities = [&mut v.x[..], &mut v.y[..], &mut v.z[..]];
        let began = [&self.began.x[..], &self.began.y[..], &self.began.z[..]];
        let support = (
            &self.layered[..],
            self.params.table_contact_m + TABLE_REACH_M,
        );
        derive_velocities(
            x,
            y,
            z,
            velocities,
            began,
            support,
            1.0 / dt,
            [max_change, sleep_2],
        );
    }
}
