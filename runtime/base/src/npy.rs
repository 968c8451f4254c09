//! Particle positions as `.npy` bytes.

use npyz::WriterBuilder;

/// Encodes positions as a little-endian float32 array of shape `[particles, 3]`.
pub fn encode(positions: &[[f32; 3]]) -> Vec<u8> {
    let numbers = positions.iter().flatten().copied();
    encode_floats(&[positions.len() as u64, 3], numbers)
}

/// Encodes numbers as a little-endian float32 array, row by row.
///
/// - `shape`: its product equals the count of the numbers.
pub fn encode_floats(shape: &[u64], numbers: impl IntoIterator<Item = f32>) -> Vec<u8> {
    const INVARIANT: &str = "writing to memory does not fail";
    let mut bytes = Vec::new();
    let mut writer = npyz::WriteOptions::new()
        .default_dtype()
        .shape(shape)
        .writer(&mut bytes)
        .begin_nd()
        .expect(INVARIANT);
    writer.extend(numbers).expect(INVARIANT);
    writer.finish().expect(INVARIANT);
    bytes
}

/// Checks that a header does not promise more data than the file holds; fails with the reason.
///
/// The decoder trusts the header when it reserves memory and multiplies the shape, so a damaged or forged header must
/// not reach it.
pub fn check_header(bytes: &[u8]) -> Result<(), String> {
    let cut = || "it is not a .npy file, or it is truncated".to_owned();
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err("it does not begin as a .npy file does".to_owned());
    }
    let (length, begin) = match (bytes.get(6), bytes.get(8..10), bytes.get(8..12)) {
        (Some(1), Some(&[a, b]), _) => (u32::from(u16::from_le_bytes([a, b])), 10),
        (Some(2 | 3), _, Some(&[a, b, c, d])) => (u32::from_le_bytes([a, b, c, d]), 12),
        _ => return Err(cut()),
    };
    let header = bytes
        .get(begin..)
        .and_then(|rest| rest.get(..length as usize))
        .ok_or_else(cut)?;
    let header = String::from_utf8_lossy(header);
    let shape = header
        .split("'shape':")
        .nth(1)
        .and_then(|rest| rest.split(')').next());
    let sides = shape
        .unwrap_or_default()
        .split(|c: char| !c.is_ascii_digit());
    let mut count: u64 = 1;
    for side in sides.filter(|side| !side.is_empty()) {
        let product = side.parse().ok().and_then(|side| count.checked_mul(side));
        count = product
            .filter(|count| *count <= bytes.len() as u64)
            .ok_or_else(|| {
                format!(
                    "its header promises more numbers than its {} bytes hold",
                    bytes.len()
                )
            })?;
    }
    Ok(())
}

/// Decodes what [`encode`] wrote; `None` for anything else.
pub fn decode(bytes: &[u8]) -> Option<Vec<[f32; 3]>> {
    check_header(bytes).ok()?;
    let array = npyz::NpyFile::new(bytes).ok()?;
    let &[count, 3] = array.shape() else {
        return None;
    };
    if array.order() != npyz::Order::C {
        return None;
    }
    // A damaged header may promise more data than there is; never reserve memory on its word.
    if count.checked_mul(12)? > bytes.len() as u64 {
        return None;
    }
    let numbers = array.into_vec::<f32>().ok()?;
    Some(numbers.as_chunks::<3>().0.to_vec())
}

/// Decodes an array of floats of any shape, stored row by row; fails with the reason.
///
/// Returns the shape and the numbers.
pub fn decode_floats(bytes: &[u8]) -> Result<(Vec<u64>, Vec<f64>), String> {
    check_header(bytes)?;
    let array = npyz::NpyFile::new(bytes).map_err(|error| error.to_string())?;
    if array.order() != npyz::Order::C {
        return Err("it is stored column by column (Fortran order)".to_owned());
    }
    let shape = array.shape().to_vec();
    // A header may promise more data than the file holds; never reserve memory on its word.
    let mut sides = shape.iter();
    let count = sides.try_fold(1u64, |count, side| count.checked_mul(*side));
    let least = count.and_then(|count| count.checked_mul(4));
    if least.is_none_or(|least| least > bytes.len() as u64) {
        return Err(format!(
            "its header promises the shape {shape:?}, its {} bytes hold less",
            bytes.len()
        ));
    }
    let numbers = match array.dtype().descr().as_str() {
        "'<f4'" => array
            .into_vec::<f32>()
            .map(|values| values.into_iter().map(f64::from).collect()),
        "'<f8'" => array.into_vec::<f64>(),
        other => return Err(format!("its numbers are of type {other}")),
    };
    let numbers = numbers.map_err(|error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => "it is cut off".to_owned(),
        _ => error.to_string(),
    })?;
    Ok((shape, numbers))
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
