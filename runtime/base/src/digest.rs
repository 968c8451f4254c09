//! Content hashes as text.

use sha2::{Digest, Sha256};

/// Hashes the bits of every position: x, y, z of particle 0, then of particle 1, each little-endian.
///
/// That is what the body of their `.npy` file holds, so anybody can recompute it.
pub fn of_positions(positions: &[[f32; 3]]) -> String {
    let mut hash = Sha256::new();
    for coordinate in positions.iter().flatten() {
        hash.update(coordinate.to_le_bytes());
    }
    hex(&hash.finalize())
}

/// Writes bytes as lower-case hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
