//! The world of `--world jaco`: an arm's settings, its calibration, and who watches it.

use compiler::program::Program;
use runtime::arm::settings::DriverKind;
use runtime::arm::supervisor::{NoWatchdog, Unattended};
use runtime::world::jaco::{self, Parts};
use runtime::world::{ArmWorld, World, WorldError};
use std::path::{Path, PathBuf};

/// Makes the world of an arm; `folder` is the run folder, for the arm's journal.
pub fn world(
    program: &Program,
    robot: &Path,
    folder: Option<&PathBuf>,
) -> Result<Box<dyn World>, WorldError> {
    let failed = |why: String| WorldError::Motion { why };
    let (settings, settings_hash, calibration) = jaco::load(robot).map_err(failed)?;
    if settings.driver != DriverKind::Simulated {
        return Err(failed(format!(
            "`{}` names the driver of a real arm, which `fabc run` does not move yet; only `simulated` is",
            robot.display()
        )));
    }
    let parts = Parts {
        settings,
        settings_hash,
        calibration,
        image_px: program.camera.image_px,
        // It moves within this program and ends with it.
        supervisor: Box::new(Unattended),
        watchdog: Box::new(NoWatchdog),
        folder: folder.cloned(),
    };
    Ok(Box::new(ArmWorld::simulated(parts)?))
}
