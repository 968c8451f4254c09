//! SHA-256 of particle states, so that two runs can be compared bit by bit.

use sha2::{Digest, Sha256};
use std::fmt::Write;

/// Returns the bytes as lower-case hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        write!(text, "{byte:02x}").expect("writing to a string cannot fail");
    }
    text
}

/// Hashes the bits of every position: x, y, z of particle 0, then of particle 1, each little-endian.
pub(crate) fn digest_of(positions: &[[f32; 3]]) -> String {
    let mut hasher = Sha256::new();
    for coordinate in positions.iter().flatten() {
        hasher.update(coordinate.to_bits().to_le_bytes());
    }
    hex(&hasher.finalize())
}
