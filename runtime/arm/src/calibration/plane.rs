//! The homography from pixels to the table, and the plane through the touched heights.
//!
//! In: points. Out: both, and how point errors propagate elsewhere. A normalised direct linear transform (Hartley 1997)
//! gives an initial guess, which Gauss-Newton refines to the least sum of squared distances on the table. The transform
//! alone would weigh each point by its distance from the horizon.

use super::fit::Sighting;
use nalgebra::{Matrix3, Point3, SMatrix, SVector, SymmetricEigen, Vector3};

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

/// Fits a homography from undistorted pixels to the base's x and y; `None` if the points do not determine one.
pub(super) fn homography(points: &[Sighting]) -> Option<Matrix3<f64>> {
    let scaled = Scaled::of(points)?;
    let numbers = scaled.refined(scaled.start()?)?;
    scaled.base_from_pixel(&numbers)
}

/// Fits `z = a + b x + c y` to the touched points; `None` if they are collinear.
pub(super) fn heights(points: &[Sighting]) -> Option<[f64; 3]> {
    let (middle, normal, sums) = height_sums(points);
    let slopes = normal.try_inverse()? * sums;
    let level = middle.z - slopes.x * middle.x - slopes.y * middle.y;
    let height = [level, slopes.x, slopes.y];
    height
        .iter()
        .all(|number| number.is_finite())
        .then_some(height)
}

/// Amplification of the touched points' errors at a place.
///
/// Ratio of standard deviations, in the worst direction and to first order.
pub(super) struct Gain {
    scaled: Scaled,
    numbers: Numbers,
    covariance: Square,
    points: Vec<Sighting>,
}

impl Gain {
    pub(super) fn of(points: &[Sighting]) -> Option<Gain> {
        let scaled = Scaled::of(points)?;
        let numbers = scaled.refined(scaled.start()?)?;
        let covariance = scaled.normal(&numbers).0.try_inverse()?;
        let points = points.to_vec();
        Some(Gain {
            scaled,
            numbers,
            covariance,
            points,
        })
    }

    pub(super) fn in_plane(&self, pixel: [f64; 2]) -> Option<f64> {
        let (_, slope) = image_of(&self.numbers, self.scaled.pixels.apply(pixel))?;
        let spread = slope * self.covariance * slope.transpose();
        let worst = SymmetricEigen::new(spread).eigenvalues.max();
        Some(worst.max(0.0).sqrt())
    }

    pub(super) fn in_height(&self, place: Point3<f64>) -> Option<f64> {
        height_gain(&self.points, place)
    }
}

/// Returns the amplification of height errors in the plane's height at a place.
pub(super) fn height_gain(points: &[Sighting], place: Point3<f64>) -> Option<f64> {
    let (middle, normal, _) = height_sums(points);
    let off = nalgebra::Vector2::new(place.x - middle.x, place.y - middle.y);
    let variance = 1.0 / points.len() as f64 + (off.transpose() * normal.try_inverse()? * off).x;
    Some(variance.max(0.0).sqrt())
}

fn height_sums(
    points: &[Sighting],
) -> (Vector3<f64>, nalgebra::Matrix2<f64>, nalgebra::Vector2<f64>) {
    let sum: Vector3<f64> = points.iter().map(|point| point.base.coords).sum();
    let middle = sum / points.len() as f64;
    let mut normal = nalgebra::Matrix2::zeros();
    let mut sums = nalgebra::Vector2::zeros();
    for point in points {
        let off = point.base.coords - middle;
        normal += off.xy() * off.xy().transpose();
        sums += off.xy() * off.z;
    }
    (middle, normal, sums)
}

/// A shift to the middle and a scaling to unit size, of points in a plane.
#[derive(Clone, Copy)]
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
        (scale.is_finite()).then_some(Scaling { middle, scale })
    }

    fn apply(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| (place[axis] - self.middle[axis]) * self.scale)
    }

    fn matrix(&self) -> Matrix3<f64> {
        let [x, y] = self.middle.map(|middle| -middle * self.scale);
        Matrix3::new(self.scale, 0.0, x, 0.0, self.scale, y, 0.0, 0.0, 1.0)
    }
}

