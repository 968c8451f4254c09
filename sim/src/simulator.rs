//! One cloth, one table, one picker: what the rest of the project drives.
//!
//! In: a start and actions in metres. Out: positions, bit for bit the same on
//! every machine, build and thread count. Anything about images is in
//! `camera`; anything about tasks is nowhere in this crate.

use crate::digest::digest_of;
use crate::grid::Grid;
use crate::params::Params;
use crate::picker::{self, Gripper, Leg};
use crate::planes::Planes;
use crate::solver::{Outcome, Solver};

/// Farthest a particle may start, and the picker may be sent, from the table's centre along an axis, metres.
pub const REACH_M: f32 = 2.0;
/// Longest stretch spring accepted in a start, as a multiple of its rest length; recorded starts reach 1.9.
pub const MAX_START_STRETCH: f32 = 3.0;
/// Deepest a particle may start below the table's surface, metres; leaves room for rounding in files.
pub const MAX_START_DEPTH_M: f32 = 0.001;
// The longest route is 7 legs of at most 2 * sqrt(3) * REACH_M at the default 5 mm a step, about 10,000 steps.
const MAX_ROUTE_STEPS: u32 = 20_000;

/// Says why positions cannot be a cloth's start.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StartError {
    /// Positions and grid disagree.
    #[error("`{got}` positions do not fill a grid of `{expected}` particles")]
    WrongCount {
        /// Particles of the grid.
        expected: usize,
        /// Positions given.
        got: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("particle `{particle}` has a coordinate `{value}`, which is not a finite number")]
    NonFinite {
        /// Index of the first such particle.
        particle: usize,
        /// The coordinate.
        value: f32,
    },
    /// A particle is under the table.
    #[error("particle `{particle}` is at height `{z_m}` m, below the table")]
    BelowTable {
        /// Index of the first such particle.
        particle: usize,
        /// Its height, metres.
        z_m: f32,
    },
    /// A particle is nowhere near the table.
    #[error(
        "particle `{particle}` has a coordinate of `{value_m}` m, more than `{REACH_M}` m from the table's centre"
    )]
    TooFar {
        /// Index of the first such particle.
        particle: usize,
        /// The coordinate, metres.
        value_m: f32,
    },
    /// Two neighbours are too far apart for this grid; often dims or spacing are wrong.
    #[error(
        "particles `{particle}` and `{neighbour}` are `{length_m}` m apart, more than `{MAX_START_STRETCH}` times their rest distance of `{rest_m}` m"
    )]
    OverStretched {
        /// Index of the first such particle.
        particle: usize,
        /// Index of its neighbour along a side.
        neighbour: usize,
        /// Distance between them, metres.
        length_m: f32,
        /// Distance between them at rest, metres.
        rest_m: f32,
    },
}

/// Says why the simulation stopped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimError {
    /// The solver produced a position or velocity that is not a finite number.
    #[error("particle `{particle}` is no longer at a finite position after step `{step}`")]
    NonFinite {
        /// Index of the first such particle.
        particle: usize,
        /// Steps simulated, including the failing one.
        step: u64,
    },
    /// The picker was sent to a place that is not a finite point near the table.
    #[error(
        "the picker cannot go to (`{x_m}`, `{y_m}`) m, outside `{REACH_M}` m around the table's centre"
    )]
    OutOfReach {
        /// X of the target, metres.
        x_m: f32,
        /// Y of the target, metres.
        y_m: f32,
    },
    /// The caller asked to stop; the cloth is left as it was at that step.
    #[error("interrupted after `{steps}` steps of the action")]
    Interrupted {
        /// Steps of the action that ran.
        steps: u32,
    },
    /// The route needs more steps than any sensible parameters allow.
    #[error("the picker's route takes more than `{MAX_ROUTE_STEPS}` steps")]
    EndlessRoute,
}

