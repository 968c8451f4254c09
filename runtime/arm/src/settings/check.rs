//! What one key of an arm's settings requires of another.
//!
//! In: settings whose keys were accepted one by one. Out: nothing, or all faults: the key, its value, the bound and the
//! reason. `fabc robot check` tests whether the arm reaches the configured places.

use super::{CameraSource, DriverKind, KeepOut, Settings};
use crate::kinematics::chain::Chain;
use std::fmt::Debug;
use std::net::Ipv4Addr;
use std::path::Path;

/// How far below the table's middle the workspace may end, metres: fingers give way, and readings have 1 mm
/// resolution.
const BELOW_TABLE_M: f64 = 0.010;

/// Slack of comparisons of decimal numbers, metres.
const EXACT_M: f64 = 1e-9;

/// Checks settings, and returns their arm; fails with all faults, one per line.
///
/// - `folder`: the folder of the files that they name.
pub(super) fn check(settings: &Settings, folder: &Path) -> Result<Chain, String> {
    let mut faults = Faults::default();
    let chain = arm(settings, folder, &mut faults);
    workspace(settings, &mut faults);
    for zone in &settings.workspace.keep_out {
        keep_out(settings, zone, &mut faults);
    }
    heights(settings, &mut faults);
    fingers(settings, &mut faults);
    camera(settings, &mut faults);
    connections(settings, &mut faults);
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

    /// Notes a key that another one needs, unless it is there.
    fn needs(&mut self, is_there: bool, who: &str, needs: &str) {
        if !is_there {
            self.0.push(format!("{who}, which needs {needs}"));
        }
    }
}

/// Finds the arm: a shipped model, or one that the settings describe.
fn arm(settings: &Settings, folder: &Path, faults: &mut Faults) -> Option<Chain> {
    let (model, models) = (&settings.model, Chain::models().join("`, `"));
    let Some(arm) = &settings.arm else {
        let chain = Chain::of_model(model).ok();
        let expected = format!("one of `{models}`, or a section `[arm]` for another arm");
        faults.unless(chain.is_some(), "model", model, expected);
        // Model names contain the number of fingers: `j2n6s200` has two.
        let stated = model.chars().nth(5).and_then(|it| it.to_digit(10));
        let (stated, count) = (stated.unwrap_or_default(), settings.fingers.count);
        let holds = chain.is_none() || stated as usize == count;
        let expected = format!("{stated}, as many as `{model}` has");
        faults.unless(holds, "fingers.count", &count, expected);
        return chain;
    };
    let expected = "no `model` beside a section `[arm]`: one of the two describes the arm";
    faults.unless(model.is_empty(), "model", model, expected.to_owned());
    if settings.driver == DriverKind::Kinova {
        faults.0.push(format!(
            "`driver` is `kinova`, whose node moves `{models}` alone; expected another driver beside a section `[arm]`"
        ));
    }
    arm.chain(folder)
        .map_err(|found| faults.0.extend(found))
        .ok()
}

/// Checks the workspace against the table, and the rest position against both.
fn workspace(settings: &Settings, faults: &mut Faults) {
    let (workspace, motion) = (&settings.workspace, &settings.motion);
    let margin_m = settings.tolerance.position_m;
    let [min_m, max_m] = [workspace.min_m, workspace.max_m];
    let middle_m = settings.table.center_m;
    let table_m = middle_m[2];
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
    let expected = format!(
        "a z of {top_m:.3} m or more: the hand travels {} m (`motion.travel_m`) above the table",
        motion.travel_m
    );
    faults.unless(
        max_m[2] >= top_m - EXACT_M,
        "workspace.max_m",
        &max_m,
        expected,
    );
    let least = min_m.map(|it| it + margin_m - EXACT_M);
    let most = max_m.map(|it| it - margin_m + EXACT_M);
    let within = "the workspace, with a margin of `tolerance.position_m`";
    let holds = contains(&least[..2], &most[..2], &middle_m[..2]);
    let expected = format!(
        "an x and y of `{min_m:?}` to `{max_m:?}`: the table's middle is inside of {within}"
    );
    faults.unless(holds, "table.center_m", &middle_m, expected);
    let rest_m = workspace.rest_m;
    let holds = contains(&least, &most, &rest_m);
    let expected = format!("a place of `{min_m:?}` to `{max_m:?}`, inside of {within}");
    faults.unless(holds, "workspace.rest_m", &rest_m, expected);
    let rest_floor_m = table_m + motion.retreat_m;
    let expected = format!(
        "a z of {rest_floor_m:.3} m or more: `motion.retreat_m` above the table, so that the hand does not drag the cloth"
    );
    let holds = rest_m[2] >= rest_floor_m - EXACT_M;
    faults.unless(holds, "workspace.rest_m", &rest_m, expected);
}

