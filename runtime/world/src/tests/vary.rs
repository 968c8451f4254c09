//! Unit tests of `vary`.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::{SimulatedWorld, World};
use fab_program::{Camera, Cloth, ClothStart, ImageUp, Picker};

fn values(axis: &Axis, value: f64) -> AxisValues {
    AxisValues(BTreeMap::from([(axis.name.to_owned(), value)]))
}

#[test]
fn a_varied_world_reports_its_values_and_sees_with_its_own_camera_and_colours() {
    let camera = Camera {
        height_m: 0.65,
        fov_rad: 0.785,
        image_px: 64,
        up: ImageUp::Y,
    };
    let start = crate::start::Start::flat(&Cloth {
        dimx: 9,
        dimy: 9,
        spacing_m: 0.00625,
        material: None,
        start: ClothStart::Flat,
    });
    // Parameters, colours, depths and camera.
    let seen_in = |mut world: SimulatedWorld| {
        world.reset(&start).unwrap();
        let seen = world.observe().unwrap();
        (
            world.parameters(),
            seen.rgb.into_raw(),
            seen.depth_m.into_raw(),
            format!("{:?}", seen.camera),
        )
    };
    let plain = || SimulatedWorld::new(&camera, Picker::PutDown).unwrap();
    let varied = |name: &str, value: f64| {
        let values = values(Axis::find(name).unwrap(), value);
        let world = plain().varied(&values, &camera);
        assert_eq!(world.variation(), values);
        seen_in(world)
    };
    let own = seen_in(plain());
    let unvaried = plain().varied(&AxisValues::default(), &camera);
    assert_eq!(seen_in(unvaried), own);
    let higher = varied("camera_height_mm", 700.0);
    assert_eq!([own.2[0], higher.2[0]], [0.65, 0.7]);
    assert!(higher.0 == own.0 && higher.3 != own.3);
    let green = varied("hue_deg", 90.0);
    assert!(green.1 != own.1 && green.2 == own.2 && green.3 == own.3);
    let slippery = varied("friction", 0.1);
    assert!(slippery.0 != own.0 && slippery.1 == own.1);
}

#[test]
fn each_axis_changes_its_own_part_of_the_world_and_no_other() {
    let own = Setup::default();
    let parts = |it: &Setup| {
        let Placement {
            size,
            turn_rad,
            shift_m,
        } = it.placement;
        [
            format!("{size}"),
            format!("{}", it.parameters.table_friction),
            format!("{}", it.parameters.self_friction),
            format!("{turn_rad}"),
            format!("{}", shift_m[0]),
            format!("{}", shift_m[1]),
            format!("{:?}", it.camera_height_m),
            format!("{:?}", [it.look.top, it.look.underside]),
            format!("{:?}", it.look.tiles),
        ]
    };
    for (index, axis) in AXES.iter().enumerate() {
        for value in [axis.low, axis.high] {
            let mut changed = Setup::default();
            values(axis, value).apply(&mut changed);
            let differ: Vec<usize> = (0..9)
                .filter(|at| parts(&changed)[*at] != parts(&own)[*at])
                .collect();
            let wanted = match axis.name {
                "brightness" => vec![7, 8],
                _ => vec![index],
            };
            assert_eq!(differ, wanted, "{axis:?} {value}");
        }
    }
}

#[test]
fn hues_turn_round_the_circle_and_back() {
    // The corners of the circle, from CSS Color 4's table of hues.
    let red = [255, 0, 0];
    for (deg, wanted) in [
        (0.0, red),
        (60.0, [255, 255, 0]),
        (120.0, [0, 255, 0]),
        (-120.0, [0, 0, 255]),
        (360.0, red),
    ] {
        assert_eq!(with_turned_hue(red, deg), wanted, "{deg}");
    }
    // Python: colorsys.hsv_to_rgb(h + 1 / 8, s, v) of the default cloth's faces.
    assert_eq!(with_turned_hue([255, 113, 0], 45.0), [206, 255, 0]);
    assert_eq!(with_turned_hue([248, 145, 201], 45.0), [248, 166, 145]);
    assert_eq!(with_turned_hue([77, 77, 77], 100.0), [77, 77, 77]);
}
