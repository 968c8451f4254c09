//! Seeded random numbers, equal on every machine.
//!
//! SplitMix64 (Steele, Lea, Flood 2014), in integer arithmetic only. It draws starts, resamples and a random policy's
//! actions. A library's generator is not used because none promises the same numbers in every version.

/// A random stream determined by a seed.
#[derive(Clone, Debug)]
pub struct Chance(u64);

impl Chance {
    /// Starts the stream of a seed.
    pub fn seeded(seed: u64) -> Chance {
        Chance(seed)
    }

    /// Starts a stream seeded by the SHA-256 of a text.
    pub fn of(text: &str) -> Chance {
        use sha2::{Digest, Sha256};
        let hash = Sha256::digest(text);
        Chance(
            hash.iter()
                .take(8)
                .fold(0, |seed, byte| seed << 8 | u64::from(*byte)),
        )
    }

    /// Returns the next number, uniform over all 2^64.
    pub fn draw(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number in `[0, 1)`, with 53 random bits.
    pub fn fraction(&mut self) -> f64 {
        (self.draw() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns an integer below `count`, uniform to within 2^-32; 0 if `count` is 0.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.draw()) * count as u128) >> 64) as usize
    }
}

#[cfg(test)]
#[path = "tests/chance.rs"]
mod tests;
