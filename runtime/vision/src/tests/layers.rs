//! Tests of the layers drawn for a model.

use super::super::*;
use super::apart;
use super::assert_refused;
use crate::recorded::recorded_data;
use fab_picture::Mask;
use fab_program::PixelPoint;
use image::{Rgb, RgbImage};
use proptest::prelude::*;
use serde_json::Value;

const BLACK: [u8; 3] = [0, 0, 0];
const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const BLUE: [u8; 3] = [0, 0, 255];
const PURPLE: [u8; 3] = [128, 0, 128];

fn layer(rgb: [u8; 3], shape: DrawnShape) -> DrawnLayer {
    DrawnLayer { rgb, shape }
}

fn rings(rgb: [u8; 3], at: Vec<PixelPoint>, radius_px: u32) -> DrawnLayer {
    layer(
        rgb,
        DrawnShape::Rings {
            at,
            radius_px,
            width_px: 2,
        },
    )
}

fn dots(rgb: [u8; 3], at: Vec<PixelPoint>, radius_px: u32) -> DrawnLayer {
    layer(rgb, DrawnShape::Dots { at, radius_px })
}

/// Draws one shape in red on white and returns the pixels that are red now.
fn red_pixels(side_px: u32, shape: DrawnShape) -> Vec<(u32, u32)> {
    let white = RgbImage::from_pixel(side_px, side_px, Rgb([255; 3]));
    let drawn = draw_layers(&white, &[layer(RED, shape)]).unwrap();
    let red = drawn
        .enumerate_pixels()
        .filter(|(_, _, pixel)| pixel.0 == RED);
    red.map(|(column, row, _)| (column, row)).collect()
}

#[test]
fn a_dotted_box_has_every_nth_pixel_and_a_solid_one_all() {
    let shape = |spacing_px| DrawnShape::Box {
        corners: [PixelPoint::new(2, 3), PixelPoint::new(10, 7)],
        spacing_px,
    };
    let dotted = [(2, 3), (6, 3), (10, 3), (2, 7), (6, 7)];
    assert_eq!(red_pixels(16, shape(4)), dotted);
    let solid = red_pixels(16, shape(1));
    assert_eq!(solid.len(), 2 * (8 + 4));
    assert!(solid.contains(&(10, 7)) && solid.contains(&(9, 3)));
    assert_eq!(red_pixels(16, shape(0)), solid);
    assert_eq!(red_pixels(16, shape(u32::MAX)), [(2, 3), (10, 3), (2, 7)]);
}

#[test]
fn a_cross_has_four_arms() {
    let at = vec![PixelPoint::new(8, 6)];
    let shape = DrawnShape::Crosses {
        at,
        radius_px: 3,
        width_px: 1,
    };
    let pixels = red_pixels(16, shape);
    assert_eq!(pixels.len(), 13);
    for tip in [(5, 6), (11, 6), (8, 3), (8, 9)] {
        assert!(pixels.contains(&tip), "{tip:?}");
    }
}

#[test]
fn an_outline_is_closed_and_one_without_points_is_nothing() {
    let triangle = [(2, 2), (12, 2), (2, 12)]
        .map(|(u, v)| PixelPoint::new(u, v))
        .to_vec();
    let outlined = |points| {
        red_pixels(
            16,
            DrawnShape::Outline {
                points,
                width_px: 1,
            },
        )
    };
    let pixels = outlined(triangle);
    for on_a_side in [(7, 2), (7, 7), (2, 7)] {
        assert!(pixels.contains(&on_a_side), "{on_a_side:?}");
    }
    assert!(!pixels.contains(&(5, 5)));
    assert_eq!(outlined(Vec::new()), []);
    assert_eq!(outlined(vec![PixelPoint::new(3, 4)]), [(3, 4)]);
}

#[test]
fn later_layers_cover_earlier_ones_and_the_picture_given_is_kept() {
    let white = RgbImage::from_pixel(9, 9, Rgb([255; 3]));
    let at = vec![PixelPoint::new(4, 4)];
    let layers = [dots(RED, at.clone(), 3), dots(BLUE, at, 1)];
    let drawn = draw_layers(&white, &layers).unwrap();
    assert_eq!(drawn.get_pixel(4, 4).0, BLUE);
    assert_eq!(drawn.get_pixel(4, 1).0, RED);
    assert!(white.pixels().all(|pixel| pixel.0 == [255; 3]));
    assert_eq!(draw_layers(&white, &[]).unwrap(), white);
}

