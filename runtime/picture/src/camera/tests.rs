//! Laws of cameras, and the recorded ones reproduced.
#![allow(clippy::unwrap_used)]
use super::*;
use proptest::prelude::*;

/// A camera with a picture and pixels that are not square and an off-centre optical axis.
fn pinhole(world_from_camera: Isometry3<f64>, distortion: [f64; 5]) -> Camera {
    let lens = Lens {
        focal_px: [500.0, 480.0],
        middle_px: [311.0, 250.0],
        distortion,
    };
    Camera {
        projection: Projection::Pinhole {
            world_from_camera,
            lens,
        },
        size_px: [640, 480],
    }
}

fn focal_of(camera: &Camera) -> f64 {
    match &camera.projection {
        Projection::Pinhole { lens, .. } => lens.focal_px[0],
        Projection::Plane(_) => f64::NAN,
    }
}

/// A camera a metre above the table, looking almost straight down.
fn over_the_table(tilt: [f64; 3], place: [f64; 2]) -> Isometry3<f64> {
    let straight = Isometry3::new(
        Vector3::new(place[0], place[1], 1.0),
        Vector3::new(std::f64::consts::PI, 0.0, 0.0),
    );
    straight * Isometry3::rotation(Vector3::from(tilt))
}

/// The plane-only camera for such a camera, fitted from four pixels at height 0.
fn plane_of(camera: &Camera) -> Camera {
    let Projection::Pinhole {
        world_from_camera,
        lens,
    } = &camera.projection
    else {
        unreachable!("a pinhole")
    };
    let pose = world_from_camera.inverse().to_homogeneous();
    let focal = lens.focal_px;
    let mut pixel_from_world = nalgebra::Matrix3::zeros();
    for (to, from) in [0, 1, 3].into_iter().enumerate() {
        let (x, y, z) = (pose[(0, from)], pose[(1, from)], pose[(2, from)]);
        let column = Vector3::new(
            focal[0] * x + lens.middle_px[0] * z,
            focal[1] * y + lens.middle_px[1] * z,
            z,
        );
        pixel_from_world.set_column(to, &column);
    }
    let world_from_pixel = pixel_from_world.try_inverse().unwrap();
    let projection = Projection::Plane(Plane {
        world_from_pixel,
        height: [0.0; 3],
        lens: Some(*lens),
    });
    Camera {
        projection,
        size_px: camera.size_px,
    }
}

fn folding() -> Camera {
    Camera::top_down(0.65, 45_f64.to_radians(), 224, ImageUp::Y)
}

#[test]
fn image_right_is_world_x_and_image_up_is_world_y() {
    let camera = folding();
    let [middle_u, middle_v] = camera.pixel_from_world(Point3::origin()).unwrap();
    assert!((middle_u - 112.0).abs() < 1e-9 && (middle_v - 112.0).abs() < 1e-9);
    let [u, v] = camera
        .pixel_from_world(Point3::new(0.1, 0.05, 0.15))
        .unwrap();
    let focal_px = 112.0 / 22.5_f64.to_radians().tan();
    assert!((u - (112.0 + focal_px * 0.1 / 0.5)).abs() < 1e-9, "{u}");
    assert!((v - (112.0 - focal_px * 0.05 / 0.5)).abs() < 1e-9, "{v}");
}

#[test]
fn with_x_up_image_right_is_world_minus_y_and_image_up_is_world_x() {
    let camera = Camera::top_down(1.0, 45_f64.to_radians(), 720, ImageUp::X);
    assert!((focal_of(&camera) - 869.1169).abs() < 1e-3);
    let point = Point3::new(0.2, 0.1, 0.5);
    let [u, v] = camera.pixel_from_world(point).unwrap();
    // The smoothing camera: u = 360 + f z / (1 - y), v = 360 - f x / (1 - y) with world = (x, -z, y).
    assert!((u - (360.0 - focal_of(&camera) * 0.1 / 0.5)).abs() < 1e-9);
    assert!((v - (360.0 - focal_of(&camera) * 0.2 / 0.5)).abs() < 1e-9);
}

#[test]
fn recorded_smoothing_picks_are_seen_where_they_were_recorded() {
    let Some(root) = crate::recorded::recorded_data(
        "recorded_smoothing_picks_are_seen_where_they_were_recorded",
    ) else {
        return;
    };
    let path = root.join("vision/shi_tomasi/manifest.json");
    let manifest: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let camera = Camera::top_down(1.0, 45_f64.to_radians(), 720, ImageUp::X);
    let mut n_points = 0;
    for fixture in manifest["fixtures"].as_array().unwrap() {
        let numbers = |name: &str| -> Option<Vec<f64>> {
            let list = fixture[name].as_array()?;
            Some(list.iter().map(|value| value.as_f64().unwrap()).collect())
        };
        // The recorded pixel was computed from the recorded point, which has y up.
        let (Some(pick), Some(px)) = (numbers("pick_world_m"), numbers("pick_px_from_world"))
        else {
            continue;
        };
        let world = Point3::new(pick[0], -pick[2], pick[1]);
        let [u, v] = camera.pixel_from_world(world).unwrap();
        let off = (u - px[0]).abs().max((v - px[1]).abs());
        assert!(off < 0.06, "{}: off by {off}", fixture["name"]);
        n_points += 1;
    }
    assert!(n_points >= 5, "{n_points} points");
}

