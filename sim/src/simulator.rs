//! One cloth, one table, one picker: what the rest of the project drives.
//!
//! In: a start and actions in metres. Out: positions, bit for bit the same on
//! every machine, build and thread count. Anything about images is in
//! `camera`; anything about tasks is nowhere in this crate.

use crate::digest::digest_of;
use crate::error::{MAX_ROUTE_STEPS, SimError, StartError, check_start};
use crate::grid::Grid;
use crate::layout::Layout;
use crate::mask::Mask;
use crate::params::{Params, ParamsFault, REACH_M};
use crate::picker::{self, Gripper, Leg, Manner, Way};
use crate::scene::Marker;
use crate::snapshot::Snapshot;
use crate::solver::{Outcome, Solver};

/// What a pick-and-place really did.
#[derive(Clone, Debug, PartialEq)]
pub struct PickAndPlace {
    /// Index of the particle that was held; `None` if none was within reach (a missed grasp).
    pub grasped: Option<usize>,
    /// Where that particle was when the picker let go of it, world frame, metres; `None` if none was held.
    pub released_at: Option<[f32; 3]>,
    /// Steps simulated.
    pub steps: u32,
    /// Time simulated, seconds.
    pub time_s: f64,
}

/// One cloth on a table, and the picker over it.
#[derive(Clone, Debug)]
pub struct Simulator {
    mask: Mask,
    params: Params,
    solver: Solver,
    sphere: [f32; 3],
    held: Option<usize>,
    steps: u64,
    /// Whether the last step was `Still` and nothing was touched since.
    at_rest: bool,
    shortcut: RestShortcut,
    aim: Aim,
    /// What is wrong with the parameters; no step is computed with such.
    fault: Option<ParamsFault>,
}

/// Whether steps of a cloth at rest are computed; results are the same bits either way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum RestShortcut {
    /// Once a step has changed nothing and the picker is away, count further steps without computing them.
    #[default]
    Skip,
    /// Compute every step; slower, for comparison.
    Compute,
}

/// Which particle within its reach the picker takes hold of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Aim {
    /// The one nearest to the sphere's centre when it closes, as PyFleX's picker does. A fold pressed together
    /// beside the pick point may be nearer than what lies at the point.
    #[default]
    Nearest,
    /// The one that lies uppermost at the pick point before the sphere comes down: what a camera above shows there.
    Uppermost,
}

/// Fails on a point of the table that the picker does not reach.
fn reachable([x_m, y_m]: [f32; 2]) -> Result<(), SimError> {
    // Written so that a NaN is out of reach too.
    match x_m.abs() <= REACH_M && y_m.abs() <= REACH_M {
        true => Ok(()),
        false => Err(SimError::OutOfReach { x_m, y_m }),
    }
}

impl Simulator {
    /// Lays a flat cloth on the centre of the table, at rest.
    ///
    /// - `cloth`: a [`Grid`], or a [`Mask`] of one.
    /// - `params`: a number out of bounds (see [`Params::check`]) is told by every step that is asked for.
    pub fn flat(cloth: impl Into<Mask>, params: &Params) -> Simulator {
        let mask = cloth.into();
        let positions = mask.grid().flat_positions(params);
        Simulator::start(mask, &positions, params)
    }

    /// Puts a cloth where the positions say, at rest.
    ///
    /// - `cloth`: a [`Grid`], or a [`Mask`] of one.
    /// - `positions`: `[n_particles]` points in grid order, world frame, metres; those of missing particles
    ///   are not read.
    ///
    /// Fails on the first parameter that is out of bounds, and on the first particle that cannot be part of
    /// a cloth on this table.
    pub fn from_positions(
        cloth: impl Into<Mask>,
        positions: &[[f32; 3]],
        params: &Params,
    ) -> Result<Simulator, StartError> {
        let mask = cloth.into();
        params.check_on(mask.grid().spacing_m)?;
        check_start(&mask, positions)?;
        Ok(Simulator::start(mask, positions, params))
    }

