//! What every [`World`] must do; a new world adds one line at the end.

use super::support;
use fab_agent::arm_sight::SIGHT;
use fab_arm::supervisor::{NoWatchdog, Unattended};
use fab_arm::world;
use fab_arm::world::ArmWorld;
use fab_arm::world::{Parts, WithinReach};
use fab_base::interrupt::Interrupt;
use fab_program::Cloth;
use fab_world::metrics::coverage;
use fab_world::start::Start;
use fab_world::{Grasp, Motion, World, WorldError, WorldPoint};

/// Fails with the name of the promise that a world breaks.
fn conforms(make: &dyn Fn() -> Box<dyn World>) {
    looks_only_after_a_reset(make().as_mut());
    two_looks_are_equal(make().as_mut());
    a_fold_moves_the_cloth_and_a_reset_brings_it_back(make().as_mut());
    equal_actions_have_equal_results(make().as_mut(), make().as_mut());
    a_pick_beside_the_cloth_grasps_nothing(make().as_mut());
    an_interrupt_ends_an_action(make().as_mut());
    a_broken_start_is_refused(make().as_mut());
    crumpling_depends_on_the_seed_alone_or_is_refused(make().as_ref());
    assert_eq!(
        make().parameters(),
        make().parameters(),
        "two equal worlds have different parameters"
    );
}

fn start() -> Start {
    Start::flat(&Cloth {
        dimx: 24,
        dimy: 20,
        spacing_m: 0.00625,
        start: fab_program::ClothStart::Flat,
    })
}

fn corner_to_center() -> Motion {
    let [x, y, z] = start().positions[0];
    Motion {
        pick: WorldPoint::new(x.into(), y.into(), z.into()),
        place: WorldPoint::new(0.0, 0.0, 0.005),
    }
}

fn looks_only_after_a_reset(world: &mut dyn World) {
    assert!(matches!(world.observe(), Err(WorldError::NotReset)));
    assert!(matches!(
        world.act(&corner_to_center(), &Interrupt::default()),
        Err(WorldError::NotReset)
    ));
    assert_eq!(world.particles(), None);
}

fn two_looks_are_equal(world: &mut dyn World) {
    world.reset(&start()).unwrap();
    let (first, second) = (world.observe().unwrap(), world.observe().unwrap());
    assert_eq!(first.rgb, second.rgb);
    assert_eq!(first.depth_m, second.depth_m);
    assert_eq!(
        first.rgb.dimensions(),
        first.depth_m.dimensions(),
        "colour and depth are not registered"
    );
}

fn a_fold_moves_the_cloth_and_a_reset_brings_it_back(world: &mut dyn World) {
    world.reset(&start()).unwrap();
    let before = world.observe().unwrap();
    let executed = world
        .act(&corner_to_center(), &Interrupt::default())
        .unwrap();
    assert_ne!(executed.grasp, Grasp::Missed);
    assert!(executed.duration_s > 0.0);
    assert_ne!(
        world.observe().unwrap().rgb,
        before.rgb,
        "the fold is not to be seen"
    );
    if let Some(particles) = world.particles() {
        assert_eq!(particles.len(), start().positions.len());
        assert!(
            particles
                .iter()
                .flatten()
                .all(|coordinate| coordinate.is_finite())
        );
        assert_ne!(particles, start().positions);
    }
    world.reset(&start()).unwrap();
    assert_eq!(
        world.observe().unwrap().rgb,
        before.rgb,
        "a reset does not lay the cloth as before"
    );
}

fn equal_actions_have_equal_results(one: &mut dyn World, other: &mut dyn World) {
    let fold = |world: &mut dyn World| {
        world.reset(&start()).unwrap();
        world
            .act(&corner_to_center(), &Interrupt::default())
            .unwrap();
    };
    fold(one);
    fold(other);
    assert_eq!(one.particles(), other.particles());
    assert_eq!(one.observe().unwrap().rgb, other.observe().unwrap().rgb);
}

fn a_pick_beside_the_cloth_grasps_nothing(world: &mut dyn World) {
    world.reset(&start()).unwrap();
    let before = world.particles();
    let beside = Motion {
        pick: WorldPoint::new(0.2, 0.2, 0.0),
        place: WorldPoint::new(0.2, -0.2, 0.0),
    };
    let executed = world.act(&beside, &Interrupt::default()).unwrap();
    assert_eq!(executed.grasp, Grasp::Missed);
    assert_eq!(
        world.particles(),
        before,
        "an empty gripper moved the cloth"
    );
}

fn an_interrupt_ends_an_action(world: &mut dyn World) {
    world.reset(&start()).unwrap();
    let interrupt = Interrupt::default();
    interrupt.raise();
    assert!(matches!(
        world.act(&corner_to_center(), &interrupt),
        Err(WorldError::Interrupted)
    ));
}

fn a_broken_start_is_refused(world: &mut dyn World) {
    let mut broken = start();
    broken.positions[3][2] = f32::NAN;
    assert!(matches!(
        world.reset(&broken),
        Err(WorldError::Start { .. })
    ));
    let mut short = start();
    short.positions.pop();
    assert!(matches!(world.reset(&short), Err(WorldError::Start { .. })));
}

fn crumpling_depends_on_the_seed_alone_or_is_refused(world: &dyn World) {
    let crumple = |seed| world.crumple(&start(), seed, &Interrupt::default());
    let heap = match crumple(7) {
        Ok(heap) => heap,
        Err(WorldError::CannotCrumple { .. }) => return,
        Err(other) => panic!("{other}"),
    };
    assert_eq!(heap.name, "crumpled, seed 7");
    assert_eq!(heap.seed, Some(7));
    assert_eq!(heap, crumple(7).unwrap());
    assert_ne!(heap.positions, crumple(8).unwrap().positions);
    assert_eq!(world.particles(), None, "crumpling a start laid a cloth");
    let before = coverage(&start().positions, &start().grid).unwrap();
    let after = coverage(&heap.positions, &heap.grid).unwrap();
    assert!(after < 0.85 * before, "covers {after}, {before} before");
    let interrupt = Interrupt::default();
    interrupt.raise();
    assert!(matches!(
        world.crumple(&start(), 7, &interrupt),
        Err(WorldError::Interrupted)
    ));
    let mut broken = start();
    broken.positions[3][2] = f32::NAN;
    assert!(matches!(
        world.crumple(&broken, 7, &Interrupt::default()),
        Err(WorldError::Start { .. })
    ));
}

#[test]
fn the_simulated_world_conforms() {
    let program = support::small_task();
    conforms(&|| support::world(&program).unwrap());
}

#[test]
fn the_simulated_arm_conforms() {
    let program = support::small_task();
    let folder = tempfile::tempdir().unwrap();
    let robot = support::root().join("tasks/real/simulated.toml");
    conforms(&|| {
        let (settings, settings_hash, calibration) = world::load(&robot).unwrap();
        let parts = Parts {
            settings,
            settings_hash,
            calibration,
            sight: SIGHT,
            image_px: program.camera.image_px,
            supervisor: Box::new(Unattended),
            watchdog: Box::new(NoWatchdog),
            folder: Some(folder.path().to_owned()),
        };
        Box::new(ArmWorld::simulated(parts).unwrap())
    });
}

#[test]
fn a_world_within_an_arms_reach_conforms() {
    let program = support::small_task();
    let robot = support::root().join("tasks/real/simulated.toml");
    let (settings, ..) = world::load(&robot).unwrap();
    conforms(&|| {
        let world = support::world(&program).unwrap();
        Box::new(WithinReach::new(world, settings.clone()).unwrap())
    });
}