#[test]
fn points_that_are_not_in_front_of_the_camera_have_no_pixel() {
    let camera = folding();
    for z in [0.65, 0.7, f64::NAN, f64::INFINITY] {
        assert_eq!(
            camera.pixel_from_world(Point3::new(0.0, 0.1, z)),
            None,
            "z = {z}"
        );
    }
}

#[test]
fn a_depth_without_a_reading_has_no_world_point() {
    let camera = folding();
    for depth_m in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        assert_eq!(
            camera.world_from_pixel([10.0, 10.0], depth_m),
            None,
            "depth {depth_m}"
        );
    }
    assert_eq!(camera.world_from_pixel([f64::NAN, 10.0], 0.5), None);
    assert!(camera.world_from_pixel([10.0, 10.0], 0.5).is_some());
}

#[test]
fn recorded_pick_pixels_are_reproduced() {
    let Some(root) = crate::recorded::recorded_data("recorded_pick_pixels_are_reproduced") else {
        return;
    };
    let path = root.join("folding120/manifest.json");
    let manifest: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let camera = folding();
    let mut n_points = 0;
    for entry in manifest["entries"].as_array().unwrap() {
        for step in entry["steps"].as_array().unwrap() {
            let number = |list: &str, index: usize| step[list][index].as_f64().unwrap();
            // The recording has y up.
            let world = Point3::new(
                number("pick_world_m", 0),
                -number("pick_world_m", 2),
                number("pick_world_m", 1),
            );
            let [u, v] = camera.pixel_from_world(world).unwrap();
            let (du, dv) = (u - number("pick_px", 0), v - number("pick_px", 1));
            assert!(du.hypot(dv) < 1e-3, "{}: off by {du}, {dv}", entry["dir"]);
            n_points += 1;
        }
    }
    assert!(n_points >= 60, "{n_points} points");
}

