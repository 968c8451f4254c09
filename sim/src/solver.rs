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
use crate::sides::Sides;
use crate::snapshot::Texture;
use crate::springs::{Direction, Springs};
use crate::textile::Textile;

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
    /// Positions are current by rows between two substeps.
    sides: Sides,
    velocities: Planes,
    /// Slots of the held particles.
    held: Vec<usize>,
    params: Params,
    springs: Springs,
    contacts: Contacts,
    neighbours: Neighbours,
    pairs: Pairs,
    /// By slot: 1 for a particle of a pair in touch, else 0.
    layered: Vec<f32>,
    /// State when the step began.
    before: Planes,
    velocities_before: Planes,
    /// Moves the cloth instead of springs and contacts, if it is of a material.
    textile: Option<Textile>,
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
        let before = positions.clone();
        let sides = Sides::new(&layout, positions);
        let textile = params.material.as_ref();
        let textile = textile.map(|material| Textile::new(&layout, &before, material, params));
        Solver {
            velocities: Planes::zeros(n),
            held: Vec::new(),
            params: params.clone(),
            springs: Springs::new(&layout, params),
            contacts: Contacts::new(&sides),
            neighbours: Neighbours::new(&layout, params.self_contact_m),
            pairs: Pairs::default(),
            layered: vec![0.0; n],
            before,
            velocities_before: Planes::zeros(n),
            sides,
            layout,
            textile,
        }
    }

    /// Returns what a cloth of a material remembers.
    pub fn texture(&self) -> Option<Texture> {
        let textile = self.textile.as_ref();
        textile.map(|textile| textile.texture(&self.layout))
    }

    /// Gives a cloth of a material what another one remembered; without it, the cloth is disturbed.
    pub fn set_texture(&mut self, texture: Option<&Texture>) {
        if let Some(textile) = &mut self.textile {
            match texture {
                Some(texture) => textile.set_texture(texture, &self.layout),
                None => textile.disturb(),
            }
        }
    }

    /// Notes that something outside has changed the cloth.
    pub fn disturb(&mut self) {
        if let Some(textile) = &mut self.textile {
            textile.disturb();
        }
    }

    /// Returns the number of substeps of a step.
    pub fn substeps(&self) -> u32 {
        let textile = self.textile.as_ref();
        textile.map_or(self.params.substeps, Textile::substeps)
    }

    /// Returns the position of every particle of the grid; a missing one is at the origin.
    pub fn points(&self) -> Vec<[f32; 3]> {
        self.by_particle(&self.sides.rows.positions)
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
            self.sides.rows.positions.set(slot as usize, point);
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
        let textile = self.textile.as_ref();
        textile.map_or_else(|| self.springs.count(), Textile::constraint_count)
    }

    /// Returns every particle that is there, and its position, ascending.
    pub fn present(&self) -> impl Iterator<Item = (usize, [f32; 3])> {
        self.layout.slots().iter().map(|&slot| {
            let slot = slot as usize;
            (
                self.layout.particle(slot),
                self.sides.rows.positions.get(slot),
            )
        })
    }

    /// Fixes particles, which then move by a step's `shift` alone, and frees all others.
    pub fn hold(&mut self, particles: &[usize]) {
        self.held.clear();
        self.held
            .extend(particles.iter().map(|&particle| self.layout.slot(particle)));
        self.sides.hold(&self.held);
        for &slot in &self.held {
            self.velocities.set(slot, [0.0; 3]);
        }
        self.springs.note_fixed(&self.sides);
        if let Some(textile) = &mut self.textile {
            textile.disturb();
        }
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
        let is_free = !sphere_in_play && self.held.is_empty();
        if let Some(textile) = &mut self.textile {
            if is_free && textile.is_at_rest() {
                return Ok(Outcome::Still);
            }
            let shift_m = (shift[0] * shift[0] + shift[1] * shift[1] + shift[2] * shift[2]).sqrt();
            textile.begin_step(
                &self.sides.rows.positions,
                &self.velocities,
                shift_m,
                &self.params,
            );
        }
        self.before.clone_from(&self.sides.rows.positions);
        self.velocities_before.clone_from(&self.velocities);
        let substeps = self.substeps();
        for substep in 0..substeps {
            let sphere = self.sphere_at(from, to, substep);
            // Where it began, also what is held; a cloth without a material takes it from where held particles are.
            if self.textile.is_some() {
                self.sides.begin_rows();
            }
            // PyFleX moves a held particle the whole way before the first substep; so moved, replays end farther from
            // the recordings (60 of them: 1.7, 2.6 and 23 mm, instead of 1.6, 2.4 and 19).
            let done = (substep + 1) as f32 / substeps as f32;
            for &held in &self.held {
                let at = self.before.get(held);
                self.sides
                    .rows
                    .positions
                    .set(held, [0, 1, 2].map(|axis| at[axis] + done * shift[axis]));
            }
            let sphere = sphere_in_play.then_some(sphere);
            match &mut self.textile {
                Some(textile) => {
                    let (sides, velocities) = (&mut self.sides, &mut self.velocities);
                    textile.substep(substep, sides, velocities, sphere, &self.params);
                    self.check_finite("after threads and contacts")?;
                }
                None => self.substep(substep, sphere)?,
            }
        }
        if let Some(textile) = &mut self.textile {
            if !textile.note_step(&self.sides.rows.positions, is_free) {
                return Ok(Outcome::Moved);
            }
            let n = self.layout.len();
            self.velocities = Planes::zeros(n);
            return Ok(Outcome::Still);
        }
        let rest_m = self.params.rest_speed_m_s * self.params.step_secs;
        // A cloth that hangs may be slow because it swings and turns; one that lies may not.
        if sphere_in_play
            || !self.held.is_empty()
            || self
                .sides
                .rows
                .positions
                .differs_beyond(&self.before, rest_m)
        {
            return Ok(Outcome::Moved);
        }
        self.sides.rows.positions.clone_from(&self.before);
        self.velocities.clone_from(&self.velocities_before);
        Ok(Outcome::Still)
    }

    /// Tells whether the sphere, on this way, comes near enough to the cloth to be part of a step.
    pub fn sphere_may_touch(&self, from: [f32; 3], to: [f32; 3]) -> bool {
        let reach = self.params.picker_radius_m + self.params.picker_skin_m + SPHERE_MARGIN_M;
        let planes = [
            &self.sides.rows.positions.x,
            &self.sides.rows.positions.y,
            &self.sides.rows.positions.z,
        ];
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
        let Planes { x, y, z } = &self.sides.rows.positions;
        if all_finite(x) && all_finite(y) && all_finite(z) {
            return Ok(());
        }
        let is_broken = |slot: &&u32| {
            let point = self.sides.rows.positions.get(**slot as usize);
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
        let share = 1.0 / self.substeps() as f32;
        let done = (substep + 1) as f32 * share;
        let way = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
        Sphere {
            centre: [0, 1, 2].map(|axis| from[axis] + done * way[axis]),
            motion: way.map(|w| w * share),
        }
    }

    fn substep(&mut self, substep: u32, sphere: Option<Sphere>) -> Result<(), Broken> {
        let dt = self.params.step_secs / self.params.substeps as f32;
        self.sides.begin();
        self.predict(dt);
        self.check_finite("after free flight")?;
        let touching = self.neighbours.find(&self.sides.rows.positions);
        self.pairs.list(touching, &self.sides);
        self.layered.fill(0.0);
        for &slot in touching.iter().flatten() {
            self.layered[slot as usize] = 1.0;
        }
        let direction = |sweep| match (sweep + substep) % 2 {
            0 => Direction::Forward,
            _ => Direction::Backward,
        };
        if direction(0) == Direction::Backward {
            self.sides.turn_to_columns();
        }
        for sweep in 0..self.params.sweeps {
            self.springs.sweep(&mut self.sides, direction(sweep));
            self.contacts.resolve(
                &mut self.sides,
                direction(sweep),
                &self.pairs,
                sphere,
                &self.params,
            );
        }
        if direction(self.params.sweeps - 1) == Direction::Forward {
            self.sides.turn_to_rows();
        }
        self.check_finite("after springs and contacts")?;
        self.finish(dt);
        Ok(())
    }

    /// Moves free particles as if nothing touched them.
    fn predict(&mut self, dt: f32) {
        let keep = 1.0 - self.params.damping_per_s * dt;
        let [x, y, z] = self.params.gravity_m_s2.map(|gravity| gravity * dt);
        let weight = &self.sides.rows.inverse_mass;
        fly(
            &mut self.sides.rows.positions.x,
            &self.velocities.x,
            weight,
            dt,
            keep,
            x,
        );
        fly(
            &mut self.sides.rows.positions.y,
            &self.velocities.y,
            weight,
            dt,
            keep,
            y,
        );
        fly(
            &mut self.sides.rows.positions.z,
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
        let Planes { x, y, z } = &mut self.sides.rows.positions;
        let v = &mut self.velocities;
        let velocities = [&mut v.x[..], &mut v.y[..], &mut v.z[..]];
        let began = [
            &self.sides.rows.began.x[..],
            &self.sides.rows.began.y[..],
            &self.sides.rows.began.z[..],
        ];
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
