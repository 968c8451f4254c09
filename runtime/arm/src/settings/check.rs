//! Checks an arm's settings: every number, and what one section requires of another.
//!
//! In: parsed settings. Out: nothing, or the first fault: the key, its value and what would be right. `fabc robot
//! check` tests whether the arm reaches the configured places.

use super::{
    CameraSettings, CameraSource, DriverKind, FingerSettings, MotionSettings, RosSettings,
    Settings, SimulatedSettings, Table, Tolerance, Workspace,
};
use crate::kinematics::chain::Chain;
use crate::rgbd::Intrinsics;
use std::fmt::Debug;
use std::ops::RangeInclusive;

/// The largest coordinate, metres: no arm comes near it.
const MAX_PLACE_M: f64 = 10.0;

/// The largest height above a point, metres.
const MAX_HEIGHT_M: f64 = 0.5;

/// The longest wait of any kind, seconds.
const MAX_WAIT_S: f64 = 600.0;

/// The most pixels along a side of a picture.
const MAX_SIDE_PX: u32 = 16_384;

type Checked = Result<(), String>;

/// The first fault of settings, if any.
pub(super) fn check(settings: &Settings) -> Checked {
    model(settings)?;
    table(&settings.table)?;
    workspace(&settings.workspace)?;
    middle_is_inside(settings)?;
    motion(&settings.motion, &settings.workspace)?;
    fingers(&settings.fingers)?;
    tolerance(&settings.tolerance)?;
    camera(&settings.camera, settings.driver)?;
    ros(settings)?;
    simulated(&settings.simulated)
}

fn model(settings: &Settings) -> Checked {
    if settings.name.trim().is_empty() {
        return wrong("name", &settings.name, "a name such as `lab_jaco`");
    }
    Chain::of_model(&settings.model).map_err(|why| format!("`model`: {why}"))?;
    // Model names contain the number of fingers: `j2n6s200` has two.
    let stated = settings.model.chars().nth(5).and_then(|it| it.to_digit(10));
    let count = settings.fingers.count;
    match stated {
        Some(fingers) if fingers as usize != count => wrong(
            "fingers.count",
            &count,
            &format!("{fingers}, as many as `{}` has", settings.model),
        ),
        _ => Ok(()),
    }
}

fn table(table: &Table) -> Checked {
    place("table.center_m", &table.center_m)?;
    within("table.turn_deg", table.turn_deg, -360.0..=360.0)
}

fn workspace(workspace: &Workspace) -> Checked {
    let Workspace {
        min_m,
        max_m,
        keep_out,
        rest_m,
        max_speed_m_s,
        max_step_m,
    } = workspace;
    is_box("workspace", min_m, max_m)?;
    for zone in keep_out {
        is_box(
            &format!("keep_out `{}`", zone.name),
            &zone.min_m,
            &zone.max_m,
        )?;
    }
    place("workspace.rest_m", rest_m)?;
    if !holds(min_m, max_m, rest_m) {
        let right = format!("a place between `{min_m:?}` and `{max_m:?}`");
        return wrong("workspace.rest_m", rest_m, &right);
    }
    let kept = keep_out
        .iter()
        .find(|it| holds(&it.min_m, &it.max_m, rest_m));
    if let Some(zone) = kept {
        let right = format!("a place outside of `{}`, which is kept out", zone.name);
        return wrong("workspace.rest_m", rest_m, &right);
    }
    above_zero("workspace.max_speed_m_s", *max_speed_m_s, 2.0)?;
    above_zero("workspace.max_step_m", *max_step_m, 2.0 * MAX_PLACE_M)
}

fn middle_is_inside(settings: &Settings) -> Checked {
    let Workspace { min_m, max_m, .. } = &settings.workspace;
    let middle_m = settings.table.center_m;
    if holds(&min_m[..2], &max_m[..2], &middle_m[..2]) {
        return Ok(());
    }
    let right = format!("a place between `{min_m:?}` and `{max_m:?}`, where the tool may be");
    wrong("table.center_m", &middle_m, &right)
}

fn motion(motion: &MotionSettings, workspace: &Workspace) -> Checked {
    for (key, height_m) in [
        ("motion.pre_pick_m", motion.pre_pick_m),
        ("motion.grasp_m", motion.grasp_m),
        ("motion.lift_m", motion.lift_m),
        ("motion.release_m", motion.release_m),
        ("motion.retreat_m", motion.retreat_m),
        ("motion.travel_m", motion.travel_m),
    ] {
        within(key, height_m, 0.0..=MAX_HEIGHT_M)?;
    }
    above_zero(
        "motion.speed_m_s",
        motion.speed_m_s,
        workspace.max_speed_m_s,
    )?;
    within("motion.hand_turn_deg", motion.hand_turn_deg, -360.0..=360.0)
}

