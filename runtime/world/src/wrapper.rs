//! A world that wraps another one and changes part of it.
//!
//! In: the inner world and the overridden methods. Out: a [`World`]; everything not overridden is delegated to the
//! inner world.

use super::{Executed, Motion, World, WorldError, WorldPoint};
use crate::start::Start;
use crate::vary::AxisValues;
use fab_base::interrupt::Interrupt;
use fab_picture::observation::Observation;

/// A wrapper around another world; methods that are not overridden are delegated to it.
pub trait Wrapper {
    /// Returns the inner world.
    fn inner(&self) -> &dyn World;

    /// Returns the inner world for changes.
    fn inner_mut(&mut self) -> &mut dyn World;

    /// As [`World::name`].
    fn name(&self) -> &str {
        self.inner().name()
    }

    /// As [`World::is_simulated`].
    fn is_simulated(&self) -> bool {
        self.inner().is_simulated()
    }

    /// As [`World::act`].
    fn act(&mut self, motion: &Motion, interrupt: &Interrupt) -> Result<Executed, WorldError> {
        self.inner_mut().act(motion, interrupt)
    }

    /// As [`World::particles`].
    fn particles(&self) -> Option<Vec<[f32; 3]>> {
        self.inner().particles()
    }

    /// As [`World::flat_cloth`].
    fn flat_cloth(&self) -> Option<Observation> {
        self.inner().flat_cloth()
    }

    /// As [`World::out_of_reach`].
    fn out_of_reach(&self, point: &WorldPoint) -> Option<String> {
        self.inner().out_of_reach(point)
    }

    /// As [`World::refuses`].
    fn refuses(&self, motion: &Motion) -> Option<String> {
        self.inner().refuses(motion)
    }
}

impl<W: Wrapper> World for W {
    fn name(&self) -> &str {
        Wrapper::name(self)
    }

    fn parameters(&self) -> String {
        self.inner().parameters()
    }

    fn code(&self) -> String {
        self.inner().code()
    }

    fn variation(&self) -> AxisValues {
        self.inner().variation()
    }

    fn repeats(&self) -> bool {
        self.inner().repeats()
    }

    fn is_simulated(&self) -> bool {
        Wrapper::is_simulated(self)
    }

    fn grippers(&self) -> usize {
        self.inner().grippers()
    }

    fn reset(&mut self, start: &Start) -> Result<(), WorldError> {
        self.inner_mut().reset(start)
    }

    fn observe(&mut self) -> Result<Observation, WorldError> {
        self.inner_mut().observe()
    }

    fn act(&mut self, motion: &Motion, interrupt: &Interrupt) -> Result<Executed, WorldError> {
        Wrapper::act(self, motion, interrupt)
    }

    fn crumple(
        &self,
        start: &Start,
        seed: u64,
        interrupt: &Interrupt,
    ) -> Result<Start, WorldError> {
        self.inner().crumple(start, seed, interrupt)
    }

    fn particles(&self) -> Option<Vec<[f32; 3]>> {
        Wrapper::particles(self)
    }

    fn crossings(&self) -> Option<usize> {
        self.inner().crossings()
    }

    fn flat_cloth(&self) -> Option<Observation> {
        Wrapper::flat_cloth(self)
    }

    fn out_of_reach(&self, point: &WorldPoint) -> Option<String> {
        Wrapper::out_of_reach(self, point)
    }

    fn refuses(&self, motion: &Motion) -> Option<String> {
        Wrapper::refuses(self, motion)
    }
}
