//! What one key of an arm's settings requires of another.
//!
//! In: settings whose keys were accepted one by one. Out: nothing, or all faults: the key, its value, the bound and the
//! reason. `fabc robot check` tests whether the arm reaches the configured places.

use super::{CameraSource, DriverKind, KeepOut, Settings};
use crate::kinematics::chain::Chain;
use fab_base::wording::quoted;
use std::fmt::Debug;
use std::net::Ipv4Addr;
use std::path::Path;
use toml::Value;

/// How far below the table's middle the workspace may end, metres: fingers give way, and readings have 1 mm
/// resolution.
const BELOW_TABLE_M: f64 = 0.010;

/// Slack of comparisons of decimal numbers, metres.
const EXACT_M: f64 = 1e-9;

/// Checks settings, and returns their arm; fails with all faults, one per line.
///
/// - `document`: the keys that are there; `folder`: that of the files that they name.
pub(super) fn check(settings: &Settings, document: &Value, folder: &Path) -> Result<Chain, String> {
    let mut faults = Faults::default();
    let chain = arm(settings, folder, &mut faults);
    workspace(settings, &mut faults);
    heights(settings, &mut faults);
    fingers(settings, &mut faults);
    connections(settings, document, &mut faults);
    if let Some(chain) = &chain {
        joint_names(settings, chain, &mut faults);
    }
    match chain {
        Some(chain) if faults.0.is_empty() => Ok(chain),
        _ => Err(faults.0.join("\n")),
    }
}

#[derive(Default)]
struct Faults(Vec<String>);

impl Faults {
    /// Notes a value that another key does not allow, unless it holds.
    fn unless(&mut self, holds: bool, key: &str, value: &dyn Debug, expected: String) {
        if !holds {
            self.0
                .push(format!("`{key}` is `{value:?}`; expected {expected}"));
        }
    }
}

/// Finds the arm: a shipped model, or one that the settings describe.
fn arm(settings: &Settings, folder: &Path, faults: &mut Faults) -> Option<Chain> {
    let (model, models) = (&settings.model, quoted(Chain::models()));
    let Some(arm) = &settings.arm else {
        let chain = Chain::of_model(model);
        let expected = format!("one of {models}, or a section `[arm]` for another arm");
        faults.unless(chain.is_some(), "model", model, expected);
        // Model names contain the number of fingers: `j2n6s200` has two.
        let (stated, count) = (model.get(5..6).unwrap_or_default(), settings.fingers.count);
        let holds = chain.is_none() || stated == count.to_string();
        let expected = format!("{stated}, as many as `{model}` has");
        faults.unless(holds, "fingers.count", &count, expected);
        return chain;
    };
    let expected = "no `model` beside a section `[arm]`: one of the two describes the arm";
    faults.unless(model.is_empty(), "model", model, expected.to_owned());
    if settings.driver == DriverKind::Kinova {
        faults.0.push(format!(
            "`driver` is `kinova`, whose node moves {models} alone; expected another driver beside a section `[arm]`"
        ));
    }
    arm.chain(folder)
        .map_err(|found| faults.0.extend(found))
        .ok()
}

