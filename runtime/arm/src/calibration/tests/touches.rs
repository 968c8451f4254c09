//! Tests of an arm guided by a person: the tool's position counts only at rest, with recent readings, and pointing
//! down.

use super::*;
use crate::driver::{Commands, PortArm};
use crate::kinematics::tool_down::tool_down;
use crate::port::{GoalId, GoalState, Port, PortError, Reading, Readings, Waypoint};

const AT_M: [f64; 3] = [0.4, 0.1, 0.02];

/// An arm that only publishes readings: the given pose every 0.1 s, until a given time.
struct Guided<F: Fn(f64) -> Isometry3<f64>> {
    clock_s: f64,
    until_s: f64,
    pose: F,
}

impl<F: Fn(f64) -> Isometry3<f64>> Port for Guided<F> {
    fn now_s(&self) -> f64 {
        self.clock_s
    }

    fn wait(&mut self, seconds: f64) {
        self.clock_s += seconds;
    }

    fn send_trajectory(&mut self, points: &[Waypoint]) -> Result<GoalId, PortError> {
        panic!("the arm is sent {points:?}");
    }

    fn send_pose(&mut self, tool: &Isometry3<f64>) -> Result<GoalId, PortError> {
        panic!("the arm is sent {tool}");
    }

    fn send_fingers(&mut self, positions: &[f64]) -> Result<GoalId, PortError> {
        panic!("the arm is sent {positions:?}");
    }

    fn goal(&mut self, _: &GoalId) -> GoalState {
        unreachable!("no goal was sent")
    }

    fn cancel(&mut self, _: &GoalId) -> Result<(), PortError> {
        unreachable!("no goal was sent")
    }

    fn stop(&mut self) -> Result<(), PortError> {
        panic!("the arm is stopped")
    }

    fn start(&mut self) -> Result<(), PortError> {
        panic!("the arm is started")
    }

    fn state(&mut self) -> Readings {
        let at_s = (self.clock_s * 10.0).floor() / 10.0;
        let at_s = at_s.min(self.until_s);
        Readings {
            tool: (at_s > 0.0).then(|| Reading {
                value: (self.pose)(at_s),
                at_s,
            }),
            joints_rad: Some(Reading {
                value: vec![0.0; 6],
                at_s,
            }),
            fingers: Some(Reading {
                value: vec![0.0; 2],
                at_s,
            }),
        }
    }
}

fn read(
    clock_s: f64,
    until_s: f64,
    pose: impl Fn(f64) -> Isometry3<f64>,
) -> Result<[f64; 3], String> {
    let port = Guided {
        clock_s,
        until_s,
        pose,
    };
    let settings = settings();
    let mut arm = PortArm::new(
        Box::new(port),
        Commands::Trajectories,
        settings.fingers,
        settings.tolerance,
    );
    place_at_rest(&mut arm)
}

fn down(at_m: [f64; 3]) -> Isometry3<f64> {
    tool_down(&at_m.into(), 0.7)
}

/// The hand over the same point, tilted by an angle about some horizontal axis.
fn tilted(angle_deg: f64) -> Isometry3<f64> {
    let axis = nalgebra::Unit::new_normalize(Vector3::new(0.6, -0.8, 0.0));
    let mut pose = down(AT_M);
    pose.rotation =
        nalgebra::UnitQuaternion::from_axis_angle(&axis, angle_deg.to_radians()) * pose.rotation;
    pose
}

/// The hand in motion, at a speed.
fn moving(speed_m_s: f64) -> impl Fn(f64) -> Isometry3<f64> {
    move |at_s| down([AT_M[0] + speed_m_s * at_s, AT_M[1], AT_M[2]])
}

#[test]
fn an_arm_at_rest_gives_its_place() {
    for (name, read) in [
        ("upright", read(5.0, f64::INFINITY, |_| down(AT_M))),
        ("a little tilted", read(5.0, f64::INFINITY, |_| tilted(3.9))),
        // The arm's own noise, a tenth of a millimetre.
        (
            "trembling",
            read(5.0, f64::INFINITY, |at_s| {
                down([AT_M[0] + 1e-4 * (at_s * 70.0).sin(), AT_M[1], AT_M[2]])
            }),
        ),
    ] {
        let place = read.unwrap_or_else(|why| panic!("{name}: {why}"));
        let off_m = (Vector3::from(place) - Vector3::from(AT_M)).norm();
        assert!(off_m < 2e-4, "{name}: {place:?}");
    }
}

#[test]
fn a_place_that_is_none_is_refused_with_its_values() {
    let forever = f64::INFINITY;
    for (read, words) in [
        (
            read(0.0, 0.0, |_| down(AT_M)),
            "the arm has not reported for `0.0` s where its tool is",
        ),
        (
            read(5.0, 3.0, |_| down(AT_M)),
            "the arm has not reported for `2.0` s where its tool is",
        ),
        // The last reading is recent enough when the point is entered, and no other follows.
        (
            read(5.0, 4.8, |_| down(AT_M)),
            "the arm still moves, or reports nothing new",
        ),
        (read(5.0, forever, moving(0.02)), "the arm still moves"),
        (read(5.0, forever, moving(0.002)), "the arm still moves"),
        (
            read(5.0, forever, |_| tilted(4.1)),
            "the hand is tilted by 4.1 degrees",
        ),
        (
            read(5.0, forever, |_| tilted(180.0)),
            "the hand is tilted by 180.0 degrees",
        ),
        (
            read(5.0, forever, |_| down([f64::NAN, 0.0, 0.0])),
            "a tool position that is not finite",
        ),
    ] {
        let why = read.expect_err(words);
        assert!(why.contains(words), "{words}: {why}");
    }
}
