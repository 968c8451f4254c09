//! Tests that calibration files round-trip, and that changed ones are refused.

use super::super::file::MAX_BYTES;
use super::*;
use image::Luma;
use std::fs;

fn noisy(method: Method) -> Calibration {
    let pairs = measured_grid(11, 4, 0.8, 0.001);
    let reference = GrayImage::from_fn(640, 480, |u, v| Luma([(u * 7 + v * 13) as u8]));
    let mut terms = terms(method);
    terms.camera = "a \"topic\"\n\u{7f}".to_owned();
    Calibration::make(terms, pairs, "2026-11-22", Some(reference)).unwrap()
}

#[test]
fn what_is_kept_is_what_is_read() {
    let folder = tempfile::tempdir().unwrap();
    for method in [Method::Plane, Method::Rigid] {
        let mut made = noisy(method);
        let path = folder.path().join("lab.toml");
        made.save(&path).unwrap();
        assert_eq!(Calibration::load(&path).unwrap(), made);
        made.reference = None;
        made.save(&path).unwrap();
        assert_eq!(Calibration::load(&path).unwrap(), made);
    }
}

#[test]
fn what_was_changed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lab.toml");
    let made = noisy(Method::Plane);
    made.save(&path).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    let first_row = text
        .lines()
        .skip_while(|line| *line != "matrix = [")
        .nth(1)
        .unwrap();
    let pixel = format!("pixel = {:?}", made.pairs[4].pixel);
    let residual = format!("residual_mm = {:?}", made.accuracy.residual_mm[2]);
    let cases: [(&str, &str, &str, &str); 12] = [
        (
            "matrix",
            first_row,
            "[0.001, 0.0, 0.0],",
            "`fit.matrix` or `fit.height` does not fit its points",
        ),
        (
            "cut matrix",
            first_row,
            "",
            "`fit.matrix` or `fit.height` does not fit its points",
        ),
        (
            "height",
            "height = [",
            "height = [0.1, 0.0, 0.0]\nold = [",
            "unknown field `old`",
        ),
        (
            "pixel",
            &pixel,
            "pixel = [1.0, 1.0]",
            "its points are refused: point 5 is",
        ),
        (
            "shifted pixel",
            &pixel,
            &format!("pixel = {:?}", made.pairs[4].pixel.map(|it| it + 1.0)),
            "does not fit its points",
        ),
        (
            "residual",
            &residual,
            "residual_mm = 0.0",
            "`residual_mm` or `left_out_mm` of a point does not fit",
        ),
        (
            "error",
            "rms_mm = ",
            "rms_mm = 1",
            "`fit.rms_mm` or `fit.left_out_mm` does not fit",
        ),
        (
            "format",
            "format = 1",
            "format = 2",
            "its format is 2, and this fabc reads 1",
        ),
        (
            "day",
            "2026-11-22",
            "2026-13-22",
            "not a date such as `2026-11-22`",
        ),
        (
            "method",
            "\"plane\"",
            "\"guess\"",
            "`method` is neither `plane` nor `rigid`",
        ),
        (
            "other method",
            "\"plane\"",
            "\"rigid\"",
            "needs the camera's intrinsics",
        ),
        (
            "window",
            "window_px = [80,",
            "window_px = [280,",
            "the window `280, 0, 480` does not lie",
        ),
    ];
    for (name, from, to, wanted) in cases {
        assert!(text.contains(from), "{name}");
        fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let error = Calibration::load(&path).unwrap_err().to_string();
        assert!(error.contains(wanted), "{name}: {error}");
    }
    for length in [0, 1, text.len() / 3, text.len() / 2, text.len() - 30] {
        fs::write(&path, &text[..length]).unwrap();
        assert!(Calibration::load(&path).is_err(), "cut off at {length}");
    }
    fs::write(&path, "# ".repeat(MAX_BYTES as usize)).unwrap();
    assert!(
        Calibration::load(&path)
            .unwrap_err()
            .to_string()
            .contains("longer than the limit")
    );
}

#[test]
fn another_picture_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lab.toml");
    let made = noisy(Method::Plane);
    made.save(&path).unwrap();
    let beside = Calibration::picture_beside(&path);
    assert_eq!(beside, folder.path().join("lab.png"));
    let mut other = made.reference.clone().unwrap();
    other.put_pixel(3, 4, Luma([9]));
    fs::write(&beside, fab_picture::png::encode_gray(&other)).unwrap();
    let error = Calibration::load(&path).unwrap_err().to_string();
    assert!(
        error.contains("is not the picture that the calibration beside it was made with"),
        "{error}"
    );
    fs::remove_file(&beside).unwrap();
    assert!(
        Calibration::load(&path)
            .unwrap_err()
            .to_string()
            .contains("lab.png")
    );
    let small = Some(GrayImage::new(320, 240));
    let refusal = Calibration::make(made.terms, made.pairs, "2026-11-22", small).unwrap_err();
    assert!(matches!(refusal.faults[..], [Fault::PictureSize { .. }]));
}
