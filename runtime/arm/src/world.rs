//! An arm over a table as a [`World`]: a real arm behind its driver, or a simulated one.
//!
//! In: motions in the world frame, whose origin is the middle of the table in the settings. Out: pictures as the task's
//! camera takes them, and the verified result of each motion. A rollout cannot be repeated, and particle positions are
//! known only on a simulated table.

mod parts;
mod picture;
mod planning;
mod reach;
mod simulated;

pub use parts::{Files, Parts, base_from_world, guard};
pub use picture::simulated_table;
pub use planning::{PLAN_FILE, PLAN_PICTURE, read_plan};
pub use reach::WithinReach;

use crate::driver::{ArmError, ArmState, Deviation, HandContents, PortArm};
use crate::execute::{Execution, FailedAction};
use crate::journal::Journal;
use crate::kinematics::tool_down::tool_down;
use crate::limits::Limited;
use crate::plan::Plan;
use crate::port::Port;
use crate::rgbd::{RgbdSource, Shot};
use crate::route::Route;
use crate::table::ClothTable;
use fab_base::interrupt::Interrupt;
use fab_picture::observation::Observation;
use fab_world::start::Start;
use fab_world::{Executed, ExecutedGrip, Grasp, Grip, Motion, World, WorldError, WorldPoint};
use nalgebra::{Isometry3, Point3};
use reach::{ArmReach, base_point};
use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;

/// How far from `rest_m` the tool may be when a picture is taken, metres.
const AT_REST_M: f64 = 0.02;

/// How far the hand may be rotated then, radians: 10 degrees.
const TURNED_AT_REST_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// What becomes of an action.
enum Acts {
    /// It is executed.
    Execute,
    /// It is planned, and the plan is written into this folder.
    PlanIn(Option<PathBuf>),
}

/// An arm over a table.
pub struct ArmWorld {
    parts: Parts,
    base_from_world: Isometry3<f64>,
    arm: Limited<dyn Port>,
    camera: Box<dyn RgbdSource>,
    /// The simulated table, if there is one.
    table: Option<Rc<RefCell<ClothTable>>>,
    reach: ArmReach,
    log: Option<Journal>,
    acts: Acts,
    is_laid: bool,
    is_camera_checked: bool,
    /// The last full picture of the camera.
    last_shot: Option<Shot>,
    n_actions: u32,
    begun_s: f64,
}

impl ArmWorld {
    /// Wraps an arm in limits, over a table that a camera sees.
    pub fn new(
        parts: Parts,
        arm: PortArm<dyn Port>,
        camera: Box<dyn RgbdSource>,
    ) -> Result<ArmWorld, WorldError> {
        let Files {
            settings,
            calibration,
            ..
        } = &parts.files;
        calibration
            .over_table(settings)
            .map_err(|why| motion(format!("the calibration does not fit the settings: {why}")))?;
        let guard = guard(settings, calibration);
        let log = parts.folder.as_deref().map(Journal::open).transpose();
        Ok(ArmWorld {
            base_from_world: base_from_world(settings),
            arm: Limited::new(arm, guard.clone()),
            camera,
            table: None,
            reach: ArmReach::new(settings, guard),
            log: log.map_err(|error| motion(error.to_string()))?,
            acts: Acts::Execute,
            is_laid: false,
            is_camera_checked: false,
            last_shot: None,
            n_actions: 0,
            begun_s: 0.0,
            parts,
        })
    }

    /// Plans a grip from where the arm is; the route is there if all of it is possible.
    fn plan(&self, from: &ArmState, asked: &Grip) -> (Plan, Option<Route>) {
        let (settings, guard) = (&self.parts.files.settings, &self.reach.guard);
        let points = [&asked.pick, &asked.place];
        let points = points.map(|point| base_point(settings, guard.surface(), point));
        Plan::make(settings, guard, from, points, &asked.manner)
    }

    /// Checks that the camera is where it was calibrated. A simulated camera that was calibrated without a picture
    /// cannot move.
    fn check_camera(&mut self, shot: &Shot) -> Result<(), WorldError> {
        let is_fixed = self.table.is_some() && self.parts.files.calibration.reference.is_none();
        if self.is_camera_checked || is_fixed {
            return Ok(());
        }
        let Parts { files, sight, .. } = &self.parts;
        let checked = files.calibration.check_camera(&shot.rgb, sight);
        checked.map_err(|why| WorldError::Camera { why })?;
        self.is_camera_checked = true;
        Ok(())
    }
}

impl World for ArmWorld {
    fn name(&self) -> &str {
        &self.parts.files.about.name
    }

    fn parameters(&self) -> String {
        let Parts {
            files, material, ..
        } = &self.parts;
        fab_world::parameters_with(files.about.parameters.clone(), material.as_ref())
    }

    fn code(&self) -> String {
        self.parts.files.about.code.clone()
    }

