//! Tests of the center of a cloth that is no longer a rectangle, and of points that are not corners.

use super::*;

/// The triangle that [`square_fold`] leaves, one of its sharp corners folded to the square's center.
fn triangle_to_center() -> Fold {
    Fold {
        before: vec![[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5]],
        after: vec![[-0.5, -0.5], [0.0, -0.5], [0.25, -0.25], [-0.5, 0.5]],
        tail: [0.5, -0.5],
        tip: [0.0, 0.0],
    }
}

/// A square without its upper corners, a lower one folded to the center.
fn house_to_center() -> Fold {
    Fold {
        before: vec![
            [-0.5, -0.5],
            [0.5, -0.5],
            [0.5, 0.0],
            [0.0, 0.5],
            [-0.5, 0.0],
        ],
        after: vec![
            [0.0, -0.5],
            [0.5, -0.5],
            [0.5, 0.0],
            [0.0, 0.5],
            [-0.5, 0.0],
        ],
        tail: [-0.5, -0.5],
        tip: [0.0, 0.0],
    }
}

/// A square folded to its left half, the half's upper right corner folded to where the square's center was.
fn half_to_center() -> Fold {
    Fold {
        before: vec![[-0.5, -0.5], [0.0, -0.5], [0.0, 0.5], [-0.5, 0.5]],
        after: vec![[-0.5, -0.5], [0.0, -0.5], [0.0, 0.5], [-0.5, 0.0]],
        tail: [-0.5, 0.5],
        tip: [0.0, 0.0],
    }
}

#[test]
#[ignore = "long"]
fn an_arrow_to_the_middle_of_the_picture_leads_to_the_center() {
    for fold in [triangle_to_center(), house_to_center(), half_to_center()] {
        for turn_deg in [0.0, 20.0, 135.0, 250.0] {
            let view = View { turn_deg, ..VIEW };
            let told = instruction(&view.pictures(&fold));
            assert!(told.contains("place center"), "{turn_deg}: {told}");
        }
    }
}

#[test]
fn an_arrow_past_the_middle_of_the_picture_does_not_lead_to_the_center() {
    for fold in [rectangle_fold(), square_fold(), triangle_fold()] {
        let told = instruction(&VIEW.pictures(&fold));
        assert!(!told.contains("center"), "{told}");
    }
}

#[test]
fn the_center_of_a_triangle_is_found_among_the_listed_points() {
    let words = instruction(&VIEW.pictures(&triangle_to_center()));
    for turn_deg in [0.0, 30.0, -40.0] {
        let view = View {
            turn_deg,
            cloth_px: 128.0,
            ..VIEW
        };
        let corners = triangle_to_center()
            .before
            .iter()
            .map(|&at| view.whole_pixel(at))
            .collect::<Vec<_>>();
        let center = view.whole_pixel([0.0, 0.0]);
        assert_eq!(
            planned(&words, &corners, center),
            [corners[1], center],
            "{turn_deg}"
        );
    }
}

/// The left edge of a square is folded to the middle: its lower corner has moved along, and the corner below it was not
/// detected. The tightest rectangle is then a slanted one.
#[test]
fn the_rectangle_that_is_meant_has_points_where_the_words_say() {
    let words = "pick 0-2, place 4-0, in eighths along the sides to the right and across them";
    let corners = "(51, 154), (81, 40), (182, 41), (182, 182), (79, 120)";
    let prompt = format!(
        "- Method of folding: {words}\n- Cloth corners: {corners}\n\
         - Side points: (112, 41), (182, 112), (112, 182), (41, 112)\n- Cloth center: (111, 111)"
    );
    let reply = ask(ModelRole::Text, vec![Message::text(Speaker::User, prompt)]);
    assert_eq!(
        points_of(&reply),
        [PixelPoint::new(51, 154), PixelPoint::new(112, 182)]
    );
}

/// Only the sharp corners of a turned triangle were detected.
#[test]
fn two_corners_are_told_apart_by_the_way_between_them() {
    let words = "pick 8-8, place 0-8, in eighths along the long sides to the lower-right and across them; bare 0-0 8-0";
    let [top, bottom, center] =
        [(109, 4), (109, 218), (111, 111)].map(|(u, v)| PixelPoint::new(u, v));
    assert_eq!(planned(words, &[top, bottom], center), [bottom, top]);
    assert_eq!(planned(words, &[bottom, top], center), [bottom, top]);
    let inward = "pick 8-8, place center, in eighths along the sides to the right and across them";
    assert_eq!(planned(inward, &[top], center), [top, center]);
}

/// A strip turned by 60 degrees whose corners are each off by some pixels: the words still mean the nearer orientation.
#[test]
fn a_few_pixels_do_not_turn_a_strip_around() {
    let words = "pick 0-8, place 8-8, in eighths along the long sides to the right and across them";
    let corners = [(147, 179), (69, 48), (97, 207), (22, 75), (119, 126)];
    let corners = corners.map(|(u, v)| PixelPoint::new(u, v));
    let center = PixelPoint::new(111, 111);
    assert_eq!(planned(words, &corners, center), [corners[1], corners[0]]);
}

#[test]
fn points_besides_the_corners_are_places_and_no_picks() {
    let prompt = "- Method of folding: pick 4-8, place 4-0, in eighths along the sides to the right and across them\n\
                  - Cloth corners: (40, 40), (180, 40), (180, 180), (40, 180), (90, 45)\n\
                  - Points of the sides: (110, 40), (180, 110),\n- Others: (110, 180)\n\
                  - Last action: it ended at (110, 181)\n- Cloth center: (110, 110)";
    let reply = ask(ModelRole::Text, vec![Message::text(Speaker::User, prompt)]);
    assert_eq!(
        points_of(&reply),
        [PixelPoint::new(90, 45), PixelPoint::new(110, 180)]
    );
    // Unless the prompt offers them.
    let offered = "Choose the pick point from the listed corners or the\nlisted points of the sides. Be brief.";
    let messages = [(Speaker::System, offered), (Speaker::User, prompt)];
    let reply = ask(
        ModelRole::Text,
        messages
            .map(|(speaker, text)| Message::text(speaker, text))
            .to_vec(),
    );
    assert_eq!(
        points_of(&reply),
        [PixelPoint::new(110, 40), PixelPoint::new(110, 180)]
    );
}

#[test]
fn a_cloth_may_slide_by_two_pixels_while_a_corner_is_folded() {
    // Cotton slides toward the folded corner, which bares a rim along the two far sides.
    let slide = |[x, y]: Point| [x + 0.015, y + 0.015];
    let after = [
        [-0.5, -0.5],
        [0.5, -0.5],
        [0.5, 0.05],
        [0.05, 0.5],
        [-0.5, 0.5],
    ];
    let fold = Fold {
        before: vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]],
        after: after.map(slide).to_vec(),
        tail: [0.5, 0.5],
        tip: [0.0, 0.0],
    };
    assert!(instruction(&VIEW.pictures(&fold)).contains("center"));
}
