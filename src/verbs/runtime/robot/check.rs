//! `fabc robot check`: whether an arm's settings and calibration are usable, what it reaches, and what to do next.
//!
//! In: a settings file, and the calibration that it names. Out: one line per subject, or JSON; the exit code says whether a
//! run could start. Plans and runs pass the same check. The arm and the camera are not contacted.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::calibrate::report::Quality;
use clap::{Args, ValueHint};
use fab_arm::calibration::Calibration;
use fab_arm::guard::Guard;
use fab_arm::kinematics::reach::Reach;
use fab_arm::settings::{CameraSource, Settings};
use fab_arm::world::Files;
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
    /// `None` if it cannot be used.
    calibration: Option<Quality>,
    reach: Vec<NamedPose>,
    /// Pairs of parts that touch at rest.
    touching: Vec<[String; 2]>,
    /// Why no run could start, and what to do about it.
    faults: Vec<String>,
}

pub fn run(arguments: &RobotCheckArguments, io: &Io) -> Result<Exit, Failure> {
    let inspection = inspect(&arguments.robot)?;
    io.either(arguments.json, &inspection, || inspection.text());
    if inspection.faults.is_empty() {
        let robot = arguments.robot.display();
        io.talk(&format!(
            "next: `fabc run TASK --world arm --robot {robot} --plan-only`"
        ));
        return Ok(Exit::Done);
    }
    io.talk("error: this arm cannot be used as it is set up");
    Ok(Exit::Environment)
}

/// Returns the files of an arm with which a plan or a run may begin; fails as `robot check` does, with what to do next.
pub fn usable(robot: &Path) -> Result<Files, Failure> {
    let faults = inspect(robot)?.faults;
    if faults.is_empty() {
        return Files::load(robot).map_err(Failure::environment);
    }
    Err(Failure::environment(format!(
        "nothing is planned or moved, because `fabc robot check` refuses the arm of `{}`\n{}",
        robot.display(),
        faults.join("\n")
    )))
}

fn inspect(robot: &Path) -> Result<Inspection, Failure> {
    let settings = Settings::load(robot)?;
    let guard = Guard::level(&settings);
    let (reach, calibration) = (places(&settings), calibration(robot, &settings));
    let faults = reach.iter().filter_map(|place| {
        let ([x, y, z], name) = (place.at_m, place.name);
        let (key, why) = (place.needed?, place.why_not.as_ref()?);
        Some(format!(
            "the {name} ({x:.3}, {y:.3}, {z:.3}) is out of reach: {why}; state another `{key}`, or the box of `workspace` \
             around it"
        ))
    });
    let useless = calibration.as_ref().err().cloned();
    Ok(Inspection {
        faults: useless.into_iter().chain(faults).collect(),
        calibration: calibration.ok(),
        reach,
        touching: guard.touching().to_vec(),
        name: settings.name,
        model: settings.model,
    })
}

/// Checks the places that a run needs, which the settings' check found within the workspace, and its corners.
fn places(settings: &Settings) -> Vec<NamedPose> {
    let (workspace, motion) = (&settings.workspace, &settings.motion);
    let reach = Reach::tool_down(settings.chain(), motion.hand_turn_deg.to_radians());
    let place = |name, at_m: [f64; 3], above_m, needed| NamedPose {
        name,
        needed,
        at_m,
        why_not: reach.check(&Point3::from(at_m), &[above_m]).err(),
    };
    let table_m = settings.table.center_m;
    let corner = |name, x, y| place(name, [x, y, table_m[2]], motion.travel_m, None);
    let ([left, low, _], [right, high, _]) = (workspace.min_m, workspace.max_m);
    vec![
        place(
            "middle of the table",
            table_m,
            motion.travel_m,
            Some("table.center_m"),
        ),
        place("rest", workspace.rest_m, 0.0, Some("workspace.rest_m")),
        corner("corner, least x, least y", left, low),
        corner("corner, least x, most y", left, high),
        corner("corner, most x, least y", right, low),
        corner("corner, most x, most y", right, high),
    ]
}

/// Reads the calibration of the settings, and compares it with them; else returns why it is useless, and what to do.
fn calibration(robot: &Path, settings: &Settings) -> Result<Quality, String> {
    let path = robot.with_file_name(&settings.calibration);
    let robot = robot.display();
    let fault = |why: String| {
        format!(
            "the calibration cannot be used: {why}; correct `{robot}`, or touch points anew: `fabc calibrate --robot {robot} \
             --pairs FILE`"
        )
    };
    let made = Calibration::load(&path).map_err(fault)?;
    let corners = made.over_table(settings).map_err(fault)?;
    // A simulated camera cannot be moved.
    if made.reference.is_none() && settings.camera.source != CameraSource::Simulated {
        let why = "it has no picture, so that a moved camera could not be noticed";
        return Err(fault(why.to_owned()));
    }
    Ok(Quality::of(&made, corners))
}

impl Inspection {
    fn text(&self) -> String {
        let (name, model) = (&self.name, &self.model);
        let mut lines = vec![format!("settings     {name}, {model}: can be used")];
        let made = self.calibration.iter();
        lines.extend(made.map(|it| format!("calibration  of {}: {}", it.made_on, it.text())));
        lines.extend(self.reach.iter().map(|place| {
            let ([x, y, z], name, why) = (place.at_m, place.name, place.why_not.as_ref());
            let result = why.map_or("reached".to_owned(), |why| format!("out of reach: {why}"));
            format!("reach        {name} ({x:.3}, {y:.3}, {z:.3}): {result}")
        }));
        lines.extend(self.touching.iter().map(|[one, other]| {
            format!("touching     {one} and {other}, at rest: these two are not kept apart")
        }));
        lines.extend(
            self.faults
                .iter()
                .map(|fault| format!("fault        {fault}")),
        );
        lines.join("\n")
    }
}
