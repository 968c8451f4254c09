//! The camera: geometry, sides, and what is left out.

use fab_sim::{
    CameraError, Frame, Grid, ImageUp, Look, Marker, Mask, Params, Picture, Simulator,
    SlantedCamera, SlantedView, TopDownCamera,
};

fn folding_camera(size_px: u32) -> TopDownCamera {
    TopDownCamera::new(0.65, 45f32.to_radians(), size_px).unwrap()
}

fn pixel(frame: &Frame, column: usize, row: usize) -> [u8; 3] {
    let at = 3 * (row * frame.width as usize + column);
    [frame.rgb[at], frame.rgb[at + 1], frame.rgb[at + 2]]
}

#[test]
fn points_right_and_up_in_the_world_are_right_and_up_in_the_image() {
    let camera = folding_camera(224);
    assert_eq!(camera.project([0.0, 0.0, 0.0]), [112.0, 112.0]);
    let [column, row] = camera.project([0.13, 0.065, 0.0]);
    // 270.3919 pixels focal length: 112 + 0.2 f and 112 - 0.1 f.
    assert!((column - 166.078).abs() < 1e-2, "{column}");
    assert!((row - 84.961).abs() < 1e-2, "{row}");
    let [nearer, _] = camera.project([0.13, 0.065, 0.325]);
    assert!((nearer - 220.157).abs() < 1e-2, "{nearer}");
}

#[test]
fn with_x_up_world_x_is_up_and_world_y_is_left() {
    let camera = folding_camera(224).with_up(ImageUp::X);
    let [column, row] = camera.project([0.13, 0.065, 0.0]);
    // 270.3919 pixels focal length: 112 - 0.1 f and 112 - 0.2 f.
    assert!((column - 84.961).abs() < 1e-2, "{column}");
    assert!((row - 57.922).abs() < 1e-2, "{row}");
}

#[test]
fn the_picture_with_x_up_is_the_other_one_turned_left() {
    let grid = Grid::new(20, 16, 0.00625).unwrap();
    let mut points = grid.flat_positions(&Params::default());
    // A corner is folded over, so neither the side nor the shading is the same everywhere.
    for point in points.iter_mut().filter(|p| p[0] + p[1] < -0.05) {
        *point = [-0.05 - point[1], -0.05 - point[0], 0.02];
    }
    let look = Look::default();
    // An odd side has a middle pixel, an even one has none.
    for size in [96, 97] {
        let camera = folding_camera(size as u32);
        let y_up = camera.render(grid, &points, &look);
        let x_up = camera.with_up(ImageUp::X).render(grid, &points, &look);
        assert_ne!(x_up, y_up);
        for row in 0..size {
            for column in 0..size {
                let (from_column, from_row) = (size - 1 - row, column);
                assert_eq!(
                    pixel(&x_up, column, row),
                    pixel(&y_up, from_column, from_row)
                );
                let depths = [
                    x_up.depth_m[row * size + column],
                    y_up.depth_m[from_row * size + from_column],
                ];
                assert_eq!(depths[0], depths[1]);
            }
        }
    }
}

#[test]
fn a_raised_corner_is_drawn_where_the_projection_says() {
    let grid = Grid::new(20, 20, 0.00625).unwrap();
    let mut points = grid.flat_positions(&Params::default());
    // The four particles of the back right corner; nothing else is as near to the camera.
    let raised = [18, 19, 38, 39];
    for index in raised {
        points[index][2] = 0.1;
    }
    for up in [ImageUp::Y, ImageUp::X] {
        let camera = folding_camera(224).with_up(up);
        let frame = camera.render(grid, &points, &Look::default());
        let nearest: Vec<[f32; 2]> = (0..224 * 224)
            .filter(|&pixel| frame.depth_m[pixel] < 0.5501)
            .map(|pixel| [(pixel % 224) as f32 + 0.5, (pixel / 224) as f32 + 0.5])
            .collect();
        assert!(nearest.len() >= 4, "{} pixels", nearest.len());
        let expected: [f32; 2] = [0, 1].map(|axis| {
            raised
                .iter()
                .map(|&index| camera.project(points[index])[axis])
                .sum::<f32>()
                / 4.0
        });
        for axis in [0, 1] {
            let seen = nearest.iter().map(|p| p[axis]).sum::<f32>() / nearest.len() as f32;
            assert!(
                (seen - expected[axis]).abs() < 0.75,
                "{up:?}: {seen} {expected:?}"
            );
        }
    }
}

