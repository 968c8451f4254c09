//! Reads the corners of a mesh: STL, binary or text, and OBJ.
//!
//! In: a file's bytes and its name. Out: the corners in the file's units; else why there are none. Faces are not needed,
//! because a capsule that contains a mesh's corners contains the mesh.

use nalgebra::Point3;

/// A format that is read.
#[derive(Clone, Copy, Debug)]
pub(super) enum Format {
    Stl,
    Obj,
}

impl Format {
    /// Returns the format of a file by the ending of its name.
    pub(super) fn of(name: &str) -> Result<Format, String> {
        match name.to_ascii_lowercase().rsplit('.').next() {
            Some("stl") => Ok(Format::Stl),
            Some("obj") => Ok(Format::Obj),
            _ => Err("its format is not read, and `.stl` and `.obj` are".to_owned()),
        }
    }
}

/// Reads the corners of a mesh.
pub(super) fn corners(format: Format, bytes: &[u8]) -> Result<Vec<Point3<f64>>, String> {
    let corners = match format {
        Format::Stl => stl(bytes),
        Format::Obj => lines(bytes, "v"),
    }?;
    if corners.is_empty() {
        return Err("it holds no corner".to_owned());
    }
    let mut numbers = corners.iter().flat_map(|it| it.iter());
    if numbers.any(|it| !it.is_finite()) {
        return Err("a corner is no place".to_owned());
    }
    Ok(corners)
}

fn stl(bytes: &[u8]) -> Result<Vec<Point3<f64>>, String> {
    /// Bytes before the first triangle, and of each: a normal, three corners, a remark.
    const HEAD: usize = 84;
    const TRIANGLE: usize = 50;
    let count = bytes.get(80..HEAD).and_then(|it| it.try_into().ok());
    let count = count.map(|it| u32::from_le_bytes(it) as usize);
    // A text begins with `solid`, and so do some binary files: their length decides.
    if count.is_some_and(|count| bytes.len() == HEAD + count.saturating_mul(TRIANGLE)) {
        let number = |it: &[u8]| f64::from(f32::from_le_bytes([it[0], it[1], it[2], it[3]]));
        let triangles = bytes[HEAD..].chunks_exact(TRIANGLE);
        let corners = triangles.flat_map(|triangle| triangle[12..48].chunks_exact(12));
        let corner = |it: &[u8]| Point3::new(number(it), number(&it[4..]), number(&it[8..]));
        return Ok(corners.map(corner).collect());
    }
    if bytes.starts_with(b"solid") {
        lines(bytes, "vertex")
    } else {
        Err(format!("its {} bytes are no STL file", bytes.len()))
    }
}

/// Reads the corners of a text: lines that begin with a word.
fn lines(bytes: &[u8], word: &str) -> Result<Vec<Point3<f64>>, String> {
    let text = std::str::from_utf8(bytes).map_err(|why| why.to_string())?;
    let mut corners = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        if words.next() != Some(word) {
            continue;
        }
        let numbers: Result<Vec<f64>, _> = words.take(3).map(str::parse).collect();
        let numbers = numbers.ok().and_then(|it| <[f64; 3]>::try_from(it).ok());
        let numbers = numbers.ok_or_else(|| format!("line {}: no corner", index + 1))?;
        corners.push(Point3::from(numbers));
    }
    Ok(corners)
}
