//! Particle positions as `.npy` bytes.

use crate::kinds::Kind;
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
fn check_header(bytes: &[u8]) -> Result<(), String> {
    let cut = || "it is not a .npy file, or it is truncated".to_owned();
    if !bytes.starts_with(b"\x93NUMPY") {
        let what = Kind::of(bytes).map(|kind| kind.sentence());
        return Err(what.unwrap_or_else(|| "it does not begin as a .npy file does".to_owned()));
    }
    let (length, rest) = match *bytes.get(6..).unwrap_or_default() {
        [1, _, a, b, ref rest @ ..] => (u32::from(u16::from_le_bytes([a, b])), rest),
        [2 | 3, _, a, b, c, d, ref rest @ ..] => (u32::from_le_bytes([a, b, c, d]), rest),
        _ => return Err(cut()),
    };
    let header = rest.get(..length as usize).ok_or_else(cut)?;
    let header = String::from_utf8_lossy(header);
    let shape = header.split("'shape':").nth(1).unwrap_or_default();
    let shape = shape.split(')').next().unwrap_or_default();
    let sides = shape.split(|c: char| !c.is_ascii_digit());
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

/// Decodes particle positions that [`decode_positions`] reads, as float32; `None` for anything else.
pub fn decode(bytes: &[u8]) -> Option<Vec<[f32; 3]>> {
    let positions = decode_positions(bytes).ok()?.into_iter();
    Some(positions.map(|at| at.map(|it| it as f32)).collect())
}

/// Decodes particle positions, finite or not; fails with the reason.
///
/// The shape is `[particles, 3]`, or `[particles, 4]` with what SoftGym and PyFleX store, x, y, z and the inverse mass,
/// which is dropped.
pub fn decode_positions(bytes: &[u8]) -> Result<Vec<[f64; 3]>, String> {
    let (shape, numbers) = decode_floats(bytes)?;
    match *shape {
        [_, 3] => Ok(numbers.as_chunks::<3>().0.to_vec()),
        [_, 4] => {
            let rows = numbers.as_chunks::<4>().0.iter();
            Ok(rows.map(|&[x, y, z, _]| [x, y, z]).collect())
        }
        _ => Err(format!(
            "it has the shape {shape:?}, not [particles, 3] or [particles, 4]"
        )),
    }
}

/// Decodes an array of floats of any shape; fails with the reason.
///
/// Returns the shape and the numbers, row by row, also if they are stored column by column, as NumPy does after a
/// transposition.
pub fn decode_floats(bytes: &[u8]) -> Result<(Vec<u64>, Vec<f64>), String> {
    check_header(bytes)?;
    let array = npyz::NpyFile::new(bytes).map_err(|error| error.to_string())?;
    let (shape, order) = (array.shape().to_vec(), array.order());
    let kind = array.dtype().descr();
    let numbers = match kind.as_str() {
        "'<f4'" | "'>f4'" => array
            .into_vec::<f32>()
            .map(|values| values.into_iter().map(f64::from).collect()),
        "'<f8'" | "'>f8'" => array.into_vec::<f64>(),
        other => {
            return Err(format!(
                "its numbers are of type {other}; save it again after `.astype(numpy.float32)`"
            ));
        }
    };
    let numbers: Vec<f64> = numbers.map_err(|error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => "it is cut off".to_owned(),
        _ => error.to_string(),
    })?;
    let numbers = match order {
        npyz::Order::C => numbers,
        npyz::Order::Fortran => by_rows(&shape, &numbers),
    };
    Ok((shape, numbers))
}

/// Puts numbers that are stored column by column row by row.
fn by_rows(shape: &[u64], numbers: &[f64]) -> Vec<f64> {
    let place = |index: usize| {
        let (mut rest, mut place, mut stride) = (index, 0, numbers.len());
        for side in shape.iter().rev() {
            stride /= *side as usize;
            place += rest % *side as usize * stride;
            rest /= *side as usize;
        }
        numbers[place]
    };
    (0..numbers.len()).map(place).collect()
}

#[cfg(test)]
mod tests;
