//! The accuracy of a fit.
//!
//! In: a fit and its points. Out: the error of each point, its error when the fit leaves it out, and summaries of both.

use super::fault::Fault;
use super::fit::{Fit, Solver};
use super::sighting::Sighting;
use super::spread::Spread;

/// The accuracy of a fit. Errors are distances in space between the tool and the fit's position for the pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Accuracy {
    /// The error of each point, millimetres, in the order of the points.
    pub residual_mm: Vec<f64>,
    /// The error of each point under the fit of the others, millimetres.
    pub left_out_mm: Vec<f64>,
    /// Root mean square of the errors, millimetres.
    pub rms_mm: f64,
    /// Root mean square of the left-out errors, millimetres.
    pub left_out_rms_mm: f64,
    /// The area covered by the points, and how their errors propagate beyond it.
    pub spread: Spread,
}

impl Accuracy {
    /// Returns the points, numbered from 1, that contradict the others although all together are accepted.
    ///
    /// The error of such a point exceeds `limit_mm` and three times that of the others.
    pub fn outliers(&self, limit_mm: f64) -> Vec<usize> {
        let others_rms = |out: usize| {
            let kept = self.left_out_mm.iter().enumerate();
            let kept: Vec<f64> = kept.filter(|it| it.0 != out).map(|it| *it.1).collect();
            root_mean_square(&kept)
        };
        let stands_out = |(index, error): &(usize, &f64)| {
            **error > limit_mm && **error > 3.0 * others_rms(*index)
        };
        let found = self.left_out_mm.iter().enumerate().filter(stands_out);
        found.map(|(index, _)| index + 1).collect()
    }
}

/// Returns the error of each point, millimetres; `None` if the fit cannot locate one.
pub(super) fn errors_mm(fit: &Fit, points: &[Sighting]) -> Option<Vec<f64>> {
    let error = |point| Some(fit.error(point)?.norm() * 1000.0);
    points.iter().map(error).collect()
}

/// Returns the error of each point under the fit of the others, millimetres.
pub(super) fn left_out(solver: &Solver, points: &[Sighting]) -> Result<Vec<f64>, Fault> {
    let error = |out: usize| {
        let others: Vec<Sighting> = points[..out]
            .iter()
            .chain(&points[out + 1..])
            .copied()
            .collect();
        let error = solver.fit(&others)?.error(&points[out])?;
        Some(error.norm() * 1000.0)
    };
    (0..points.len())
        .map(|out| error(out).ok_or(Fault::HangsOn { point: out + 1 }))
        .collect()
}

/// Returns the root mean square; 0 for no values.
pub(super) fn root_mean_square(errors: &[f64]) -> f64 {
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    (squares / errors.len().max(1) as f64).sqrt()
}
