//! Particle positions as `.npy` bytes.

use npyz::WriterBuilder;

/// Encodes positions as a little-endian float32 array of shape `[particles, 3]`.
pub fn encode(positions: &[[f32; 3]]) -> Vec<u8> {
    const INVARIANT: &str = "writing to memory does not fail";
    let mut bytes = Vec::new();
    let mut writer = npyz::WriteOptions::new()
        .default_dtype()
        .shape(&[positions.len() as u64, 3])
        .writer(&mut bytes)
        .begin_nd()
        .expect(INVARIANT);
    writer
        .extend(positions.iter().flatten().copied())
        .expect(INVARIANT);
    writer.finish().expect(INVARIANT);
    bytes
}

/// Decodes what [`encode`] wrote; `None` for anything else.
pub fn decode(bytes: &[u8]) -> Option<Vec<[f32; 3]>> {
    let array = npyz::NpyFile::new(bytes).ok()?;
    let &[count, 3] = array.shape() else {
        return None;
    };
    // A damaged header may promise more than there is; never reserve memory on its word.
    if count.checked_mul(12)? > bytes.len() as u64 {
        return None;
    }
    let numbers = array.into_vec::<f32>().ok()?;
    Some(numbers.as_chunks::<3>().0.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_survive_the_file_format() {
        let positions = vec![[0.1, -0.2, 0.3], [f32::MIN_POSITIVE, 4.0, -5.5]];
        assert_eq!(decode(&encode(&positions)), Some(positions));
    }

    #[test]
    fn cut_bytes_are_no_positions() {
        let bytes = encode(&[[0.1, -0.2, 0.3]; 7]);
        for length in 0..bytes.len() {
            assert_eq!(decode(&bytes[..length]), None, "{length} bytes");
        }
    }
}