/// Points around the origin, at unit size.
struct Scaled {
    pixels: Scaling,
    table: Scaling,
    pairs: Vec<([f64; 2], [f64; 2])>,
}

impl Scaled {
    fn of(points: &[Sighting]) -> Option<Scaled> {
        if points.len() < N / 2 {
            return None;
        }
        let level = |point: &Sighting| [point.base.x, point.base.y];
        let pixels = Scaling::of(points.iter().map(|point| point.pixel))?;
        let table = Scaling::of(points.iter().map(level))?;
        let pair = |point: &Sighting| (pixels.apply(point.pixel), table.apply(level(point)));
        Some(Scaled {
            pixels,
            table,
            pairs: points.iter().map(pair).collect(),
        })
    }

    /// Solves the linear equations for the homography.
    fn start(&self) -> Option<Numbers> {
        let mut normal = SMatrix::<f64, 9, 9>::zeros();
        for ([u, v], [x, y]) in &self.pairs {
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
    fn refined(&self, start: Numbers) -> Option<Numbers> {
        let mut numbers = start;
        let mut cost = self.cost(&numbers)?;
        for _ in 0..MAX_STEPS {
            let (normal, down) = self.normal(&numbers);
            let mut step = normal.cholesky()?.solve(&down);
            // A step that overshoots is halved; from the linear solution that hardly ever happens.
            let taken = (0..20).find_map(|_| {
                let next = numbers + step;
                let better = self.cost(&next).filter(|next| *next <= cost);
                step = if better.is_some() { step } else { step / 2.0 };
                better.map(|better| (next, better))
            });
            let Some((next, better)) = taken else {
                break;
            };
            (numbers, cost) = (next, better);
            if step.norm() < SMALL_STEP {
                break;
            }
        }
        Some(numbers)
    }

    fn cost(&self, numbers: &Numbers) -> Option<f64> {
        self.pairs.iter().try_fold(0.0, |sum, (pixel, [x, y])| {
            let (put, _) = image_of(numbers, *pixel)?;
            Some(sum + (put[0] - x).powi(2) + (put[1] - y).powi(2))
        })
    }

    /// Returns the normal equations' matrix and right side.
    fn normal(&self, numbers: &Numbers) -> (Square, Numbers) {
        let (mut normal, mut down) = (Square::zeros(), Numbers::zeros());
        for (pixel, [x, y]) in &self.pairs {
            let Some((put, slope)) = image_of(numbers, *pixel) else {
                continue;
            };
            normal += slope.transpose() * slope;
            down += slope.transpose() * nalgebra::Vector2::new(x - put[0], y - put[1]);
        }
        (normal, down)
    }

    fn base_from_pixel(&self, numbers: &Numbers) -> Option<Matrix3<f64>> {
        let scaled = Matrix3::from_row_iterator(numbers.iter().copied().chain([1.0]));
        let whole = self.table.matrix().try_inverse()? * scaled * self.pixels.matrix();
        whole
            .iter()
            .all(|number| number.is_finite())
            .then_some(whole)
    }
}

/// Returns the image of a scaled pixel, and its derivative by the homography's numbers.
fn image_of(numbers: &Numbers, [u, v]: [f64; 2]) -> Option<([f64; 2], SMatrix<f64, 2, N>)> {
    let h = numbers;
    let factor = h[6] * u + h[7] * v + 1.0;
    if factor <= 0.0 {
        return None;
    }
    let (x, y) = (
        (h[0] * u + h[1] * v + h[2]) / factor,
        (h[3] * u + h[4] * v + h[5]) / factor,
    );
    let slope = SMatrix::<f64, 2, N>::from_row_slice(&[
        u,
        v,
        1.0,
        0.0,
        0.0,
        0.0,
        -x * u,
        -x * v,
        0.0,
        0.0,
        0.0,
        u,
        v,
        1.0,
        -y * u,
        -y * v,
    ]) / factor;
    Some(([x, y], slope))
}
