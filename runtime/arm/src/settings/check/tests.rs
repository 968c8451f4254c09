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
min_m = [0.15, -0.525, 0.01]
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

/// The settings with some values replaced; `-` removes one.
fn with(robot: &str, changes: &[(&str, &str)]) -> Result<Settings, String> {
    let mut table: Table = toml::from_str(robot).unwrap();
    for (key, value) in changes {
        replace(&mut table, key, value);
    }
    Settings::parse(&toml::to_string(&table).unwrap())
}

fn replace(table: &mut Table, key: &str, value: &str) {
    let mut parts: Vec<&str> = key.split('.').collect();
    let last = parts.pop().unwrap();
    let mut inner = table;
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
}

#[test]
fn settings_that_can_be_used_are_read() {
    Settings::parse(ROBOT).unwrap();
    for (key, value) in [
        ("fingers.open", "-5.0"),
        ("fingers.cloth", "-"),
        ("motion.speed_m_s", "0.2"),
        ("motion.acceleration_deg_s2", "1000.0"),
        ("motion.jerk_deg_s3", "100.0"),
        ("motion.lift_m", "0.0031"),
        ("workspace.min_m", "[0.15, -0.525, 0.017]"),
        ("workspace.rest_m", "[0.153, -0.522, 0.07]"),
        ("workspace.keep_out", "-"),
        ("model", "'j2s6s200'"),
        ("camera.flat", "'flat.png'"),
        ("table.center_m", "[0, 0, 0]"),
    ] {
        let moved = match key {
            "table.center_m" => ROBOT.replace("0.15, -0.525, 0.01]", "-0.15, -0.525, -0.01]"),
            _ => ROBOT.to_owned(),
        };
        with(&moved, &[(key, value)]).unwrap_or_else(|why| panic!("{key} = {value}: {why}"));
    }
}

