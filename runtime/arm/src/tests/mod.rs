//! Tests of the driver, the limits and the execution of a pick and place, over a simulated arm with faults.

#![allow(clippy::unwrap_used)]

mod drivers;
mod executions;
mod fault;
mod faults;
#[allow(dead_code, reason = "tests of other packages use the rest")]
mod faulty;
mod journals;
mod judged;
mod kinova;
mod limited;
mod pauses;
mod simulations;
mod timed;
mod trajectories;

use super::driver::{ArmError, ArmState, Commands, Halt, PortArm, Watch};
use super::execute::{CompletedAction, Execution, FailedAction};
use super::guard::{Guard, Surface};
use super::journal::Journal;
use super::kinematics::chain::Chain;
use super::limits::Limited;
use super::plan::Plan;
use super::port::{GoalId, GoalState, Port, PortError, Readings, Waypoint};
use super::route::Route;
use super::settings::Settings;
use super::simulated::{SimulatedArm, SimulatedTable};
use super::supervisor::{Supervisor, Watchdog};
use crate as arm;
use fab_base::interrupt::Interrupt;
use fab_program::Manner;
use fault::FaultKind;
use faulty::{Fault, Faulty};
use nalgebra::{Isometry3, Point3, Vector3};
use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

const ROBOT: &str = "
name = 'lab'
model = 'j2n6s200'
driver = 'simulated'
calibration = 'lab.calibration.toml'
table = { center_m = [0.45, 0.0, 0.02] }
workspace = { min_m = [0.15, -0.525, 0.01], max_m = [0.75, 0.525, 0.45], rest_m = [0.35, -0.35, 0.25] }
fingers = { count = 2, open = 0.0, closed = 6400.0, cloth = 200.0, tolerance = 100.0 }
camera = { source = 'simulated', window_px = [0, 0, 720] }
";

const PICK_M: [f64; 3] = [0.40, 0.05, 0.02];
const PLACE_M: [f64; 3] = [0.50, -0.06, 0.02];

/// The speed at which tests move, m/s.
const SPEED_M_S: f64 = 0.1;

fn guard(settings: &Settings) -> Guard {
    Guard::level(settings)
}

fn settings() -> Settings {
    Settings::parse(ROBOT).unwrap()
}

/// A small piece of cloth that follows closed fingers.
struct Patch {
    at: Point3<f64>,
    is_grasped: bool,
}

impl SimulatedTable for Patch {
    fn advance(&mut self, _: f64, tool: &Isometry3<f64>, are_closed: bool) {
        self.is_grasped = are_closed && (self.is_grasped || self.is_cloth_between_fingers(tool));
        if self.is_grasped {
            self.at = Point3::from(tool.translation.vector);
        }
    }

    fn is_cloth_between_fingers(&self, tool: &Isometry3<f64>) -> bool {
        (self.at.coords - tool.translation.vector).norm() < 0.02
    }
}

type Driven = PortArm<Faulty>;

/// The kind of commands that a driver sends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    Poses,
    Trajectories,
}

impl By {
    const BOTH: [By; 2] = [By::Poses, By::Trajectories];

    fn drive<P: Port>(self, port: P, settings: &Settings) -> PortArm<P> {
        let commands = match self {
            By::Poses => Commands::Poses,
            By::Trajectories => Commands::Trajectories,
        };
        PortArm::new(
            Box::new(port),
            commands,
            settings.fingers,
            settings.tolerance,
        )
    }
}

fn faulty(
    settings: &Settings,
    seed: u64,
    faults: &[(FaultKind, f64)],
    table: Option<Rc<RefCell<dyn SimulatedTable>>>,
) -> Faulty {
    let faults = faults.iter().map(|&(kind, from_s)| Fault { kind, from_s });
    Faulty::new(settings, seed, table, faults.collect()).unwrap()
}

/// An arm above a patch of cloth, at rest, with all its surroundings.
struct Bench {
    settings: Settings,
    arm: Limited<Faulty>,
    cloth: Rc<RefCell<Patch>>,
    folder: tempfile::TempDir,
    interrupt: Interrupt,
    manner: Manner,
}