fn keep_out(settings: &Settings, zone: &KeepOut, faults: &mut Faults) {
    let (workspace, margin_m) = (&settings.workspace, settings.tolerance.position_m);
    let (key, [min_m, max_m]) = (
        format!("keep_out `{}`", zone.name),
        [zone.min_m, zone.max_m],
    );
    if !is_box(&format!("{key}.min_m"), &min_m, &max_m, faults) {
        return;
    }
    let overlaps = (0..3)
        .all(|axis| min_m[axis] < workspace.max_m[axis] && max_m[axis] > workspace.min_m[axis]);
    let expected = format!(
        "a box that reaches into the workspace, `{:?}` to `{:?}`: outside of it, it keeps the tool from nothing",
        workspace.min_m, workspace.max_m
    );
    faults.unless(overlaps, &key, &[min_m, max_m], expected);
    let (least, most) = (min_m.map(|it| it - margin_m), max_m.map(|it| it + margin_m));
    let holds = !contains(&least, &most, &workspace.rest_m);
    let expected = format!(
        "a place outside of `{}`, which is kept out, by `tolerance.position_m` or more",
        zone.name
    );
    faults.unless(holds, "workspace.rest_m", &workspace.rest_m, expected);
}

/// Checks the order of heights, and that a miss by the tolerance shows in each difference.
fn heights(settings: &Settings, faults: &mut Faults) {
    let motion = &settings.motion;
    let margin_m = settings.tolerance.position_m;
    for (key, height_m, other, below_m) in [
        ("pre_pick_m", motion.pre_pick_m, "grasp_m", motion.grasp_m),
        ("lift_m", motion.lift_m, "grasp_m", motion.grasp_m),
        ("retreat_m", motion.retreat_m, "release_m", motion.release_m),
    ] {
        let expected = format!(
            "above {:.4}: `motion.{other}`, {below_m}, and `tolerance.position_m`, {margin_m}; else a motion between the \
             two that never happened would count as done",
            below_m + margin_m
        );
        let holds = height_m > below_m + margin_m + EXACT_M;
        faults.unless(holds, &format!("motion.{key}"), &height_m, expected);
    }
    let (lift_m, release_m) = (motion.lift_m, motion.release_m);
    let expected =
        format!("{release_m} or more, `motion.release_m`: the hand comes down to the place");
    faults.unless(lift_m >= release_m, "motion.lift_m", &lift_m, expected);
    for (key, height_m) in [
        ("pre_pick_m", motion.pre_pick_m),
        ("lift_m", motion.lift_m),
        ("retreat_m", motion.retreat_m),
    ] {
        let holds = motion.travel_m >= height_m;
        let expected =
            format!("{height_m} or more, `motion.{key}`: the hand travels above the cloth");
        faults.unless(holds, "motion.travel_m", &motion.travel_m, expected);
    }
    let (speed_m_s, most_m_s) = (motion.speed_m_s, settings.workspace.max_speed_m_s);
    let expected = format!("at most {most_m_s}, `workspace.max_speed_m_s`");
    faults.unless(
        speed_m_s <= most_m_s,
        "motion.speed_m_s",
        &speed_m_s,
        expected,
    );
}

fn fingers(settings: &Settings, faults: &mut Faults) {
    let fingers = &settings.fingers;
    let (way, tolerance) = ((fingers.open - fingers.closed).abs(), fingers.tolerance);
    let expected = "another position than `fingers.open`".to_owned();
    faults.unless(way > 0.0, "fingers.closed", &fingers.closed, expected);
    let expected = format!(
        "at most {}, a tenth of the way from open to closed: fingers that did not move would count as moved",
        way / 10.0
    );
    let holds = way == 0.0 || tolerance <= way / 10.0;
    faults.unless(holds, "fingers.tolerance", &tolerance, expected);
    if let Some(cloth) = fingers.cloth {
        let expected = format!(
            "above {tolerance}, `fingers.tolerance`, and below {}, half of the way from open to closed: an empty hand would \
             count as one that holds cloth, or the reverse",
            way / 2.0
        );
        let holds = way == 0.0 || cloth > tolerance && cloth < way / 2.0;
        faults.unless(holds, "fingers.cloth", &cloth, expected);
    }
}

