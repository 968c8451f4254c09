//! Tests that calibration files round-trip, and that changed ones are refused.

use super::*;
use image::Luma;
use std::fs;

fn noisy() -> Calibration {
    let pairs = measured_grid(11, 4, 0.8);
    let reference = GrayImage::from_fn(640, 480, |u, v| Luma([(u * 7 + v * 13) as u8]));
    Calibration::make(terms(), pairs, "2026-11-22", Some(reference)).unwrap()
}

#[test]
fn what_is_kept_is_what_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lab.toml");
    let mut made = noisy();
    made.save(&path).unwrap();
    assert_eq!(Calibration::load(&path).unwrap(), made);
    made.reference = None;
    fs::remove_file(Calibration::picture_beside(&path)).unwrap();
    made.save(&path).unwrap();
    assert_eq!(Calibration::load(&path).unwrap(), made);
}

#[test]
fn damaged_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lab.toml");
    let made = noisy();
    made.save(&path).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    let pixel = format!("pixel = {:?}", made.pairs[4].pixel);
    let cases: [(&str, &str, &str); 3] = [
        (
            &pixel,
            "pixel = [1.0, 1.0]",
            "without point 5 the others agree",
        ),
        (
            "format = 2",
            "format = 1",
            "its format is 1, and this fabc reads 2",
        ),
        ("limit_mm = 4.0", "limit_mm = 40.0", "the limit is 40 mm"),
    ];
    for (from, to, wanted) in cases {
        assert!(text.contains(from), "{from}");
        fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let error = Calibration::load(&path).unwrap_err().to_string();
        assert!(error.contains(wanted), "{to}: {error}");
    }
    for length in [0, 1, text.len() / 3, text.len() / 2, text.len() - 30] {
        fs::write(&path, &text[..length]).unwrap();
        assert!(Calibration::load(&path).is_err(), "cut off at {length}");
    }
    fs::write(&path, "# ".repeat(1 << 20)).unwrap();
    let error = Calibration::load(&path).unwrap_err().to_string();
    assert!(error.contains("longer than the limit"), "{error}");
}

/// Until 2026-11-30, files repeated what follows from their points, and what the settings say.
#[test]
fn a_file_with_computed_values_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lab.toml");
    let made = Calibration {
        reference: None,
        ..noisy()
    };
    let text = made.to_toml();
    let old = text
        .replace(
            "[terms]",
            "method = \"plane\"\n[accuracy]\nrms_mm = 0.5\n[terms]\nwindow = [80, 0, 480]",
        )
        .replace("base_m =", "residual_mm = 0.4\nbase_m =");
    assert_ne!(text, old);
    fs::write(&path, old).unwrap();
    assert_eq!(Calibration::load(&path).unwrap(), made);
}

#[test]
fn a_picture_of_another_size_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lab.toml");
    let made = noisy();
    made.save(&path).unwrap();
    let beside = Calibration::picture_beside(&path);
    assert_eq!(beside, folder.path().join("lab.png"));
    let small = GrayImage::new(320, 240);
    fs::write(&beside, fab_picture::png::encode(&small)).unwrap();
    let error = Calibration::load(&path).unwrap_err();
    assert!(error.contains("the picture has 320 x 240 px"), "{error}");
    fs::write(&beside, "no picture").unwrap();
    let error = Calibration::load(&path).unwrap_err();
    assert!(error.contains("lab.png"), "{error}");
}