/// What a pick-and-place really did.
#[derive(Clone, Debug, PartialEq)]
pub struct PickAndPlace {
    /// Index of the particle that was held; `None` if none was within reach (a missed grasp).
    pub grasped: Option<usize>,
    /// Steps simulated.
    pub steps: u32,
    /// Time simulated, seconds.
    pub time_s: f64,
}

/// One cloth on a table, and the picker over it.
#[derive(Clone, Debug)]
pub struct Simulator {
    grid: Grid,
    params: Params,
    solver: Solver,
    sphere: [f32; 3],
    held: Option<usize>,
    steps: u64,
    /// Whether the last step was `Still` and nothing was touched since.
    at_rest: bool,
    shortcut: RestShortcut,
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

impl Simulator {
    /// Lays a flat cloth on the centre of the table, at rest.
    pub fn flat(grid: Grid, params: &Params) -> Simulator {
        let positions = grid.flat_positions(params);
        Simulator::start(grid, Planes::from_points(&positions), params)
    }

    /// Puts a cloth where the positions say, at rest.
    ///
    /// - `positions`: `[n_particles]` points in grid order, world frame, metres.
    ///
    /// Fails on the first particle that cannot be part of a cloth on this table.
    pub fn from_positions(
        grid: Grid,
        positions: &[[f32; 3]],
        params: &Params,
    ) -> Result<Simulator, StartError> {
        check_start(grid, positions)?;
        Ok(Simulator::start(
            grid,
            Planes::from_points(positions),
            params,
        ))
    }

    fn start(grid: Grid, positions: Planes, params: &Params) -> Simulator {
        Simulator {
            grid,
            solver: Solver::new(grid, positions, params),
            sphere: params.picker_home_m,
            params: params.clone(),
            held: None,
            steps: 0,
            at_rest: false,
            shortcut: RestShortcut::Skip,
        }
    }

    /// Chooses whether steps of a cloth at rest are computed.
    pub fn set_rest_shortcut(&mut self, shortcut: RestShortcut) {
        self.shortcut = shortcut;
    }

    /// Returns the grid that the cloth was made with.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Returns where every particle is, in grid order, world frame, metres.
    pub fn positions(&self) -> Vec<[f32; 3]> {
        self.solver.positions.to_points()
    }

    /// Returns the velocity of every particle, in grid order, world frame, metres per second.
    pub fn velocities(&self) -> Vec<[f32; 3]> {
        self.solver.velocities.to_points()
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
        digest_of(&self.solver.positions)
    }