fn fingers(fingers: &FingerSettings) -> Checked {
    let FingerSettings {
        count,
        open,
        closed,
        cloth,
        tolerance,
    } = *fingers;
    if !(2..=3).contains(&count) {
        return wrong("fingers.count", &count, "2 or 3");
    }
    let any = -1e6..=1e6;
    within("fingers.open", open, any.clone())?;
    within("fingers.closed", closed, any)?;
    let way = (open - closed).abs();
    if way == 0.0 {
        return wrong(
            "fingers.closed",
            &closed,
            "another position than `fingers.open`",
        );
    }
    // A tolerance of the whole travel would accept closed fingers as open.
    if !(tolerance > 0.0 && tolerance < way) {
        let right = format!("above 0 and below `{way}`, the way from open to closed");
        return wrong("fingers.tolerance", &tolerance, &right);
    }
    match cloth {
        Some(cloth) if !(cloth > 0.0 && cloth < way) => {
            let right = format!("above 0 and below `{way}`, the way from open to closed");
            wrong("fingers.cloth", &cloth, &right)
        }
        _ => Ok(()),
    }
}

fn tolerance(tolerance: &Tolerance) -> Checked {
    above_zero("tolerance.position_m", tolerance.position_m, 0.1)?;
    above_zero("tolerance.angle_deg", tolerance.angle_deg, 45.0)?;
    if tolerance.corrections > 100 {
        return wrong(
            "tolerance.corrections",
            &tolerance.corrections,
            "at most 100",
        );
    }
    above_zero("tolerance.settle_s", tolerance.settle_s, MAX_WAIT_S)?;
    above_zero("tolerance.stale_s", tolerance.stale_s, MAX_WAIT_S)?;
    // A heartbeat comes at least every quarter of a second.
    within("tolerance.watchdog_s", tolerance.watchdog_s, 0.5..=60.0)
}

fn camera(camera: &CameraSettings, driver: DriverKind) -> Checked {
    let [left, top, side] = camera.window_px;
    if side == 0 || [left, top, side].iter().any(|it| *it > MAX_SIDE_PX) {
        let right = format!("left, top and side, the side above 0, none above {MAX_SIDE_PX}");
        return wrong("camera.window_px", &camera.window_px, &right);
    }
    if let Some(intrinsics) = &camera.intrinsics {
        projects(intrinsics)?;
    }
    if let Some(height_m) = camera.height_m {
        within("camera.height_m", height_m, 0.1..=MAX_PLACE_M)?;
    }
    if let Some(up_deg) = camera.up_deg {
        within("camera.up_deg", up_deg, -360.0..=360.0)?;
    }
    above_zero("camera.timeout_s", camera.timeout_s, MAX_WAIT_S)?;
    if let Some(flat) = &camera.flat
        && flat.as_os_str().is_empty()
    {
        return wrong("camera.flat", flat, "a picture's file such as `flat.png`");
    }
    match camera.source {
        CameraSource::Directory if camera.folder.is_none() => Err(
            "`camera.source` is `directory`, which needs `camera.folder`, the folder with the pictures".to_owned(),
        ),
        CameraSource::Simulated if driver != DriverKind::Simulated => Err(
            "`camera.source` is `simulated`, which would be right with `driver = \"simulated\"` only".to_owned(),
        ),
        _ => Ok(()),
    }
}

fn projects(intrinsics: &Intrinsics) -> Checked {
    let size_px = intrinsics.size_px;
    if size_px.iter().any(|side| !(1..=MAX_SIDE_PX).contains(side)) {
        let right = format!("sides of 1 to {MAX_SIDE_PX} pixels");
        return wrong("camera.intrinsics.size_px", &size_px, &right);
    }
    for focal_px in intrinsics.focal_px {
        above_zero("camera.intrinsics.focal_px", focal_px, 1e6)?;
    }
    let numbers = intrinsics.middle_px.iter().chain(&intrinsics.distortion);
    for number in numbers {
        within("camera.intrinsics", *number, -1e6..=1e6)?;
    }
    Ok(())
}

