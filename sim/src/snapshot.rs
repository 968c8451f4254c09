//! A cloth's whole state, to go on from later or elsewhere with the same bits.
//!
//! In: a simulator between two steps. Out: plain data, and back. Parameters and outline are not part of it: a
//! snapshot fits the cloth that it was taken of, or one made alike.

use crate::error::SimError;
use crate::simulator::Simulator;
use serde::{Deserialize, Serialize};

/// All that a simulator's further steps depend on, beside its outline and its parameters.
///
/// Numbers survive JSON exactly, so that a snapshot read back continues with the same bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Snapshot {
    /// `[n_particles]` points in grid order, world frame, metres; missing particles are at the origin.
    pub positions: Vec<[f32; 3]>,
    /// `[n_particles]` velocities in grid order, world frame, metres per second.
    pub velocities: Vec<[f32; 3]>,
    /// Indices of the held particles.
    pub held: Vec<usize>,
    /// Centre of the picker's sphere, world frame, metres.
    pub sphere: [f32; 3],
    /// Steps since the start.
    pub steps: u64,
    /// Whether the last step changed nothing.
    pub at_rest: bool,
}

impl Simulator {
    /// Returns the state between two steps.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            positions: self.positions(),
            velocities: self.velocities(),
            held: self.held(),
            sphere: self.sphere(),
            steps: self.steps(),
            at_rest: self.is_at_rest(),
        }
    }

    /// Goes on from a state that was taken of this cloth, or of one made alike.
    ///
    /// Fails, and changes nothing, where counts differ, a number is not finite, or a held particle is missing.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SimError> {
        let count = self.grid().particle_count();
        for vectors in [&snapshot.positions, &snapshot.velocities] {
            if vectors.len() != count {
                return Err(SimError::OtherCloth {
                    expected: count,
                    got: vectors.len(),
                });
            }
            let is_broken = |vector: &[f32; 3]| vector.iter().any(|value| !value.is_finite());
            if let Some(particle) = vectors.iter().position(is_broken) {
                return Err(SimError::NonFinite {
                    particle,
                    step: snapshot.steps,
                    place: "in the snapshot",
                });
            }
        }
        if let Some(&particle) = snapshot.held.iter().find(|&&held| !self.has(held)) {
            return Err(SimError::NoSuchParticle { particle, count });
        }
        self.resume(snapshot);
        Ok(())
    }
}
