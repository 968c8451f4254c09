//! Fits the map from pixels to the table: a homography, and a plane through the touched heights.
//!
//! In: points and the camera's lens. Out: a [`Plane`] in the base frame, and how far points are from it. A normalised
//! direct linear transform (Hartley 1997) gives an initial guess, which Gauss-Newton refines to the least sum of squared
//! distances on the table: the transform alone would weigh each point by its distance from the horizon.

use super::Pair;
use crate::rgbd::Intrinsics;
use fab_picture::camera::{Lens, Plane, through};
use nalgebra::{Matrix2, Matrix3, Point3, SMatrix, SVector, SymmetricEigen, Vector2, Vector3};

/// Degrees of freedom of a homography.
const N: usize = 8;
/// The most refinement steps; three are usual.
const MAX_STEPS: usize = 50;
/// Refinement ends at a step below this share of the points' extent.
const SMALL_STEP: f64 = 1e-13;
/// The smallest ratio of the second smallest to the largest eigenvalue: below it, more than one homography fits.
const DETERMINED: f64 = 1e-11;

type Numbers = SVector<f64, N>;
type Square = SMatrix<f64, N, N>;

/// A touched point in the form that the solvers use.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    /// Its undistorted pixel.
    pub pixel: [f64; 2],
    /// Its position touched by the tool, metres, base frame.
    pub base: Point3<f64>,
}

/// Makes a lens from intrinsics; the error says what is wrong with them.
pub(super) fn lens(intrinsics: &Intrinsics) -> Result<Lens, String> {
    let given = &intrinsics.distortion;
    let mut distortion = [0.0; 5];
    if !matches!(given.len(), 0 | 4 | 5) {
        return Err(format!(
            "`distortion` has {} coefficients; `plumb_bob` has 4 or 5, and none is right too",
            given.len()
        ));
    }
    distortion[..given.len()].copy_from_slice(given);
    Ok(Lens {
        focal_px: intrinsics.focal_px,
        middle_px: intrinsics.middle_px,
        distortion,
    })
}

/// Prepares points; the error names one to whose pixel no ray leads.
pub(super) fn sightings(lens: Option<&Lens>, pairs: &[Pair]) -> Result<Vec<Sighting>, String> {
    let sighting = |(pair, point): (&Pair, usize)| {
        let pixel = lens.map_or(Some(pair.pixel), |lens| lens.straightened(pair.pixel));
        let pixel = pixel.ok_or_else(|| {
            format!(
                "no ray leads through the lens to point {point}: the coefficients in `distortion` do not reach that far"
            )
        })?;
        let base = Point3::from(pair.base_m);
        Ok(Sighting { pixel, base })
    };
    pairs.iter().zip(1..).map(sighting).collect()
}

/// Finds the fit of points; `None` if they do not determine one.
pub(super) fn fit(lens: Option<&Lens>, points: &[Sighting]) -> Option<Plane> {
    Some(Plane {
        world_from_pixel: homography(points)?,
        height: heights(points)?,
        lens: lens.copied(),
    })
}

/// Returns the offset of the fit's place for a point from the tool's, metres along the axes of the base; `None` beyond
/// the horizon.
pub(super) fn error(fit: &Plane, point: &Sighting) -> Option<Vector3<f64>> {
    let [x, y] = through(&fit.world_from_pixel, point.pixel)?;
    Some(Point3::new(x, y, height_at(&fit.height, [x, y])) - point.base)
}

/// Returns a plane's height at `x`, `y`.
pub(super) fn height_at(height: &[f64; 3], [x, y]: [f64; 2]) -> f64 {
    height[0] + height[1] * x + height[2] * y
}

/// Fits `z = a + b x + c y` to the touched points; `None` if they are collinear.
fn heights(points: &[Sighting]) -> Option<[f64; 3]> {
    let sum: Vector3<f64> = points.iter().map(|point| point.base.coords).sum();
    let middle = sum / points.len() as f64;
    let (mut normal, mut sums) = (Matrix2::zeros(), Vector2::zeros());
    for point in points {
        let off = point.base.coords - middle;
        normal += off.xy() * off.xy().transpose();
        sums += off.xy() * off.z;
    }
    let slopes = normal.try_inverse()? * sums;
    let level = middle.z - slopes.x * middle.x - slopes.y * middle.y;
    let height = [level, slopes.x, slopes.y];
    let is_finite = height.iter().all(|number| number.is_finite());
    is_finite.then_some(height)
}

/// Fits a homography from undistorted pixels to the base's x and y; `None` if the points do not determine one.
fn homography(points: &[Sighting]) -> Option<Matrix3<f64>> {
    let level = |point: &Sighting| [point.base.x, point.base.y];
    let pixels = Scaling::of(points.iter().map(|point| point.pixel))?;
    let table = Scaling::of(points.iter().map(level))?;
    let pair = |point: &Sighting| (pixels.apply(point.pixel), table.apply(level(point)));
    let pairs: Vec<([f64; 2], [f64; 2])> = points.iter().map(pair).collect();
    let numbers = refined(&pairs, linear(&pairs)?)?;
    let scaled = Matrix3::from_row_iterator(numbers.iter().copied().chain([1.0]));
    let whole = table.matrix().try_inverse()? * scaled * pixels.matrix();
    let is_finite = whole.iter().all(|number| number.is_finite());
    is_finite.then_some(whole)
}