proptest! {
    #[test]
    fn a_pixel_with_its_depth_leads_back_to_the_world_point(
        height_m in 0.2..3.0_f64,
        fov_rad in 0.2..2.5_f64,
        image_px in 16..2000_u32,
        x in -1.0..1.0_f64,
        y in -1.0..1.0_f64,
        above in 0.0..0.9_f64,
        x_is_up: bool,
    ) {
        let up = if x_is_up { ImageUp::X } else { ImageUp::Y };
        let camera = Camera::top_down(height_m, fov_rad, image_px, up);
        let point = Point3::new(x, y, above * height_m);
        let pixel = camera.pixel_from_world(point).unwrap();
        let back = camera.world_from_pixel(pixel, height_m - point.z).unwrap();
        prop_assert!((back - point).norm() < 1e-9);
    }

    #[test]
    fn any_pose_leads_back_to_the_world_point(
        turn in prop::array::uniform3(-3.0..3.0_f64),
        place in prop::array::uniform3(-1.0..1.0_f64),
        pixel in prop::array::uniform2(0.0..480.0_f64),
        depth_m in 0.05..5.0_f64,
    ) {
        let world_from_camera = Isometry3::new(Vector3::from(place), Vector3::from(turn));
        let camera = pinhole(world_from_camera, [0.0; 5]);
        let point = camera.world_from_pixel(pixel, depth_m).unwrap();
        let [u, v] = camera.pixel_from_world(point).unwrap();
        prop_assert!((u - pixel[0]).abs() < 1e-6 && (v - pixel[1]).abs() < 1e-6);
    }

    #[test]
    fn a_bent_pixel_leads_back_to_the_world_point(
        tilt in prop::array::uniform3(-0.3..0.3_f64),
        place in prop::array::uniform2(-0.5..0.5_f64),
        pixel in prop::array::uniform2(0.0..480.0_f64),
        depth_m in 0.05..5.0_f64,
        k1 in -0.15..0.15_f64,
        others in prop::array::uniform4(-0.02..0.02_f64),
    ) {
        let [k2, t1, t2, k3] = others;
        let camera = pinhole(over_the_table(tilt, place), [k1, k2, t1 / 10.0, t2 / 10.0, k3]);
        let point = camera.world_from_pixel(pixel, depth_m).unwrap();
        let [u, v] = camera.pixel_from_world(point).unwrap();
        prop_assert!((u - pixel[0]).abs() < 1e-6 && (v - pixel[1]).abs() < 1e-6, "{u}, {v}");
    }

    #[test]
    fn the_plane_of_a_camera_shows_the_table_where_the_camera_does(
        tilt in prop::array::uniform3(-0.3..0.3_f64),
        place in prop::array::uniform2(-0.5..0.5_f64),
        pixel in prop::array::uniform2(0.0..480.0_f64),
        k1 in -0.1..0.1_f64,
        above_m in 0.0..0.3_f64,
        way in 0.0..std::f64::consts::TAU,
    ) {
        let camera = pinhole(over_the_table(tilt, place), [k1, 0.0, 0.0, 0.0, 0.0]);
        let plane = plane_of(&camera);
        let point = camera.table_from_pixel(pixel).unwrap();
        prop_assert!(point.z.abs() < 1e-9);
        for depth_m in [0.0, 0.4, f64::NAN] {
            prop_assert!((plane.world_from_pixel(pixel, depth_m).unwrap() - point).norm() < 1e-8);
        }
        prop_assert!((plane.table_from_pixel(pixel).unwrap() - point).norm() < 1e-8);
        // A point above the plane is shown where the plane's point below it is.
        let [u, v] = plane.pixel_from_world(point + Vector3::z() * above_m).unwrap();
        prop_assert!((u - pixel[0]).abs() < 1e-6 && (v - pixel[1]).abs() < 1e-6, "{u}, {v}");
        let way = [2.0 * way.cos(), 2.0 * way.sin()];
        let (ours, theirs) = (camera.table_direction(pixel, way).unwrap(), plane.table_direction(pixel, way).unwrap());
        prop_assert!((ours - theirs).norm() < 1e-6, "{ours} {theirs}");
        prop_assert!((ours.norm() - 2.0).abs() < 1e-9 && ours.z == 0.0);
        // A step along it leads where the image direction leads.
        let there = camera.pixel_from_world(point + ours * 1e-4).unwrap();
        let led = [there[0] - pixel[0], there[1] - pixel[1]];
        let across = (led[0] * way[1] - led[1] * way[0]) / led[0].hypot(led[1]) / 2.0;
        prop_assert!(across.abs() < 1e-2, "{across}");
    }

    #[test]
    fn what_is_cut_out_and_scaled_shows_the_same_points(
        tilt in prop::array::uniform3(-0.3..0.3_f64),
        pixel in prop::array::uniform2(0.0..480.0_f64),
        origin in prop::array::uniform2(0.0..200.0_f64),
        scale in 0.2..3.0_f64,
        k1 in -0.1..0.1_f64,
    ) {
        let camera = pinhole(over_the_table(tilt, [0.0; 2]), [k1, 0.0, 0.001, 0.0, 0.0]);
        let mut cut = camera.clone();
        if let Projection::Pinhole { lens, .. } = &mut cut.projection {
            *lens = lens.cut(origin, scale);
        }
        let there = [0, 1].map(|axis| (pixel[axis] - origin[axis]) * scale);
        let (whole, part) = (camera.table_from_pixel(pixel).unwrap(), cut.table_from_pixel(there).unwrap());
        prop_assert!((whole - part).norm() < 1e-9);
    }
}

#[test]
fn the_ways_of_a_straight_picture_are_the_axes_of_its_camera_bit_for_bit() {
    for up in [ImageUp::X, ImageUp::Y] {
        let camera = Camera::top_down(0.65, 0.8, 224, up);
        let Projection::Pinhole {
            world_from_camera, ..
        } = &camera.projection
        else {
            unreachable!("a pinhole")
        };
        let (right, down) = (std::f64::consts::FRAC_1_SQRT_2, -0.3);
        let axes = world_from_camera.rotation * Vector3::new(right, down, 0.0);
        assert_eq!(
            camera.table_direction([3.0, 200.0], [right, down]),
            Some(axes)
        );
    }
}

#[test]
fn beyond_the_horizon_there_is_no_table() {
    let tilted = pinhole(over_the_table([1.2, 0.0, 0.0], [0.0; 2]), [0.0; 5]);
    let plane = plane_of(&tilted);
    for camera in [&tilted, &plane] {
        let seen = [[311.0, 1.0], [311.0, 479.0]].map(|pixel| camera.table_from_pixel(pixel));
        assert_eq!(seen.iter().flatten().count(), 1, "{seen:?}");
        assert_eq!(camera.table_from_pixel([f64::NAN, 1.0]), None);
    }
}

#[test]
fn a_lens_bends_as_opencv_defines_it() {
    let camera = pinhole(Isometry3::identity(), [0.1, 0.01, 0.001, 0.002, 0.001]);
    // By hand from the formulas in OpenCV's manual, for the ray (0.1, 0.2, 1).
    let [x, y] = [0.100_682_512_5, 0.201_215_025];
    let [u, v] = camera.pixel_from_world(Point3::new(0.2, 0.4, 2.0)).unwrap();
    let off = (u - 311.0 - 500.0 * x).hypot(v - 250.0 - 480.0 * y);
    assert!(off < 1e-9, "{u}, {v}");
}
