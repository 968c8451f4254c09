//! The camera that a fit implies, to be compared with the stated one.
//!
//! In: a fit and the camera's focal lengths. Out: where the lens would be and which way is up. A homography from a
//! table to a camera's picture is, up to a factor, `K [r1 r2 t]` with two columns of a rotation (Zhang 2000). Columns
//! that are not at right angles or not of one length belong to no camera: the points are sheared or stretched.

use fab_picture::camera::{Lens, Plane};
use nalgebra::{Matrix2, Matrix3, Matrix3x2, Vector3};

/// The camera that a fit implies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ImpliedCamera {
    /// How far the angle between the table's axes is from a right one, degrees.
    pub shear_deg: f64,
    /// How much longer the table is along one direction than along the one across it; 1 is right.
    pub stretch: f64,
    /// Height of the lens above the table, metres.
    pub height_m: f64,
}

/// Decomposes a fit; `None` if it is singular.
pub(super) fn camera(fit: &Plane, lens: &Lens) -> Option<ImpliedCamera> {
    let [across, down] = lens.focal_px;
    let [right, below] = lens.middle_px;
    let pixel_from_camera = Matrix3::new(across, 0.0, right, 0.0, down, below, 0.0, 0.0, 1.0);
    let camera_from_base = pixel_from_camera.try_inverse()? * fit.world_from_pixel.try_inverse()?;
    // The base's x and y axes, projected vertically onto the table, in an orthonormal frame of the table.
    let [_, along_x, along_y] = fit.height;
    let axes = Matrix3x2::new(1.0, 0.0, 0.0, 1.0, along_x, along_y).qr();
    let to_table: Matrix2<f64> = axes.r().try_inverse()?;
    let columns: Matrix3x2<f64> = camera_from_base.fixed_columns::<2>(0) * to_table;
    let lengths = [0, 1].map(|axis| columns.column(axis).norm());
    let cosine = columns.column(0).dot(&columns.column(1)) / (lengths[0] * lengths[1]);
    let sizes = columns.svd(true, true);
    let (least, most) = (sizes.singular_values.min(), sizes.singular_values.max());
    let nearest: Matrix3x2<f64> = sizes.u? * sizes.v_t?;
    let normal: Vector3<f64> = nearest.column(0).cross(&nearest.column(1));
    let table_at_origin = camera_from_base.column(2) / (least * most).sqrt();
    let implied = ImpliedCamera {
        shear_deg: cosine.clamp(-1.0, 1.0).asin().to_degrees().abs(),
        stretch: most / least,
        height_m: normal.dot(&table_at_origin).abs(),
    };
    let numbers = [implied.shear_deg, implied.stretch, implied.height_m];
    numbers.iter().all(|it| it.is_finite()).then_some(implied)
}
