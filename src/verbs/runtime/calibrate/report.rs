//! Reports a calibration as text and as JSON.

use fab_arm::calibration::{Calibration, Corner, Pair};
use fab_base::table::{Align, aligned};
use serde::Serialize;
use std::path::PathBuf;

#[derive(Serialize)]
pub struct Calibrated<'a> {
    made_on: &'a str,
    points: &'a [Pair],
    limit_mm: f64,
    /// The error of each point by the others.
    left_out_mm: &'a [f64],
    left_out_rms_mm: f64,
    corners: [Corner; 4],
    file: PathBuf,
    /// The picture by which a moved camera is noticed.
    reference: PathBuf,
    /// The drawing of the errors.
    drawn: PathBuf,
}

impl<'a> Calibrated<'a> {
    /// Reports a calibration that was written to `file`.
    pub fn of(
        made: &'a Calibration,
        corners: [Corner; 4],
        file: PathBuf,
        drawn: PathBuf,
    ) -> Calibrated<'a> {
        Calibrated {
            made_on: &made.made_on,
            points: &made.pairs,
            limit_mm: made.terms.limit_mm,
            left_out_mm: &made.left_out_mm,
            left_out_rms_mm: made.left_out_rms_mm(),
            corners,
            reference: Calibration::picture_beside(&file),
            file,
            drawn,
        }
    }

    pub fn text(&self) -> String {
        let titles = "point|column|row|x|y|z|by the others, mm";
        let mut table = vec![titles.split('|').map(str::to_owned).collect()];
        for ((point, off_mm), number) in self.points.iter().zip(self.left_out_mm).zip(1..) {
            let [u, v] = point.pixel.map(|at| format!("{at:.1}"));
            let [x, y, z] = point.base_m.map(|at| format!("{at:.4}"));
            table.push(vec![
                number.to_string(),
                u,
                v,
                x,
                y,
                z,
                format!("{off_mm:.1}"),
            ]);
        }
        let mut lines = aligned(&[Align::Right; 7], &table);
        lines.push(format!(
            "{} points, each by the others: {:.1} mm (root mean square); the limit is {} mm",
            self.points.len(),
            self.left_out_rms_mm,
            self.limit_mm
        ));
        let corners = self.corners.iter().map(|corner| {
            let ([x, y, _], error_mm) = (corner.at_m, corner.error_mm);
            format!("{x:.3}, {y:.3} to {error_mm:.1} mm")
        });
        let corners = corners.collect::<Vec<String>>().join("; ");
        lines.push(format!("the table's corners are known: {corners}"));
        let files = [&self.file, &self.reference, &self.drawn].into_iter();
        lines.extend(files.map(|file| format!("written: {}", file.display())));
        lines.join("\n")
    }
}
