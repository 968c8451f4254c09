//! Crumples a cloth as SoftGym does: lifts it by one particle, drops it, lets it come to rest.
//!
//! In: a cloth and a seed, and a judge where a heap may be refused. Out: the same cloth in a heap on the table's
//! centre, at rest. Which particle and how high come from the seed alone; the rest is the solver's work, so equal
//! cloths and seeds give equal bits. The picker takes no part and stays at home.
//!
//! SoftGym differs in three ways: it puts the particle at its height at once, it lifts once and keeps whatever
//! heap that gives, and it ends while the heap still moves. What heap is good enough is the caller's to say.

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
/// Likewise for a cloth of a material, whose layers must not outrun the search for contacts: 2 m/s.
const TEXTILE_RISE_M: f32 = 0.02;
/// Most steps that the lifted cloth is given to hang still (SoftGym: 300).
const MAX_HANG_STEPS: u32 = 300;
/// A lifted cloth hangs still below this speed along every axis, m/s (SoftGym: 0.2).
const HANG_SPEED_M_S: f32 = 0.01;
/// Most steps that the dropped cloth is given to come to rest (SoftGym: 300).
const MAX_REST_STEPS: u32 = 300;
/// Most further steps in which what still creeps is slowed down.
const MAX_CALMING_STEPS: u32 = 300;

/// What crumpling did.
#[derive(Clone, Debug, PartialEq)]
pub struct Crumpled {
    /// The lifts, in their order; at least one.
    pub lifts: Vec<Lift>,
    /// Steps simulated, over all lifts.
    pub steps: u32,
}

/// One lift by one particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lift {
    /// Index of the particle that was lifted.
    pub particle: usize,
    /// How far it was lifted from where it lay, metres.
    pub height_m: f32,
}

impl Simulator {
    /// Lifts the cloth once by a particle that the seed chooses, drops it, and lays the heap on the table's centre.
    ///
    /// This is [`Simulator::crumple_until`] with the first heap taken as it is.
    pub fn crumple(
        &mut self,
        seed: u64,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<Crumpled, SimError> {
        self.crumple_until(seed, 1, &|_| true, interrupted)
    }

    /// Lifts and drops the cloth, from the heap as it lies, until a heap is taken.
    ///
    /// Particles and heights of all lifts come from one sequence that the seed begins. Where no heap is taken,
    /// the last one is left. Afterwards the cloth is as [`Simulator::from_positions`] would start it from its
    /// positions: without velocities, its clock at zero.
    ///
    /// - `most_lifts`: bounds the time; a lift takes at most 1000 steps. 0 counts as 1.
    /// - `take`: judges each heap at rest: `[n_particles]` points, grid order, world frame, metres; missing ones
    ///   are at the origin. Equal bits need a rule that gives equal answers on every machine.
    /// - `interrupted`: asked before every step; `true` ends the crumpling early, with the cloth let go
    ///   where it is, without the lift's speed.
    pub fn crumple_until(
        &mut self,
        seed: u64,
        most_lifts: u32,
        take: &dyn Fn(&[[f32; 3]]) -> bool,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<Crumpled, SimError> {
        let mut chance = SplitMix(seed);
        let mut done = Crumpled {
            lifts: Vec::new(),
            steps: 0,
        };
        loop {
            let lift = self.lift_by_chance(&mut chance);
            self.hold(&[lift.particle])?;
            self.lift_and_drop(lift.height_m, &mut done.steps, interrupted)
                .inspect_err(|_| self.restart_from(&self.positions()))?;
            done.lifts.push(lift);
            if done.lifts.len() >= most_lifts as usize || take(&self.positions()) {
                return Ok(done);
            }
        }
    }

    fn lift_by_chance(&self, chance: &mut SplitMix) -> Lift {
        // The remainder favours the first particles by less than one in 10^14.
        let number = (chance.next() % self.mask().count() as u64) as usize;
        let count = self.grid().particle_count();
        let particle = (0..count)
            .filter(|&particle| self.has(particle))
            .nth(number);
        Lift {
            particle: particle.expect("a number below the count of those that exist"),
            height_m: MIN_LIFT_M + (MAX_LIFT_M - MIN_LIFT_M) * chance.fraction(),
        }
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
        let rise_m = if self.is_textile() {
            TEXTILE_RISE_M
        } else {
            RISE_M
        };
        let rises = (lift_m / rise_m).ceil();
        for _ in 0..rises as u32 {
            step(self, lift_m / rises)?;
        }
        for _ in 0..MAX_HANG_STEPS {
            step(self, 0.0)?;
            let velocities = self.velocities();
            if velocities
                .iter()
                .flatten()
                .all(|v| v.abs() < HANG_SPEED_M_S)
            {
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
        if self.is_textile() {
            // It rests when nothing drives it, with its creases, and a shift as a whole changes neither.
            for _ in 0..MAX_CALMING_STEPS {
                if self.is_at_rest() {
                    break;
                }
                step(self, 0.0)?;
            }
            self.restart_from(&self.centred());
            return Ok(());
        }
        // Whoever starts from these positions starts without speeds, and a heap that rests by the hop of some
        // particles then slides on (one by 13 mm): it is brought to rest from standstill to standstill, until
        // a step changes nothing.
        for _ in 0..MAX_CALMING_STEPS {
            self.restart_from(&self.centred());
            step(self, 0.0)?;
            if self.is_at_rest() {
                break;
            }
        }
        self.restart_from(&self.centred());
        Ok(())
    }

    /// Returns the positions shifted as a whole, so that their mean lies above the table's centre (as SoftGym does).
    fn centred(&self) -> Vec<[f32; 3]> {
        let positions = self.positions();
        let mean = |axis: usize| {
            // Missing particles are at the origin and add nothing.
            let sum: f64 = positions.iter().map(|point| f64::from(point[axis])).sum();
            (sum / self.mask().count() as f64) as f32
        };
        let [x, y] = [mean(0), mean(1)];
        positions
            .iter()
            .map(|point| [point[0] - x, point[1] - y, point[2]])
            .collect()
    }
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
