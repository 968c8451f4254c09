//! An arm's world in which nothing moves: the first action is planned and drawn, and the rollout ends.
//!
//! In: what [`ArmWorld`] takes, without an arm. Out: pictures, and for the first motion a [`Plan`] in the run folder as
//! `plan.json` and `plan.png`. No arm is connected, so none can move; the tool is assumed to be at `rest_m`.

use super::{ArmWorld, FlatPicture, Parts, motion};
use crate::driver::parked::ParkedArm;
use crate::kinematics::tool_down::tool_down;
use crate::plan::Plan;
use crate::rgbd::RgbdSource;
use crate::settings::DriverKind;
use crate::table::{ClothTable, TableCamera};
use fab_base::files;
use fab_base::interrupt::Interrupt;
use fab_picture::png;
use fab_world::{Executed, Motion, World, WorldError, Wrapper};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Name of a plan's file in a run folder.
pub const PLAN_FILE: &str = "plan.json";

/// Name of its drawing.
pub const PLAN_PICTURE: &str = "plan.png";

/// The longest plan accepted, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// A table under a camera, and an arm to plan for.
pub struct PlanningWorld {
    world: ArmWorld,
    folder: Option<PathBuf>,
}

impl PlanningWorld {
    /// Sets up a table that this program simulates, for settings with the driver `simulated`.
    pub fn simulated(parts: Parts) -> Result<PlanningWorld, WorldError> {
        if parts.settings.driver != DriverKind::Simulated {
            return Err(motion(
                "its settings name another driver than `simulated`".to_owned(),
            ));
        }
        let base_from_world = super::base_from_world(&parts.settings);
        let table = ClothTable::new(&parts.settings, &base_from_world)?
            .with_material(parts.material.as_ref());
        let table = Rc::new(RefCell::new(table));
        let camera = Box::new(TableCamera(table.clone()));
        let mut planning = PlanningWorld::new(parts, camera)?;
        planning.world.table = Some(table);
        Ok(planning)
    }

    /// Sets up a table that a camera sees.
    pub fn new(mut parts: Parts, camera: Box<dyn RgbdSource>) -> Result<PlanningWorld, WorldError> {
        // Without motion there is no journal.
        let folder = parts.folder.take();
        let settings = &parts.settings;
        let turn_rad = settings.motion.hand_turn_deg.to_radians();
        let at = tool_down(&settings.workspace.rest_m.into(), turn_rad);
        let arm = ParkedArm::at(at);
        let world = ArmWorld::new(parts, Box::new(arm), camera)?;
        Ok(PlanningWorld { world, folder })
    }

    /// Measures coverage against a picture of the flat cloth, as the arm's own world does.
    pub fn with_flat(self, flat: Option<FlatPicture>) -> PlanningWorld {
        PlanningWorld {
            world: self.world.with_flat(flat),
            ..self
        }
    }

    /// Writes a plan and its drawing into the run folder.
    fn save(&self, plan: &Plan) -> Result<(), WorldError> {
        let Some(folder) = &self.folder else {
            return Err(motion("there is no run folder for the plan".to_owned()));
        };
        let Some(shot) = &self.world.last_shot else {
            return Err(motion("there is no picture to draw the plan on".to_owned()));
        };
        let Parts {
            settings,
            calibration,
            sight,
            ..
        } = &self.world.parts;
        let reach = self.world.reach.reach();
        let drawn = (sight.draw_plan)(plan, &shot.rgb, calibration, settings, reach);
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

impl Wrapper for PlanningWorld {
    fn inner(&self) -> &dyn World {
        &self.world
    }

    fn inner_mut(&mut self) -> &mut dyn World {
        &mut self.world
    }

    fn act(&mut self, asked: &Motion, _: &Interrupt) -> Result<Executed, WorldError> {
        if !self.world.is_laid {
            return Err(WorldError::NotReset);
        }
        let grip = asked.only(self.world.name())?;
        if let Some(why) = self.world.refuses(asked) {
            return Err(motion(why));
        }
        let at_rest = self.world.arm.arm().state();
        let from = at_rest.map_err(|error| motion(error.to_string()))?;
        let (plan, _) = self.world.plan(&from, &grip);
        self.save(&plan)?;
        match plan.refusal() {
            Some(why) => Err(motion(why)),
            None => Err(WorldError::PlannedOnly),
        }
    }
}