impl Bench {
    /// - `seed`: determines where within its repeatability the arm comes to rest.
    fn of(by: By, seed: u64, faults: &[(FaultKind, f64)]) -> Bench {
        let settings = settings();
        let cloth = Rc::new(RefCell::new(Patch {
            at: Point3::from(PICK_M),
            is_grasped: false,
        }));
        let port = faulty(&settings, seed, faults, Some(cloth.clone()));
        let arm = by.drive(port, &settings);
        Bench {
            arm: Limited::new(arm, guard(&settings)),
            settings,
            cloth,
            folder: tempfile::tempdir().unwrap(),
            interrupt: Interrupt::default(),
            manner: Manner::default(),
        }
    }

    fn with(faults: &[(FaultKind, f64)]) -> Bench {
        Bench::driven(By::Poses, faults)
    }

    fn driven(by: By, faults: &[(FaultKind, f64)]) -> Bench {
        Bench::of(by, 0, faults)
    }

    fn take_cloth_away(&self) {
        self.cloth.borrow_mut().at = Point3::new(0.6, 0.3, 0.02);
    }

    fn port(&mut self) -> &mut Faulty {
        self.arm.arm().port()
    }

    fn driver(&mut self) -> &mut Driven {
        self.arm.arm()
    }

    fn folder(&self) -> &Path {
        self.folder.path()
    }

    fn route(&mut self) -> Route {
        let here = self.driver().state().unwrap();
        let points = [PICK_M, PLACE_M].map(Point3::from);
        let guard = guard(&self.settings);
        let (plan, route) = Plan::make(&self.settings, &guard, &here, points, &self.manner);
        route.unwrap_or_else(|| panic!("{:?}", plan.refused))
    }

    /// Executes a pick and place.
    fn run(
        &mut self,
        supervisor: &mut dyn Supervisor,
        watchdog: &mut dyn Watchdog,
    ) -> Result<CompletedAction, FailedAction> {
        let log = &mut Journal::open(self.folder()).unwrap();
        let route = self.route();
        let execution = &mut Execution {
            arm: &mut self.arm,
            log,
            supervisor,
            watchdog,
            interrupt: &self.interrupt,
            number: 1,
        };
        execution.run([PICK_M.into(), PLACE_M.into()], &route)
    }

    /// Lets time pass, and fails if a stopped arm moves or is enabled.
    #[track_caller]
    fn stays_stopped(&mut self) {
        let port = self.port();
        assert!(port.is_stopped(), "the arm is not stopped");
        port.wait(5.0);
        assert!(port.is_stopped(), "the arm was let go");
        assert!(port.moved_after_stop_m().unwrap() < 1e-9);
    }

    /// Returns the tool's distance from a place, metres.
    fn off_m(&mut self, place_m: [f64; 3]) -> f64 {
        let at = self.port().tool().translation.vector;
        (at - Point3::from(place_m).coords).norm()
    }
}

/// An arm whose joint readings stop at a given time or are off by an angle, and which records when it moved and when a
/// goal was cancelled; or one without the vendor's servers.
struct Tapped {
    arm: Faulty,
    deaf_s: f64,
    off_rad: f64,
    cancelled_s: Option<f64>,
    /// When the tool first and last moved, by steps of the simulated clock.
    moved_s: Option<[f64; 2]>,
    /// Whether it takes trajectories alone, and its stop is their cancellation.
    is_generic: bool,
    last: Option<GoalId>,
}

impl Tapped {
    fn deaf(arm: Faulty, deaf_s: f64) -> Tapped {
        Tapped {
            arm,
            deaf_s,
            off_rad: 0.0,
            cancelled_s: None,
            moved_s: None,
            is_generic: false,
            last: None,
        }
    }

    /// An arm that takes trajectories alone, and whose stop is their cancellation.
    fn generic(arm: Faulty) -> Tapped {
        Tapped {
            is_generic: true,
            ..Tapped::deaf(arm, f64::INFINITY)
        }
    }
}

