//! The arm and the table that this program simulates, as a world like any other.

use super::{ArmWorld, Parts, base_from_world, motion};
use crate::driver::{Commands, PortArm};
use crate::port::Port;
use crate::rgbd::RgbdSource;
use crate::settings::DriverKind;
use crate::simulated::SimulatedArm;
use crate::table::{ClothTable, TableCamera};
use fab_world::WorldError;
use std::cell::RefCell;
use std::rc::Rc;

impl ArmWorld {
    /// Sets up the simulated arm and table.
    pub fn simulated(parts: Parts) -> Result<ArmWorld, WorldError> {
        ArmWorld::simulated_behind(parts, |arm, camera| (Box::new(arm), Box::new(camera)))
    }

    /// Sets them up with something between them and the driver, such as faults in a test.
    pub fn simulated_behind(
        parts: Parts,
        between: impl FnOnce(SimulatedArm, TableCamera) -> (Box<dyn Port>, Box<dyn RgbdSource>),
    ) -> Result<ArmWorld, WorldError> {
        let table = table(&parts)?;
        let settings = &parts.files.settings;
        if settings.driver != DriverKind::Simulated {
            return Err(motion(
                "its settings name another driver than `simulated`".to_owned(),
            ));
        }
        let arm = SimulatedArm::new(settings, Some(table.clone())).map_err(motion)?;
        let (port, camera) = between(arm, TableCamera(table.clone()));
        let (fingers, tolerance) = (settings.fingers, settings.tolerance);
        let driver = PortArm::new(port, Commands::Trajectories, fingers, tolerance);
        let mut world = ArmWorld::new(parts, driver, camera)?;
        world.table = Some(table);
        Ok(world)
    }
}

/// Sets up the table without a cloth.
pub(super) fn table(parts: &Parts) -> Result<Rc<RefCell<ClothTable>>, WorldError> {
    let settings = &parts.files.settings;
    let table = ClothTable::new(
        settings,
        &base_from_world(settings),
        parts.material.as_ref(),
    )?;
    Ok(Rc::new(RefCell::new(table)))
}