fn camera(settings: &Settings, faults: &mut Faults) {
    let camera = &settings.camera;
    let [left, top, side] = camera.window_px;
    let expected = "a side above 0".to_owned();
    faults.unless(side > 0, "camera.window_px", &camera.window_px, expected);
    if let Some(intrinsics) = &camera.intrinsics {
        let [width, height] = intrinsics.size_px;
        let expected =
            format!("a square inside of {width} x {height} px, `camera.intrinsics.size_px`");
        let holds = left + side <= width && top + side <= height;
        faults.unless(holds, "camera.window_px", &camera.window_px, expected);
    }
    if camera.source == CameraSource::Simulated && settings.driver != DriverKind::Simulated {
        faults.0.push(
            "`camera.source` is `simulated`, which would be right with `driver = \"simulated\"` only"
                .to_owned(),
        );
    }
}

/// Checks that driver and camera have every key that they need.
fn connections(settings: &Settings, faults: &mut Faults) {
    let (driver, camera) = (settings.driver, &settings.camera);
    let (ros, ros2) = (settings.ros.as_ref(), settings.ros2.as_ref());
    let driver_is = format!("`driver` is `{}`", driver.name());
    let camera_is = format!("`camera.source` is `{}`", camera.source.name());
    match driver {
        DriverKind::Simulated => {}
        DriverKind::Ros2 => faults.needs(ros2.is_some(), &driver_is, "a part `[ros2]`"),
        _ => faults.needs(ros.is_some(), &driver_is, "a part `[ros]`"),
    }
    if let (DriverKind::Trajectory, Some(ros)) = (driver, ros) {
        faults.needs(ros.trajectory.is_some(), &driver_is, "`ros.trajectory`");
    }
    if let (DriverKind::Ros2, Some(ros2)) = (driver, ros2) {
        faults.needs(ros2.trajectory.is_some(), &driver_is, "`ros2.trajectory`");
        faults.needs(ros2.gripper.is_some(), &driver_is, "`ros2.gripper`");
        let (joints, count) = (&ros2.gripper_joints, settings.fingers.count);
        faults.needs(!joints.is_empty(), &driver_is, "`ros2.gripper_joints`");
        let holds = joints.len() <= 1 || joints.len() == count;
        let expected = format!("one name, or one for each finger of `fingers.count`, {count}");
        faults.unless(holds, "ros2.gripper_joints", joints, expected);
    }
    if let Some(address) = ros2.and_then(|ros2| ros2.interface.as_ref()) {
        let expected = "an IPv4 address of this machine, e.g. `192.168.1.10`".to_owned();
        let holds = address.parse::<Ipv4Addr>().is_ok();
        faults.unless(holds, "ros2.interface", address, expected);
    }
    let topics = match camera.source {
        CameraSource::Ros => ros.map(|ros| [&ros.color, &ros.depth, &ros.info]),
        CameraSource::Ros2 => ros2.map(|ros2| [&ros2.color, &ros2.depth, &ros2.info]),
        CameraSource::Directory => {
            let folder = "`camera.folder`, the folder with the pictures";
            faults.needs(camera.folder.is_some(), &camera_is, folder);
            return;
        }
        CameraSource::Simulated => return,
    };
    let part = camera.source.name();
    let Some(topics) = topics else {
        // A driver that lacks the same part has said so.
        if !faults
            .0
            .iter()
            .any(|fault| fault.ends_with(&format!("a part `[{part}]`")))
        {
            faults.needs(false, &camera_is, &format!("a part `[{part}]`"));
        }
        return;
    };
    for (key, topic) in ["color", "depth", "info"].into_iter().zip(topics) {
        faults.needs(topic.is_some(), &camera_is, &format!("`{part}.{key}`"));
    }
}

/// Checks that names of joints, if they are stated, are as many as the arm's joints.
fn joint_names(settings: &Settings, chain: &Chain, faults: &mut Faults) {
    let ros = settings.ros.as_ref().map(|ros| ("ros.joints", &ros.joints));
    let ros2 = settings
        .ros2
        .as_ref()
        .map(|ros2| ("ros2.joints", &ros2.joints));
    for (key, names) in [ros, ros2].into_iter().flatten() {
        let count = chain.joints().len();
        let expected = format!("{count} names, one for each joint of the arm");
        let holds = names.is_empty() || names.len() == count;
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
    all.all(|((least, most), at)| (least..=most).contains(&at))
}

#[cfg(test)]
mod tests;
