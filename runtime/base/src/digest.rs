//! Content hashes as text.

use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Hashes bytes with SHA-256.
pub fn of(bytes: impl AsRef<[u8]>) -> String {
    hex(&Sha256::digest(bytes))
}

/// Hashes the bits of every position: x, y, z of particle 0, then of particle 1, each little-endian.
///
/// The body of their `.npy` file holds the same bytes, so anybody can recompute the hash.
pub fn of_positions(positions: &[[f32; 3]]) -> String {
    let mut hash = Sha256::new();
    for coordinate in positions.iter().flatten() {
        hash.update(coordinate.to_le_bytes());
    }
    hex(&hash.finalize())
}

/// Hashes files one after the other, in chunks; an unreadable file counts up to the point of failure.
pub fn of_files<'p>(files: impl Iterator<Item = &'p Path>) -> String {
    let mut hash = Sha256::new();
    let mut piece = [0; 1 << 16];
    for file in files {
        let Ok(mut file) = File::open(file) else {
            continue;
        };
        while let Ok(count @ 1..) = file.read(&mut piece) {
            hash.update(&piece[..count]);
        }
    }
    hex(&hash.finalize())
}

/// Writes bytes as lower-case hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
