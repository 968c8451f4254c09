//! Decides whether points fit well enough to make a calibration.
//!
//! In: points and terms. Out: the fit with the error of each point, its error when left out, and how errors propagate
//! from the points' spread; or a refusal. It stops at the first fault, because later ones would follow from it.

use super::accuracy::{Accuracy, errors_mm, left_out, root_mean_square};
use super::fault::{Fault, MAX_GAIN, MAX_SCALE_OFF, MAX_TILT_DEG};
use super::fit::{Fit, Solver};
use super::{LEFT_OUT_SHARE, Pair, Refusal, Terms, mistakes, rigid, spread};

/// Fits points and judges the fit.
pub(super) fn judge(terms: &Terms, pairs: &[Pair]) -> Result<(Fit, Accuracy), Refusal> {
    mistakes::check(terms, pairs)?;
    let solver = Solver::of(terms)?;
    let points = solver.sightings(pairs)?;
    let fit = solver.fit(&points);
    let residual_mm = fit.as_ref().and_then(|fit| errors_mm(fit, &points));
    let fits = |errors: &Vec<f64>| root_mean_square(errors) <= terms.limit_mm;
    if !residual_mm.as_ref().is_some_and(fits)
        && let Some(refusal) = mistakes::find(terms, &solver, pairs)
    {
        return Err(refusal);
    }
    let covered = spread::extent_m(&points);
    let (Some(fit), Some(residual_mm)) = (fit, residual_mm) else {
        let [length_mm, width_mm] = covered.map(|side| side * 1000.0);
        return Err(Fault::OnALine {
            length_mm,
            width_mm,
        }
        .into());
    };
    let against = |fault: Fault| Refusal {
        faults: vec![fault],
        fit: Some(Box::new(fit.clone())),
    };
    let is_mirrored = match fit {
        Fit::Plane { .. } => false,
        // Points of a table lie in a plane, so a pose fits them mirrored or not; in that case the side from which it
        // sees the table decides.
        Fit::Rigid { .. } => !fits(&residual_mm) && rigid::fits_mirrored(&points),
    };
    if is_mirrored || !fit.sees_from_above(terms.window.middle_px()) {
        let hint = mistakes::why_mirrored(terms, pairs);
        return Err(against(Fault::Mirrored { hint }));
    }
    let spread = spread::measure(terms, &fit, &points).map_err(against)?;
    if !(spread.plane_gain <= MAX_GAIN && spread.height_gain <= MAX_GAIN) {
        return Err(against(Fault::Spread {
            length_mm: spread.length_m * 1000.0,
            width_mm: spread.width_m * 1000.0,
            plane_gain: spread.plane_gain,
            height_gain: spread.height_gain,
        }));
    }
    let left_out_mm = left_out(&solver, &points).map_err(against)?;
    let accuracy = Accuracy {
        rms_mm: root_mean_square(&residual_mm),
        left_out_rms_mm: root_mean_square(&left_out_mm),
        residual_mm,
        left_out_mm,
        spread,
    };
    if let Some(fault) = too_large(terms, &accuracy, &fit) {
        return Err(against(fault));
    }
    if fit.tilt_deg() > MAX_TILT_DEG {
        let tilt_deg = fit.tilt_deg();
        return Err(against(Fault::Tilted { tilt_deg }));
    }
    match fit {
        Fit::Rigid { scale, .. } if (scale - 1.0).abs() > MAX_SCALE_OFF => {
            Err(against(Fault::Scale { scale }))
        }
        _ => Ok((fit, accuracy)),
    }
}

fn too_large(terms: &Terms, accuracy: &Accuracy, fit: &Fit) -> Option<Fault> {
    let left_out_limit_mm = terms.limit_mm * LEFT_OUT_SHARE;
    let is_enough =
        accuracy.rms_mm <= terms.limit_mm && accuracy.left_out_rms_mm <= left_out_limit_mm;
    let numbered = accuracy.left_out_mm.iter().copied().zip(1..);
    let (worst_mm, worst) = numbered.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let hint = match fit {
        Fit::Rigid { scale, .. } if (scale - 1.0).abs() > MAX_SCALE_OFF => {
            format!(", and by depth the table is {scale:.3} times as large as by the arm")
        }
        _ => String::new(),
    };
    (!is_enough).then_some(Fault::Inaccurate {
        rms_mm: accuracy.rms_mm,
        left_out_mm: accuracy.left_out_rms_mm,
        limit_mm: terms.limit_mm,
        left_out_limit_mm,
        worst,
        worst_mm,
        hint,
    })
}
