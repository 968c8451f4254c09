//! `fabc robot check`: whether an arm's settings and calibration are usable, and what it reaches.
//!
//! In: a settings file, and the calibration that it names. Out: one line per subject, or JSON; the exit code says whether a
//! run could start. The arm and the camera are not contacted.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::Args;
use clap::ValueHint;
use fab_arm::calibration::Calibration;
use fab_arm::guard::{Guard, Surface};
use fab_arm::kinematics::chain::Chain;
use fab_arm::kinematics::reach::{Reach, Turn};
use fab_arm::settings::Settings;
use nalgebra::Point3;
use serde_json::{Value, json};
use std::path::Path;
use std::path::PathBuf;

/// Arguments of `robot check`.
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
struct NamedPose {
    name: &'static str,
    at_m: [f64; 3],
    why_not: Option<String>,
}

/// The state of the calibration.
enum CalibrationState {
    /// It is usable; its error with each point left out, millimetres.
    Usable(f64),
    /// It is not, for this reason.
    Unusable(String),
}

/// Checks the settings and everything that they name.
pub fn run(arguments: &RobotCheckArguments, io: &Io) -> Result<Exit, Failure> {
    let settings = Settings::load(&arguments.robot).map_err(Failure::environment)?;
    let chain = Chain::of_model(&settings.model).map_err(Failure::environment)?;
    let places = places(&settings, &chain);
    let measured = measured(&arguments.robot, &settings);
    // A corner out of reach only costs the points near it; a run needs the middle of the table and the rest position.
    let mut needed = places.iter().filter(|place| !is_corner(place));
    let is_usable =
        needed.all(|it| it.why_not.is_none()) && !matches!(measured, CalibrationState::Unusable(_));
    let exit = match is_usable {
        true => Exit::Done,
        false => Exit::Environment,
    };
    match arguments.json {
        true => io.json(&as_json(&settings, &places, &measured, exit)),
        false => io.data(&as_text(&settings, &places, &measured)),
    }
    if exit != Exit::Done {
        io.talk("error: this arm cannot be used as it is set up");
    }
    Ok(exit)
}

fn is_corner(place: &NamedPose) -> bool {
    place.name.starts_with("corner")
}

fn places(settings: &Settings, chain: &Chain) -> Vec<NamedPose> {
    let turn = Turn::Fixed(settings.motion.hand_turn_deg.to_radians());
    let reach = Reach::tool_down(chain, turn);
    let guard = Guard::new(settings, chain.clone(), Surface::level(settings));
    let [x, y, z] = settings.table.center_m;
    let ([left, low, _], [right, high, _]) = (settings.workspace.min_m, settings.workspace.max_m);
    let motion = &settings.motion;
    let over_table = [
        motion.pre_pick_m,
        motion.lift_m,
        motion.retreat_m,
        motion.travel_m,
    ];
    let place = |name, at_m: [f64; 3], above_m: &[f64]| NamedPose {
        name,
        at_m,
        why_not: reach
            .check(&Point3::from(at_m), above_m)
            .err()
            .map(|why| why.to_string()),
    };
    let top_m = over_table.into_iter().fold(0.0, f64::max);
    // The corners are those of the workspace, so only the other places are checked against it.
    let in_box = |place: NamedPose, above_m: f64| {
        let [x, y, z] = place.at_m;
        let ends = [z, z + above_m].map(|z| Point3::new(x, y, z));
        let mut why = ends.iter().filter_map(|end| guard.goal(end).err());
        NamedPose {
            why_not: place.why_not.clone().or_else(|| why.next()),
            ..place
        }
    };
    vec![
        in_box(place("middle of the table", [x, y, z], &over_table), top_m),
        in_box(place("rest", settings.workspace.rest_m, &[]), 0.0),
        place("corner, least x, least y", [left, low, z], &over_table),
        place("corner, least x, most y", [left, high, z], &over_table),
        place("corner, most x, least y", [right, low, z], &over_table),
        place("corner, most x, most y", [right, high, z], &over_table),
    ]
}

fn measured(robot: &Path, settings: &Settings) -> CalibrationState {
    let path = robot
        .parent()
        .unwrap_or(Path::new(""))
        .join(&settings.calibration);
    let calibration = match Calibration::load(&path) {
        Ok(calibration) => calibration,
        Err(error) => {
            let robot = robot.display();
            return CalibrationState::Unusable(format!(
                "{error}; `fabc calibrate --robot {robot}` writes it"
            ));
        }
    };
    match calibration.check_settings(settings) {
        Ok(()) if calibration.reference.is_none() => CalibrationState::Unusable(format!(
            "it has no picture, so that a moved camera could not be noticed and no run begins; calibrate with `--image PNG` or `--shoot`, and keep `{}` beside it",
            Calibration::picture_beside(&path).display()
        )),
        Ok(()) => CalibrationState::Usable(calibration.accuracy.left_out_rms_mm),
        Err(refusal) => {
            CalibrationState::Unusable(format!("it does not fit these settings: {refusal}"))
        }
    }
}

fn as_text(settings: &Settings, places: &[NamedPose], measured: &CalibrationState) -> String {
    let mut lines = vec![format!(
        "settings     {}, {}: can be used",
        settings.name, settings.model
    )];
    lines.push(match measured {
        CalibrationState::Usable(error_mm) => {
            format!("calibration  can be used; a point left out is {error_mm:.1} mm off")
        }
        CalibrationState::Unusable(why) => format!("calibration  cannot be used: {why}"),
    });
    for place in places {
        let [x, y, z] = place.at_m;
        let result = match &place.why_not {
            None => "reached".to_owned(),
            Some(why) => format!("out of reach: {why}"),
        };
        lines.push(format!(
            "reach        {} ({x:.3}, {y:.3}, {z:.3}): {result}",
            place.name
        ));
    }
    lines.join("\n")
}

fn as_json(
    settings: &Settings,
    places: &[NamedPose],
    measured: &CalibrationState,
    exit: Exit,
) -> Value {
    let places: Vec<Value> = places
        .iter()
        .map(|it| json!({ "place": it.name, "at_m": it.at_m, "why_not": it.why_not }))
        .collect();
    let calibration = match measured {
        CalibrationState::Usable(error_mm) => json!({ "usable": true, "left_out_mm": error_mm }),
        CalibrationState::Unusable(why) => json!({ "usable": false, "why": why }),
    };
    json!({
        "name": settings.name,
        "model": settings.model,
        "calibration": calibration,
        "reach": places,
        "exit": exit.code(),
    })
}
