//! Finding the drawn arrow, wherever it points and however large the picture.

use crate::draw_arrow;
use fab_picture::arrow;
use fab_picture::hull::{Point, distance};
use image::{Rgb, RgbImage};
use proptest::prelude::*;

fn found(picture: &RgbImage, scale: f64) -> Result<[Point; 2], &'static str> {
    arrow::find(picture, scale).map(|arrow| [arrow.tail, arrow.tip])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_drawn_arrow_is_found_where_it_is(
        side_px in prop::sample::select(vec![128_u32, 224, 224, 224, 300, 512, 720]),
        ground in prop::sample::select(vec![[255; 3], [230; 3], [255, 114, 0], [120, 130, 140]]),
        tail in prop::array::uniform2(20.0..204.0_f64),
        tip in prop::array::uniform2(2.0..222.0_f64),
    ) {
        prop_assume!(distance(tail, tip) * (f64::from(side_px) / 224.0).min(1.0) > 11.0);
        let across = f64::from(side_px) / 224.0;
        let scale = across.max(1.0);
        let mut picture = RgbImage::from_pixel(side_px, side_px, Rgb(ground));
        let [tail, tip] = [tail, tip].map(|point| point.map(|value| value * across));
        draw_arrow(&mut picture, tail, tip).unwrap();
        match found(&picture, scale) {
            Ok([seen_tail, seen_tip]) => {
                prop_assert!(distance(seen_tail, tail) <= 1.5 * scale, "{:?} for {:?}", seen_tail, tail);
                prop_assert!(distance(seen_tip, tip) <= 2.5 * scale, "{:?} for {:?}", seen_tip, tip);
            }
            Err(fault) => prop_assert!(false, "{:?}", fault),
        }
    }
}

#[test]
fn a_head_at_the_edge_of_the_picture_is_no_ring() {
    for (tail, tip) in [([90.3, 29.2], [19.3, 1.1]), ([16.3, 31.6], [90.0, 1.1])] {
        let mut picture = RgbImage::from_pixel(128, 128, Rgb([230; 3]));
        draw_arrow(&mut picture, tail, tip).unwrap();
        let [seen_tail, seen_tip] = found(&picture, 1.0).unwrap();
        assert!(distance(seen_tail, tail) <= 1.5, "{seen_tail:?}");
        assert!(distance(seen_tip, tip) <= 2.5, "{seen_tip:?}");
    }
}

#[test]
fn the_tip_is_the_middle_of_the_strokes_end() {
    let mut picture = RgbImage::from_pixel(224, 224, Rgb([230; 3]));
    draw_arrow(&mut picture, [41.3, 55.7], [41.3, 168.3]).unwrap();
    assert_eq!(found(&picture, 1.0), Ok([[41.5, 55.5], [41.5, 168.5]]));
}

#[test]
fn a_ring_alone_and_a_dark_cloth_are_no_arrows() {
    let mut ring = RgbImage::from_pixel(224, 224, Rgb([230; 3]));
    draw_arrow(&mut ring, [100.0, 100.0], [102.0, 100.0]).unwrap();
    assert_eq!(found(&ring, 1.0), Err("no arrow"));
    let mut cloth = RgbImage::from_fn(224, 224, |column, row| {
        let is_cloth = (50..170).contains(&column) && (60..150).contains(&row);
        Rgb([if is_cloth { 10 } else { 230 }; 3])
    });
    for (column, row) in [(100, 100), (101, 100), (100, 101)] {
        cloth.put_pixel(column, row, Rgb([200; 3]));
    }
    assert_eq!(found(&cloth, 1.0), Err("no arrow"));
}
