//! Fits the map from pixels to the table: a homography, and a plane through the touched heights.
//!
//! In: points and the camera's lens. Out: a [`Plane`] in the base frame, and how far points are from it. A normalised
//! direct linear transform (Hartley 1997) weighs each point by its distance from the horizon, so it is repeated with the
//! weights of its last result taken out: then the sum of squared distances on the table is least.

use super::{Pair, Terms};
use fab_picture::camera::{Lens, Plane, through};
use nalgebra::{Matrix3, RowVector3, SMatrix, SVector, SymmetricEigen, Vector2, Vector3};

/// No arm on a table reaches farther than this, metres: twice the largest of the supported ones.
const FAR_M: f64 = 2.0;
/// How often the linear equations are solved; after three times nothing changes that could be measured.
const PASSES: usize = 5;
/// The smallest ratio of the second smallest to the largest eigenvalue: below it, more than one homography fits.
const DETERMINED: f64 = 1e-11;

impl Terms {
    /// Takes the lens's distortion out of the points' pixels; the error names a point that cannot be one.
    pub(super) fn straightened(
        &self,
        lens: Option<&Lens>,
        pairs: &[Pair],
    ) -> Result<Vec<Pair>, String> {
        let [width, height] = self.size_px;
        let straight = |(pair, point): (&Pair, usize)| {
            let Pair {
                pixel: [u, v],
                base_m: [x, y, z],
            } = *pair;
            let is_seen = |(at, side): (&f64, u32)| (0.0..=f64::from(side)).contains(at);
            let is_in = pair.pixel.iter().zip(self.size_px).all(is_seen);
            if !is_in || !pair.base_m.iter().all(|m| m.abs() <= FAR_M) {
                return Err(format!(
                    "point {point} is at the pixel {u:.1}, {v:.1} and at {x}, {y}, {z} m; the picture has {width} x {height} px, \
                     and an arm reaches about a metre"
                ));
            }
            let pixel = lens.map_or(Some([u, v]), |lens| lens.straightened([u, v]));
            let pixel = pixel.ok_or_else(|| {
                format!(
                    "no ray leads through the lens to point {point}: the coefficients in `distortion` do not reach that far"
                )
            })?;
            Ok(Pair { pixel, ..*pair })
        };
        pairs.iter().zip(1..).map(straight).collect()
    }
}

/// Finds the fit of points with undistorted pixels; `None` if they do not determine one.
pub(super) fn fit(lens: Option<&Lens>, points: &[Pair]) -> Option<Plane> {
    Some(Plane {
        world_from_pixel: homography(points)?,
        height: heights(points)?,
        lens: lens.copied(),
    })
}

/// Returns how far a point is in space from where a fit puts it, millimetres; infinity beyond the horizon.
pub(super) fn error_mm(fit: &Plane, point: &Pair) -> f64 {
    let shown = through(&fit.world_from_pixel, point.pixel);
    let apart_m = shown.map_or(f64::INFINITY, |[x, y]| {
        let shown = Vector3::new(x, y, height_at(&fit.height, [x, y]));
        (shown - Vector3::from(point.base_m)).norm()
    });
    apart_m * 1000.0
}

/// Returns a plane's height at `x`, `y`.
pub(super) fn height_at(height: &[f64; 3], [x, y]: [f64; 2]) -> f64 {
    height[0] + height[1] * x + height[2] * y
}

/// Fits `z = a + b x + c y` to the touched points; `None` if they are collinear.
fn heights(points: &[Pair]) -> Option<[f64; 3]> {
    let (mut normal, mut sums) = (Matrix3::zeros(), Vector3::zeros());
    for Pair {
        base_m: [x, y, z], ..
    } in points
    {
        let row = Vector3::new(1.0, *x, *y);
        normal += row * row.transpose();
        sums += row * *z;
    }
    let height: [f64; 3] = (normal.try_inverse()? * sums).into();
    let is_finite = height.iter().all(|number| number.is_finite());
    is_finite.then_some(height)
}

/// Fits a homography from undistorted pixels to the base's x and y; `None` if the points do not determine one.
fn homography(points: &[Pair]) -> Option<Matrix3<f64>> {
    // Pixels are counted from their middle in units of their spread, as places are in metres.
    let n = points.len() as f64;
    let sum: Vector2<f64> = points.iter().map(|it| Vector2::from(it.pixel)).sum();
    let middle = sum / n;
    let away = |it: &Pair| (Vector2::from(it.pixel) - middle).norm();
    let scale = n / points.iter().map(away).sum::<f64>();
    let scaled = |it: &Pair| {
        let pixel = (Vector2::from(it.pixel) - middle) * scale;
        (pixel.into(), [it.base_m[0], it.base_m[1]])
    };
    let pairs: Vec<([f64; 2], [f64; 2])> = points.iter().map(scaled).collect();
    let homography = linear(&pairs)?;
    let middle = middle * -scale;
    let whole =
        homography * Matrix3::new(scale, 0.0, middle.x, 0.0, scale, middle.y, 0.0, 0.0, 1.0);
    let is_finite = whole.iter().all(|number| number.is_finite());
    is_finite.then_some(whole)
}

/// Solves the linear equations for the homography of scaled pixels and places.
fn linear(pairs: &[([f64; 2], [f64; 2])]) -> Option<Matrix3<f64>> {
    let mut homography = Matrix3::identity();
    for _ in 0..PASSES {
        let mut normal = SMatrix::<f64, 9, 9>::zeros();
        for ([u, v], [x, y]) in pairs {
            let factor = homography.row(2).dot(&RowVector3::new(*u, *v, 1.0));
            let rows = [
                [*u, *v, 1.0, 0.0, 0.0, 0.0, -x * u, -x * v, -x],
                [0.0, 0.0, 0.0, *u, *v, 1.0, -y * u, -y * v, -*y],
            ];
            for row in rows {
                let row = SVector::<f64, 9>::from(row) / factor;
                normal += row * row.transpose();
            }
        }
        if !normal.iter().all(|number| number.is_finite()) {
            return None;
        }
        let eigen = SymmetricEigen::new(normal);
        let mut order: Vec<usize> = (0..9).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        if eigen.eigenvalues[order[1]] <= DETERMINED * eigen.eigenvalues[order[8]] {
            return None;
        }
        let least = eigen.eigenvectors.column(order[0]);
        // The factor at the points' middle is nonzero unless the horizon runs through them.
        homography = Matrix3::from_row_iterator(least.iter().map(|number| number / least[8]));
    }
    Some(homography)
}
