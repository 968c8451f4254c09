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
    ros(settings, chain.as_ref(), &mut faults);
    ros2(settings, chain.as_ref(), &mut faults);
    match chain {
        Some(chain) if faults.0.is_empty() => Ok(chain),
        _ => Err(faults.0.join("\n")),
    }
}

#[derive(Default)]
struct Faults(Vec<String>);

impl Faults {
    /// Notes a value that another key does not allow.
    fn wrong(&mut self, key: &str, value: &dyn Debug, expected: &str) {
        self.0
            .push(format!("`{key}` is `{value:?}`; expected {expected}"));
    }

    /// Notes a key that another one needs.
    fn missing(&mut self, who: &str, needs: &str) {
        self.0.push(format!("{who}, which needs {needs}"));
    }
}

/// Finds the arm: a built-in model, or one that a URDF describes.
fn arm(settings: &Settings, folder: &Path, faults: &mut Faults) -> Option<Chain> {
    let Some(arm) = &settings.arm else {
        return model(settings, faults);
    };
    if !settings.model.is_empty() {
        let expected = "no `model` beside a section `[arm]`: one of the two describes the arm";
        faults.wrong("model", &settings.model, expected);
    }
    if settings.driver == DriverKind::Kinova {
        let built_in = Chain::models().join("`, `");
        faults.0.push(format!(
            "`driver` is `kinova`, whose node moves `{built_in}` alone; expected another driver beside a section `[arm]`"
        ));
    }
    match arm.chain(folder) {
        Ok(chain) => Some(chain),
        Err(found) => {
            faults.0.extend(found);
            None
        }
    }
}

fn model(settings: &Settings, faults: &mut Faults) -> Option<Chain> {
    let chain = match Chain::of_model(&settings.model) {
        Ok(chain) => chain,
        Err(unknown) => {
            let models = unknown.available.join("`, `");
            let expected = format!("one of `{models}`, or a section `[arm]` for another arm");
            faults.wrong("model", &settings.model, &expected);
            return None;
        }
    };
    // Model names contain the number of fingers: `j2n6s200` has two.
    let stated = settings.model.chars().nth(5).and_then(|it| it.to_digit(10));
    let count = settings.fingers.count;
    if let Some(stated) = stated
        && stated as usize != count
    {
        let expected = format!("{stated}, as many as `{}` has", settings.model);
        faults.wrong("fingers.count", &count, &expected);
    }
    Some(chain)
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
    if !(floor_m[0] - EXACT_M..=floor_m[1] + EXACT_M).contains(&min_m[2]) {
        let expected = format!(
            "a z of {:.3} to {:.3} m: the table is at {table_m:.3} m (`table.center_m`); a lower floor would let the hand \
             go below the table, a higher one would keep it from touching (`tolerance.position_m`)",
            floor_m[0], floor_m[1]
        );
        faults.wrong("workspace.min_m", &min_m, &expected);
    }
    let top_m = table_m + motion.travel_m + margin_m;
    if max_m[2] < top_m - EXACT_M {
        let expected = format!(
            "a z of {top_m:.3} m or more: the hand travels {} m (`motion.travel_m`) above the table",
            motion.travel_m
        );
        faults.wrong("workspace.max_m", &max_m, &expected);
    }
    let [least, most] = [
        min_m.map(|it| it + margin_m - EXACT_M),
        max_m.map(|it| it - margin_m + EXACT_M),
    ];
    let within = "the workspace, with a margin of `tolerance.position_m`";
    if !holds(&least[..2], &most[..2], &middle_m[..2]) {
        let expected = format!(
            "an x and y of `{min_m:?}` to `{max_m:?}`: the table's middle is inside of {within}"
        );
        faults.wrong("table.center_m", &middle_m, &expected);
    }
    let rest_m = workspace.rest_m;
    if !holds(&least, &most, &rest_m) {
        let expected = format!("a place of `{min_m:?}` to `{max_m:?}`, inside of {within}");
        faults.wrong("workspace.rest_m", &rest_m, &expected);
    }
    let rest_floor_m = table_m + motion.retreat_m;
    if rest_m[2] < rest_floor_m - EXACT_M {
        let expected = format!(
            "a z of {rest_floor_m:.3} m or more: `motion.retreat_m` above the table, so that the hand does not drag the cloth"
        );
        faults.wrong("workspace.rest_m", &rest_m, &expected);
    }
}

