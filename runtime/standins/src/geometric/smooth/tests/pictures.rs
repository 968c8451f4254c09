//! Tests that the answer follows the picture.

use super::super::{Offer, offers};
use super::*;
use std::collections::BTreeMap;

#[test]
fn a_corner_is_pulled_and_not_a_point_of_a_side() {
    let ([u, v], direction, _) = pull_of(&narrowed().answer());
    assert!(
        [[130, 121], [211, 121], [211, 199], [179, 234], [130, 234]].contains(&[u, v]),
        "({u}, {v})"
    );
    // From the center, (170, 178), it leads outward.
    let (sin, cos) = direction.to_radians().sin_cos();
    let outward = f64::from(u - 170) * cos - f64::from(v - 178) * sin;
    assert!(outward > 0.0, "({u}, {v}) {direction}");
}

#[test]
fn where_the_cloth_ends_is_read_from_the_picture_and_not_from_the_list() {
    // The same list, but the cloth extends beyond the points on the right: they are inside, not corners.
    let wide = question(
        &[([130, 121, 240, 235], ORANGE)],
        &[
            [130, 121],
            [211, 121],
            [211, 234],
            [130, 234],
            [211, 180],
            [170, 121],
        ],
        [185, 178],
    );
    let ([u, _], _, _) = pull_of(&wide.answer());
    assert_eq!(u, 130);
}

#[test]
fn a_mirrored_picture_gives_the_mirrored_answer() {
    let before = pull_of(&narrowed().answer());
    let Question {
        picture,
        corners,
        center,
        ..
    } = narrowed();
    let flip = |[u, v]: [i32; 2]| [SIDE as i32 - 1 - u, v];
    let mirrored = Question {
        picture: image::imageops::flip_horizontal(&picture),
        corners: corners.into_iter().map(flip).collect(),
        center: flip(center),
        ..narrowed()
    };
    let (pick, direction, distance) = pull_of(&mirrored.answer());
    assert_eq!((flip(pick), distance), (before.0, before.2));
    let turned = (180.0 - direction).rem_euclid(360.0);
    assert!(
        (turned - before.1).abs() < 1e-9,
        "{turned} and {}",
        before.1
    );
}

#[test]
fn layers_drawn_over_the_cloth_change_no_estimate_by_a_hundredth() {
    let plain = narrowed();
    let mut drawn = narrowed();
    for ([u, v], colour, radius) in [
        ([211, 121], [0_u8, 0, 255], 3_i32),
        ([130, 234], [0, 0, 255], 3),
        ([170, 178], [0, 0, 0], 4),
        ([150, 200], [255, 0, 0], 4),
    ] {
        // With smooth edges, as layers are drawn.
        let near = -radius - 1..=radius + 1;
        for (dv, du) in near
            .clone()
            .flat_map(|dv: i32| near.clone().map(move |du: i32| (dv, du)))
        {
            let covered =
                (f64::from(radius) + 0.5 - f64::from(du).hypot(dv.into())).clamp(0.0, 1.0);
            let pixel = drawn
                .picture
                .get_pixel_mut((u + du) as u32, (v + dv) as u32);
            for (level, ink) in pixel.0.iter_mut().zip(colour) {
                let mixed = f64::from(*level) + covered * (f64::from(ink) - f64::from(*level));
                *level = mixed.round() as u8;
            }
        }
    }
    assert_ne!(plain.picture, drawn.picture);
    let (before, after) = (plain.answer(), drawn.answer());
    assert_eq!(
        (pull_of(&before).0, pull_of(&before).1),
        (pull_of(&after).0, pull_of(&after).1)
    );
    let by_pull = |question: &Question| -> BTreeMap<_, f64> {
        let offered = offers(&[question.turn()]).unwrap();
        let named = |offer: &Offer| {
            format!(
                "{:?} {} {}",
                offer.pick, offer.direction_deg, offer.distance
            )
        };
        offered
            .iter()
            .map(|offer| (named(offer), offer.gain))
            .collect()
    };
    let (before, after) = (by_pull(&plain), by_pull(&drawn));
    assert!(before.keys().eq(after.keys()));
    for (pull, gain) in before {
        assert!(
            (gain - after[&pull]).abs() < 0.01,
            "{pull}: {gain} and {}",
            after[&pull]
        );
    }
}

#[test]
fn a_heap_is_pulled_farther_than_a_cloth_that_is_almost_flat() {
    let heap = question(
        &[([150, 150, 205, 205], PINK)],
        &[[150, 150], [204, 150], [204, 204], [150, 204]],
        [177, 177],
    );
    let flat = question(
        &[([128, 128, 232, 232], PINK)],
        &[[128, 128], [231, 128], [231, 231], [128, 231]],
        [179, 179],
    );
    let (far, near) = (pull_of(&heap.answer()).2, pull_of(&flat.answer()).2);
    assert!(far > near, "{far} and {near}");
}

#[test]
fn pictures_without_cloth_are_told_and_nothing_is_answered() {
    let empty = question(&[], &[[130, 121]], [170, 178]);
    let reply = empty.answer();
    assert!(reply.contains("I see no cloth"), "{reply}");
    assert_eq!(prompt::answered("pick", &reply), None);
    let broken = Message {
        speaker: Speaker::User,
        parts: vec![
            Part::Text(empty.words()),
            Part::Image(Png::new(vec![1, 2, 3])),
        ],
    };
    let reply = asked(vec![broken]);
    assert!(reply.contains("cannot be read"), "{reply}");
    let tiny = Question {
        picture: RgbImage::new(3, 2),
        ..empty
    };
    assert!(
        tiny.answer().contains("shorter than 32"),
        "{}",
        tiny.answer()
    );
}