/// Checks that `[ros]` has everything that the driver and the camera need.
fn ros(settings: &Settings) -> Checked {
    let driver = match settings.driver {
        DriverKind::Kinova => Some("`driver` is `kinova`"),
        DriverKind::Trajectory => Some("`driver` is `trajectory`"),
        DriverKind::Simulated => None,
    };
    let is_topic = settings.camera.source == CameraSource::Ros;
    let camera = is_topic.then_some("`camera.source` is `ros`");
    let Some(ros) = &settings.ros else {
        return match driver.or(camera) {
            Some(who) => Err(format!("{who}, which needs a part `[ros]`")),
            None => Ok(()),
        };
    };
    addresses(ros)?;
    let missing = |who: &str, key: &str| Err(format!("{who}, which needs `ros.{key}`"));
    if settings.driver == DriverKind::Trajectory && ros.trajectory.is_none() {
        return missing("`driver` is `trajectory`", "trajectory");
    }
    if is_topic {
        for (key, topic) in [
            ("color", &ros.color),
            ("depth", &ros.depth),
            ("info", &ros.info),
        ] {
            if topic.is_none() {
                return missing("`camera.source` is `ros`", key);
            }
        }
    }
    Ok(())
}

fn addresses(ros: &RosSettings) -> Checked {
    if !ros.master.starts_with("http://") {
        let right = "an address such as `http://localhost:11311`";
        return wrong("ros.master", &ros.master, right);
    }
    if !ros.arm.starts_with('/') {
        return wrong("ros.arm", &ros.arm, "a name such as `/j2n6s200_driver`");
    }
    Ok(())
}

fn simulated(simulated: &SimulatedSettings) -> Checked {
    let SimulatedSettings {
        camera_height_m,
        camera_offset_m,
        camera_turn_deg,
        camera_fov_deg,
        camera_px,
        repeatability_m,
        seed: _,
    } = *simulated;
    within(
        "simulated.camera_height_m",
        camera_height_m,
        0.1..=MAX_PLACE_M,
    )?;
    for offset_m in camera_offset_m {
        within(
            "simulated.camera_offset_m",
            offset_m,
            -MAX_PLACE_M..=MAX_PLACE_M,
        )?;
    }
    within("simulated.camera_turn_deg", camera_turn_deg, -360.0..=360.0)?;
    within("simulated.camera_fov_deg", camera_fov_deg, 1.0..=170.0)?;
    if !(16..=4096).contains(&camera_px) {
        return wrong("simulated.camera_px", &camera_px, "16 to 4096");
    }
    within("simulated.repeatability_m", repeatability_m, 0.0..=0.1)
}

fn is_box(name: &str, min_m: &[f64; 3], max_m: &[f64; 3]) -> Checked {
    place(&format!("{name}.min_m"), min_m)?;
    place(&format!("{name}.max_m"), max_m)?;
    if min_m.iter().zip(max_m).all(|(least, most)| least < most) {
        return Ok(());
    }
    let right = format!("less than `{max_m:?}`, its max_m, along each axis");
    wrong(&format!("{name}.min_m"), min_m, &right)
}

fn holds(min_m: &[f64], max_m: &[f64], point_m: &[f64]) -> bool {
    let sides = min_m.iter().zip(max_m);
    let mut all = sides.zip(point_m);
    all.all(|((least, most), at)| (least..=most).contains(&at))
}

fn place(key: &str, point_m: &[f64; 3]) -> Checked {
    match point_m.iter().all(|it| it.abs() <= MAX_PLACE_M) {
        true => Ok(()),
        false => {
            let right = format!("three numbers of -{MAX_PLACE_M} to {MAX_PLACE_M} m");
            wrong(key, point_m, &right)
        }
    }
}

fn within(key: &str, value: f64, range: RangeInclusive<f64>) -> Checked {
    match range.contains(&value) {
        true => Ok(()),
        false => wrong(
            key,
            &value,
            &format!("{} to {}", range.start(), range.end()),
        ),
    }
}

fn above_zero(key: &str, value: f64, most: f64) -> Checked {
    match value > 0.0 && value <= most {
        true => Ok(()),
        false => wrong(key, &value, &format!("above 0 and at most {most}")),
    }
}

fn wrong(key: &str, value: &dyn Debug, right: &str) -> Checked {
    Err(format!("`{key}` is `{value:?}`; expected {right}"))
}

#[cfg(test)]
mod tests;
