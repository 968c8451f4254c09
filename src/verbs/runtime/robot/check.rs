//! `fabc robot check`: whether an arm's settings and calibration are usable, what it reaches, and what to do next.
//!
//! In: a settings file, and the calibration that it names. Out: one line per subject, or JSON; the exit code says whether a
//! run could start. Plans and runs pass the same check. The arm and the camera are not contacted.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::{Args, ValueHint};
use fab_arm::calibration::{Calibration, Corner};
use fab_arm::guard::{Guard, Surface};
use fab_arm::kinematics::reach::Reach;
use fab_arm::settings::{CameraSource, Settings};
use nalgebra::Point3;
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct RobotCheckArguments {
    /// The arm's settings.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub robot: PathBuf,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// A place, and why it is out of reach if it is.
#[derive(Serialize)]
struct NamedPose {
    #[serde(rename = "place")]
    name: &'static str,
    /// The settings' key of a place that a run needs. A corner out of reach only costs the points near it.
    #[serde(skip)]
    needed: Option<&'static str>,
    at_m: [f64; 3],
    why_not: Option<String>,
}

/// What is printed, as text or as JSON.
#[derive(Serialize)]
struct Inspection {
    name: String,
    model: String,
    calibration: CalibrationCheck,
    reach: Vec<NamedPose>,
    /// Pairs of parts that touch at rest.
    touching: Vec<[String; 2]>,
    #[serde(skip)]
    faults: Vec<String>,
    /// What to do: about each fault, else to plan.
    next: Vec<String>,
    exit: u8,
}

#[derive(Serialize)]
#[serde(untagged)]
enum CalibrationCheck {
    Usable(Box<MadeCalibration>),
    Unusable { usable: bool, why: String },
}

#[derive(Serialize)]
struct MadeCalibration {
    usable: bool,
    made_on: String,
    left_out_mm: Vec<f64>,
    left_out_rms_mm: f64,
    corners: [Corner; 4],
}

pub fn run(arguments: &RobotCheckArguments, io: &Io) -> Result<Exit, Failure> {
    let inspection = inspect(&arguments.robot, &Settings::load(&arguments.robot)?);
    io.either(arguments.json, &inspection, || inspection.text());
    if inspection.faults.is_empty() {
        return Ok(Exit::Done);
    }
    io.talk("error: this arm cannot be used as it is set up");
    Ok(Exit::Environment)
}

/// Returns the settings of an arm with which a plan or a run may begin; fails as `robot check` does, with what to do next.
pub fn usable(robot: &Path) -> Result<Settings, Failure> {
    let settings = Settings::load(robot)?;
    let inspection = inspect(robot, &settings);
    if inspection.faults.is_empty() {
        return Ok(settings);
    }
    Err(Failure::environment(format!(
        "nothing is planned or moved, because `fabc robot check` refuses the arm of `{}`\n{}\nnext: {}",
        robot.display(),
        inspection.faults.join("\n"),
        inspection.next.join("\nnext: ")
    )))
}

fn inspect(robot: &Path, settings: &Settings) -> Inspection {
    let guard = Guard::new(settings, Surface::level(settings));
    let (reach, file) = (places(settings, &guard), robot.display());
    let (mut faults, mut next) = (Vec::new(), Vec::new());
    let calibration = match calibration(robot, settings) {
        Ok(made) => CalibrationCheck::Usable(Box::new(made)),
        Err([why, cure]) => {
            faults.push(format!("the calibration cannot be used: {why}"));
            next.push(cure);
            CalibrationCheck::Unusable { usable: false, why }
        }
    };
    for place in &reach {
        let ([x, y, z], name) = (place.at_m, place.name);
        if let (Some(key), Some(why)) = (place.needed, &place.why_not) {
            faults.push(format!(
                "the {name} ({x:.3}, {y:.3}, {z:.3}) is out of reach: {why}"
            ));
            next.push(format!(
                "state another `{key}` in `{file}`, or the box of `workspace` around it"
            ));
        }
    }
    if faults.is_empty() {
        let plan = format!("`fabc run TASK --world arm --robot {file} --plan-only`");
        next.push(plan);
    }
    let exit = match faults.as_slice() {
        [] => Exit::Done,
        _ => Exit::Environment,
    };
    Inspection {
        name: settings.name.clone(),
        model: settings.model.clone(),
        calibration,
        reach,
        touching: guard.touching().to_vec(),
        faults,
        next,
        exit: exit.code(),
    }
}

fn places(settings: &Settings, guard: &Guard) -> Vec<NamedPose> {
    let turn_rad = settings.motion.hand_turn_deg.to_radians();
    let reach = Reach::tool_down(settings.chain(), turn_rad);
    let [x, y, z] = settings.table.center_m;
    let ([left, low, _], [right, high, _]) = (settings.workspace.min_m, settings.workspace.max_m);
    let motion = &settings.motion;
    let over_table = &[
        motion.pre_pick_m,
        motion.lift_m,
        motion.retreat_m,
        motion.travel_m,
    ][..];
    let rest_m = settings.workspace.rest_m;
    // The corners are those of the workspace, so only the other places are checked against it.
    let places = [
        (
            "middle of the table",
            [x, y, z],
            over_table,
            Some("table.center_m"),
        ),
        ("rest", rest_m, &[], Some("workspace.rest_m")),
        ("corner, least x, least y", [left, low, z], over_table, None),
        ("corner, least x, most y", [left, high, z], over_table, None),
        ("corner, most x, least y", [right, low, z], over_table, None),
        ("corner, most x, most y", [right, high, z], over_table, None),
    ];
    let checked = places.map(|(name, at_m, above_m, needed)| {
        let out_of_reach = reach.check(&Point3::from(at_m), above_m).err();
        let top_m = above_m.iter().copied().fold(0.0, f64::max);
        let ends = [at_m[2], at_m[2] + top_m].map(|z| Point3::new(at_m[0], at_m[1], z));
        let mut ends = ends.iter().filter(|_| needed.is_some());
        let out_of_box = || ends.find_map(|end| guard.goal(end).err());
        NamedPose {
            name,
            needed,
            at_m,
            why_not: out_of_reach.or_else(out_of_box),
        }
    });
    checked.into()
}

/// Reads the calibration of the settings, and compares it with them; else returns why it is useless, and what to do.
fn calibration(robot: &Path, settings: &Settings) -> Result<MadeCalibration, [String; 2]> {
    let beside = robot.parent().unwrap_or(Path::new(""));
    let path = beside.join(&settings.calibration);
    let is_simulated = settings.camera.source == CameraSource::Simulated;
    let calibrate = format!(
        "touch points and calibrate: `fabc calibrate --robot {} --pairs FILE`",
        robot.display()
    );
    let made = Calibration::load(&path);
    let made = made.map_err(|error| [error, calibrate.clone()])?;
    let corners = made.over_table(settings).map_err(|why| {
        let file = robot.display();
        [
            format!("it does not fit these settings: {why}"),
            format!("correct what is said of it in `{file}`; else {calibrate}"),
        ]
    })?;
    // A simulated camera cannot be moved.
    if made.reference.is_none() && !is_simulated {
        let why = "it has no picture, so that a moved camera could not be noticed";
        return Err([why.to_owned(), calibrate]);
    }
    Ok(MadeCalibration {
        usable: true,
        left_out_rms_mm: made.left_out_rms_mm(),
        made_on: made.made_on,
        left_out_mm: made.left_out_mm,
        corners,
    })
}

impl Inspection {
    fn text(&self) -> String {
        let (name, model) = (&self.name, &self.model);
        let mut lines = vec![format!("settings     {name}, {model}: can be used")];
        match &self.calibration {
            CalibrationCheck::Usable(made) => {
                let (made_on, left_out_mm) = (&made.made_on, made.left_out_rms_mm);
                lines.push(format!(
                    "calibration  of {made_on}: can be used; a point left out is {left_out_mm:.1} mm off"
                ));
                lines.extend(made.corners.iter().map(|corner| {
                    let ([x, y, z], error_mm) = (corner.at_m, corner.error_mm);
                    format!("corner       ({x:.3}, {y:.3}, {z:.3}): known to {error_mm:.1} mm")
                }));
            }
            CalibrationCheck::Unusable { why, .. } => {
                lines.push(format!("calibration  cannot be used: {why}"));
            }
        }
        lines.extend(self.reach.iter().map(|place| {
            let [x, y, z] = place.at_m;
            let why = place.why_not.as_ref();
            let result = why.map_or("reached".to_owned(), |why| format!("out of reach: {why}"));
            let name = place.name;
            format!("reach        {name} ({x:.3}, {y:.3}, {z:.3}): {result}")
        }));
        lines.extend(self.touching.iter().map(|[one, other]| {
            format!("touching     {one} and {other}, at rest: these two are not kept apart")
        }));
        lines.extend(self.next.iter().map(|next| format!("next         {next}")));
        lines.join("\n")
    }
}
