//! Reports a calibration as text and as JSON, and warns of doubtful values.

use crate::io::Io;
use fab_agent::arm_sight::SIGHT;
use fab_arm::calibration::{Calibration, Check, METHOD, tilt_deg};
use fab_arm::settings::Settings;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The files that were written.
pub struct Written<'a> {
    /// The calibration file.
    pub file: &'a Path,
    /// Its reference picture.
    pub reference: Option<PathBuf>,
    /// The drawing of the errors.
    pub drawn: Option<&'a Path>,
    /// The backup of the previous file.
    pub earlier: Option<&'a Path>,
}

/// Returns the table's height at its middle, metres, base frame.
fn height_m(calibration: &Calibration, settings: &Settings) -> f64 {
    let [x, y, _] = settings.table.center_m;
    calibration.table_height_m([x, y])
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

/// Returns the report as the fields that scripts rely on.
pub fn as_json(calibration: &Calibration, settings: &Settings, written: &Written<'_>) -> Value {
    let accuracy = &calibration.accuracy;
    let errors = accuracy.residual_mm.iter().zip(&accuracy.left_out_mm);
    let points: Vec<Value> = calibration
        .pairs
        .iter()
        .zip(errors)
        .map(|(pair, (residual_mm, left_out_mm))| {
            let mut point = json!({
                "pixel": pair.pixel,
                "base_m": pair.base_m,
                "residual_mm": residual_mm,
                "left_out_mm": left_out_mm,
            });
            if let Some(tag) = pair.tag {
                point["tag"] = json!(tag);
            }
            point
        })
        .collect();
    let spread = &accuracy.spread;
    json!({
        "method": METHOD,
        "made_on": calibration.made_on,
        "camera": calibration.terms.camera,
        "points": points,
        "rms_mm": accuracy.rms_mm,
        "left_out_mm": accuracy.left_out_rms_mm,
        "limit_mm": calibration.terms.limit_mm,
        "spread": {
            "length_m": spread.length_m,
            "width_m": spread.width_m,
            "plane_gain": spread.plane_gain,
            "height_gain": spread.height_gain,
        },
        "height_m": height_m(calibration, settings),
        "tilt_deg": tilt_deg(&calibration.fit),
        "corners": accuracy.corners,
        "checks": checks_as_json(&accuracy.checks),
        "marks": calibration.marks(&SIGHT)[0],
        "file": written.file,
        "reference": written.reference,
        "drawn": written.drawn,
        "earlier": written.earlier,
    })
}

/// Returns every compared value with its bound, by its name.
pub fn checks_as_json(checks: &[Check]) -> Value {
    let by_name = checks.iter().map(|check| {
        let Check { value, bound, .. } = check;
        (
            check.name.to_owned(),
            json!({ "value": value, "bound": bound }),
        )
    });
    Value::Object(by_name.collect())
}

/// Returns the report as lines for a person.
pub fn as_text(calibration: &Calibration, settings: &Settings, written: &Written<'_>) -> String {
    let accuracy = &calibration.accuracy;
    let errors = accuracy.residual_mm.iter().zip(&accuracy.left_out_mm);
    let mut lines = vec![
        "point   column     row        x        y        z    error  by the others".to_owned(),
    ];
    for ((pair, (residual, left_out)), number) in calibration.pairs.iter().zip(errors).zip(1..) {
        let ([u, v], [x, y, z]) = (pair.pixel, pair.base_m);
        lines.push(format!(
            "{number:5} {u:8.1} {v:7.1} {x:8.4} {y:8.4} {z:8.4} {residual:5.1} mm {left_out:11.1} mm"
        ));
    }
    lines.push(format!(
        "{} by {} points: {:.1} mm (root mean square), each by the others {:.1} mm; the limit is {} mm",
        METHOD,
        calibration.pairs.len(),
        accuracy.rms_mm,
        accuracy.left_out_rms_mm,
        calibration.terms.limit_mm
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
        height_m(calibration, settings),
        tilt_deg(&calibration.fit)
    ));
    lines.push("compared with the settings              value    bound".to_owned());
    let compared = accuracy.checks.iter().filter(|check| check.is_comparison());
    lines.extend(compared.map(|check| {
        let Check {
            name, value, bound, ..
        } = check;
        format!("{name:37} {value:7.1} {bound:8.1}")
    }));
    if let Some(earlier) = written.earlier {
        lines.push(format!("kept: {}", earlier.display()));
    }
    let files = std::iter::once(written.file)
        .chain(written.reference.as_deref())
        .chain(written.drawn);
    lines.extend(files.map(|file| format!("written: {}", file.display())));
    lines.join("\n")
}
