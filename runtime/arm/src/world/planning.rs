//! An arm's world in which nothing moves: the first action is planned and drawn, and the rollout ends.
//!
//! In: what an [`ArmWorld`] takes, without an arm. Out: pictures, and for the first motion a [`Plan`] in the run folder as
//! `plan.json` and `plan.png`. No arm is connected, so none can move; the tool is assumed to be at `rest_m`.

use super::simulated::table;
use super::{Acts, ArmWorld, Parts, motion};
use crate::driver::{Commands, PortArm};
use crate::plan::Plan;
use crate::port::Port;
use crate::rgbd::RgbdSource;
use crate::simulated::SimulatedArm;
use crate::table::TableCamera;
use fab_base::files;
use fab_picture::png;
use fab_world::WorldError;
use std::path::Path;

/// Name of a plan's file in a run folder.
pub const PLAN_FILE: &str = "plan.json";

/// Name of its drawing.
pub const PLAN_PICTURE: &str = "plan.png";

/// The longest plan accepted, bytes.
const MAX_BYTES: u64 = 1 << 20;

impl ArmWorld {
    /// Sets up a table that this program simulates, to plan over it, for settings with the driver `simulated`.
    pub fn planning_simulated(parts: Parts) -> Result<ArmWorld, WorldError> {
        let table = table(&parts)?;
        let camera = Box::new(TableCamera(table.clone()));
        let planning = ArmWorld::planning(parts, camera)?;
        Ok(ArmWorld {
            table: Some(table),
            ..planning
        })
    }

    /// Sets up a table that a camera sees, to plan over it.
    pub fn planning(mut parts: Parts, camera: Box<dyn RgbdSource>) -> Result<ArmWorld, WorldError> {
        // Without motion there is no journal.
        let folder = parts.folder.take();
        let settings = &parts.files.settings;
        let arm = Box::new(SimulatedArm::new(settings, None).map_err(motion)?);
        let (fingers, tolerance) = (settings.fingers, settings.tolerance);
        let arm = PortArm::<dyn Port>::new(arm, Commands::Trajectories, fingers, tolerance);
        let world = ArmWorld::new(parts, arm, camera)?;
        Ok(ArmWorld {
            acts: Acts::PlanIn(folder),
            ..world
        })
    }

    /// Writes a plan and its drawing into the run folder.
    pub(super) fn save_plan(&self, folder: Option<&Path>, plan: &Plan) -> Result<(), WorldError> {
        let Some(folder) = folder else {
            return Err(motion("there is no run folder for the plan".to_owned()));
        };
        let Some(shot) = &self.last_shot else {
            return Err(motion("there is no picture to draw the plan on".to_owned()));
        };
        let Parts { files, sight, .. } = &self.parts;
        let (calibration, reach) = (&files.calibration, &self.reach.reach);
        let drawn = (sight.draw_plan)(plan, &shot.rgb, calibration, &files.settings, reach);
        let drawn = drawn.map_err(motion)?;
        let text = serde_json::to_vec_pretty(plan).map_err(|error| motion(error.to_string()))?;
        let picture = png::encode(&drawn);
        for (name, bytes) in [(PLAN_FILE, &text), (PLAN_PICTURE, &picture)] {
            let path = folder.join(name);
            std::fs::write(&path, bytes)
                .map_err(|error| motion(format!("`{}`: {error}", path.display())))?;
        }
        Ok(())
    }
}

/// Reads the plan in a run folder; the error says why it cannot be read.
pub fn read_plan(folder: &Path) -> Result<Plan, String> {
    let path = folder.join(PLAN_FILE);
    let text = files::read_text(&path, MAX_BYTES)?;
    serde_json::from_str(&text).map_err(|error| format!("`{}`: {error}", path.display()))
}