/// A shift to the middle and a scaling to unit size, of points in a plane.
struct Scaling {
    middle: [f64; 2],
    scale: f64,
}

impl Scaling {
    fn of(places: impl Iterator<Item = [f64; 2]> + Clone) -> Option<Scaling> {
        let n = places.clone().count() as f64;
        let sum = places.clone().fold([0.0; 2], |sum, place| {
            [sum[0] + place[0], sum[1] + place[1]]
        });
        let middle = sum.map(|sum| sum / n);
        let far = |place: [f64; 2]| (place[0] - middle[0]).hypot(place[1] - middle[1]);
        let mean = places.map(far).sum::<f64>() / n;
        let scale = std::f64::consts::SQRT_2 / mean;
        scale.is_finite().then_some(Scaling { middle, scale })
    }

    fn apply(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| (place[axis] - self.middle[axis]) * self.scale)
    }

    fn matrix(&self) -> Matrix3<f64> {
        let [x, y] = self.middle.map(|middle| -middle * self.scale);
        Matrix3::new(self.scale, 0.0, x, 0.0, self.scale, y, 0.0, 0.0, 1.0)
    }
}

/// Solves the linear equations for the homography of scaled pixels and places.
fn linear(pairs: &[([f64; 2], [f64; 2])]) -> Option<Numbers> {
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for ([u, v], [x, y]) in pairs {
        let rows = [
            [*u, *v, 1.0, 0.0, 0.0, 0.0, -x * u, -x * v, -x],
            [0.0, 0.0, 0.0, *u, *v, 1.0, -y * u, -y * v, -*y],
        ];
        for row in rows {
            let row = SVector::<f64, 9>::from(row);
            normal += row * row.transpose();
        }
    }
    let eigen = SymmetricEigen::new(normal);
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    let is_determined = eigen.eigenvalues[order[1]] > DETERMINED * eigen.eigenvalues[order[8]];
    let least = eigen.eigenvectors.column(order[0]);
    // The factor at the points' middle is nonzero unless the horizon runs through them.
    let numbers = Numbers::from_iterator(least.iter().take(N).map(|number| number / least[8]));
    (is_determined && numbers.iter().all(|number| number.is_finite())).then_some(numbers)
}

/// Refines a homography to the least squared distance on the table.
fn refined(pairs: &[([f64; 2], [f64; 2])], start: Numbers) -> Option<Numbers> {
    let cost = |numbers: &Numbers| {
        pairs.iter().try_fold(0.0, |sum, (pixel, [x, y])| {
            let (put, _) = image_of(numbers, *pixel)?;
            Some(sum + (put[0] - x).powi(2) + (put[1] - y).powi(2))
        })
    };
    let mut numbers = start;
    let mut least = cost(&numbers)?;
    for _ in 0..MAX_STEPS {
        let (mut normal, mut down) = (Square::zeros(), Numbers::zeros());
        for (pixel, [x, y]) in pairs {
            let (put, slope) = image_of(&numbers, *pixel)?;
            normal += slope.transpose() * slope;
            down += slope.transpose() * Vector2::new(x - put[0], y - put[1]);
        }
        let mut step = normal.cholesky()?.solve(&down);
        // A step that overshoots is halved; from the linear solution that hardly ever happens.
        let taken = (0..20).find_map(|_| {
            let next = numbers + step;
            let better = cost(&next).filter(|next| *next <= least);
            step = if better.is_some() { step } else { step / 2.0 };
            better.map(|better| (next, better))
        });
        let Some((next, better)) = taken else {
            break;
        };
        (numbers, least) = (next, better);
        if step.norm() < SMALL_STEP {
            break;
        }
    }
    Some(numbers)
}

/// Returns the image of a scaled pixel, and its derivative by the homography's numbers; `None` beyond the horizon.
fn image_of(h: &Numbers, [u, v]: [f64; 2]) -> Option<([f64; 2], SMatrix<f64, 2, N>)> {
    let factor = h[6] * u + h[7] * v + 1.0;
    if factor <= 0.0 {
        return None;
    }
    let (x, y) = (
        (h[0] * u + h[1] * v + h[2]) / factor,
        (h[3] * u + h[4] * v + h[5]) / factor,
    );
    let along_x = [u, v, 1.0, 0.0, 0.0, 0.0, -x * u, -x * v];
    let along_y = [0.0, 0.0, 0.0, u, v, 1.0, -y * u, -y * v];
    let slope =
        SMatrix::<f64, 2, N>::from_row_iterator(along_x.into_iter().chain(along_y)) / factor;
    Some(([x, y], slope))
}