    fn start(mask: Mask, positions: &[[f32; 3]], params: &Params) -> Simulator {
        // Springs run over the ends of rows; the lines of a material are solved row by row.
        let layout = match params.material {
            None => Layout::new(mask.grid(), |particle| mask.has(particle)),
            Some(_) => Layout::in_lanes(mask.grid(), |particle| mask.has(particle)),
        };
        let fault = params.check_on(mask.grid().spacing_m).err();
        Simulator {
            mask,
            solver: Solver::new(layout, positions, params),
            sphere: params.picker_home_m,
            params: params.clone(),
            held: None,
            steps: 0,
            at_rest: false,
            shortcut: RestShortcut::Skip,
            aim: Aim::Nearest,
            fault,
        }
    }

    /// Chooses whether steps of a cloth at rest are computed.
    pub fn set_rest_shortcut(&mut self, shortcut: RestShortcut) {
        self.shortcut = shortcut;
    }

    /// Chooses what the picker takes hold of.
    pub fn set_aim(&mut self, aim: Aim) {
        self.aim = aim;
    }

    /// Returns the grid that the cloth was made with.
    pub fn grid(&self) -> Grid {
        self.mask.grid()
    }

    /// Returns which particles of the grid the cloth is made of.
    pub fn mask(&self) -> &Mask {
        &self.mask
    }

    /// Returns the substeps of a step; one of a material takes more while it moves fast.
    pub fn substeps(&self) -> u32 {
        self.solver.substeps()
    }

    /// Returns the number of springs that a sweep pulls.
    pub fn spring_count(&self) -> usize {
        self.solver.spring_count()
    }

    /// Returns where every particle is, in grid order, world frame, metres; missing ones are at the origin.
    pub fn positions(&self) -> Vec<[f32; 3]> {
        self.solver.points()
    }

    /// Returns the velocity of every particle, in grid order, world frame, metres per second.
    pub fn velocities(&self) -> Vec<[f32; 3]> {
        self.solver.velocities()
    }

    /// Returns the number of steps since the start.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Returns the simulated time since the start, seconds.
    pub fn time_s(&self) -> f64 {
        self.steps as f64 * f64::from(self.params.step_secs)
    }

    /// Returns the SHA-256 of all positions' bits, as 64 hex digits.
    pub fn digest(&self) -> String {
        digest_of(&self.positions())
    }

    /// Advances by one step with the picker where it is.
    pub fn step(&mut self) -> Result<(), SimError> {
        self.step_held([0.0; 3])
    }

    /// Steps until nothing moves any more, at most `max_steps` times; returns the steps taken.
    pub fn settle(&mut self, max_steps: u32) -> Result<u32, SimError> {
        for taken in 0..max_steps {
            if self.at_rest {
                return Ok(taken);
            }
            self.step()?;
        }
        Ok(max_steps)
    }

    /// Carries the particle that `pick` points at (see [`Aim`]) to `place`, and takes the picker home.
    ///
    /// The sphere goes over the pick point, down, closes, goes up, across, and releases and goes home as
    /// [`crate::Route`] says. A closed picker that holds nothing keeps trying on its way, as in SoftGym.
    ///
    /// - `pick`, `place`: table coordinates, world frame, metres.
    /// - `interrupted`: asked before every step; `true` ends the action early.
    pub fn pick_and_place(
        &mut self,
        pick: [f32; 2],
        place: [f32; 2],
        interrupted: &dyn Fn() -> bool,
    ) -> Result<PickAndPlace, SimError> {
        self.pick_and_place_in(&Manner::default(), pick, place, interrupted, &mut |_| {})
    }

