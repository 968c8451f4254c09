//! Crumples a cloth as SoftGym does: lifts it by one particle, drops it, lets it come to rest.
//!
//! In: a cloth and a seed. Out: the same cloth in a heap on the table's centre, at rest. Which particle and
//! how high come from the seed alone; the rest is the solver's work, so equal cloths and seeds give equal
//! bits. The picker takes no part and stays at home.

use crate::error::SimError;
use crate::simulator::Simulator;

/// Least height that the chosen particle is lifted by, metres (SoftGym: 0.5 to 1).
const MIN_LIFT_M: f32 = 0.5;
/// Greatest height that the chosen particle is lifted by, metres.
const MAX_LIFT_M: f32 = 1.0;
/// Rise of the chosen particle per step, metres. SoftGym puts it at its height at once; so fast a jerk crumples
/// about as much (16 cloths cover 0.32 to 0.60 of their area, mean 0.42; recorded ones 0.33 to 0.63, mean 0.45),
/// while at a gentle 0.01 m they fall open (0.36 to 0.91, mean 0.53).
const RISE_M: f32 = 0.1;
/// Most steps that the lifted cloth is given to hang still (SoftGym: 300).
const MAX_HANG_STEPS: u32 = 300;
/// Most steps that the dropped cloth is given to come to rest (SoftGym: 300).
const MAX_REST_STEPS: u32 = 300;
/// Most further steps in which what still creeps is slowed down.
const MAX_CALMING_STEPS: u32 = 300;

/// What crumpling did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crumpled {
    /// Index of the particle that was lifted.
    pub lifted: usize,
    /// How high it was lifted, metres.
    pub lift_m: f32,
    /// Steps simulated.
    pub steps: u32,
}

impl Simulator {
    /// Lifts the cloth by a particle that the seed chooses, drops it, and lays the heap on the table's centre.
    ///
    /// Afterwards the cloth is as [`Simulator::from_positions`] would start it from its positions: without
    /// velocities, its clock at zero.
    ///
    /// - `interrupted`: asked before every step; `true` ends the crumpling early, with the cloth let go
    ///   where it is, without the lift's speed.
    pub fn crumple(
        &mut self,
        seed: u64,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<Crumpled, SimError> {
        let mut chance = SplitMix(seed);
        // The remainder favours the first particles by less than one in 10^14.
        let lifted = (chance.next() % self.grid().particle_count() as u64) as usize;
        let lift_m = MIN_LIFT_M + (MAX_LIFT_M - MIN_LIFT_M) * chance.fraction();
        let mut steps = 0;
        self.hold(&[lifted])?;
        self.lift_and_drop(lift_m, &mut steps, interrupted)
            .inspect_err(|_| self.restart_from(&self.positions()))?;
        Ok(Crumpled {
            lifted,
            lift_m,
            steps,
        })
    }

    fn lift_and_drop(
        &mut self,
        lift_m: f32,
        steps: &mut u32,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<(), SimError> {
        let mut step = |cloth: &mut Simulator, rise_m: f32| {
            if interrupted() {
                return Err(SimError::Interrupted { steps: *steps });
            }
            *steps += 1;
            cloth.step_held([0.0, 0.0, rise_m])
        };
        for _ in 0..(lift_m / RISE_M) as u32 {
            step(self, RISE_M)?;
        }
        for _ in 0..MAX_HANG_STEPS {
            step(self, 0.0)?;
            if self.is_at_rest() {
                break;
            }
        }
        self.hold(&[])?;
        for _ in 0..MAX_REST_STEPS {
            step(self, 0.0)?;
            if self.is_at_rest() {
                break;
            }
        }
        // Whoever starts from these positions starts without speeds, and a heap that rests by the hop of some
        // particles then slides on (one by 13 mm): it is brought to rest from standstill to standstill, until
        // a step changes nothing.
        for _ in 0..MAX_CALMING_STEPS {
            self.restart_from(&centred(&self.positions()));
            step(self, 0.0)?;
            if self.is_at_rest() {
                break;
            }
        }
        self.restart_from(&centred(&self.positions()));
        Ok(())
    }
}

/// Shifts a cloth as a whole, so that its mean lies above the table's centre (as SoftGym does).
fn centred(positions: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let mean = |axis: usize| {
        let sum: f64 = positions.iter().map(|point| f64::from(point[axis])).sum();
        (sum / positions.len() as f64) as f32
    };
    let [x, y] = [mean(0), mean(1)];
    positions
        .iter()
        .map(|point| [point[0] - x, point[1] - y, point[2]])
        .collect()
}

/// The generator SplitMix64 (Steele, Lea, Flood 2014): whole numbers only, so equal on every machine.
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number from 0 up to, not including, 1; its 24 bits are all exact in an `f32`.
    fn fraction(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u32 << 24) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_gives_the_published_numbers() {
        // First outputs of the reference implementation for the seed 1234567.
        let mut chance = SplitMix(1_234_567);
        assert_eq!(chance.next(), 6_457_827_717_110_365_317);
        assert_eq!(chance.next(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn fractions_stay_below_one() {
        assert_eq!(u64::MAX >> 40, (1 << 24) - 1);
        let mut chance = SplitMix(3);
        assert!((0..1000).all(|_| (0.0..1.0).contains(&chance.fraction())));
    }
}
