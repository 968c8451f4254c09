//! Reads the corners of a mesh: STL, binary or text, and OBJ.
//!
//! In: a file's bytes and its path. Out: the corners in the file's units; else why there are none. Faces are not needed,
//! because a capsule that contains a mesh's corners contains the mesh.

use fab_base::files;
use mesh_loader::Loader;
use nalgebra::Point3;
use std::path::Path;

/// The longest mesh accepted, bytes.
const MAX_BYTES: u64 = 32 << 20;

/// Reads the corners of a mesh.
pub(super) fn read(path: &Path) -> Result<Vec<Point3<f64>>, String> {
    let is_of_kind = |ending| files::ends_in(path, ending);
    if !["stl", "obj"].into_iter().any(is_of_kind) {
        return Err("its format is not read, and `.stl` and `.obj` are".to_owned());
    }
    corners(path, &files::read(path, MAX_BYTES)?)
}

/// Finds the corners in a file's bytes.
pub(super) fn corners(path: &Path, bytes: &[u8]) -> Result<Vec<Point3<f64>>, String> {
    // The materials of an OBJ file are not needed.
    let loader = Loader::with_custom_reader(|_| Ok(Vec::new()));
    let scene = loader.load_from_slice(bytes, path);
    let scene = scene.map_err(|why| why.to_string())?;
    let corners = scene.meshes.iter().flat_map(|mesh| &mesh.vertices);
    let corners: Vec<_> = corners.map(|it| Point3::from(it.map(f64::from))).collect();
    if corners.is_empty() {
        return Err("it holds no corner".to_owned());
    }
    let mut numbers = corners.iter().flat_map(|it| it.iter());
    if numbers.any(|it| !it.is_finite()) {
        return Err("a corner is no place".to_owned());
    }
    Ok(corners)
}
