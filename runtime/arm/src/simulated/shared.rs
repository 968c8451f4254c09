//! A simulated arm that a driver moves while a test inspects it.

use super::SimulatedArm;
use crate::port::{AfterStop, GoalId, GoalState, Port, PortError, Readings, Waypoint};
use nalgebra::Isometry3;
use std::cell::{RefCell, RefMut};
use std::rc::Rc;

/// A shared handle to a simulated arm; clones refer to the same arm.
#[derive(Clone)]
pub struct SharedArm(Rc<RefCell<SimulatedArm>>);

impl SharedArm {
    /// Shares an arm.
    pub fn new(arm: SimulatedArm) -> SharedArm {
        SharedArm(Rc::new(RefCell::new(arm)))
    }

    /// Borrows the arm for inspection; panics if an earlier borrow is still alive.
    pub fn arm(&self) -> RefMut<'_, SimulatedArm> {
        self.0.borrow_mut()
    }
}

impl Port for SharedArm {
    fn now_s(&self) -> f64 {
        self.0.borrow().now_s()
    }

    fn wait(&mut self, seconds: f64) {
        self.arm().wait(seconds);
    }

    fn send_trajectory(&mut self, points: &[Waypoint]) -> Result<GoalId, PortError> {
        self.arm().send_trajectory(points)
    }

    fn send_pose(&mut self, tool: &Isometry3<f64>) -> Result<GoalId, PortError> {
        self.arm().send_pose(tool)
    }

    fn send_fingers(&mut self, positions: &[f64]) -> Result<GoalId, PortError> {
        self.arm().send_fingers(positions)
    }

    fn goal(&mut self, goal: &GoalId) -> GoalState {
        self.arm().goal(goal)
    }

    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError> {
        self.arm().cancel(goal)
    }

    fn stop(&mut self) -> Result<(), PortError> {
        self.arm().stop()
    }

    fn after_stop(&self) -> AfterStop {
        self.0.borrow().after_stop()
    }

    fn start(&mut self) -> Result<(), PortError> {
        self.arm().start()
    }

    fn state(&mut self) -> Readings {
        self.arm().state()
    }
}