#[test]
fn numbers_lie_inside_the_picture_beside_their_points() {
    let corners = [(1, 1), (98, 1), (1, 98), (98, 98), (50, 50)];
    for (u, v) in corners {
        // Nine points off the picture are counted, so the tenth has two digits.
        let mut at = vec![PixelPoint::new(-5, 50); 9];
        at.push(PixelPoint::new(u, v));
        let gray = RgbImage::from_pixel(100, 100, Rgb([120; 3]));
        let numbers = |at| draw_layers(&gray, &[layer(RED, DrawnShape::Numbers { at })]).unwrap();
        assert_eq!(numbers(at[..9].to_vec()), gray);
        let changed: Vec<_> = numbers(at)
            .enumerate_pixels()
            .filter(|(_, _, pixel)| pixel.0 != [120; 3])
            .map(|(column, row, _)| PixelPoint::new(column as i32, row as i32))
            .collect();
        let mask = Mask::from_fn(100, 100, |column, row| {
            changed.contains(&PixelPoint::new(column as i32, row as i32))
        });
        let [low, high] = bounding_box(&mask).unwrap();
        // Two digits of 9 px with their rims, none cut off.
        let size_px = (high.u - low.u + 1, high.v - low.v + 1);
        assert_eq!(size_px, (15, 11), "({u}, {v})");
        let off_px = box_distance_px(PixelPoint::new(u, v), [low, high]);
        assert!((1.0..=10.0).contains(&off_px), "({u}, {v}): {off_px} px");
    }
}

#[test]
fn a_picture_without_pixels_is_refused() {
    assert_refused(draw_layers(&RgbImage::new(0, 3), &[]), "cannot be used");
}

fn any_point() -> impl Strategy<Value = PixelPoint> {
    let axis = || prop_oneof![8 => -10..50_i32, 1 => any::<i32>()];
    (axis(), axis()).prop_map(|(u, v)| PixelPoint::new(u, v))
}

fn any_shape() -> impl Strategy<Value = DrawnShape> {
    let at = || prop::collection::vec(any_point(), 0..6);
    let size = || prop_oneof![8 => 0..12_u32, 1 => any::<u32>()];
    prop_oneof![
        (at(), size()).prop_map(|(at, radius_px)| DrawnShape::Dots { at, radius_px }),
        (at(), size(), size()).prop_map(|(at, radius_px, width_px)| DrawnShape::Rings {
            at,
            radius_px,
            width_px
        }),
        (at(), size(), size()).prop_map(|(at, radius_px, width_px)| DrawnShape::Crosses {
            at,
            radius_px,
            width_px
        }),
        at().prop_map(|at| DrawnShape::Numbers { at }),
        (any_point(), any_point(), size()).prop_map(|(from, to, width_px)| DrawnShape::Arrow {
            from,
            to,
            width_px
        }),
        (any_point(), any_point(), size()).prop_map(|(a, b, spacing_px)| DrawnShape::Box {
            corners: [a, b],
            spacing_px
        }),
        (at(), size()).prop_map(|(points, width_px)| DrawnShape::Outline { points, width_px }),
    ]
}

proptest! {
    #[test]
    fn any_layers_can_be_drawn_on_any_picture(
        size in (1..40_u32, 1..40_u32),
        shapes in prop::collection::vec((any::<[u8; 3]>(), any_shape()), 0..4),
    ) {
        let white = RgbImage::from_pixel(size.0, size.1, Rgb([255; 3]));
        let layers: Vec<_> = shapes.into_iter().map(|(rgb, shape)| layer(rgb, shape)).collect();
        prop_assert_eq!(draw_layers(&white, &layers).unwrap().dimensions(), size);
    }
}