    /// Does the same in a stated manner, and shows the cloth to `watch` after every step.
    ///
    /// A crease is pressed after the release and before the picker goes home.
    pub fn pick_and_place_in(
        &mut self,
        manner: &Manner,
        pick: [f32; 2],
        place: [f32; 2],
        interrupted: &dyn Fn() -> bool,
        watch: &mut dyn FnMut(&Simulator),
    ) -> Result<PickAndPlace, SimError> {
        manner.check()?;
        reachable(pick)?;
        reachable(place)?;
        let mut done = PickAndPlace {
            grasped: None,
            released_at: None,
            steps: 0,
            time_s: 0.0,
        };
        if !self.solver.held().is_empty() {
            self.let_go();
        }
        let points = self.positions();
        // A picture's pixel at the cloth's rim may lie beside every triangle, so that the particle says how high.
        let uppermost = picker::uppermost(&self.mask, &points, pick);
        let surface_m = uppermost.map_or(0.0, |particle| points[particle][2]);
        let aimed_at = uppermost.filter(|_| self.aim == Aim::Uppermost);
        let legs = picker::legs(pick, place, surface_m, manner, &self.params);
        self.go(&legs, aimed_at, &mut done, interrupted, watch)?;
        if let Some(press_m) = manner.press_m {
            self.open(&mut done);
            let legs = picker::presses(pick, place, press_m, &self.params);
            self.go(&legs, None, &mut done, interrupted, watch)?;
        }
        let home = [picker::home(&self.params)];
        self.go(&home, None, &mut done, interrupted, watch)?;
        done.time_s = f64::from(done.steps) * f64::from(self.params.step_secs);
        Ok(done)
    }

    /// Takes the sphere along legs, one step after the other, and notes in `done` what comes of it.
    fn go(
        &mut self,
        legs: &[Leg],
        aimed_at: Option<usize>,
        done: &mut PickAndPlace,
        interrupted: &dyn Fn() -> bool,
        watch: &mut dyn FnMut(&Simulator),
    ) -> Result<(), SimError> {
        for leg in legs {
            let mut way = Way::new(self.sphere, leg, &self.params);
            while let Some(next) = way.next(self.sphere) {
                if interrupted() {
                    self.release();
                    return Err(SimError::Interrupted { steps: done.steps });
                }
                if done.steps >= MAX_ROUTE_STEPS {
                    self.release();
                    return Err(SimError::EndlessRoute);
                }
                match leg.gripper {
                    Gripper::Open => self.open(done),
                    Gripper::Closed => self.grasp(aimed_at),
                }
                done.grasped = done.grasped.or(self.held);
                self.step_to(next)?;
                done.steps += 1;
                watch(self);
            }
        }
        Ok(())
    }

    /// Lets go, and notes where that was.
    fn open(&mut self, done: &mut PickAndPlace) {
        if let Some(particle) = self.held {
            done.released_at = Some(self.positions()[particle]);
        }
        self.release();
    }

    /// Fixes particles in space, until the next call, instead of those that were held; none lets all go.
    ///
    /// Held particles move by [`Simulator::step_held`] alone. The picker takes no part: it grasps only in
    /// [`Simulator::pick_and_place`], which lets go of everything first.
    ///
    /// Fails, and holds what it held, where an index is not that of a particle.
    pub fn hold(&mut self, particles: &[usize]) -> Result<(), SimError> {
        let count = self.grid().particle_count();
        if let Some(&particle) = particles.iter().find(|&&particle| !self.has(particle)) {
            return Err(SimError::NoSuchParticle { particle, count });
        }
        self.held = None;
        self.solver.hold(particles);
        self.at_rest = false;
        Ok(())
    }

    /// Advances by one step while the held particles move by `shift`, metres; the picker stays.
    pub fn step_held(&mut self, shift: [f32; 3]) -> Result<(), SimError> {
        self.advance(self.sphere, shift)
    }

    /// Returns the indices of the held particles: by the hand of [`Simulator::hold`], or by the picker.
    pub fn held(&self) -> Vec<usize> {
        self.solver.held()
    }

    /// Returns the centre of the picker's sphere, world frame, metres.
    pub fn sphere(&self) -> [f32; 3] {
        self.sphere
    }

    /// Returns a marker of where the picker grasps: at the particle that it holds, else at its sphere's lowest point.
    pub fn marker(&self) -> Marker {
        let [x, y, z] = self.sphere;
        let lowest = [x, y, z - self.params.picker_radius_m];
        let held = self
            .held()
            .first()
            .and_then(|&particle| self.solver.points().get(particle).copied());
        Marker {
            tip: held.unwrap_or(lowest),
            holds: held.is_some(),
        }
    }