#[test]
fn cameras_outside_the_bounds_are_refused() {
    let fov = 45f32.to_radians();
    assert_eq!(
        TopDownCamera::new(0.65, fov, 15),
        Err(CameraError::Size(15))
    );
    assert_eq!(
        TopDownCamera::new(0.65, fov, 2049),
        Err(CameraError::Size(2049))
    );
    assert_eq!(
        TopDownCamera::new(0.0, fov, 224),
        Err(CameraError::Height(0.0))
    );
    assert!(TopDownCamera::new(0.65, f32::NAN, 224).is_err());
}

#[test]
fn a_flat_cloth_shows_its_top_and_a_turned_one_its_underside() {
    let grid = Grid::new(20, 20, 0.00625).unwrap();
    let look = Look::default();
    let flat = grid.flat_positions(&Params::default());
    let turned: Vec<[f32; 3]> = flat.iter().map(|p| [-p[0], p[1], p[2]]).collect();
    let camera = folding_camera(64);
    assert_eq!(pixel(&camera.render(grid, &flat, &look), 32, 32), look.top);
    assert_eq!(
        pixel(&camera.render(grid, &turned, &look), 32, 32),
        look.underside
    );
}

#[test]
fn the_upper_layer_hides_the_lower_one_and_tiles_alternate() {
    let grid = Grid::new(20, 20, 0.00625).unwrap();
    let mut points = grid.flat_positions(&Params::default());
    // Folds the left half over the right half.
    for point in &mut points {
        if point[0] < 0.0 {
            *point = [-point[0], point[1], 0.02];
        }
    }
    let look = Look::default();
    let frame = folding_camera(64).render(grid, &points, &look);
    assert_eq!(pixel(&frame, 35, 32), look.underside);
    assert!((frame.depth_m[32 * 64 + 35] - 0.63).abs() < 1e-4);
    assert_eq!(pixel(&frame, 60, 3), look.tiles[0]);
    assert_eq!(pixel(&frame, 3, 3), look.tiles[1]);
    assert_eq!(pixel(&frame, 3, 60), look.tiles[0]);
    assert_eq!(pixel(&frame, 60, 60), look.tiles[1]);
}

#[test]
fn every_depth_is_that_of_the_table_or_of_the_cloth() {
    let grid = Grid::new(20, 20, 0.00625).unwrap();
    let frame = folding_camera(97).render(
        grid,
        &grid.flat_positions(&Params::default()),
        &Look::default(),
    );
    let cloth = frame
        .depth_m
        .iter()
        .filter(|d| (*d - 0.645).abs() < 1e-5)
        .count();
    let table = frame
        .depth_m
        .iter()
        .filter(|d| (*d - 0.65).abs() < 1e-5)
        .count();
    assert_eq!(cloth + table, 97 * 97);
    // 19 spacings of 6.25 mm at 117.1 pixels focal length and 0.645 m distance.
    let side = (cloth as f32).sqrt();
    assert!((side - 21.56).abs() < 0.6, "{side}");
}

#[test]
fn broken_positions_are_left_out_without_a_panic() {
    let grid = Grid::new(20, 20, 0.00625).unwrap();
    let mut points = grid.flat_positions(&Params::default());
    points[50] = [f32::NAN, 0.0, 0.0];
    points[100] = [0.0, 0.0, 0.65];
    points[150] = [1e30, -1e30, 0.1];
    points.truncate(300);
    let frame = folding_camera(64).render(grid, &points, &Look::default());
    assert_eq!(frame.rgb.len(), 64 * 64 * 3);
    assert!(frame.depth_m.iter().all(|depth| depth.is_finite()));
}

