//! Reports a calibration as text and as JSON.

use fab_arm::calibration::{Calibration, Corner, Pair};
use serde::Serialize;
use std::path::PathBuf;

/// How well the points of a calibration agree, and the table is known by them.
#[derive(Serialize)]
pub struct Quality {
    pub made_on: String,
    limit_mm: f64,
    /// The error of each point by the others.
    left_out_mm: Vec<f64>,
    left_out_rms_mm: f64,
    corners: [Corner; 4],
}

impl Quality {
    pub fn of(made: &Calibration, corners: [Corner; 4]) -> Quality {
        Quality {
            made_on: made.made_on.clone(),
            limit_mm: made.terms.limit_mm,
            left_out_mm: made.left_out_mm.clone(),
            left_out_rms_mm: made.left_out_rms_mm(),
            corners,
        }
    }

    pub fn text(&self) -> String {
        let corners = self.corners.iter().map(|corner| {
            let ([x, y, _], error_mm) = (corner.at_m, corner.error_mm);
            format!("{x:.3}, {y:.3} to {error_mm:.1} mm")
        });
        format!(
            "{} points, each by the others: {:.1} mm (root mean square); the limit is {} mm\nthe table's corners are known: {}",
            self.left_out_mm.len(),
            self.left_out_rms_mm,
            self.limit_mm,
            corners.collect::<Vec<String>>().join("; ")
        )
    }
}

/// A calibration that was written.
#[derive(Serialize)]
pub struct Calibrated<'a> {
    #[serde(flatten)]
    pub quality: Quality,
    pub points: &'a [Pair],
    pub file: PathBuf,
    /// The picture by which a moved camera is noticed.
    pub reference: PathBuf,
    /// The drawing of the errors.
    pub drawn: PathBuf,
}

impl Calibrated<'_> {
    pub fn text(&self) -> String {
        let titles = "point  column    row       x        y       z  by the others, mm";
        let mut lines = vec![titles.to_owned()];
        let errors_mm = self.quality.left_out_mm.iter();
        lines.extend(self.points.iter().zip(errors_mm).zip(1..).map(
            |((point, off_mm), number)| {
                let ([u, v], [x, y, z]) = (point.pixel, point.base_m);
                format!("{number:>5}  {u:>6.1} {v:>6.1} {x:>7.4}  {y:>7.4} {z:>7.4} {off_mm:>18.1}")
            },
        ));
        lines.push(self.quality.text());
        let files = [&self.file, &self.reference, &self.drawn].into_iter();
        lines.extend(files.map(|file| format!("written: {}", file.display())));
        lines.join("\n")
    }
}
