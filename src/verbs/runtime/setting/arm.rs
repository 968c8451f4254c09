//! The world of `--world arm`: an arm's settings, calibration, driver, supervisor and watchdog.

use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::runtime::robot::check::usable;
use crate::verbs::runtime::robot::terminal::{Confirm, TerminalSupervisor};
use crate::verbs::runtime::robot::watchdog::Process;
use crate::verbs::runtime::robot::{connect, preflight};
use crate::verbs::runtime::setting::worlds::WorldChoice;
use clap::{Args, ValueHint};
use fab_agent::arm_sight::SIGHT;
use fab_arm::directory::PictureSelection;
use fab_arm::journal;
use fab_arm::settings::{CameraSource, DriverKind, Settings};
use fab_arm::supervisor::{NoWatchdog, Supervisor, Unattended};
use fab_arm::world::{ArmWorld, Files, Parts, WithinReach};
use fab_program::{ClothStart, Program};
use fab_world::start::Start;
use fab_world::{World, WorldError};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The arm of `--world arm`, and who watches it.
#[derive(Args, Clone, Debug, Default, Serialize, Deserialize)]
pub struct ArmArguments {
    /// With `--world arm`: the settings of the arm and its table; default: robot.toml.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub robot: Option<PathBuf>,
    /// When a person must confirm motion; default: each pick and place of a real arm, never for a simulated one.
    #[arg(long, value_enum, value_name = "WHAT")]
    pub confirm: Option<Confirm>,
    /// Let the arm move only while the space bar is held.
    #[arg(long)]
    pub hold_to_run: bool,
}

impl ArmArguments {
    pub fn robot(&self) -> &Path {
        self.robot.as_deref().unwrap_or(Path::new("robot.toml"))
    }

    /// Fails if an option is for an arm and another world was chosen: whoever gave it believes that it applies.
    pub fn check_world(&self, world: &WorldChoice) -> Result<(), Failure> {
        let is_given = self.robot.is_some() || self.confirm.is_some() || self.hold_to_run;
        if is_given && *world != WorldChoice::Arm {
            return Err(Failure::usage(format!(
                "`--robot`, `--confirm` and `--hold-to-run` are for an arm, and nothing is moved by one with `--world {world}`: \
                 add `--world arm`, or leave them out"
            )));
        }
        Ok(())
    }
}

/// Whether an arm executes actions or only plans them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmMode {
    Execute,
    /// The first action is planned, and no arm is connected.
    PlanOnly,
}

/// What the driver `kinova` cannot hold.
const POSES_ALONE: &str = "\
note: with the driver `kinova` the vendor's node chooses speed and joint path: the arm is stopped when its measured place, joint \
angles or speed leave their limits";

/// Checks first of all that the settings are usable and that a supervisor can be asked.
pub fn check(arguments: &ArmArguments, mode: ArmMode, io: &Io) -> Result<Files, Failure> {
    let robot = arguments.robot();
    if mode == ArmMode::Execute && is_real(&Settings::load(robot)?) {
        // The state of the arm comes first: it does not depend on anything else.
        preflight::claim(robot).map_err(Failure::environment)?;
        preflight::check(robot).map_err(Failure::environment)?;
    }
    let files = usable(robot)?;
    let settings = &files.settings;
    if settings.driver == DriverKind::Kinova {
        io.talk(POSES_ALONE);
    }
    if mode == ArmMode::PlanOnly {
        return Ok(files);
    }
    if !is_real(settings) && settings.camera.source != CameraSource::Simulated {
        return Err(Failure::environment(format!(
            "the arm of `{}` is simulated and would move a simulated cloth, and its `camera.source` shows another table: \
             state `camera.source = \"simulated\"`, or plan for the camera's picture with `--plan-only`",
            robot.display()
        )));
    }
    connect::check_built(settings).map_err(Failure::environment)?;
    supervisor(arguments, settings, io)?;
    Ok(files)
}

