//! Tests of arms that a URDF describes: a made-up one of seven joints, and everything that is refused.

#![allow(clippy::unwrap_used)]

mod laws;
mod peer;
mod refusals;

use crate::settings::Settings;
use std::path::{Path, PathBuf};

/// The folder of the described arms.
fn arms() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/arms")
}

/// The made-up arm of seven joints.
fn seven() -> Settings {
    Settings::load(&arms().join("seven.toml")).unwrap()
}

#[test]
fn the_page_names_the_settings_of_the_ur5() {
    let page = std::fs::read_to_string(arms().join("../../../docs/arm.md")).unwrap();
    assert!(page.contains("tests/fixtures/arms/ur5.toml") && arms().join("ur5.toml").is_file());
}
