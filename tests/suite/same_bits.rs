//! The detectors give the same bits in WebAssembly, and with the instructions that newer processors have.
//!
//! `make test-all` runs the first test if node and the standard library of wasm32-unknown-unknown are available
//! (scripts/wasm-parts.sh).

#[path = "../wasm/host.rs"]
mod host;
#[path = "../wasm/keypoints.rs"]
mod keypoints;

use super::support::{project, root as project_root};
use crate::recorded_data::recorded_data;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Reads the manifest of recorded pictures, and returns each picture that is there with its recorded corners.
fn recorded(
    root: &Path,
    folder: &str,
    corners: &str,
    file: impl Fn(&Value) -> String,
) -> Vec<(Value, Value)> {
    let manifest = fs::read_to_string(root.join(folder).join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    let mut pictures = Vec::new();
    for fixture in manifest["fixtures"].as_array().unwrap() {
        let Ok(picture) = image::open(root.join(file(fixture))) else {
            continue;
        };
        let picture = picture.into_luma8();
        let mut levels = String::new();
        for level in picture.as_raw() {
            write!(levels, "{level:02x}").unwrap();
        }
        let limit = fixture.get("corner_limit");
        let asked = json!({
            "width": picture.width(),
            "levels": levels,
            "max": limit.unwrap_or(&json!(27)),
            "harris": limit.is_none(),
        });
        pictures.push((asked, fixture[corners].clone()));
    }
    pictures
}

#[test]
#[ignore = "needs node and the standard library of wasm32-unknown-unknown"]
fn peer_node_finds_in_webassembly_the_recorded_corners_and_the_same_outlines() {
    let Some(root) =
        recorded_data("peer_node_finds_in_webassembly_the_recorded_corners_and_the_same_outlines")
    else {
        return;
    };
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let mut pictures = recorded(&root, "vision/harris128", "corners", |fixture| {
        text(&fixture["file"])
    });
    pictures.extend(recorded(
        &root,
        "vision/shi_tomasi",
        "recorded_corners",
        |fixture| format!("{}/gray.png", text(&fixture["dir"])),
    ));
    assert!(pictures.len() >= 290, "{} pictures", pictures.len());
    let asked: Value = pictures.iter().map(|(asked, _)| asked.clone()).collect();
    let target = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let found = host::call(project_root(), target, "keypoints", &asked);
    for ((asked, corners), found) in pictures.iter().zip(found.as_array().unwrap()) {
        assert_eq!(*found, keypoints::of(asked));
        let whole = |corner: &Value| [0, 1].map(|axis| corner[axis].as_f64().unwrap() as i64);
        let [found, recorded] = [&found["corners"], corners].map(|list| {
            list.as_array()
                .unwrap()
                .iter()
                .map(whole)
                .collect::<Vec<_>>()
        });
        assert_eq!(found, recorded);
    }
}

#[test]
#[ignore = "long"]
#[cfg(target_arch = "x86_64")]
fn a_build_for_avx_and_fma_finds_the_same() {
    let name = "a_build_for_avx_and_fma_finds_the_same";
    if !(is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")) {
        return crate::recorded_data::count_as_skipped(name);
    }
    let run = Command::new(std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned()))
        .args(["test", "--locked", "--package", "fab-vision", "--lib"])
        .args(["--manifest-path", &project("Cargo.toml"), "--target-dir"])
        .arg(Path::new(env!("CARGO_TARGET_TMPDIR")).join("avx"))
        .env("RUSTFLAGS", "-Ctarget-feature=+avx2,+fma")
        .output()
        .unwrap();
    let output = String::from_utf8_lossy(&run.stdout);
    let log = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{output}\n{log}");
    for test in [
        "harris_corners_match_the_recorded_lists_in_order",
        "a_turned_square_is_found_with_these_bits",
    ] {
        assert!(output.contains(&format!("{test} ... ok")), "{output}");
    }
}