/// Checks the workspace against the table, and the rest position against both.
fn workspace(settings: &Settings, faults: &mut Faults) {
    let (workspace, motion) = (&settings.workspace, &settings.motion);
    let (min_m, max_m) = (workspace.min_m, workspace.max_m);
    let (middle_m, rest_m) = (settings.table.center_m, workspace.rest_m);
    let (table_m, margin_m) = (middle_m[2], settings.tolerance.position_m);
    if !is_box("workspace.min_m", &min_m, &max_m, faults) {
        return;
    }
    let floor_m = [table_m - BELOW_TABLE_M, table_m - margin_m];
    let holds = (floor_m[0] - EXACT_M..=floor_m[1] + EXACT_M).contains(&min_m[2]);
    let expected = format!(
        "a z of {:.3} to {:.3} m: the table is at {table_m:.3} m (`table.center_m`); a lower floor would let the hand go \
         below the table, a higher one would keep it from touching (`tolerance.position_m`)",
        floor_m[0], floor_m[1]
    );
    faults.unless(holds, "workspace.min_m", &min_m, expected);
    let top_m = table_m + motion.travel_m + margin_m;
    let holds = max_m[2] >= top_m - EXACT_M;
    let expected =
        format!("a z of {top_m:.3} m or more: the hand travels `motion.travel_m` above the table");
    faults.unless(holds, "workspace.max_m", &max_m, expected);
    let mut least_m = min_m.map(|it| it + margin_m);
    let most_m = max_m.map(|it| it - margin_m);
    let holds = contains(&least_m[..2], &most_m[..2], &middle_m[..2]);
    let expected = format!(
        "an x and y of `{least_m:?}` to `{most_m:?}`: the table's middle is inside of the workspace by `tolerance.position_m`"
    );
    faults.unless(holds, "table.center_m", &middle_m, expected);
    least_m[2] = least_m[2].max(table_m + motion.retreat_m);
    let holds = contains(&least_m, &most_m, &rest_m);
    let expected = format!(
        "a place of `{least_m:?}` to `{most_m:?}`: inside of the workspace by `tolerance.position_m`, and `motion.retreat_m` \
         above the table, so that the hand does not drag the cloth"
    );
    faults.unless(holds, "workspace.rest_m", &rest_m, expected);
    for KeepOut { name, min_m, max_m } in &workspace.keep_out {
        is_box(&format!("keep_out `{name}`.min_m"), min_m, max_m, faults);
        let (least_m, most_m) = (min_m.map(|it| it - margin_m), max_m.map(|it| it + margin_m));
        let holds = !contains(&least_m, &most_m, &rest_m);
        let expected = format!(
            "a place outside of `{name}`, which is kept out, by `tolerance.position_m` or more"
        );
        faults.unless(holds, "workspace.rest_m", &rest_m, expected);
    }
}

/// Checks the order of heights, and that a miss by the tolerance shows in each difference.
fn heights(settings: &Settings, faults: &mut Faults) {
    let (motion, margin_m) = (&settings.motion, settings.tolerance.position_m);
    for (key, height_m, other, below_m) in [
        ("pre_pick_m", motion.pre_pick_m, "grasp_m", motion.grasp_m),
        ("lift_m", motion.lift_m, "grasp_m", motion.grasp_m),
        ("retreat_m", motion.retreat_m, "release_m", motion.release_m),
    ] {
        let (key, least_m) = (format!("motion.{key}"), below_m + margin_m);
        let expected = format!(
            "above {least_m:.4}: `motion.{other}`, {below_m}, and `tolerance.position_m`, {margin_m}; else a motion between \
             the two that never happened would count as done"
        );
        faults.unless(height_m > least_m + EXACT_M, &key, &height_m, expected);
        let expected = format!("{height_m} or more, `{key}`: the hand travels above the cloth");
        let (travel_m, holds) = (motion.travel_m, motion.travel_m >= height_m);
        faults.unless(holds, "motion.travel_m", &travel_m, expected);
    }
    let (speed_m_s, most_m_s) = (motion.speed_m_s, settings.workspace.max_speed_m_s);
    let expected = format!("at most {most_m_s}, `workspace.max_speed_m_s`");
    let holds = speed_m_s <= most_m_s;
    faults.unless(holds, "motion.speed_m_s", &speed_m_s, expected);
}

fn fingers(settings: &Settings, faults: &mut Faults) {
    let fingers = &settings.fingers;
    let (way, tolerance) = ((fingers.open - fingers.closed).abs(), fingers.tolerance);
    let expected = format!(
        "at most {}, a tenth of the way from `fingers.open` to `fingers.closed`: fingers that did not move would count as \
         moved",
        way / 10.0
    );
    let holds = tolerance <= way / 10.0;
    faults.unless(holds, "fingers.tolerance", &tolerance, expected);
    let Some(cloth) = fingers.cloth else { return };
    let expected = format!(
        "above {tolerance}, `fingers.tolerance`, and below {}, half of the way from open to closed: an empty hand would count \
         as one that holds cloth, or the reverse",
        way / 2.0
    );
    let holds = cloth > tolerance && cloth < way / 2.0;
    faults.unless(holds, "fingers.cloth", &cloth, expected);
}