/// Returns the start for a cloth that a person lays.
pub fn start(program: &Program, named: Option<&String>) -> Result<Start, Failure> {
    if let Some(named) = named {
        return Err(Failure::usage(format!(
            "`--start {named}` is for the simulator: on a real table a person lays the cloth"
        )));
    }
    let name = match program.cloth.start {
        ClothStart::Crumpled => "crumpled by hand",
        _ => "flat, laid by hand",
    };
    Ok(Start {
        name: name.to_owned(),
        ..Start::flat(&program.cloth)
    })
}

/// Makes the world of an arm; `folder` is the run folder, for the arm's journal.
pub fn world(
    program: &Program,
    arguments: &ArmArguments,
    mode: ArmMode,
    folder: Option<&PathBuf>,
    io: &Io,
) -> Result<Box<dyn World>, WorldError> {
    let robot = arguments.robot();
    // Again, because the files may have changed since.
    let files = usable(robot).map_err(failed)?;
    let settings = files.settings.clone();
    let supervisor = match mode {
        ArmMode::Execute => supervisor(arguments, &settings, io).map_err(failed)?,
        ArmMode::PlanOnly => Box::new(Unattended),
    };
    let mut parts = Parts {
        files,
        sight: SIGHT,
        image_px: program.camera.image_px,
        // A real cloth is what it is.
        material: program
            .cloth
            .material
            .clone()
            .filter(|_| !is_real(&settings)),
        supervisor,
        // A simulated arm ends with this program; a real one gets a watchdog below.
        watchdog: Box::new(NoWatchdog),
        folder: folder.cloned(),
    };
    let camera = |selection: PictureSelection| {
        let camera = connect::camera(&settings, robot, selection);
        camera.map_err(|why| WorldError::Camera { why })
    };
    Ok(Box::new(match mode {
        ArmMode::PlanOnly if settings.camera.source == CameraSource::Simulated => {
            ArmWorld::planning_simulated(parts)?
        }
        ArmMode::PlanOnly => ArmWorld::planning(parts, camera(PictureSelection::Newest)?)?,
        ArmMode::Execute if !is_real(&settings) => ArmWorld::simulated(parts)?,
        ArmMode::Execute => {
            preflight::check(robot).map_err(failed)?;
            let process = Process::start(robot, settings.tolerance.watchdog_s);
            parts.watchdog = Box::new(process.map_err(failed)?);
            let timeout_s = settings.camera.timeout_s;
            let camera = camera(PictureSelection::Fresh { timeout_s })?;
            let world = ArmWorld::new(parts, connect::arm(&settings).map_err(failed)?, camera)?;
            if let Some(folder) = folder {
                // Before the first motion: after a crash in it, the next run must find this one.
                journal::record_run(robot, folder).map_err(failed)?;
            }
            world
        }
    }))
}

/// Makes a simulated world that refuses points out of the arm's reach: nobody is asked, and nothing moves.
pub fn look(program: &Program, arguments: &ArmArguments) -> Result<Box<dyn World>, WorldError> {
    let files = Files::load(arguments.robot()).map_err(failed)?;
    let world = super::world(program)?;
    let reach = WithinReach::new(world, files.settings, &files.calibration);
    Ok(Box::new(reach))
}

/// Returns whether the arm is a real one, beside which a person must stand.
pub fn is_real(settings: &Settings) -> bool {
    settings.driver != DriverKind::Simulated
}

/// Returns whether a person beside the arm judges the result, if the command line does not say.
pub fn has_operator(arguments: &ArmArguments, settings: &Settings, io: &Io) -> bool {
    is_real(settings) && arguments.confirm != Some(Confirm::None) && io.has_terminal_input()
}

/// Returns the supervisor: for a real arm a person, unless the command line says otherwise.
fn supervisor(
    arguments: &ArmArguments,
    settings: &Settings,
    io: &Io,
) -> Result<Box<dyn Supervisor>, Failure> {
    let usual = [Confirm::None, Confirm::Each][usize::from(is_real(settings))];
    let confirm = arguments.confirm.unwrap_or(usual);
    if confirm == Confirm::None && !arguments.hold_to_run {
        return Ok(Box::new(Unattended));
    }
    let supervisor = TerminalSupervisor::new(confirm, arguments.hold_to_run, io)?;
    Ok(Box::new(supervisor))
}

fn failed(why: impl ToString) -> WorldError {
    WorldError::Motion {
        why: why.to_string(),
    }
}
