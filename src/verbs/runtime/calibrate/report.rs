//! Reports a calibration as text and as JSON, and warns of doubtful values.

use crate::io::Io;
use fab_agent::arm_sight::SIGHT;
use fab_arm::calibration::{Accuracy, Calibration, METHOD, Pair, tilt_deg};
use fab_arm::settings::Settings;
use fab_base::table::{Align, aligned};
use serde::Serialize;
use std::path::PathBuf;

#[derive(Serialize)]
pub struct Calibrated<'a> {
    method: &'static str,
    made_on: &'a str,
    camera: &'a str,
    points: &'a [Pair],
    limit_mm: f64,
    #[serde(flatten)]
    accuracy: &'a Accuracy,
    /// The table's height at its middle, metres, base frame.
    height_m: f64,
    tilt_deg: f64,
    marks: usize,
    file: PathBuf,
    /// The picture by which a moved camera is noticed.
    reference: Option<PathBuf>,
    /// The drawing of the errors.
    drawn: Option<PathBuf>,
    /// The backup of the previous calibration.
    earlier: Option<PathBuf>,
}

/// Warns on stderr of what a person should check, even though the calibration was accepted.
pub fn say_doubts(calibration: &Calibration, io: &Io) {
    let note = |text: String| io.talk(&format!("note: {text}"));
    for point in calibration.accuracy.outliers(calibration.terms.limit_mm) {
        let off_mm = calibration.accuracy.left_out_mm[point - 1];
        note(format!(
            "point {point} is {off_mm:.1} mm from where the others put it, far more than any other; was it typed wrong?"
        ));
    }
    let [n_marks, needed] = calibration.marks(&SIGHT);
    if calibration.reference.is_none() {
        note(
            "without a picture, a moved camera could not be noticed, so that no run begins; give one with `--image PNG`, or take one with `--shoot`"
                .to_owned(),
        );
    } else if n_marks < needed {
        note(format!(
            "the picture shows {n_marks} places that can be found again, and {needed} are needed to notice a moved \
             camera: stick a few pieces of printed paper beside the cloth's place"
        ));
    }
}

impl<'a> Calibrated<'a> {
    /// Reports a calibration that was written to `file`.
    pub fn of(
        made: &'a Calibration,
        settings: &Settings,
        file: PathBuf,
        drawn: Option<PathBuf>,
        earlier: Option<PathBuf>,
    ) -> Calibrated<'a> {
        let [x, y, _] = settings.table.center_m;
        let reference = made.reference.as_ref();
        Calibrated {
            method: METHOD,
            made_on: &made.made_on,
            camera: &made.terms.camera,
            points: &made.pairs,
            limit_mm: made.terms.limit_mm,
            accuracy: &made.accuracy,
            height_m: made.table_height_m([x, y]),
            tilt_deg: tilt_deg(&made.fit),
            marks: made.marks(&SIGHT)[0],
            reference: reference.map(|_| Calibration::picture_beside(&file)),
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
        lines.push(format!(
            "{METHOD} by {} points: {:.1} mm (root mean square), each by the others {:.1} mm; the limit is {} mm",
            self.points.len(),
            accuracy.rms_mm,
            accuracy.left_out_rms_mm,
            self.limit_mm
        ));
        let spread = &accuracy.spread;
        lines.push(format!(
            "the points cover {:.0} x {:.0} mm; 1 mm of error in them is at most {:.1} mm in the plane and {:.1} mm in height",
            spread.length_m * 1000.0,
            spread.width_m * 1000.0,
            spread.plane_gain,
            spread.height_gain
        ));
        lines.push(format!(
            "the table's middle is at {:.4} m, tilted by {:.1} degrees against the base",
            self.height_m, self.tilt_deg
        ));
        let titles = ["compared with the settings", "value", "bound"];
        let mut table = vec![titles.map(str::to_owned)];
        let compared = accuracy.checks.iter().filter(|check| check.is_comparison());
        table.extend(compared.map(|check| {
            let [value, bound] = [check.value, check.bound].map(|value| format!("{value:.1}"));
            [check.name.to_owned(), value, bound]
        }));
        lines.extend(aligned(&[Align::Left, Align::Right, Align::Right], &table));
        let earlier = self.earlier.iter();
        lines.extend(earlier.map(|file| format!("kept: {}", file.display())));
        let files = [&self.file].into_iter();
        let files = files.chain(&self.reference).chain(&self.drawn);
        lines.extend(files.map(|file| format!("written: {}", file.display())));
        lines.join("\n")
    }
}
