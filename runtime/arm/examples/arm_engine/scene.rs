//! A simulated arm over a simulated cloth, built from an arm's settings, with faults.
//!
//! In: a [`Plan`]. Out: a stage. Message faults are kept here, because messages are lost between the node and its
//! client; the other faults belong to the simulated arm. Before the cloth is laid, the camera sees the bare table.

use super::Stage;
use super::fault::FaultKind;
use super::faulty::{Fault, Faulty};
use fab_arm::port::{GoalId, GoalState, Port, PortError, Readings, Waypoint};
use fab_arm::rgbd::{RgbdSource, Shot};
use fab_arm::settings::Settings;
use fab_arm::table::{ClothTable, TableCamera};
use fab_arm::world::base_from_world;
use fab_program::{Cloth, ClothStart};
use fab_world::start::Start;
use nalgebra::{Isometry3, Point3};
use serde::Deserialize;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;

/// How long a short silence lasts, seconds.
const SHORT_SILENCE_S: f64 = 0.6;

/// The description of a scene.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// The settings; only the arm, its table and the section `simulated` are used.
    robot: PathBuf,
    /// Seeds everything random about the arm, overriding the settings.
    seed: u64,
    /// Particles along the sides of the cloth, and their spacing, metres.
    cloth: (u32, u32, f64),
    /// The faults and their times.
    #[serde(default)]
    faults: Vec<Fault>,
    /// The socket for tests.
    pub control: PathBuf,
}

/// An arm over a table.
pub struct Scene {
    arm: Faulty,
    camera: TableCamera,
    table: Rc<RefCell<ClothTable>>,
    settings: Settings,
    start: Start,
    /// Message faults and their start times.
    messages: Vec<Fault>,
    /// How many more goals will be lost.
    goals_to_lose: u32,
    is_laid: bool,
}

impl Scene {
    /// Sets up the scene with an empty table; fails with the reason.
    pub fn new(plan: &Plan) -> Result<Scene, String> {
        let settings = Settings::load(&plan.robot).map_err(|error| error.to_string())?;
        let table = ClothTable::new(&settings, &base_from_world(&settings), None);
        let table = Rc::new(RefCell::new(table.map_err(|error| error.to_string())?));
        let (messages, faults) = plan
            .faults
            .iter()
            .partition(|fault| is_of_messages(fault.kind));
        let (dimx, dimy, spacing_m) = plan.cloth;
        Ok(Scene {
            arm: Faulty::new(&settings, plan.seed, Some(table.clone()), faults)?,
            camera: TableCamera(table.clone()),
            table,
            settings,
            start: Start::flat(&Cloth {
                dimx,
                dimy,
                spacing_m,
                start: ClothStart::Flat,
                material: None,
            }),
            messages,
            goals_to_lose: 0,
            is_laid: false,
        })
    }

    /// Returns since when a message fault has been active.
    fn due(&self, kind: FaultKind) -> Option<f64> {
        let now_s = self.arm.now_s();
        let mut due = self.messages.iter();
        let fault = due.find(|fault| fault.kind == kind && fault.from_s <= now_s);
        fault.map(|fault| fault.from_s)
    }

    fn take(&mut self, kind: FaultKind) -> bool {
        let is_due = self.due(kind).is_some();
        if is_due {
            self.messages.retain(|fault| fault.kind != kind);
        }
        is_due
    }
}

fn is_of_messages(kind: FaultKind) -> bool {
    use FaultKind::{LostCancel, LostGoal, LostGoals, LostResult, LostStop, ShortSilence, Silence};
    let of_messages = [
        LostGoal,
        LostGoals,
        LostResult,
        LostCancel,
        LostStop,
        Silence,
        ShortSilence,
    ];
    of_messages.contains(&kind)
}

impl Stage for Scene {
    fn loses(&mut self, message: &str) -> bool {
        match message {
            "goal" => {
                if self.take(FaultKind::LostGoals) {
                    self.goals_to_lose = 3;
                }
                let is_one_of_many = self.goals_to_lose > 0;
                self.goals_to_lose = self.goals_to_lose.saturating_sub(1);
                is_one_of_many || self.take(FaultKind::LostGoal)
            }
            "result" => self.take(FaultKind::LostResult),
            "cancel" => self.take(FaultKind::LostCancel),
            "stop" => self.take(FaultKind::LostStop),
            "reading" => {
                let now_s = self.arm.now_s();
                let is_short = |since_s: f64| now_s < since_s + SHORT_SILENCE_S;
                self.due(FaultKind::Silence).is_some()
                    || self.due(FaultKind::ShortSilence).is_some_and(is_short)
            }
            _ => false,
        }
    }

    fn fail(&mut self, kind: FaultKind) -> Result<(), String> {
        match is_of_messages(kind) {
            true => self.messages.push(Fault {
                kind,
                from_s: self.arm.now_s(),
            }),
            false => self.arm.fail(kind),
        }
        Ok(())
    }

    fn lay(&mut self) -> Result<(), String> {
        let laid = self.table.borrow_mut().lay(&self.start);
        laid.map_err(|error| error.to_string())?;
        self.is_laid = true;
        Ok(())
    }

    fn truth(&self) -> Value {
        json!({
            "clock_s": self.arm.now_s(),
            "tool_m": self.arm.tool().translation.vector.as_slice(),
            "extent_m": self.arm.extent_m(),
            "is_stopped": self.arm.is_stopped(),
            "moved_after_stop_m": self.arm.moved_after_stop_m(),
            "particles_m": self.table.borrow().particles(),
        })
    }

    fn pixel(&self, point_m: [f64; 3]) -> Option<[f64; 2]> {
        let world_from_base = base_from_world(&self.settings).inverse();
        let camera = &self.settings.simulated;
        let lens = camera.intrinsics();
        let at = camera.world_from_camera().inverse() * world_from_base * Point3::from(point_m);
        let scale = lens.focal_px[0] / (camera.camera_height_m - at.z);
        let [column, row] = lens.middle_px;
        Some([column + scale * at.x, row - scale * at.y])
    }
}

impl RgbdSource for Scene {
    fn name(&self) -> String {
        self.camera.name()
    }

    fn shoot(&mut self) -> Result<Shot, String> {
        if self.arm.has_lost_camera() {
            return Err("nothing comes from it any more".to_owned());
        }
        if self.is_laid {
            return self.camera.shoot();
        }
        let bare = self.table.borrow().bare_shot();
        bare.map_err(|error| error.to_string())
    }
}

impl Port for Scene {
    fn now_s(&self) -> f64 {
        self.arm.now_s()
    }

    fn wait(&mut self, seconds: f64) {
        self.arm.wait(seconds);
    }

    fn send_trajectory(&mut self, points: &[Waypoint]) -> Result<GoalId, PortError> {
        self.arm.send_trajectory(points)
    }

    fn send_pose(&mut self, tool: &Isometry3<f64>) -> Result<GoalId, PortError> {
        self.arm.send_pose(tool)
    }

    fn send_fingers(&mut self, positions: &[f64]) -> Result<GoalId, PortError> {
        self.arm.send_fingers(positions)
    }

    fn goal(&mut self, goal: &GoalId) -> GoalState {
        self.arm.goal(goal)
    }

    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError> {
        self.arm.cancel(goal)
    }

    fn stop(&mut self) -> Result<(), PortError> {
        self.arm.stop()
    }

    fn start(&mut self) -> Result<(), PortError> {
        self.arm.start()
    }

    fn state(&mut self) -> Readings {
        self.arm.state()
    }
}