    /// Returns the state between two steps.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            positions: self.positions(),
            velocities: self.velocities(),
            held: self.held(),
            sphere: self.sphere,
            steps: self.steps,
            at_rest: self.at_rest,
            texture: self.solver.texture(),
        }
    }

    /// Goes on from a state that was taken of this cloth, or of one made alike.
    ///
    /// Fails, and changes nothing, where counts differ, a number is not finite, or a held particle is missing.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SimError> {
        snapshot.check(&self.mask)?;
        self.solver.set_positions(&snapshot.positions);
        self.solver.hold(&snapshot.held);
        self.solver.set_velocities(&snapshot.velocities);
        self.solver.set_texture(snapshot.texture.as_ref());
        self.held = None;
        self.sphere = snapshot.sphere;
        self.steps = snapshot.steps;
        self.at_rest = snapshot.at_rest;
        Ok(())
    }

    /// Gives every particle a velocity.
    ///
    /// - `velocities`: `[n_particles]`, grid order, world frame, metres per second; those of missing particles
    ///   are not read.
    ///
    /// Fails, and changes nothing, where the count differs or a number is not finite.
    pub fn set_velocities(&mut self, velocities: &[[f32; 3]]) -> Result<(), SimError> {
        let moving = Snapshot {
            velocities: velocities.to_vec(),
            at_rest: false,
            ..self.snapshot()
        };
        self.restore(&moving)?;
        self.solver.disturb();
        Ok(())
    }

    /// Tells whether a particle of the grid is part of the cloth.
    pub(crate) fn has(&self, particle: usize) -> bool {
        particle < self.grid().particle_count() && self.mask.has(particle)
    }

    /// Tells whether the cloth is of a material.
    pub(crate) fn is_textile(&self) -> bool {
        self.params.material.is_some()
    }

    /// Tells whether the last step changed nothing.
    pub(crate) fn is_at_rest(&self) -> bool {
        self.at_rest
    }

    /// Begins anew with the cloth at the given positions, at rest.
    pub(crate) fn restart_from(&mut self, positions: &[[f32; 3]]) {
        let shortcut = self.shortcut;
        *self = Simulator::start(self.mask.clone(), positions, &self.params);
        self.shortcut = shortcut;
    }

    fn grasp(&mut self, aimed_at: Option<usize>) {
        if self.held.is_some() {
            return;
        }
        let capture_m = self.params.picker_capture_m;
        let allowed = self
            .solver
            .present()
            .filter(|&(particle, _)| aimed_at.is_none_or(|aim| particle == aim));
        self.held = picker::nearest(allowed, self.sphere, capture_m);
        if let Some(particle) = self.held {
            self.solver.hold(&[particle]);
            self.at_rest = false;
        }
    }

    fn release(&mut self) {
        if self.held.is_some() {
            self.let_go();
        }
    }

    fn let_go(&mut self) {
        self.held = None;
        self.solver.hold(&[]);
        self.at_rest = false;
    }

    /// Advances by one step while the sphere moves to `next`, with the held particle.
    fn step_to(&mut self, next: [f32; 3]) -> Result<(), SimError> {
        // A sphere that carries nothing leaves a cloth at rest.
        let shift = match self.held {
            Some(_) => [0, 1, 2].map(|axis| next[axis] - self.sphere[axis]),
            None => [0.0; 3],
        };
        self.advance(next, shift)
    }

    /// Advances by one step while the sphere moves to `next` and what is held by `shift`.
    fn advance(&mut self, next: [f32; 3], shift: [f32; 3]) -> Result<(), SimError> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone().into());
        }
        self.steps += 1;
        let skip = self.shortcut == RestShortcut::Skip
            && self.at_rest
            && shift == [0.0; 3]
            && !self.solver.sphere_may_touch(self.sphere, next);
        if !skip {
            let outcome = self.solver.step(self.sphere, next, shift);
            let outcome = outcome.map_err(|broken| SimError::NonFinite {
                particle: broken.particle,
                step: self.steps,
                place: broken.place,
            })?;
            self.at_rest = outcome == Outcome::Still;
        }
        self.sphere = next;
        Ok(())
    }
}