    fn reset(&mut self, start: &Start) -> Result<(), WorldError> {
        let state = self.arm.arm().state();
        let tool = state.map_err(|error| motion(error.to_string()))?.tool;
        let settings = &self.parts.files.settings;
        let rest = tool_down(
            &settings.workspace.rest_m.into(),
            settings.motion.hand_turn_deg.to_radians(),
        );
        let off = Deviation::between(&tool, &rest);
        // NaN must fail this check.
        let is_at_rest = off.position_m <= AT_REST_M && off.angle_rad <= TURNED_AT_REST_RAD;
        if !is_at_rest {
            return Err(motion(format!(
                "the tool is {off} away from the hand straight down at `motion.hand_turn_deg`, and not at `rest_m`, so that the \
                 arm may hide the cloth; bring it there by hand"
            )));
        }
        match &self.table {
            Some(table) => table.borrow_mut().lay(start)?,
            None if self.parts.supervisor.confirm_cloth(start) => {}
            None => {
                return Err(WorldError::Start {
                    start: start.name.clone(),
                    why: "nobody confirmed that the cloth lies on the table".to_owned(),
                });
            }
        }
        self.is_laid = true;
        self.is_camera_checked = false;
        self.begun_s = self.arm.arm().now_s();
        Ok(())
    }

    fn observe(&mut self) -> Result<Observation, WorldError> {
        if !self.is_laid {
            return Err(WorldError::NotReset);
        }
        let shot = self.camera.shoot().map_err(|why| WorldError::Camera {
            why: format!("the camera `{}` gave no picture: {why}", self.camera.name()),
        })?;
        self.check_camera(&shot)?;
        let time_s = self.arm.arm().now_s() - self.begun_s;
        let seen = picture::square(&self.parts, &shot, time_s);
        self.last_shot = Some(shot);
        seen
    }

    fn act(
        &mut self,
        motion_asked: &Motion,
        interrupt: &Interrupt,
    ) -> Result<Executed, WorldError> {
        if !self.is_laid {
            return Err(WorldError::NotReset);
        }
        let asked = motion_asked.only(self.name())?;
        if let Some(why) = self.refuses(motion_asked) {
            return Err(motion(why));
        }
        let from = self.arm.arm().state();
        let from = from.map_err(|error| motion(error.to_string()))?;
        let (plan, route) = self.plan(&from, &asked);
        if let Acts::PlanIn(folder) = &self.acts {
            self.save_plan(folder.as_deref(), &plan)?;
            return Err(plan.refusal().map_or(WorldError::PlannedOnly, motion));
        }
        let Some(route) = route else {
            return Err(motion(plan.refusal().unwrap_or_default()));
        };
        self.n_actions += 1;
        let Some(log) = &mut self.log else {
            return Err(motion(
                "the arm has no run folder for its journal, and moves only with one".to_owned(),
            ));
        };
        let done = Execution {
            arm: &mut self.arm,
            log,
            supervisor: self.parts.supervisor.as_mut(),
            watchdog: self.parts.watchdog.as_mut(),
            interrupt,
            number: self.n_actions,
        }
        .run([plan.pick_m, plan.place_m].map(Point3::from), &route);
        let done = done.map_err(world_error)?;
        let world_from_base = self.base_from_world.inverse();
        let done_grip = ExecutedGrip {
            grip: Grip {
                pick: world_from_base * done.grasped_at,
                place: world_from_base * done.released_at,
                manner: asked.manner,
            },
            grasp: match done.contents {
                HandContents::Something => Grasp::Held,
                HandContents::Nothing => Grasp::Missed,
                HandContents::Unknown => Grasp::Unverified,
            },
            // It holds cloth, and does not know which particle.
            released_at: None,
        };
        Ok(Executed {
            grips: vec![done_grip],
            duration_s: done.duration_s,
        })
    }

    fn crumple(&self, _: &Start, _: u64, _: &Interrupt) -> Result<Start, WorldError> {
        Err(WorldError::CannotCrumple {
            world: self.name().to_owned(),
        })
    }

    fn particles(&self) -> Option<Vec<[f32; 3]>> {
        self.table.as_ref()?.borrow().particles()
    }

    fn flat_cloth(&self) -> Option<Observation> {
        let shot = match (&self.parts.files.flat, &self.table) {
            (Some(flat), _) => Shot::aligned(flat.clone(), None, None).ok()?,
            (None, Some(table)) => table.borrow().flat_shot()?,
            (None, None) => return None,
        };
        picture::square(&self.parts, &shot, 0.0).ok()
    }

    fn out_of_reach(&self, point: &WorldPoint) -> Option<String> {
        self.reach.out_of_reach(&self.parts.files.settings, point)
    }

    fn refuses(&self, motion: &Motion) -> Option<String> {
        self.reach.refuses(&self.parts.files.settings, motion)
    }
}

fn motion(why: String) -> WorldError {
    WorldError::Motion { why }
}

/// Converts a failed action into the world's error.
fn world_error(failed: FailedAction) -> WorldError {
    let told = failed.to_string();
    match (&failed.why, &failed.stopped) {
        // An unverified stop is a failure, even if a person requested the stop.
        (ArmError::Interrupted | ArmError::NotConfirmed, None | Some(Ok(()))) => {
            match failed.in_segment {
                None if failed.why == ArmError::Interrupted => WorldError::Interrupted,
                _ => WorldError::Halted { told },
            }
        }
        _ => motion(told),
    }
}