#[test]
fn each_number_that_cannot_be_meant_is_refused_by_its_key() {
    for (key, value) in [
        ("name", "' '"),
        ("model", "'j2n7s300'"),
        ("driver", "'kinovas'"),
        ("table.center_m", "[nan, 0.0, 0.0]"),
        ("table.center_m", "[0.9, 0.0, 0.02]"),
        ("table.center_m", "[0.45, 0, 0, 0.02]"),
        ("table.center_m", "[0.45, 0.0]"),
        ("table.turn_deg", "inf"),
        ("workspace.min_m", "[0.15, 0.525, 0.01]"),
        ("workspace.min_m", "[0.15, -0.525, 0.0]"),
        ("workspace.min_m", "[0.15, -0.525, 0.019]"),
        ("workspace.max_m", "[inf, 0.525, 0.5]"),
        ("workspace.max_m", "[0.75, 0.525, 0.12]"),
        ("workspace.rest_m", "[0.3, -0.4, 0.6]"),
        ("workspace.rest_m", "[0.3, -0.4, 0.01]"),
        ("workspace.rest_m", "[0.3, -0.4, 0.06]"),
        ("workspace.rest_m", "[0.152, -0.4, 0.3]"),
        ("workspace.rest_m", "[0.65, 0.35, 0.2]"),
        ("workspace.rest_m", "[0.598, 0.35, 0.2]"),
        ("workspace.rest_m", "[nan, 0.35, 0.2]"),
        ("workspace.max_speed_m_s", "0.0"),
        ("workspace.max_speed_m_s", "0.6"),
        ("motion.pre_pick_m", "-0.001"),
        ("motion.pre_pick_m", "0.003"),
        ("motion.grasp_m", "nan"),
        ("motion.lift_m", "0.6"),
        ("motion.lift_m", "0.0"),
        ("motion.release_m", "-inf"),
        ("motion.retreat_m", "5.0"),
        ("motion.retreat_m", "0.002"),
        ("motion.travel_m", "-0.1"),
        ("motion.travel_m", "0.0"),
        ("motion.speed_m_s", "0.0"),
        ("motion.speed_m_s", "0.004"),
        ("motion.acceleration_deg_s2", "9.9"),
        ("motion.acceleration_deg_s2", "1001.0"),
        ("motion.acceleration_deg_s2", "nan"),
        ("motion.jerk_deg_s3", "0.0"),
        ("motion.jerk_deg_s3", "99.0"),
        ("motion.jerk_deg_s3", "1e6"),
        ("motion.jerk_deg_s3", "[600.0]"),
        ("motion.speed_m_s", "0.21"),
        ("motion.hand_turn_deg", "nan"),
        ("fingers.count", "3"),
        ("fingers.open", "nan"),
        ("fingers.tolerance", "0.0"),
        ("fingers.tolerance", "6399.0"),
        ("fingers.tolerance", "641.0"),
        ("fingers.cloth", "-1.0"),
        ("fingers.cloth", "200.0"),
        ("fingers.cloth", "3200.0"),
        ("tolerance.position_m", "0.0"),
        ("tolerance.position_m", "0.1"),
        ("tolerance.angle_deg", "-3.0"),
        ("tolerance.angle_deg", "45.0"),
        ("tolerance.stale_s", "0.0"),
        ("tolerance.stale_s", "600.0"),
        ("tolerance.watchdog_s", "0.0"),
        ("tolerance.watchdog_s", "60.0"),
        ("camera.window_px", "[0, 0, 0]"),
        ("camera.window_px", "[161, 0, 480]"),
        ("camera.window_px", "[80, 0, 480, 1]"),
        ("camera.window_px", "[4294967295, 0, 480]"),
        ("camera.timeout_s", "inf"),
        ("camera.timeout_s", "600.0"),
        ("camera.flat", "''"),
        ("camera.intrinsics.size_px", "[0, 480]"),
        ("camera.intrinsics.focal_px", "[0, 480]"),
        ("camera.intrinsics.focal_px", "[600, 600, 600]"),
        ("camera.intrinsics.middle_px", "[320.0, -1.0]"),
        ("simulated.camera_height_m", "0.0"),
        ("simulated.camera_offset_m", "[nan, 0.0]"),
        ("simulated.camera_turn_deg", "1e9"),
        ("simulated.camera_px", "0"),
    ] {
        let why = with(ROBOT, &[(key, value)]).expect_err(&format!("{key} = {value}"));
        assert!(
            why.contains(&format!("`{key}` is ")),
            "{key} = {value}: {why}"
        );
    }
    for (zone, why) in [
        (
            "min_m = [0.6, 0.3, 0.0], max_m = [0.6, 0.4, 0.5]",
            "keep_out `lamp`.min_m",
        ),
        (
            "min_m = [0.0, -1.0, 0.0], max_m = [1.0, 1.0, 1.0]",
            "`workspace.rest_m` is",
        ),
        (
            "min_m = [0.6, 0.3, 0.0], max_m = [0.5, 0.6, 0.01, 0.4]",
            "`workspace.keep_out[0].max_m` is `[0.5, 0.6, 0.01, 0.4]`; expected 3 numbers",
        ),
    ] {
        let zones = format!("[{{ name = 'lamp', {zone} }}]");
        let refused = with(ROBOT, &[("workspace.keep_out", &zones)]).expect_err(zone);
        assert!(refused.contains(why), "{refused}");
    }
}

/// A value that one number alone would allow.
#[test]
fn a_tolerance_that_would_hide_a_miss_is_refused_against_each_height() {
    let why = with(ROBOT, &[("tolerance.position_m", "0.006")]).unwrap_err();
    for key in ["motion.pre_pick_m", "motion.lift_m"] {
        assert!(
            why.contains(&format!("`{key}` is `0.005`; expected above 0.0060")),
            "{why}"
        );
    }
    let higher = [
        ("tolerance.position_m", "0.006"),
        ("motion.pre_pick_m", "0.02"),
        ("motion.lift_m", "0.02"),
    ];
    with(ROBOT, &higher).unwrap();
}

#[test]
fn an_unknown_key_is_refused_with_the_one_that_was_meant() {
    for (key, expected) in [
        (
            "workspace.max_sped_m_s",
            "did you mean `workspace.max_speed_m_s`?",
        ),
        ("tolerence", "did you mean `tolerance`?"),
        ("motion.Lift_m", "did you mean `motion.lift_m`?"),
        ("tolerance.settle_s", "did you mean `tolerance.stale_s`?"),
        ("table.sideways", "here may stand `center_m`, `turn_deg`"),
        ("camera.intrinsics.focal", "did you mean"),
    ] {
        let why = with(ROBOT, &[(key, "0.1")]).unwrap_err();
        assert!(why.contains(&format!("`{key}` is not a setting")), "{why}");
        if key != "camera.intrinsics.focal" {
            assert!(why.contains(expected), "{why}");
        }
    }
    let zone =
        "[{ name = 'a', min = [0, 0, 0], min_m = [0.5, 0.2, 0.0], max_m = [0.6, 0.4, 0.5] }]";
    let why = with(ROBOT, &[("workspace.keep_out", zone)]).unwrap_err();
    assert!(
        why.contains("`workspace.keep_out[0].min` is not a setting"),
        "{why}"
    );
}

