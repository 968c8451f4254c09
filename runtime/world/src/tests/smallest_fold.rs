//! Unit tests of `smallest_fold`.

use super::*;
use crate::SimulatedWorld;
use fab_program::{Camera, Cloth, ClothStart, ImageUp, Picker};

#[test]
fn a_way_without_direction_has_no_smallest_fold() {
    let camera = Camera {
        height_m: 0.65,
        fov_rad: std::f64::consts::FRAC_PI_4,
        image_px: 32,
        up: ImageUp::Y,
    };
    let cloth = Start::flat(&Cloth {
        dimx: 5,
        dimy: 5,
        spacing_m: 0.00625,
        material: None,
        start: ClothStart::Flat,
    });
    let [x, y, z] = cloth.positions[0].map(f64::from);
    let pick = crate::WorldPoint::new(x, y, z);
    let mut world = SimulatedWorld::new(&camera, Picker::PutDown).expect("a camera");
    let grip = Grip::new(pick, crate::WorldPoint::new(x + 0.0005, y, z));
    let found = find(&cloth, &grip, &mut world, &Interrupt::default());
    assert_eq!(found.expect("a cloth"), SmallestFold::NoneUpTo { mm: 0 });
}