#[test]
fn a_fold_shows_both_sides() {
    let grid = Grid::new(20, 20, 0.00625).unwrap();
    let mut cloth = Simulator::flat(grid, &Params::default());
    let [x, y, _] = cloth.positions()[0];
    cloth.pick_and_place([x, y], [0.0, 0.0], &|| false).unwrap();
    let frame = folding_camera(128).render(grid, &cloth.positions(), &Look::default());
    // Shading changes a colour's brightness, so blue tells the sides apart: there is none on top.
    let blue = |minimum: u8| {
        let cloth = |p: &[u8]| p[0] > 150 && p[1] < 160;
        frame
            .rgb
            .chunks(3)
            .filter(|p| cloth(p) && p[2] >= minimum)
            .count()
    };
    let (all, underside) = (blue(0), blue(100));
    assert!(
        underside > 50 && all - underside > 300,
        "{underside} of {all}"
    );
}

#[test]
fn missing_particles_are_neither_drawn_nor_read() {
    let mask = Mask::parse(include_str!("../../outlines/square_with_hole.txt"), 0.00625).unwrap();
    let whole = mask.grid().flat_positions(&Params::default());
    let mut holed = whole.clone();
    for (index, point) in holed.iter_mut().enumerate() {
        if !mask.has(index) {
            // Nearer to the camera than everything else, or NaN.
            *point = if index % 2 == 0 {
                [0.0, 0.0, 0.3]
            } else {
                [f32::NAN; 3]
            };
        }
    }
    let camera = folding_camera(224);
    let look = Look::default();
    let frame = camera.render(&mask, &holed, &look);
    assert_eq!(frame, camera.render(&mask, &whole, &look));
    assert!(frame.depth_m.iter().all(|depth| *depth > 0.64));
    let is_cloth =
        |frame: &Frame, row: usize, column: usize| frame.depth_m[row * 224 + column] < 0.648;
    let full = camera.render(mask.grid(), &whole, &look);
    assert!(is_cloth(&full, 112, 112) && !is_cloth(&frame, 112, 112));
    assert!(is_cloth(&frame, 112, 60) && is_cloth(&frame, 60, 112));
    // The hole is 17 spacings wide: 17 * 6.25 mm * 270.39 px / 0.645 m.
    let n_hole = (0..224 * 224)
        .filter(|&pixel| full.depth_m[pixel] != frame.depth_m[pixel])
        .count();
    let side_px = (n_hole as f64).sqrt();
    assert!((side_px - 44.54).abs() < 1.0, "{side_px}");
}

#[test]
fn slopes_at_a_hole_are_shaded_as_at_an_edge() {
    let grid = Grid::new(9, 9, 0.00625).unwrap();
    let mask = Mask::from_fn(grid, |ix, _| ix < 5).unwrap();
    let alone = Grid::new(5, 9, 0.00625).unwrap();
    let slope = |positions: Vec<[f32; 3]>| -> Vec<[f32; 3]> {
        let rise = |point: [f32; 3]| [point[0], point[1], 0.01 + 0.5 * (point[0] + 0.05)];
        positions.into_iter().map(rise).collect()
    };
    let wide = slope(grid.flat_positions(&Params::default()));
    let narrow: Vec<[f32; 3]> = (0..wide.len())
        .filter(|&index| mask.has(index))
        .map(|index| wide[index])
        .collect();
    let camera = folding_camera(224);
    let look = Look::default();
    assert_eq!(
        camera.render(&mask, &wide, &look),
        camera.render(alone, &narrow, &look)
    );
}

/// The slanted view of the tests: from the front, 320 by 240 pixels.
fn slanted() -> SlantedCamera {
    SlantedCamera::new([0.0, -0.5, 0.5], [0.0; 3], 0.8, [320, 240]).unwrap()
}

