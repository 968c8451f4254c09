//! A simulated arm's world with injected faults.
//!
//! In: the parts of a world, and faults. Out: a world like any other, and a handle to its arm for inspection
//! afterwards.

use super::{ArmWorld, Parts, base_from_world, motion};
use crate::driver::{Commands, PortArm};
use crate::settings::DriverKind;
use crate::simulated::{Fault, SharedArm, SimulatedArm, Simulation};
use crate::table::{ClothTable, TableCamera};
use fab_world::WorldError;
use std::cell::RefCell;
use std::rc::Rc;

/// A simulated world, and a handle to its arm.
pub struct Rehearsal {
    /// The world.
    pub world: ArmWorld,
    /// The arm in it.
    pub arm: SharedArm,
}

impl ArmWorld {
    /// Sets up the arm and the table that this program simulates.
    pub fn simulated(parts: Parts) -> Result<ArmWorld, WorldError> {
        ArmWorld::rehearsed(parts, Vec::new()).map(|rehearsal| rehearsal.world)
    }

    /// Sets them up with injected faults.
    ///
    /// - `faults`: their times are on the arm's clock, which starts at 0 and advances only while the arm works.
    pub fn rehearsed(parts: Parts, faults: Vec<Fault>) -> Result<Rehearsal, WorldError> {
        let settings = &parts.settings;
        if settings.driver != DriverKind::Simulated {
            return Err(motion(
                "its settings name another driver than `simulated`".to_owned(),
            ));
        }
        let base_from_world = base_from_world(settings);
        let table = Rc::new(RefCell::new(
            ClothTable::new(settings, &base_from_world)?.with_material(parts.material.as_ref()),
        ));
        let simulation = Simulation {
            faults,
            ..Simulation::of(settings).map_err(motion)?
        };
        let arm = SharedArm::new(SimulatedArm::new(simulation, Some(table.clone())));
        let (fingers, tolerance) = (settings.fingers, settings.tolerance);
        let commands = Commands::PosesAt(settings.motion.speed_m_s);
        let driver = PortArm::new(Box::new(arm.clone()), commands, fingers, tolerance);
        let camera = TableCamera(table.clone());
        let mut world = ArmWorld::new(parts, Box::new(driver), Box::new(camera))?;
        world.table = Some(table);
        Ok(Rehearsal { world, arm })
    }
}
