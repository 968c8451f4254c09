//! What can go wrong, in words that name the value and what would be right.

use crate::mask::Mask;
use crate::material::MaterialError;
use crate::params::{ParamsError, ParamsFault, REACH_M};

/// Longest stretch spring accepted in a start, as a multiple of its rest length; recorded starts reach 1.9.
pub const MAX_START_STRETCH: f32 = 3.0;
/// Deepest a particle may start below the table's surface, metres; leaves room for rounding in files.
pub const MAX_START_DEPTH_M: f32 = 0.001;
// The longest route is 7 legs of at most 2 * sqrt(3) * REACH_M at the default 5 mm a step, about 10,000 steps.
/// Most steps that a pick-and-place may take.
pub(crate) const MAX_ROUTE_STEPS: u32 = 20_000;

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
    /// A parameter is out of bounds.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// The material cannot be simulated on this grid.
    #[error(transparent)]
    Material(#[from] MaterialError),
}

impl From<ParamsFault> for StartError {
    fn from(fault: ParamsFault) -> StartError {
        match fault {
            ParamsFault::Params(error) => error.into(),
            ParamsFault::Material(error) => error.into(),
        }
    }
}

/// Says why the simulation stopped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimError {
    /// A position or velocity is not a finite number.
    #[error(
        "particle `{particle}` has a position or speed that is not a finite number {place}, at step `{step}`"
    )]
    NonFinite {
        /// Index of the first such particle.
        particle: usize,
        /// Steps simulated, including the failing one.
        step: u64,
        /// Where it was noticed.
        place: &'static str,
    },
    /// A snapshot is of a cloth with another number of particles.
    #[error("the snapshot has `{got}` particles and this cloth's grid `{expected}`")]
    OtherCloth {
        /// Particles of this cloth's grid.
        expected: usize,
        /// Entries of the snapshot.
        got: usize,
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
    /// A particle was asked for that the cloth does not have.
    #[error("the cloth has no particle `{particle}`; its grid has `{count}`, counted from 0")]
    NoSuchParticle {
        /// The index asked for.
        particle: usize,
        /// Particles of the grid.
        count: usize,
    },
    /// The route needs more steps than any sensible parameters allow.
    #[error("the picker's route takes more than `{MAX_ROUTE_STEPS}` steps")]
    EndlessRoute,
    /// A parameter of this cloth, or a number of an action's manner, is out of bounds; nothing moved.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// The material of this cloth cannot be simulated on its grid; it never moved.
    #[error(transparent)]
    Material(#[from] MaterialError),
}

impl From<ParamsFault> for SimError {
    fn from(fault: ParamsFault) -> SimError {
        match fault {
            ParamsFault::Params(error) => error.into(),
            ParamsFault::Material(error) => error.into(),
        }
    }
}

/// Checks that positions can be the start of a cloth on this table.
pub(crate) fn check_start(mask: &Mask, positions: &[[f32; 3]]) -> Result<(), StartError> {
    let grid = mask.grid();
    if positions.len() != grid.particle_count() {
        return Err(StartError::WrongCount {
            expected: grid.particle_count(),
            got: positions.len(),
        });
    }
    for (particle, point) in positions.iter().enumerate() {
        if !mask.has(particle) {
            continue;
        }
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
        let there = |other: &usize| mask.has(particle) && mask.has(*other);
        for neighbour in right.into_iter().chain(front).filter(there) {
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
