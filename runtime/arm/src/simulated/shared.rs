//! A simulated arm that a driver moves while a test inspects it.

use super::SimulatedArm;
use crate::port::{Goal, GoalId, GoalState, Port, PortError, Readings};
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

    fn send(&mut self, goal: &Goal) -> Result<GoalId, PortError> {
        self.arm().send(goal)
    }

    fn state(&mut self, goal: &GoalId) -> GoalState {
        self.arm().state(goal)
    }

    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError> {
        self.arm().cancel(goal)
    }

    fn stop(&mut self) -> Result<(), PortError> {
        self.arm().stop()
    }

    fn start(&mut self) -> Result<(), PortError> {
        self.arm().start()
    }

    fn readings(&mut self) -> Readings {
        self.arm().readings()
    }
}
