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
fn the_page_shows_the_section_of_the_ur5() {
    let page = std::fs::read_to_string(arms().join("../../../docs/arm.md")).unwrap();
    let text = std::fs::read_to_string(arms().join("ur5.toml")).unwrap();
    let section = text
        .split("[arm]")
        .nth(1)
        .unwrap()
        .split("[camera]")
        .next()
        .unwrap();
    assert!(
        page.contains(&format!("[arm]{}", section.trim_end())),
        "write it:\n[arm]{section}"
    );
}