    /// Advances by one step with the picker where it is.
    pub fn step(&mut self) -> Result<(), SimError> {
        self.step_to(self.sphere)
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

    /// Carries the particle nearest to `pick` to `place`, and takes the picker home.
    ///
    /// The sphere goes over the pick point, down, closes, goes up, across, down, opens, goes up and
    /// home, 5 mm a step (Foldsformer's folding environment). A closed picker that holds nothing keeps
    /// trying on its way, as there.
    ///
    /// - `pick`, `place`: table coordinates, world frame, metres.
    /// - `interrupted`: asked before every step; `true` ends the action early.
    pub fn pick_and_place(
        &mut self,
        pick: [f32; 2],
        place: [f32; 2],
        interrupted: &dyn Fn() -> bool,
    ) -> Result<PickAndPlace, SimError> {
        for [x_m, y_m] in [pick, place] {
            // Written so that a NaN is out of reach too.
            if !(x_m.abs() <= REACH_M && y_m.abs() <= REACH_M) {
                return Err(SimError::OutOfReach { x_m, y_m });
            }
        }
        let mut grasped = None;
        let mut steps = 0;
        for Leg { target, gripper } in picker::legs(pick, place, &self.params) {
            while let Some(next) = picker::advance(self.sphere, target, self.params.picker_travel_m)
            {
                if interrupted() {
                    self.release();
                    return Err(SimError::Interrupted { steps });
                }
                if steps >= MAX_ROUTE_STEPS {
                    self.release();
                    return Err(SimError::EndlessRoute);
                }
                match gripper {
                    Gripper::Open => self.release(),
                    Gripper::Closed => self.grasp(),
                }
                grasped = grasped.or(self.held);
                self.step_to(next)?;
                steps += 1;
            }
        }
        Ok(PickAndPlace {
            grasped,
            steps,
            time_s: f64::from(steps) * f64::from(self.params.step_secs),
        })
    }

    /// Fixes a particle to the hand of [`Simulator::step_by_hand`], or lets all go; as does an index that no
    /// particle has.
    pub fn hold(&mut self, particle: Option<usize>) {
        let particle = particle.filter(|&index| index < self.grid.particle_count());
        self.held = particle;
        self.solver.hold(particle);
        self.at_rest = false;
    }

    /// Advances by one step with the picker away, while the held particle goes along with a hand.
    ///
    /// - `from`, `to`: the hand's way, world frame, metres; it must be far from the cloth, which it would push.
    pub fn step_by_hand(&mut self, from: [f32; 3], to: [f32; 3]) -> Result<(), SimError> {
        let picker = std::mem::replace(&mut self.sphere, from);
        let done = self.step_to(to);
        self.sphere = picker;
        done
    }

    /// Tells whether the last step changed nothing.
    pub(crate) fn is_at_rest(&self) -> bool {
        self.at_rest
    }

    /// Begins anew with the cloth at the given positions, at rest.
    pub(crate) fn restart_from(&mut self, positions: Planes) {
        let shortcut = self.shortcut;
        *self = Simulator::start(self.grid, positions, &self.params);
        self.shortcut = shortcut;
    }

    fn grasp(&mut self) {
        if self.held.is_some() {
            return;
        }
        let capture_m = self.params.picker_capture_m;
        self.held = picker::nearest(&self.solver.positions, self.sphere, capture_m);
        if self.held.is_some() {
            self.solver.hold(self.held);
            self.at_rest = false;
        }
    }

    fn release(&mut self) {
        if self.held.take().is_some() {
            self.solver.hold(None);
            self.at_rest = false;
        }
    }

    /// Advances by one step while the sphere moves to `next`, with the held particle.
    fn step_to(&mut self, next: [f32; 3]) -> Result<(), SimError> {
        self.steps += 1;
        let skip = self.shortcut == RestShortcut::Skip
            && self.at_rest
            && !self.solver.sphere_may_touch(self.sphere, next);
        if !skip {
            let outcome = self.solver.step(self.sphere, next);
            self.at_rest = outcome == Outcome::Still;
        }
        self.sphere = next;
        match self.solver.first_non_finite() {
            Some(particle) => Err(SimError::NonFinite {
                particle,
                step: self.steps,
            }),
            None => Ok(()),
        }
    }
}

fn check_start(grid: Grid, positions: &[[f32; 3]]) -> Result<(), StartError> {
    if positions.len() != grid.particle_count() {
        return Err(StartError::WrongCount {
            expected: grid.particle_count(),
            got: positions.len(),
        });
    }
    for (particle, point) in positions.iter().enumerate() {
        for &value in point {
            if !value.is_finite() {
                return Err(StartError::NonFinite { particle, value });
            }
            if value.abs() > REACH_M {
                return Err(StartError::TooFar {
                    particle,
                    value_m: value,
                });
            }
        }
        if point[2] < -MAX_START_DEPTH_M {
            return Err(StartError::BelowTable {
                particle,
                z_m: point[2],
            });
        }
    }
    for particle in 0..positions.len() {
        let right = (particle % grid.dimx + 1 < grid.dimx).then_some(particle + 1);
        let front = (particle + grid.dimx < positions.len()).then_some(particle + grid.dimx);
        for neighbour in right.into_iter().chain(front) {
            let [a, b] = [positions[particle], positions[neighbour]];
            let length_m =
                ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt();
            if length_m > MAX_START_STRETCH * grid.spacing_m {
                return Err(StartError::OverStretched {
                    particle,
                    neighbour,
                    length_m,
                    rest_m: grid.spacing_m,
                });
            }
        }
    }
    Ok(())
}
