//! The camera's pose from 3D points in its frame.
//!
//! In: points with their positions in the camera's frame. Out: the least-squares pose (Umeyama 1991, without scale; the
//! scale is computed only to check the depth readings), and how point errors propagate elsewhere.

use super::sighting::Sighting;
use nalgebra::{
    Isometry3, Matrix3, Matrix6, Point3, Rotation3, SMatrix, SymmetricEigen, Translation3,
    UnitQuaternion, Vector3,
};

/// The smallest ratio of the second to the largest singular value: below it, the points are collinear.
const DETERMINED: f64 = 1e-7;

/// Points in the camera's frame with their counterparts in the base frame.
struct Clouds {
    pairs: Vec<(Vector3<f64>, Vector3<f64>)>,
    seen_middle: Vector3<f64>,
    base_middle: Vector3<f64>,
}

impl Clouds {
    fn of(points: &[Sighting]) -> Option<Clouds> {
        let pairs: Option<Vec<_>> = points
            .iter()
            .map(|point| Some((point.seen?.coords, point.base.coords)))
            .collect();
        let pairs = pairs.filter(|pairs| pairs.len() >= 3)?;
        let n = pairs.len() as f64;
        Some(Clouds {
            seen_middle: pairs.iter().map(|(seen, _)| seen).sum::<Vector3<f64>>() / n,
            base_middle: pairs.iter().map(|(_, base)| base).sum::<Vector3<f64>>() / n,
            pairs,
        })
    }

    fn centred(&self) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> {
        let middles = (self.seen_middle, self.base_middle);
        let off =
            move |(seen, base): &(Vector3<f64>, Vector3<f64>)| (seen - middles.0, base - middles.1);
        self.pairs.iter().map(off)
    }
}

/// Fits the camera's pose in the base frame; `None` if the points do not determine one.
///
/// Also returns the points' size according to the camera, divided by their size according to the arm.
pub(super) fn pose(points: &[Sighting]) -> Option<(Isometry3<f64>, f64)> {
    let clouds = Clouds::of(points)?;
    let joined: Matrix3<f64> = clouds
        .centred()
        .map(|(seen, base)| base * seen.transpose())
        .sum();
    let svd = joined.svd(true, true);
    let (left, right) = (svd.u?, svd.v_t?);
    let mut sizes: Vec<f64> = svd.singular_values.iter().copied().collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    if sizes[1] <= DETERMINED * sizes[0] {
        return None;
    }
    let mut signs = Vector3::repeat(1.0);
    let smallest = svd.singular_values.imin();
    if (left * right).determinant() < 0.0 {
        signs[smallest] = -1.0;
    }
    let rotation = left * Matrix3::from_diagonal(&signs) * right;
    let rotation =
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    let moved = clouds.base_middle - rotation * clouds.seen_middle;
    let seen_size: f64 = clouds.centred().map(|(seen, _)| seen.norm_squared()).sum();
    let umeyama = svd.singular_values.component_mul(&signs).sum() / seen_size;
    let base_from_camera = Isometry3::from_parts(Translation3::from(moved), rotation);
    let is_finite = base_from_camera.to_matrix().iter().all(|it| it.is_finite());
    is_finite.then_some((base_from_camera, 1.0 / umeyama))
}

/// Returns whether a mirror image would fit the points with less than half the error.
pub(super) fn fits_mirrored(points: &[Sighting]) -> bool {
    let mirrored: Vec<Sighting> = points
        .iter()
        .map(|point| Sighting {
            seen: point.seen.map(|seen| Point3::new(-seen.x, seen.y, seen.z)),
            ..*point
        })
        .collect();
    let error = |points: &[Sighting]| -> Option<f64> {
        let (base_from_camera, _) = pose(points)?;
        points
            .iter()
            .map(|point| Some((base_from_camera * point.seen? - point.base).norm_squared()))
            .sum()
    };
    match (error(points), error(&mirrored)) {
        (Some(as_it_is), Some(mirrored)) => mirrored < as_it_is / 4.0,
        _ => false,
    }
}

/// Amplification of the points' errors at a place: in the plane, and in height.
///
/// Ratio of standard deviations, in the worst direction and to first order.
pub(super) struct Gain {
    covariance: Matrix6<f64>,
    middle: Vector3<f64>,
}

impl Gain {
    pub(super) fn of(points: &[Sighting]) -> Option<Gain> {
        let clouds = Clouds::of(points)?;
        let normal: Matrix6<f64> = clouds
            .centred()
            .map(|(_, base)| {
                let slope = slope(base);
                slope.transpose() * slope
            })
            .sum();
        Some(Gain {
            covariance: normal.try_inverse()?,
            middle: clouds.base_middle,
        })
    }

    pub(super) fn at(&self, place: Point3<f64>) -> [f64; 2] {
        let slope = slope(place.coords - self.middle);
        let spread = slope * self.covariance * slope.transpose();
        let level = spread.fixed_view::<2, 2>(0, 0).into_owned();
        let in_plane = SymmetricEigen::new(level).eigenvalues.max();
        [in_plane, spread[(2, 2)]].map(|variance| variance.max(0.0).sqrt())
    }
}

/// The derivative of a point by a rotation about the points' middle and a shift.
fn slope(off: Vector3<f64>) -> SMatrix<f64, 3, 6> {
    let mut slope = SMatrix::<f64, 3, 6>::zeros();
    slope
        .fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&(-off.cross_matrix()));
    slope
        .fixed_view_mut::<3, 3>(0, 3)
        .copy_from(&Matrix3::identity());
    slope
}
