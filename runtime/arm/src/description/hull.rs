//! Finds a capsule that contains given balls.
//!
//! In: the balls' middles and their one radius. Out: a capsule that contains all of them, as thin as a few directions of
//! its axis allow.

use nalgebra::{Matrix3, Point3, SymmetricEigen, Unit, Vector3};

/// Steps of the search for the middle of points in a plane; each comes nearer by its share.
const STEPS: u32 = 200;

/// Slack for rounding, metres.
const EXACT_M: f64 = 1e-9;

/// The ends of a capsule's line, and its radius, metres.
pub(super) type Ends = (Point3<f64>, Point3<f64>, f64);

/// Returns a capsule around balls; `None` if there is none.
///
/// - `middles`: metres; `radius_m`: the radius of each.
pub(super) fn capsule(middles: &[Point3<f64>], radius_m: f64) -> Option<Ends> {
    let [x, y, z] = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
    let axes = principal(middles)?.into_iter().chain([x, y, z]);
    let volume = |(from, to, radius_m): &Ends| {
        radius_m.powi(2) * ((to - from).norm() + 4.0 / 3.0 * radius_m)
    };
    axes.map(|axis| along(middles, radius_m, &axis))
        .min_by(|one, other| volume(one).total_cmp(&volume(other)))
}

/// Returns the axes of the points' spread.
fn principal(points: &[Point3<f64>]) -> Option<[Unit<Vector3<f64>>; 3]> {
    if points.is_empty() {
        return None;
    }
    let sum: Vector3<f64> = points.iter().map(|point| point.coords).sum();
    let middle = sum / points.len() as f64;
    let spread = points.iter().map(|point| point.coords - middle);
    let spread: Matrix3<f64> = spread.map(|away| away * away.transpose()).sum();
    let axes = SymmetricEigen::new(spread).eigenvectors;
    let axis = |index: usize| Unit::try_new(axes.column(index).into_owned(), 0.5);
    // Points in one place have no spread.
    Some([
        axis(0).unwrap_or(Vector3::x_axis()),
        axis(1).unwrap_or(Vector3::y_axis()),
        axis(2).unwrap_or(Vector3::z_axis()),
    ])
}

/// Returns the capsule with its axis in a direction.
fn along(middles: &[Point3<f64>], radius_m: f64, axis: &Unit<Vector3<f64>>) -> Ends {
    let flat = |point: &Point3<f64>| point.coords - axis.into_inner() * point.coords.dot(axis);
    // Steps towards the farthest point lead to the middle of the smallest circle (Badoiu and Clarkson 2003).
    let mut centre = flat(&middles[0]);
    for step in 1..=STEPS {
        let away = middles.iter().map(|point| flat(point) - centre);
        let farthest =
            away.max_by(|one, other| one.norm_squared().total_cmp(&other.norm_squared()));
        centre += farthest.unwrap_or_default() / f64::from(step + 1);
    }
    let aside_m = |point: &Point3<f64>| (flat(point) - centre).norm();
    let round_m = middles.iter().map(aside_m).fold(0.0, f64::max);
    // Each end's ball must reach over the points before it; nothing else holds them.
    let reach_m = |point: &Point3<f64>| (round_m.powi(2) - aside_m(point).powi(2)).max(0.0).sqrt();
    let at_m = |point: &Point3<f64>| point.coords.dot(axis);
    let [mut low_m, mut high_m] = [f64::INFINITY, f64::NEG_INFINITY];
    for point in middles {
        low_m = low_m.min(at_m(point) + reach_m(point));
        high_m = high_m.max(at_m(point) - reach_m(point));
    }
    if low_m > high_m {
        // A ball contains them all.
        low_m = (low_m + high_m) / 2.0;
        high_m = low_m;
    }
    let end = |at_m: f64| Point3::from(centre + axis.into_inner() * at_m);
    (end(low_m), end(high_m), round_m + radius_m + EXACT_M)
}
