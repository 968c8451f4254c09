//! Tests that calibration files round-trip, and that changed ones are refused.

use super::super::file::MAX_BYTES;
use super::*;
use image::Luma;
use std::fs;

fn noisy() -> Calibration {
    let mut pairs = measured_grid(11, 4, 0.8);
    pairs[3].tag = Some(TagName(7));
    let reference = GrayImage::from_fn(640, 480, |u, v| Luma([(u * 7 + v * 13) as u8]));
    let mut terms = terms();
    terms.camera = "a \"topic\"\n\u{7f}".to_owned();
    Calibration::make(terms, pairs, "2026-11-22", Some(reference)).unwrap()
}

#[test]
fn what_is_kept_is_what_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lab.toml");
    let mut made = noisy();
    made.save(&path).unwrap();
    assert_eq!(Calibration::load(&path).unwrap(), made);
    made.reference = None;
    made.terms.camera = "a".to_owned();
    made.save(&path).unwrap();
    assert_eq!(Calibration::load(&path).unwrap(), made);
}

#[test]
fn what_was_changed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lab.toml");
    let made = noisy();
    made.save(&path).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    let pixel = format!("pixel = {:?}", made.pairs[4].pixel);
    let residual = format!("residual_mm = {:?}", made.accuracy.residual_mm[2]);
    let matrix = format!("{:?}", made.fit.world_from_pixel[(0, 0)]);
    let place = format!("base_m = {:?}", made.pairs[4].base_m);
    let longer = place.replace(']', ", 0.5]");
    let shifted = format!("pixel = {:?}", made.pairs[4].pixel.map(|it| it + 1.0));
    let cases: [(&str, &str, &str, &str); 16] = [
        (
            "matrix",
            &matrix,
            "0.001",
            "`fit.base_from_pixel.1.1` does not fit its points",
        ),
        (
            "cut matrix",
            &format!("{matrix}, "),
            "",
            "expected an array of length 3",
        ),
        (
            "height",
            "height = [",
            "height = [0.1, 0.0, 0.0]\nold = [",
            "`fit.height.1` does not fit",
        ),
        (
            "key",
            "limit_mm",
            "slack_mm = 3\nlimit_mm",
            "`terms.slack_mm` does not fit",
        ),
        (
            "longer place",
            &place,
            &longer,
            "invalid length 4, expected 3 elements",
        ),
        (
            "pixel",
            &pixel,
            "pixel = [1.0, 1.0]",
            "its points are refused: point 5 is",
        ),
        ("shifted pixel", &pixel, &shifted, "does not fit its points"),
        (
            "residual",
            &residual,
            "residual_mm = 0.0",
            "`points.3.residual_mm` does not fit",
        ),
        (
            "error",
            "rms_mm = ",
            "rms_mm = 1",
            "`accuracy.rms_mm` does not fit",
        ),
        (
            "bound",
            "shear_deg = ",
            "shear_deg = 1",
            "`accuracy.shear_deg` does not fit",
        ),
        (
            "format",
            "format = 2",
            "format = 1",
            "its format is 1, and this fabc reads 2",
        ),
        (
            "day",
            "2026-11-22",
            "2026-13-22",
            "not a date such as `2026-11-22`",
        ),
        (
            "day of the month",
            "2026-11-22",
            "2026-02-30",
            "not a date such as `2026-11-22`",
        ),
        ("method", "\"plane\"", "\"guess\"", "`method` does not fit"),
        ("tag", "tag7", "seven", "`seven` is not a tag"),
        (
            "window",
            "window = [80,",
            "window = [280,",
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
    let made = noisy();
    made.save(&path).unwrap();
    let beside = Calibration::picture_beside(&path);
    assert_eq!(beside, folder.path().join("lab.png"));
    let mut other = made.reference.clone().unwrap();
    other.put_pixel(3, 4, Luma([9]));
    fs::write(&beside, fab_picture::png::encode(&other)).unwrap();
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