/// Checks that driver and camera have every key that they need.
fn connections(settings: &Settings, document: &Value, faults: &mut Faults) {
    let camera = &settings.camera;
    let driver: &[&str] = match settings.driver {
        DriverKind::Simulated => &[],
        DriverKind::Kinova => &["ros"],
        DriverKind::Trajectory => &["ros.trajectory"],
        DriverKind::Ros2 => &["ros2.trajectory", "ros2.gripper", "ros2.gripper_joints"],
    };
    let source: &[&str] = match camera.source {
        CameraSource::Simulated => &[],
        CameraSource::Directory => &["camera.folder"],
        CameraSource::Ros => &["ros.color", "ros.depth", "ros.info"],
        CameraSource::Ros2 => &["ros2.color", "ros2.depth", "ros2.info"],
    };
    let driver_is = format!("`driver` is `{}`", settings.driver.name());
    let camera_is = format!("`camera.source` is `{}`", camera.source.name());
    for (who, keys) in [(&driver_is, driver), (&camera_is, source)] {
        let is_missing = |key: &&&str| {
            let mut parts = key.split('.');
            let value = parts.try_fold(document, |at, part| at.get(part));
            value.is_none_or(|value| value.as_array().is_some_and(Vec::is_empty))
        };
        let missing = keys.iter().filter(is_missing);
        let missing = missing.map(|key| format!("{who}, which needs `{key}`"));
        faults.0.extend(missing);
    }
    if camera.source == CameraSource::Simulated && settings.driver != DriverKind::Simulated {
        let needs = "which needs `driver = \"simulated\"`";
        faults.0.push(format!("{camera_is}, {needs}"));
    }
    let [left, top, side] = camera.window_px;
    let whole_px = camera.intrinsics.as_ref().map(|it| it.size_px);
    let [width, height] = whole_px.unwrap_or([u32::MAX; 2]);
    let expected = "a square with a side above 0, inside of `camera.intrinsics.size_px`".to_owned();
    let holds = side > 0 && left + side <= width && top + side <= height;
    let window = &camera.window_px;
    faults.unless(holds, "camera.window_px", window, expected);
    let Some(ros2) = &settings.ros2 else { return };
    let (joints, count) = (&ros2.gripper_joints, settings.fingers.count);
    let expected = format!("one name, or one for each finger of `fingers.count`, {count}");
    let holds = joints.len() <= 1 || joints.len() == count;
    faults.unless(holds, "ros2.gripper_joints", joints, expected);
    let expected = "an IPv4 address of this machine, e.g. `192.168.1.10`".to_owned();
    if let Some(address) = &ros2.interface {
        let holds = address.parse::<Ipv4Addr>().is_ok();
        faults.unless(holds, "ros2.interface", address, expected);
    }
}

/// Checks that names of joints, if they are stated, are as many as the arm's joints.
fn joint_names(settings: &Settings, chain: &Chain, faults: &mut Faults) {
    let ros = settings.ros.as_ref().map(|ros| ("ros.joints", &ros.joints));
    let ros2 = settings.ros2.as_ref();
    let ros2 = ros2.map(|ros2| ("ros2.joints", &ros2.joints));
    let count = chain.joints().len();
    for (key, names) in [ros, ros2].into_iter().flatten() {
        let holds = names.is_empty() || names.len() == count;
        let expected = format!("{count} names, one for each joint of the arm");
        faults.unless(holds, key, names, expected);
    }
}

/// Checks that the corners of a box are in order.
fn is_box(key: &str, min_m: &[f64; 3], max_m: &[f64; 3], faults: &mut Faults) -> bool {
    let is_box = min_m.iter().zip(max_m).all(|(least, most)| least < most);
    let expected = format!("less than `{max_m:?}`, its max_m, along each axis");
    faults.unless(is_box, key, min_m, expected);
    is_box
}

fn contains(min_m: &[f64], max_m: &[f64], point_m: &[f64]) -> bool {
    let sides = min_m.iter().zip(max_m);
    let mut all = sides.zip(point_m);
    all.all(|((least, most), at)| (least - EXACT_M..=most + EXACT_M).contains(at))
}

#[cfg(test)]
mod tests;
