//! Reports a calibration as text and as JSON.

use fab_arm::calibration::{Accuracy, Calibration, Corner, Pair};
use fab_base::table::{Align, aligned};
use serde::Serialize;
use std::path::PathBuf;

#[derive(Serialize)]
pub struct Calibrated<'a> {
    made_on: &'a str,
    camera: &'a str,
    points: &'a [Pair],
    limit_mm: f64,
    #[serde(flatten)]
    accuracy: &'a Accuracy,
    corners: [Corner; 4],
    file: PathBuf,
    /// The picture by which a moved camera is noticed.
    reference: PathBuf,
    /// The drawing of the errors.
    drawn: PathBuf,
    /// The backup of the previous calibration.
    earlier: Option<PathBuf>,
}

impl<'a> Calibrated<'a> {
    /// Reports a calibration that was written to `file`.
    pub fn of(
        made: &'a Calibration,
        corners: [Corner; 4],
        file: PathBuf,
        drawn: PathBuf,
        earlier: Option<PathBuf>,
    ) -> Calibrated<'a> {
        Calibrated {
            made_on: &made.made_on,
            camera: &made.terms.camera,
            points: &made.pairs,
            limit_mm: made.terms.limit_mm,
            accuracy: &made.accuracy,
            corners,
            reference: Calibration::picture_beside(&file),
            file,
            drawn,
            earlier,
        }
    }

    pub fn text(&self) -> String {
        let accuracy = self.accuracy;
        let errors = accuracy.residual_mm.iter().zip(&accuracy.left_out_mm);
        let titles = "point|column|row|x|y|z|error, mm|by the others, mm";
        let mut table = vec![titles.split('|').map(str::to_owned).collect()];
        for ((point, (error, left_out)), number) in self.points.iter().zip(errors).zip(1..) {
            let [u, v] = point.pixel.map(|at| format!("{at:.1}"));
            let [x, y, z] = point.base_m.map(|at| format!("{at:.4}"));
            let [error, left_out] = [error, left_out].map(|mm| format!("{mm:.1}"));
            table.push(vec![number.to_string(), u, v, x, y, z, error, left_out]);
        }
        let mut lines = aligned(&[Align::Right; 8], &table);
        let (worst, worst_mm) = accuracy.worst();
        lines.push(format!(
            "{} points: {:.1} mm (root mean square), each by the others {:.1} mm, point {worst} {worst_mm:.1} mm; the limit is {} mm",
            self.points.len(),
            accuracy.rms_mm,
            accuracy.left_out_rms_mm,
            self.limit_mm
        ));
        let corners = self.corners.iter().map(|corner| {
            let ([x, y, _], error_mm) = (corner.at_m, corner.error_mm);
            format!("{x:.3}, {y:.3} to {error_mm:.1} mm")
        });
        let corners = corners.collect::<Vec<String>>().join("; ");
        lines.push(format!("the table's corners are known: {corners}"));
        let earlier = self.earlier.iter();
        lines.extend(earlier.map(|file| format!("kept: {}", file.display())));
        let files = [&self.file, &self.reference, &self.drawn].into_iter();
        lines.extend(files.map(|file| format!("written: {}", file.display())));
        lines.join("\n")
    }
}