#[test]
fn what_is_missing_or_of_another_type_is_named() {
    for (key, value, expected) in [
        ("name", "-", "`name` is missing"),
        ("table", "-", "`table.center_m` is missing"),
        ("table", "5", "`table` is `5`; expected a section"),
        ("fingers.tolerance", "-", "`fingers.tolerance` is missing"),
        (
            "workspace.keep_out",
            "5",
            "`workspace.keep_out` is `5`; expected a list of sections",
        ),
        (
            "workspace.keep_out",
            "[5]",
            "`workspace.keep_out[0]` is `5`",
        ),
        ("ros", "'here'", "expected a section"),
        ("fingers.count", "2.0", "expected a whole number, 2 to 3"),
        ("ros.joints", "['a', '']", "expected a list of texts"),
        (
            "camera.intrinsics.distortion",
            "[nan]",
            "`camera.intrinsics.distortion` is",
        ),
    ] {
        let why = with(ROBOT, &[(key, value)]).unwrap_err();
        assert!(why.contains(expected), "{why}");
    }
    // All at once, not one after the other.
    let why = with(ROBOT, &[("name", "-"), ("motion.grasp_m", "9")]).unwrap_err();
    assert_eq!(why.lines().count(), 2, "{why}");
}

#[test]
fn what_one_part_needs_of_another_is_said() {
    for (key, value, expected) in [
        ("ros", "-", "`driver` is `kinova`, which needs `ros`"),
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
            "driver",
            "'ros2'",
            "`driver` is `ros2`, which needs `ros2.gripper`",
        ),
        (
            "camera.source",
            "'ros2'",
            "`camera.source` is `ros2`, which needs `ros2.color`",
        ),
        (
            "camera.source",
            "'directory'",
            "`camera.source` is `directory`, which needs `camera.folder`",
        ),
        (
            "camera.source",
            "'simulated'",
            "`camera.source` is `simulated`, which needs `driver = \"simulated\"`",
        ),
        (
            "motion.speed_m_s",
            "0.5",
            "`motion.speed_m_s` is `0.5`; expected at most 0.2, `workspace.max_speed_m_s`",
        ),
        (
            "fingers.count",
            "3",
            "`fingers.count` is `3`; expected 2, as many as `j2n6s200` has",
        ),
    ] {
        let why = with(ROBOT, &[(key, value)]).unwrap_err();
        assert!(why.lines().any(|line| line == expected), "{why}");
    }
}

/// The example of the documentation, with what it may not lack.
#[test]
fn the_settings_for_ros_2_say_what_they_need() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/arm.md");
    let page = std::fs::read_to_string(page).unwrap();
    let (_, example) = page.split_once("```toml file=ros2.toml\n").unwrap();
    let (example, _) = example.split_once("```").unwrap();
    let ros2 = with(example, &[]).unwrap().ros2.unwrap();
    assert_eq!((ros2.joints.len(), ros2.rmw.name()), (6, "fastrtps"));
    for (key, value, expected) in [
        (
            "ros2.trajectory",
            "-",
            "`driver` is `ros2`, which needs `ros2.trajectory`",
        ),
        (
            "ros2.gripper",
            "-",
            "`driver` is `ros2`, which needs `ros2.gripper`",
        ),
        (
            "ros2.gripper_joints",
            "-",
            "`driver` is `ros2`, which needs `ros2.gripper_joints`",
        ),
        (
            "ros2.info",
            "-",
            "`camera.source` is `ros2`, which needs `ros2.info`",
        ),
        (
            "ros2.gripper_joints",
            "['a', 'b', 'c']",
            "`ros2.gripper_joints` is `[\"a\", \"b\", \"c\"]`; expected one name, or one for each finger of \
             `fingers.count`, 2",
        ),
        (
            "ros2.interface",
            "'eth0'",
            "`ros2.interface` is `\"eth0\"`; expected an IPv4 address of this machine, e.g. `192.168.1.10`",
        ),
    ] {
        assert_eq!(with(example, &[(key, value)]).unwrap_err(), expected);
    }
    let domain = with(example, &[("ros2.domain", "233")]).unwrap_err();
    assert!(
        domain.contains("`ros2.domain` is `233`; expected a whole number, 0 to 232"),
        "{domain}"
    );
}
