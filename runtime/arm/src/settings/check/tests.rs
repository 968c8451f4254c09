//! Tests that each implausible number is refused by its key, and that defaults apply to missing ones.

#![allow(clippy::unwrap_used)]

use crate::settings::Settings;
use toml::{Table, Value};

const ROBOT: &str = "
name = 'lab'
model = 'j2n6s200'
driver = 'kinova'
calibration = 'lab.toml'
table = { center_m = [0.45, 0.0, 0.02] }
fingers = { count = 2, open = 0.0, closed = 6400.0, cloth = 300.0, tolerance = 200.0 }
motion = { lift_m = 0.005 }
[workspace]
min_m = [0.15, -0.525, 0.0]
max_m = [0.75, 0.525, 0.5]
rest_m = [0.3, -0.4, 0.4]
keep_out = [{ name = 'post', min_m = [0.6, 0.3, 0.0], max_m = [0.7, 0.4, 0.5] }]
[camera]
source = 'ros'
window_px = [80, 0, 480]
intrinsics = { size_px = [640, 480], focal_px = [600.0, 600.0], middle_px = [320.0, 240.0] }
[ros]
master = 'http://localhost:11311'
arm = '/j2n6s200_driver'
color = '/c'
depth = '/d'
info = '/i'
";

/// The settings with one value replaced; `-` removes it.
fn with(key: &str, value: &str) -> Result<Settings, String> {
    let mut table: Table = toml::from_str(ROBOT).unwrap();
    let mut parts: Vec<&str> = key.split('.').collect();
    let last = parts.pop().unwrap();
    let mut inner = &mut table;
    for part in parts {
        let next = inner.entry(part).or_insert(Value::Table(Table::new()));
        inner = next.as_table_mut().unwrap();
    }
    match value {
        "-" => {
            inner.remove(last);
        }
        _ => {
            let read: Table = toml::from_str(&format!("it = {value}")).unwrap();
            inner.insert(last.to_owned(), read["it"].clone());
        }
    }
    let settings: Settings = table.try_into().map_err(|error| format!("{error}"))?;
    super::check(&settings).map(|()| settings)
}

#[test]
fn settings_that_can_be_used_are_read() {
    Settings::parse(ROBOT).unwrap();
    for (key, value) in [
        ("fingers.open", "-5.0"),
        ("fingers.cloth", "-"),
        ("motion.speed_m_s", "0.2"),
        ("workspace.rest_m", "[0.15, -0.525, 0.5]"),
        ("workspace.keep_out", "-"),
        ("model", "'j2s6s200'"),
        ("camera.flat", "'flat.png'"),
    ] {
        with(key, value).unwrap_or_else(|why| panic!("{key} = {value}: {why}"));
    }
}

#[test]
fn each_number_that_cannot_be_meant_is_refused_by_its_key() {
    for (key, value) in [
        ("name", "' '"),
        ("model", "'j2n7s300'"),
        ("table.center_m", "[nan, 0.0, 0.0]"),
        ("table.center_m", "[0.9, 0.0, 0.0]"),
        ("table.turn_deg", "inf"),
        ("workspace.min_m", "[0.15, 0.525, 0.0]"),
        ("workspace.max_m", "[inf, 0.525, 0.5]"),
        ("workspace.rest_m", "[0.3, -0.4, 0.6]"),
        ("workspace.rest_m", "[0.65, 0.35, 0.2]"),
        ("workspace.rest_m", "[nan, 0.35, 0.2]"),
        ("workspace.max_speed_m_s", "0.0"),
        ("workspace.max_step_m", "-1.0"),
        ("motion.pre_pick_m", "-0.001"),
        ("motion.grasp_m", "nan"),
        ("motion.lift_m", "0.6"),
        ("motion.release_m", "-inf"),
        ("motion.retreat_m", "5.0"),
        ("motion.travel_m", "-0.1"),
        ("motion.speed_m_s", "0.0"),
        ("motion.speed_m_s", "0.21"),
        ("motion.hand_turn_deg", "nan"),
        ("fingers.count", "3"),
        ("fingers.open", "nan"),
        ("fingers.closed", "0.0"),
        ("fingers.tolerance", "0.0"),
        ("fingers.tolerance", "6400.0"),
        ("fingers.cloth", "-1.0"),
        ("tolerance.position_m", "0.0"),
        ("tolerance.angle_deg", "-3.0"),
        ("tolerance.corrections", "4000"),
        ("tolerance.settle_s", "nan"),
        ("tolerance.stale_s", "0.0"),
        ("tolerance.watchdog_s", "0.0"),
        ("camera.window_px", "[0, 0, 0]"),
        ("camera.window_px", "[4294967295, 0, 480]"),
        ("camera.timeout_s", "inf"),
        ("camera.flat", "''"),
        ("ros.master", "'localhost'"),
        ("ros.arm", "'j2n6s200_driver'"),
        ("simulated.camera_height_m", "0.0"),
        ("simulated.camera_offset_m", "[nan, 0.0]"),
        ("simulated.camera_turn_deg", "1e9"),
        ("simulated.camera_fov_deg", "180.0"),
        ("simulated.camera_px", "0"),
        ("simulated.repeatability_m", "-0.001"),
    ] {
        let why = with(key, value).expect_err(key);
        assert!(why.contains(&format!("`{key}`")), "{key} = {value}: {why}");
    }
    let why = with(
        "workspace.keep_out",
        "[{ name = 'post', min_m = [0.6, 0.3, 0.0], max_m = [0.6, 0.4, 0.5] }]",
    );
    assert!(why.unwrap_err().contains("keep_out `post`"));
    for key in ["size_px", "focal_px"] {
        let key = format!("camera.intrinsics.{key}");
        assert!(with(&key, "[0, 480]").is_err());
    }
}

#[test]
fn what_one_part_needs_of_another_is_said() {
    for (key, value, expected) in [
        (
            "ros",
            "-",
            "`driver` is `kinova`, which needs a part `[ros]`",
        ),
        (
            "driver",
            "'trajectory'",
            "`driver` is `trajectory`, which needs `ros.trajectory`",
        ),
        (
            "ros.depth",
            "-",
            "`camera.source` is `ros`, which needs `ros.depth`",
        ),
        (
            "camera.source",
            "'directory'",
            "`camera.source` is `directory`, which needs `camera.folder`, the folder with the pictures",
        ),
        (
            "camera.source",
            "'simulated'",
            "`camera.source` is `simulated`, which would be right with `driver = \"simulated\"` only",
        ),
        (
            "motion.speed_m_s",
            "0.5",
            "`motion.speed_m_s` is `0.5`; expected above 0 and at most 0.2",
        ),
        (
            "fingers.count",
            "3",
            "`fingers.count` is `3`; expected 2, as many as `j2n6s200` has",
        ),
    ] {
        assert_eq!(with(key, value).unwrap_err(), expected);
    }
}