fn keep_out(settings: &Settings, zone: &KeepOut, faults: &mut Faults) {
    let (workspace, margin_m) = (&settings.workspace, settings.tolerance.position_m);
    let key = format!("keep_out `{}`", zone.name);
    if !is_box(&format!("{key}.min_m"), &zone.min_m, &zone.max_m, faults) {
        return;
    }
    let overlaps = (0..3).all(|axis| {
        zone.min_m[axis] < workspace.max_m[axis] && zone.max_m[axis] > workspace.min_m[axis]
    });
    if !overlaps {
        let expected = format!(
            "a box that reaches into the workspace, `{:?}` to `{:?}`: outside of it, it keeps the tool from nothing",
            workspace.min_m, workspace.max_m
        );
        faults.wrong(&key, &[zone.min_m, zone.max_m], &expected);
    }
    let grown = [
        zone.min_m.map(|it| it - margin_m),
        zone.max_m.map(|it| it + margin_m),
    ];
    if holds(&grown[0], &grown[1], &workspace.rest_m) {
        let expected = format!(
            "a place outside of `{}`, which is kept out, by `tolerance.position_m` or more",
            zone.name
        );
        faults.wrong("workspace.rest_m", &workspace.rest_m, &expected);
    }
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
        if height_m <= below_m + margin_m + EXACT_M {
            let expected = format!(
                "above {:.4}: `motion.{other}`, {below_m}, and `tolerance.position_m`, {margin_m}; else a motion between \
                 the two that never happened would count as done",
                below_m + margin_m
            );
            faults.wrong(&format!("motion.{key}"), &height_m, &expected);
        }
    }
    if motion.lift_m < motion.release_m {
        let expected = format!(
            "{} or more, `motion.release_m`: the hand comes down to the place",
            motion.release_m
        );
        faults.wrong("motion.lift_m", &motion.lift_m, &expected);
    }
    for (key, height_m) in [
        ("pre_pick_m", motion.pre_pick_m),
        ("lift_m", motion.lift_m),
        ("retreat_m", motion.retreat_m),
    ] {
        if motion.travel_m < height_m {
            let expected =
                format!("{height_m} or more, `motion.{key}`: the hand travels above the cloth");
            faults.wrong("motion.travel_m", &motion.travel_m, &expected);
        }
    }
    let most_m_s = settings.workspace.max_speed_m_s;
    if motion.speed_m_s > most_m_s {
        let expected = format!("at most {most_m_s}, `workspace.max_speed_m_s`");
        faults.wrong("motion.speed_m_s", &motion.speed_m_s, &expected);
    }
}

fn fingers(settings: &Settings, faults: &mut Faults) {
    let fingers = &settings.fingers;
    let way = (fingers.open - fingers.closed).abs();
    if way == 0.0 {
        let expected = "another position than `fingers.open`";
        faults.wrong("fingers.closed", &fingers.closed, expected);
        return;
    }
    if fingers.tolerance > way / 10.0 {
        let expected = format!(
            "at most {}, a tenth of the way from open to closed: fingers that did not move would count as moved",
            way / 10.0
        );
        faults.wrong("fingers.tolerance", &fingers.tolerance, &expected);
    }
    if let Some(cloth) = fingers.cloth
        && !(cloth > fingers.tolerance && cloth < way / 2.0)
    {
        let expected = format!(
            "above {}, `fingers.tolerance`, and below {}, half of the way from open to closed: an empty hand would count \
             as one that holds cloth, or the reverse",
            fingers.tolerance,
            way / 2.0
        );
        faults.wrong("fingers.cloth", &cloth, &expected);
    }
}

fn camera(settings: &Settings, faults: &mut Faults) {
    let camera = &settings.camera;
    let [left, top, side] = camera.window_px;
    if side == 0 {
        faults.wrong("camera.window_px", &camera.window_px, "a side above 0");
    }
    if let Some(intrinsics) = &camera.intrinsics {
        let [width, height] = intrinsics.size_px;
        if left + side > width || top + side > height {
            let expected =
                format!("a square inside of {width} x {height} px, `camera.intrinsics.size_px`");
            faults.wrong("camera.window_px", &camera.window_px, &expected);
        }
    }
    match camera.source {
        CameraSource::Directory if camera.folder.is_none() => faults.missing(
            "`camera.source` is `directory`",
            "`camera.folder`, the folder with the pictures",
        ),
        CameraSource::Simulated if settings.driver != DriverKind::Simulated => faults.0.push(
            "`camera.source` is `simulated`, which would be right with `driver = \"simulated\"` only"
                .to_owned(),
        ),
        _ => {}
    }
}

