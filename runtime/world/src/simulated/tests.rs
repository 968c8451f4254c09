//! Tests of `simulated.rs`.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::conformance;
use fab_program::{Cloth, ClothStart, Colour, Face, Picker};

pub(crate) fn towel() -> program::Material {
    let along = |warp, weft, bias| program::Directions { warp, weft, bias };
    program::Material {
        name: "towel".to_owned(),
        weight_kg_m2: 0.42,
        thickness_m: 0.0021,
        bending_length_m: along(0.021, 0.018, 0.019),
        crease_recovery_deg: 110.0,
        stretch: along(0.02, 0.03, 0.1),
        table_friction: 0.4,
        self_friction: 0.6,
        upper: Colour {
            name: "blue".to_owned(),
            rgb: [20, 40, 200],
        },
        under: Colour::recorded(Face::Under),
        sources: Vec::new(),
    }
}

#[test]
fn the_language_allows_the_grids_that_the_simulator_has() {
    let most = [fab_sim::MIN_DIM, fab_sim::MAX_DIM];
    assert_eq!(fab_program::PARTICLES_A_SIDE.map(|it| it as usize), most);
}

#[test]
fn a_material_changes_the_parameters_and_the_picture_and_none_changes_nothing() {
    let world = || SimulatedWorld::new(&conformance::camera(), Picker::default()).unwrap();
    let plain = world().with_material(None);
    assert_eq!(plain.parameters(), world().parameters());
    let mut made = world().with_material(Some(&towel()));
    assert_ne!(made.parameters(), plain.parameters());
    let start = Start::flat(&Cloth {
        dimx: 21,
        dimy: 21,
        spacing_m: 0.00625,
        start: ClothStart::Flat,
        material: Some(towel()),
    });
    made.reset(&start).unwrap();
    let seen = made.observe().unwrap();
    let middle = seen.rgb.width() / 2;
    assert_eq!(seen.rgb.get_pixel(middle, middle).0, [20, 40, 200]);
}

#[test]
fn a_copy_goes_on_by_itself_and_ends_as_the_world_does() {
    let start = Start::flat(&Cloth {
        dimx: 10,
        dimy: 10,
        spacing_m: 0.00625,
        start: ClothStart::Flat,
        material: None,
    });
    let mut world = SimulatedWorld::new(&conformance::camera(), Picker::Drop).unwrap();
    world.reset(&start).unwrap();
    let [from, middle, to] =
        [[-0.028, -0.028], [0.0, 0.01], [0.03, 0.03]].map(|[x, y]| [x, y, 0.005].into());
    let stop = Interrupt::default();
    world.act(&Grip::new(from, middle).into(), &stop).unwrap();
    let before = world.particles();
    let mut copy = world.fork().unwrap();
    let tried = copy.act(&Grip::new(middle, to).into(), &stop).unwrap();
    assert_eq!(world.particles(), before);
    let done = world.act(&Grip::new(middle, to).into(), &stop).unwrap();
    assert_eq!((tried, copy.particles()), (done, world.particles()));
    assert_ne!(world.particles(), before);
}

#[test]
fn a_flat_cloth_lies_where_the_simulator_lets_it_rest() {
    for thickness_m in [0.0002, 0.0021, 0.009] {
        let material = program::Material {
            thickness_m,
            ..towel()
        };
        let simulated = Params {
            material: Some(self::material(&material)),
            ..Params::default()
        };
        let cloth = Cloth {
            dimx: 2,
            dimy: 2,
            spacing_m: 0.00625,
            start: ClothStart::Flat,
            material: Some(material),
        };
        assert_eq!(cloth.rest_height_m() as f32, simulated.rest_height_m());
    }
}

#[test]
fn the_recorded_cloth_has_the_simulators_friction() {
    let cloth = Cloth {
        dimx: 2,
        dimy: 2,
        spacing_m: 0.00625,
        start: ClothStart::Flat,
        material: None,
    };
    let friction = Params::default().table_friction;
    assert_eq!(cloth.table_friction() as f32, friction);
}

#[test]
fn a_material_that_is_too_stiff_for_the_grid_is_refused_with_a_spacing_that_would_do() {
    let mut stiff = towel();
    stiff.bending_length_m = program::Directions {
        warp: 0.1,
        weft: 0.1,
        bias: 0.09,
    };
    let cloth = Cloth {
        dimx: 21,
        dimy: 21,
        spacing_m: 0.00625,
        start: ClothStart::Flat,
        material: Some(stiff),
    };
    let world = SimulatedWorld::new(&conformance::camera(), Picker::default()).unwrap();
    let mut world = world.with_material(cloth.material.as_ref());
    let error = world.reset(&Start::flat(&cloth)).unwrap_err().to_string();
    assert!(
        error.contains("substeps") && error.contains("would do"),
        "{error}"
    );
}
