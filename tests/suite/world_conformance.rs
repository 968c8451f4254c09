//! Every [`World`] keeps the promises of `fab_world::conformance`; add a line at the end for each new world.

use super::support;
use fab_arm::supervisor::Unattended;
use fab_arm::world::{Files, WithinReach};
use fab_world::World;
use fab_world::conformance::PROMISES;

/// Fails with the name of the promise that a world breaks.
fn conforms(make: &dyn Fn() -> Box<dyn World>) {
    for promise in PROMISES {
        if let Err(broken) = promise.check(&|| Ok(make())) {
            panic!("{}: {broken}", promise.name);
        }
    }
}

#[test]
#[ignore = "long"]
fn the_simulated_world_conforms() {
    let program = support::small_task();
    conforms(&|| support::world(&program).unwrap());
}

#[test]
#[ignore = "long"]
fn the_simulated_arm_conforms() {
    let program = support::small_task();
    let folder = tempfile::tempdir().unwrap();
    let robot = support::root().join("tasks/real/simulated.toml");
    conforms(&|| {
        let image_px = program.camera.image_px;
        let folder = Some(folder.path());
        Box::new(support::simulated_arm(
            &robot,
            image_px,
            Box::new(Unattended),
            folder,
        ))
    });
}

#[test]
#[ignore = "long"]
fn a_world_within_an_arms_reach_conforms() {
    let program = support::small_task();
    let robot = support::root().join("tasks/real/simulated.toml");
    let Files {
        settings,
        calibration,
        ..
    } = Files::load(&robot).unwrap();
    conforms(&|| {
        let world = support::world(&program).unwrap();
        Box::new(WithinReach::new(world, settings.clone(), &calibration))
    });
}
