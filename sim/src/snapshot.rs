//! A cloth's whole state, to go on from later or elsewhere with the same bits.
//!
//! Plain data; a simulator takes it between two steps, and goes on from it. Parameters and outline are not part of it: a
//! snapshot fits the cloth that it was taken of, or one made alike.

use crate::error::SimError;
use crate::mask::Mask;
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
    /// Creases, of a cloth of a material.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texture: Option<Texture>,
}

/// What a cloth of a material remembers beside its positions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Texture {
    /// `[n_particles]` rest bends along warp and weft, and of the twist of the cell that begins there.
    pub rest: Vec<[f32; 3]>,
    /// `[n_particles]` points where the cloth was when it began to be calm, world frame, metres.
    pub calm_at: Vec<[f32; 3]>,
    /// Steps for which it has been calm.
    pub calm_steps: u32,
}

impl Snapshot {
    /// Tells whether a cloth can go on from it: fails on the first count, number or held particle that does not fit.
    pub(crate) fn check(&self, mask: &Mask) -> Result<(), SimError> {
        let count = mask.grid().particle_count();
        let texture = self.texture.iter();
        let texture = texture.flat_map(|texture| [&texture.rest, &texture.calm_at]);
        for vectors in [&self.positions, &self.velocities]
            .into_iter()
            .chain(texture)
        {
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
                    step: self.steps,
                    place: "in the snapshot",
                });
            }
        }
        let is_there = |particle: usize| particle < count && mask.has(particle);
        match self.held.iter().find(|&&held| !is_there(held)) {
            Some(&particle) => Err(SimError::NoSuchParticle { particle, count }),
            None => Ok(()),
        }
    }
}