/// Checks that `[ros]` has everything that the driver and the camera need.
fn ros(settings: &Settings, chain: Option<&Chain>, faults: &mut Faults) {
    let driver = match settings.driver {
        DriverKind::Kinova => Some("`driver` is `kinova`"),
        DriverKind::Trajectory => Some("`driver` is `trajectory`"),
        DriverKind::Ros2 | DriverKind::Simulated => None,
    };
    let is_topic = settings.camera.source == CameraSource::Ros;
    let camera = is_topic.then_some("`camera.source` is `ros`");
    let Some(ros) = &settings.ros else {
        if let Some(who) = driver.or(camera) {
            faults.missing(who, "a part `[ros]`");
        }
        return;
    };
    joint_names("ros.joints", &ros.joints, chain, faults);
    if settings.driver == DriverKind::Trajectory && ros.trajectory.is_none() {
        faults.missing("`driver` is `trajectory`", "`ros.trajectory`");
    }
    if is_topic {
        let topics = [&ros.color, &ros.depth, &ros.info];
        camera_topics("ros", topics, faults);
    }
}

/// Checks that names of joints, if they are stated, are as many as the arm's joints.
fn joint_names(key: &str, names: &[String], chain: Option<&Chain>, faults: &mut Faults) {
    let n_joints = chain.map_or(names.len(), |chain| chain.joints().len());
    if !names.is_empty() && names.len() != n_joints {
        let expected = format!("{n_joints} names, one for each joint of the arm");
        faults.wrong(key, &names, &expected);
    }
}

/// Checks that `[ros2]` has everything that the driver and the camera need.
fn ros2(settings: &Settings, chain: Option<&Chain>, faults: &mut Faults) {
    let is_driver = settings.driver == DriverKind::Ros2;
    let is_topic = settings.camera.source == CameraSource::Ros2;
    let Some(ros2) = &settings.ros2 else {
        match (is_driver, is_topic) {
            (true, _) => faults.missing("`driver` is `ros2`", "a part `[ros2]`"),
            (_, true) => faults.missing("`camera.source` is `ros2`", "a part `[ros2]`"),
            _ => {}
        }
        return;
    };
    if let Some(address) = &ros2.interface
        && address.parse::<Ipv4Addr>().is_err()
    {
        let expected = "an IPv4 address of this machine, e.g. `192.168.1.10`";
        faults.wrong("ros2.interface", address, expected);
    }
    joint_names("ros2.joints", &ros2.joints, chain, faults);
    if is_driver {
        for (key, is_missing) in [
            ("trajectory", ros2.trajectory.is_none()),
            ("gripper", ros2.gripper.is_none()),
            ("gripper_joints", ros2.gripper_joints.is_empty()),
        ] {
            if is_missing {
                faults.missing("`driver` is `ros2`", &format!("`ros2.{key}`"));
            }
        }
        let (found, count) = (ros2.gripper_joints.len(), settings.fingers.count);
        if found > 1 && found != count {
            let expected = format!("one name, or one for each finger of `fingers.count`, {count}");
            faults.wrong("ros2.gripper_joints", &ros2.gripper_joints, &expected);
        }
    }
    if is_topic {
        let topics = [&ros2.color, &ros2.depth, &ros2.info];
        camera_topics("ros2", topics, faults);
    }
}

/// Checks that a camera has its topics: colour, depth, projection.
fn camera_topics(source: &str, topics: [&Option<String>; 3], faults: &mut Faults) {
    for (key, topic) in ["color", "depth", "info"].into_iter().zip(topics) {
        if topic.is_none() {
            let who = format!("`camera.source` is `{source}`");
            faults.missing(&who, &format!("`{source}.{key}`"));
        }
    }
}

/// Checks that the corners of a box are in order.
fn is_box(key: &str, min_m: &[f64; 3], max_m: &[f64; 3], faults: &mut Faults) -> bool {
    let is_box = min_m.iter().zip(max_m).all(|(least, most)| least < most);
    if !is_box {
        let expected = format!("less than `{max_m:?}`, its max_m, along each axis");
        faults.wrong(key, min_m, &expected);
    }
    is_box
}

fn holds(min_m: &[f64], max_m: &[f64], point_m: &[f64]) -> bool {
    let sides = min_m.iter().zip(max_m);
    let mut all = sides.zip(point_m);
    all.all(|((least, most), at)| (least..=most).contains(&at))
}

#[cfg(test)]
mod tests;
