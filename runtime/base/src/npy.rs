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
pub fn check_header(bytes: &[u8]) -> Result<(), String> {
    let cut = || "it is not a .npy file, or it is truncated".to_owned();
    if !bytes.starts_with(b"\x93NUMPY") {
        let what = Kind::of(bytes).map(|kind| kind.sentence());
        return Err(what.unwrap_or_else(|| "it does not begin as a .npy file does".to_owned()));
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

/// What the numbers of other types are called, by the end of the type that a header states.
const NUMBER_TYPES: [(&str, &str); 2] = [
    ("f2'", "float16, which is too coarse for a cloth"),
    ("O'", "Python objects, not numbers"),
];

/// Decodes an array of floats of any shape; fails with the reason.
///
/// Returns the shape and the numbers, row by row, also if they are stored column by column, as NumPy does after a
/// transposition.
pub fn decode_floats(bytes: &[u8]) -> Result<(Vec<u64>, Vec<f64>), String> {
    check_header(bytes)?;
    let array = npyz::NpyFile::new(bytes).map_err(|error| error.to_string())?;
    let (shape, order) = (array.shape().to_vec(), array.order());
    let kind = array.dtype().descr();
    let width = match kind.as_str() {
        "'<f4'" | "'>f4'" => 4,
        "'<f8'" | "'>f8'" => 8,
        other => {
            let named = NUMBER_TYPES.iter().find(|(end, _)| other.ends_with(end));
            let name = named.map_or(other.to_owned(), |(_, name)| format!("{name} ({other})"));
            return Err(format!(
                "its numbers are of type {name}; save it again after `.astype(numpy.float32)`"
            ));
        }
    };
    // A header may promise more data than the file holds; never reserve memory on its word.
    let mut sides = shape.iter();
    let count = sides.try_fold(1u64, |count, side| count.checked_mul(*side));
    let least = count.and_then(|count| count.checked_mul(width));
    if least.is_none_or(|least| least > bytes.len() as u64) {
        return Err(format!(
            "its header promises the shape {shape:?}, its {} bytes hold less",
            bytes.len()
        ));
    }
    let numbers = match width {
        4 => array
            .into_vec::<f32>()
            .map(|values| values.into_iter().map(f64::from).collect()),
        _ => array.into_vec::<f64>(),
    };
    let numbers: Vec<f64> = numbers.map_err(|error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => "it is cut off".to_owned(),
        _ => error.to_string(),
    })?;
    Ok(match order {
        npyz::Order::C => (shape, numbers),
        npyz::Order::Fortran => {
            let rows = by_rows(&shape, &numbers);
            (shape, rows)
        }
    })
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