impl Port for Tapped {
    fn now_s(&self) -> f64 {
        self.arm.now_s()
    }
    fn wait(&mut self, seconds: f64) {
        for _ in 0..((seconds / 0.01).round() as usize).max(1) {
            let (before, at_s) = (self.arm.tool(), self.arm.now_s());
            self.arm.wait(0.01);
            if self.arm.tool() != before {
                let now_s = self.arm.now_s();
                self.moved_s = Some([self.moved_s.map_or(at_s, |[first_s, _]| first_s), now_s]);
            }
        }
    }
    fn send_trajectory(&mut self, points: &[Waypoint]) -> Result<GoalId, PortError> {
        let sent = self.arm.send_trajectory(points);
        self.last = sent.clone().ok();
        sent
    }
    fn send_pose(&mut self, tool: &Isometry3<f64>) -> Result<GoalId, PortError> {
        assert!(!self.is_generic, "it takes no poses");
        self.arm.send_pose(tool)
    }
    fn send_fingers(&mut self, positions: &[f64]) -> Result<GoalId, PortError> {
        self.arm.send_fingers(positions)
    }
    fn goal(&mut self, goal: &GoalId) -> GoalState {
        self.arm.goal(goal)
    }
    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError> {
        self.cancelled_s.get_or_insert(self.arm.now_s());
        self.arm.cancel(goal)
    }
    fn stop(&mut self) -> Result<(), PortError> {
        if !self.is_generic {
            return self.arm.stop();
        }
        let Some(id) = self.last.clone() else {
            return Ok(());
        };
        self.arm.cancel(&id)?;
        self.arm.wait(0.2);
        match self.arm.goal(&id) {
            GoalState::Ended(_) => Ok(()),
            _ => Err(PortError {
                what: "the cancellation of every goal".to_owned(),
                why: "no answer".to_owned(),
            }),
        }
    }
    fn probe(&mut self) -> Result<Option<GoalId>, PortError> {
        if self.is_generic {
            return Ok(None);
        }
        self.arm.probe()
    }
    fn moved_until_s(&mut self, rest: Option<&Vector3<f64>>) -> Option<f64> {
        if self.is_generic {
            return Some(f64::INFINITY);
        }
        self.arm.moved_until_s(rest)
    }
    fn start(&mut self) -> Result<(), PortError> {
        self.arm.start()
    }
    fn state(&mut self) -> Readings {
        let mut readings = self.arm.state();
        let deaf_s = self.deaf_s;
        readings.joints_rad = readings.joints_rad.filter(|heard| heard.at_s <= deaf_s);
        if let Some(heard) = &mut readings.joints_rad {
            heard.value[0] += self.off_rad;
        }
        readings
    }
}

impl Waypoint {
    /// Returns the angles at a time between this point and a later one, radians, as controllers interpolate: with the
    /// angles, speeds and accelerations of both.
    ///
    /// - `at_s`: seconds since the start of the trajectory.
    pub fn towards(&self, next: &Waypoint, at_s: f64) -> Vec<f64> {
        let whole_s = next.at_s - self.at_s;
        let part = (at_s - self.at_s) / whole_s;
        let ends = |point: &Waypoint, joint: usize| {
            let or_still = |values: &[f64]| values.get(joint).copied().unwrap_or_default();
            [
                or_still(&point.speeds_rad_s) * whole_s,
                or_still(&point.accelerations_rad_s2) * whole_s * whole_s,
            ]
        };
        let angles = self.joints_rad.iter().zip(&next.joints_rad).enumerate();
        let angles = angles.map(|(joint, (from, to))| {
            let ([speed, bend], [end_speed, end_bend]) = (ends(self, joint), ends(next, joint));
            let way = to - from;
            let third = 10.0 * way - 6.0 * speed - 4.0 * end_speed - 1.5 * bend + 0.5 * end_bend;
            let fourth = -15.0 * way + 8.0 * speed + 7.0 * end_speed + 1.5 * bend - end_bend;
            let fifth = 6.0 * way - 3.0 * (speed + end_speed) - 0.5 * (bend - end_bend);
            let curved = bend / 2.0 + part * (third + part * (fourth + part * fifth));
            from + part * (speed + part * curved)
        });
        angles.collect()
    }
}

/// Checks a motion from where the arm is, and makes it.
fn go_to<P: Port>(
    arm: &mut PortArm<P>,
    settings: &Settings,
    to: &Isometry3<f64>,
    speed_m_s: f64,
    watch: &mut Watch<'_>,
) -> Result<ArmState, ArmError> {
    arm.ready(watch)?;
    let from = arm.state()?;
    let motion = guard(settings).motion(&from, to, speed_m_s);
    arm.move_tool(&motion.map_err(ArmError::Refused)?, watch)
}

/// Permits every motion.
fn nobody(_: &ArmState) -> Result<(), Halt> {
    Ok(())
}

/// Returns why a motion failed.
#[track_caller]
fn failure<T: std::fmt::Debug>(moved: Result<T, ArmError>) -> String {
    match moved {
        Err(ArmError::Failed(why)) => why,
        other => panic!("it should have failed: {other:?}"),
    }
}
