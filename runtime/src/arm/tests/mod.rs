//! Tests of the arm's core over a simulated arm: what its driver believes, what its limits let pass, and where a pick and
//! place ends when something goes wrong.

mod drivers;
mod executions;
mod faults;
mod journals;
mod limited;

use super::driver::{Arm, ArmState, Halt, PortArm};
use super::execute::{Broken, Done, Execution, without_cloth};
use super::limits::Limited;
use super::log::ArmLog;
use super::route::{Segment, segments};
use super::settings::Settings;
use super::simulated::{Fault, FaultKind, SimulatedArm, Simulation, Table};
use super::supervisor::{Supervisor, Watchdog};
use crate::interrupt::Interrupt;
use nalgebra::{Isometry3, Point3};
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

fn settings() -> Settings {
    Settings::parse(ROBOT).unwrap()
}

/// A small piece of cloth, which goes where closed fingers take it.
struct Patch {
    at: Point3<f64>,
    is_held: bool,
}

impl Table for Patch {
    fn advance(&mut self, _: f64, tool: &Isometry3<f64>, are_closed: bool) {
        self.is_held = are_closed && (self.is_held || self.is_between(tool));
        if self.is_held {
            self.at = Point3::from(tool.translation.vector);
        }
    }

    fn is_between(&self, tool: &Isometry3<f64>) -> bool {
        (self.at.coords - tool.translation.vector).norm() < 0.02
    }
}

type Driven = PortArm<SimulatedArm>;

/// An arm over a patch of cloth, at rest, with everything around it.
struct Bench {
    settings: Settings,
    arm: Limited<Driven>,
    cloth: Rc<RefCell<Patch>>,
    folder: tempfile::TempDir,
    interrupt: Interrupt,
}

impl Bench {
    /// - `seed`: draws where within its repeatability the arm comes to rest.
    fn of(seed: u64, faults: &[(FaultKind, f64)]) -> Bench {
        let settings = settings();
        let cloth = Rc::new(RefCell::new(Patch {
            at: Point3::from(PICK_M),
            is_held: false,
        }));
        let mut simulation = Simulation::of(&settings).unwrap();
        simulation.seed = seed;
        simulation.faults = faults
            .iter()
            .map(|&(kind, from_s)| Fault { kind, from_s })
            .collect();
        let port = SimulatedArm::new(simulation, Some(cloth.clone()));
        let arm = PortArm::by_poses(port, &settings.model, settings.fingers, settings.tolerance);
        let margin_m = settings.tolerance.position_m;
        Bench {
            arm: Limited::new(arm, settings.workspace.clone(), margin_m),
            settings,
            cloth,
            folder: tempfile::tempdir().unwrap(),
            interrupt: Interrupt::default(),
        }
    }

    fn with(faults: &[(FaultKind, f64)]) -> Bench {
        Bench::of(0, faults)
    }

    fn take_cloth_away(&self) {
        self.cloth.borrow_mut().at = Point3::new(0.6, 0.3, 0.02);
    }

    fn port(&mut self) -> &mut SimulatedArm {
        self.arm.arm().port()
    }

    fn driver(&mut self) -> &mut Driven {
        self.arm.arm()
    }

    fn folder(&self) -> &Path {
        self.folder.path()
    }

    fn segments(&mut self) -> Vec<Segment> {
        let here = self.port().tool();
        segments(&self.settings, &here, &PICK_M.into(), &PLACE_M.into())
    }

    /// Carries a pick and place out.
    fn run(
        &mut self,
        supervisor: &mut dyn Supervisor,
        watchdog: &mut dyn Watchdog,
    ) -> Result<Done, Broken> {
        let segments = self.segments();
        let tail = without_cloth(&segments, &PICK_M.into(), self.settings.motion.retreat_m);
        let mut log = ArmLog::open(self.folder()).unwrap();
        let execution = &mut Execution {
            arm: &mut self.arm,
            log: &mut log,
            supervisor,
            watchdog,
            interrupt: &self.interrupt,
            speed_m_s: SPEED_M_S,
            number: 1,
        };
        execution.run([PICK_M.into(), PLACE_M.into()], &segments, &tail)
    }

    /// Lets time pass, and fails where a stopped arm moves in it or is let go.
    #[track_caller]
    fn stays_stopped(&mut self) {
        let port = self.port();
        assert!(port.is_stopped(), "the arm is not stopped");
        super::port::Port::wait(port, 5.0);
        assert!(port.is_stopped(), "the arm was let go");
        assert!(port.moved_after_stop_m().unwrap() < 1e-9);
    }

    /// Returns how far the tool is from a place, metres.
    fn off_m(&mut self, place_m: [f64; 3]) -> f64 {
        let at = self.port().tool().translation.vector;
        (at - Point3::from(place_m).coords).norm()
    }
}

/// Lets every motion go on.
fn nobody(_: &ArmState) -> Result<(), Halt> {
    Ok(())
}