/// The original's annotation: corners, centre, box, and the previous action's place with its mirror image.
fn annotation(fixture: &Value, last_place: Option<PixelPoint>) -> Vec<DrawnLayer> {
    let bounds = |side: &str| fixture["bounds_px"][side].as_i64().unwrap() as i32;
    let corners = [
        PixelPoint::new(bounds("left"), bounds("top")),
        PixelPoint::new(bounds("right"), bounds("bottom")),
    ];
    let center = box_center(corners);
    let recorded: PixelPoint = serde_json::from_value(fixture["center_px"].clone()).unwrap();
    assert_eq!(center, recorded);
    let detected = serde_json::from_value(fixture["recorded_corners"].clone()).unwrap();
    let mut layers = vec![
        dots(BLUE, detected, 3),
        // Radius 4, as measured.
        dots(BLACK, vec![center], 4),
        layer(
            BLUE,
            DrawnShape::Box {
                corners,
                spacing_px: 4,
            },
        ),
    ];
    if let Some(last) = last_place {
        let mirror = PixelPoint::new(2 * center.u - last.u, 2 * center.v - last.v);
        layers.push(rings(RED, vec![last, mirror], 3));
    }
    layers
}

/// The place of a recorded action: the middle of the purple ring drawn around it.
fn place_shown(drawing: &RgbImage) -> PixelPoint {
    let purple = Mask::from_fn(drawing.width(), drawing.height(), |column, row| {
        drawing.get_pixel(column, row).0 == PURPLE
    });
    box_center(bounding_box(&purple).unwrap())
}

#[test]
fn annotations_and_actions_are_drawn_where_they_were_recorded() {
    let test = "annotations_and_actions_are_drawn_where_they_were_recorded";
    let Some(root) = recorded_data(test) else {
        return;
    };
    let manifest = std::fs::read_to_string(root.join("vision/shi_tomasi/manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    let (mut last_place, mut n_annotations, mut n_actions) = (None, 0, 0);
    for fixture in manifest["fixtures"].as_array().unwrap() {
        let folder = root.join(fixture["dir"].as_str().unwrap());
        if !folder.exists() {
            continue;
        }
        let name = fixture["name"].as_str().unwrap();
        let picture = |file: &str| image::open(folder.join(file)).unwrap().into_rgb8();
        // The last place does not carry over to the next series.
        last_place = last_place.filter(|_| !name.ends_with("_step_0"));
        let (ground, layers) = (picture("aug.png"), annotation(fixture, last_place));
        let annotated = draw_layers(&ground, &layers).unwrap();
        for DrawnLayer { rgb, .. } in layers {
            let drawings = [&annotated, &picture("processed.png")];
            let apart = apart(&ground, drawings, rgb);
            // Where a ring covers a dot, it may leave another pixel of it visible.
            assert!(apart.len() <= 1, "{name}: {rgb:?} {apart:?}");
        }
        n_annotations += 1;
        let place = place_shown(&picture("vis.png"));
        last_place = Some(place);
        let Some(pick) = fixture["pick_px_from_world"].as_array() else {
            continue;
        };
        // The pick was drawn at the chosen corner, before it was moved to the nearest cloth pixel.
        let [u, v] = [0, 1].map(|axis| pick[axis].as_f64().unwrap() as i32);
        let near = |corner: &PixelPoint| corner.distance_px(PixelPoint::new(u, v)) < 1.5;
        let detected = fixture["recorded_corners"].clone();
        let detected: Vec<PixelPoint> = serde_json::from_value(detected).unwrap();
        let from = detected.into_iter().find(near).unwrap();
        let mut acted = annotated.clone();
        draw_action(&mut acted, from, place).unwrap();
        for (rgb, free) in [(GREEN, vec![from, place]), (PURPLE, vec![])] {
            let mut apart = apart(&ground, [&acted, &picture("vis.png")], rgb);
            // The recorded arrow leads from middle to middle, ours from ring to ring, and so does its head.
            let head_px = 0.1 * from.distance_px(place);
            apart.retain(|at| {
                free.iter()
                    .all(|middle| at.distance_px(*middle) > 7.0 + head_px)
            });
            assert_eq!(apart, [], "{name}: {rgb:?}");
        }
        n_actions += 1;
    }
    assert!(
        n_annotations >= 10 && n_actions >= 5,
        "{n_annotations}, {n_actions}"
    );
}
