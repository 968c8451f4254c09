//! Unit tests of `twin`.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::conformance;
use crate::simulated::tests::towel;
use crate::{Grip, WorldPoint};
use fab_program::RECORDED_SPACING_M;
use fab_program::{Cloth, Picker};

/// The recorded cloth, of 25 by 17 particles.
fn recorded() -> Cloth {
    Cloth {
        dimx: 25,
        dimy: 17,
        spacing_m: RECORDED_SPACING_M,
        start: ClothStart::Flat,
        material: None,
    }
}

/// The cloth, turned and shifted.
fn laid() -> SimulatedWorld {
    let cloth = recorded();
    let mut world = SimulatedWorld::new(&conformance::camera(), Picker::default()).unwrap();
    let start = Start::flat(&cloth).moved(0.3, [0.02, -0.01]);
    world.reset(&start).unwrap();
    world
}

/// The corners of [`laid`] in its picture.
fn corners_px(world: &SimulatedWorld, seen: &Observation) -> [[f64; 2]; 4] {
    let particles = world.particles().unwrap();
    [0, 24, 424, 400].map(|index| {
        let [x, y, z] = particles[index].map(f64::from);
        let point = WorldPoint::new(x, y, z);
        seen.camera.pixel_from_world(point).unwrap()
    })
}

fn ranges(size: [f64; 2], friction: [f64; 2]) -> TwinRanges {
    TwinRanges {
        material: None,
        size,
        friction,
        draws: 1,
    }
}

fn twin(seen: &Sighting, size: f64) -> Twin {
    let camera = conformance::camera();
    let kind = Kind {
        camera: &camera,
        picker: Picker::default(),
        ranges: &ranges([size; 2], [0.5; 2]),
        cloth: &recorded(),
    };
    let drawn = Drawn::by(kind.ranges, "a");
    assert_eq!(
        drawn,
        Drawn {
            size,
            friction: 0.5
        }
    );
    Twin::lay(seen, &kind, drawn).unwrap()
}

#[test]
fn a_twin_lies_where_the_camera_sees_the_cloth_and_has_the_drawn_size() {
    let mut world = laid();
    let observation = world.observe().unwrap();
    let corners = corners_px(&world, &observation);
    for first in 0..4 {
        // Whichever corner comes first.
        let mut corners = corners;
        corners.rotate_left(first);
        let seen = Sighting::of(&observation, corners).unwrap();
        let [x, y] = seen.center_m;
        assert!((x - 0.02).hypot(y + 0.01) < 1e-4, "{seen:?}");
        assert!((seen.turn_rad - 0.3).abs() < 1e-3, "{seen:?}");
        let wanted = [0.15, 0.1];
        assert!((0..2).all(|it| (seen.sides_m[it] - wanted[it]).abs() < 2e-4));
        let table = observation.camera.clone();
        let cloth = depth_mask(&observation.depth_m, f64::from(0.648_f32));
        let overlap = |size| {
            let view = twin(&seen, size).view().unwrap();
            assert_eq!(view.observation.camera, table);
            view.overlap_with(&cloth, &observation)
        };
        let [same, larger] = [1.0, 1.2].map(overlap);
        assert!(same > 0.97, "{same}");
        // 1 / 1.2^2 is 0.69.
        assert!((0.66..0.73).contains(&larger), "{larger}");
    }
}

#[test]
fn a_twin_of_a_material_has_the_spacing_of_the_tasks_cloth() {
    let mut world = laid();
    let observation = world.observe().unwrap();
    let seen = Sighting::of(&observation, corners_px(&world, &observation)).unwrap();
    let cloth = Cloth {
        spacing_m: 0.005,
        ..recorded()
    };
    let count = |material| {
        let ranges = TwinRanges {
            material,
            ..ranges([1.0; 2], [0.5; 2])
        };
        let kind = Kind {
            camera: &conformance::camera(),
            picker: Picker::default(),
            ranges: &ranges,
            cloth: &cloth,
        };
        let twin = Twin::lay(&seen, &kind, Drawn::by(&ranges, "a")).unwrap();
        twin.world.particles().unwrap().len()
    };
    // 150 mm by 100 mm.
    assert_eq!(count(Some(towel())), 31 * 21);
    assert_eq!(count(None), 25 * 17);
}

#[test]
fn a_twin_holds_no_reference_and_folds_without_the_world() {
    fn owns_all_that_it_has<T: 'static>() {}
    owns_all_that_it_has::<Twin>();
    owns_all_that_it_has::<Sighting>();
    let mut world = laid();
    let observation = world.observe().unwrap();
    let seen = Sighting::of(&observation, corners_px(&world, &observation)).unwrap();
    let before = world.particles();
    let mut folded = twin(&seen, 1.0);
    let corner = |index: usize| {
        let [x, y, z] = before.as_ref().unwrap()[index].map(f64::from);
        WorldPoint::new(x, y, z)
    };
    let grip = Grip::new(corner(0), corner(24));
    folded.fold(&grip.into(), &Interrupt::default()).unwrap();
    let flat = twin(&seen, 1.0).view().unwrap().silhouette.area_px() as f64;
    let left = folded.view().unwrap().silhouette.area_px() as f64 / flat;
    assert!(left < 0.85, "{left}");
    assert_eq!(world.particles(), before);
}

#[test]
fn draws_depend_on_their_seed_alone_and_stay_in_the_ranges() {
    let ranges = ranges([0.9, 1.1], [0.2, 0.8]);
    let drawn = |seed: u32| Drawn::by(&ranges, &format!("twin {seed}"));
    assert_eq!(drawn(1), drawn(1));
    assert_ne!(drawn(1), drawn(2));
    for seed in 0..100 {
        let Drawn { size, friction } = drawn(seed);
        assert!((0.9..1.1).contains(&size) && (0.2..0.8).contains(&friction));
    }
}