#[test]
fn the_slanted_camera_projects_as_a_pinhole_does() {
    let camera = slanted();
    let [column, row] = camera.project([0.0; 3]).unwrap();
    assert!(
        (column - 160.0).abs() < 1e-3 && (row - 120.0).abs() < 1e-3,
        "{column} {row}"
    );
    // 0.1 m to the right, at the target's depth of 0.5 * sqrt(2) m: a seventh of the focal length, 378.44 pixels.
    let [column, row] = camera.project([0.1, 0.0, 0.0]).unwrap();
    assert!(
        (column - 213.52).abs() < 0.05 && (row - 120.0).abs() < 1e-3,
        "{column} {row}"
    );
    // What is behind is farther up, and what is higher too.
    let [_, behind] = camera.project([0.0, 0.1, 0.0]).unwrap();
    let [_, above] = camera.project([0.0, 0.0, 0.1]).unwrap();
    assert!(
        (behind - 85.60).abs() < 0.05 && (above - 77.95).abs() < 0.05,
        "{behind} {above}"
    );
    assert_eq!(camera.project([0.0, -1.0, 1.0]), None);
}

#[test]
fn the_slanted_view_shows_cloth_shadow_and_marker() {
    let grid = Grid::new(21, 21, 0.00625).unwrap();
    let look = Look::default();
    let camera = slanted();
    let view = SlantedView::new(camera, &look);
    let flat = grid.flat_positions(&Params::default());
    let picture = view.render(grid, &flat, None);
    let at = |picture: &Picture, point: [f32; 3]| {
        let [column, row] = camera.project(point).unwrap().map(|it| it as usize);
        let first = 3 * (row * picture.width as usize + column);
        [0, 1, 2].map(|channel| picture.rgb[first + channel])
    };
    // A flat cloth has its declared colour.
    assert_eq!(at(&picture, [0.01, 0.0, flat[0][2]]), look.top);
    assert_eq!(at(&picture, [0.2, 0.1, 0.0]), look.tiles[0]);

    // Raised, it shows the same colour higher up, and darkens the table away from the light.
    let mut raised = flat.clone();
    raised.iter_mut().for_each(|point| point[2] += 0.1);
    let picture = view.render(grid, &raised, None);
    assert_eq!(at(&picture, [0.01, 0.0, raised[0][2]]), look.top);
    let shadow = at(&picture, [0.09, -0.05, 0.0]);
    assert_eq!(
        shadow,
        look.tiles[1].map(|channel| (f32::from(channel) * 0.8) as u8)
    );

    // The other way up it shows its underside.
    let mut turned = flat.clone();
    turned.iter_mut().for_each(|point| point[0] = -point[0]);
    let picture = view.render(grid, &turned, None);
    assert_eq!(at(&picture, [0.01, 0.0, flat[0][2]]), look.underside);

    for holds in [false, true] {
        let marker = Marker {
            tip: [0.0, 0.0, 0.05],
            holds,
        };
        let picture = view.render(grid, &flat, Some(&marker));
        let [red, _, blue] = at(&picture, [0.0, 0.0, 0.059]);
        assert_eq!(blue > 100 && red < blue / 2, holds, "{red} {blue}");
    }
}

#[test]
fn slanted_cameras_that_cannot_be_are_refused() {
    let build = |position, fov, size| SlantedCamera::new(position, [0.0; 3], fov, size);
    for position in [
        [0.0, 0.0, 0.5],
        [0.0, -0.5, 0.0],
        [0.0, f32::NAN, 0.5],
        [0.0, -20.0, 0.5],
    ] {
        let refused = build(position, 0.8, [320, 240]).unwrap_err();
        assert!(matches!(refused, CameraError::Slant { .. }), "{refused}");
    }
    let wide = build([0.0, -0.5, 0.5], 3.0, [320, 240]);
    assert_eq!(wide.unwrap_err(), CameraError::FieldOfView(3.0));
    let flat = build([0.0, -0.5, 0.5], 0.8, [320, 8]);
    assert_eq!(flat.unwrap_err(), CameraError::Size(8));
}
