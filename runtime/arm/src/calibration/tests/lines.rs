//! Tests of points as lines.

use super::*;
use fab_picture::Tag;
use proptest::prelude::*;

#[test]
fn files_with_and_without_names_are_read() {
    let wanted = [
        Pair {
            pixel: [10.5, 20.5],
            base_m: [0.3, -0.1, 0.02],
        },
        Pair {
            pixel: [30.0, 40.0],
            base_m: [0.4, 0.1, 0.02],
        },
    ];
    for text in [
        "10.5,20.5,0.3,-0.1,0.02\n30,40,0.4,0.1,0.02\n",
        "# a table\n\nu,v,x,y,z\n10.5, 20.5, 0.3, -0.1, 0.02  # first\n30,40,0.4,0.1,0.02",
        "10.5 20.5 0.3 -0.1 0.02\r\n30 40 0.4 0.1 0.02\r\n",
        "u;v;x;y;z\n10.5;20.5;0.3;-0.1;0.02\n\n30;40;0.4;0.1;0.02\n;;;;\n",
        "u\tv\tx\ty\tz\n10.5\t20.5\t0.3\t-0.1\t0.02\n30\t40\t0.4\t0.1\t0.02",
    ] {
        assert_eq!(parse_pairs(text, Ok(&[])).unwrap(), wanted, "{text}");
    }
    assert_eq!(parse_pairs("# none\n", Ok(&[])).unwrap(), []);
}

#[test]
fn a_wrong_line_is_named() {
    let many = "1,2,3,4,5\n".repeat(MAX_PAIRS + 1);
    for (text, wanted) in [
        ("1,2,3,4\n", "line 1: 4 values; a point is `u,v,x,y,z`"),
        ("1,2,3,4,5,6\n", "line 1: 6 values; a point is `u,v,x,y,z`"),
        ("1\n", "line 1: 1 values; a point is"),
        (
            "1,2,0.3,0.4,0.5\n1,2,0.3,x,0.5\n",
            "line 2: `x` is not a number",
        ),
        ("1,2,0.3,,0.5\n", "line 1: 4 values"),
        ("1,2,nan,3,4\n", "line 1: `nan` is not a number"),
        ("1,2,3,inf,4\n", "line 1: `inf` is not a number"),
        (
            "u,v,x,y\n",
            "line 1: `u` is not a number; a point is `u,v,x,y,z`",
        ),
        ("x,y,z,u,v\n", "line 1: `x` is not a number; a point is"),
        (&many, "there are more than 400 points"),
    ] {
        let error = parse_pairs(text, Ok(&[])).map(|_| ()).unwrap_err();
        assert!(error.contains(wanted), "{error}");
    }
}

proptest! {
    #[test]
    fn a_line_leads_back_to_its_point(
        pixel in prop::array::uniform2(-1e6..1e6_f64),
        base_m in prop::array::uniform3(-3.0..3.0_f64),
    ) {
        let pair = Pair { pixel, base_m };
        prop_assert_eq!(parse_pairs(&csv_line(&pair), Ok(&[])).unwrap(), [pair]);
    }

    #[test]
    fn no_text_brings_it_down(text in "(tag|[0-9a-z,;\t\". #:\r\n\\-]){0,80}") {
        let _ = parse_pairs(&text, Ok(&[TAG]));
    }
}

#[test]
fn a_slip_shows_while_typing() {
    let grid = Truth::usual().grid(4, 0.8);
    let off_mm = |pair: &Pair| terms().off_mm(&grid[..6], pair).unwrap();
    assert!(off_mm(&grid[6]) < 1e-6);
    let mut wrong = grid[7];
    wrong.base_m[0] += 0.05;
    assert!((off_mm(&wrong) - 50.0).abs() < 1e-6);
    assert_eq!(terms().off_mm(&grid[..3], &grid[6]), None);
}

#[test]
fn a_pixel_is_typed_alone() {
    let pixel = |line| parse_pixel(line, Ok(&[TAG]));
    assert_eq!(pixel("120.5, 80"), Ok([120.5, 80.0]));
    assert_eq!(pixel("tag7"), Ok(TAG.middle_px));
    for line in ["1,2,3,4,5", "tag7,1"] {
        let why = pixel(line).unwrap_err();
        assert!(why.contains("a pixel is typed as `u,v`"), "{why}");
    }
}

const TAG: Tag = Tag {
    id: 7,
    middle_px: [200.5, 133.25],
};

#[test]
fn a_tag_stands_for_its_pixel() {
    let seen = [TAG, Tag { id: 8, ..TAG }, Tag { id: 8, ..TAG }];
    let text = "u,v,x,y,z\ntag7,0.3,0.1,0.02\n5,6,0.5,0.1,0.02\n";
    let pairs = parse_pairs(text, Ok(&seen)).unwrap();
    assert_eq!(
        [pairs[0].pixel, pairs[1].pixel],
        [TAG.middle_px, [5.0, 6.0]]
    );
    assert_eq!(csv_line(&pairs[0]), "200.5,133.25,0.3,0.1,0.02");
    assert_eq!(
        parse_pairs("tag7 0.3 0.1 0.02", Ok(&seen)).unwrap(),
        pairs[..1]
    );
    for (text, words) in [
        (
            "tag9,0.3,0.1,0.02",
            "does not show `tag9` once; of the family 36h11 it shows: tag7, tag8, tag8",
        ),
        ("tag8,0.3,0.1,0.02", "does not show `tag8` once"),
        ("tag7:top,0.3,0.1,0.02", "does not show `tag7:top` once"),
        ("tag-1,0.3,0.1,0.02", "does not show `tag-1` once"),
        ("0.3,tag7,0.1,0.02", "`tag7` is not a number"),
        ("tag7,0.3,0.1", "3 values; a point is"),
        ("tag7,1,0.3,0.1,0.02", "5 values; a point is"),
    ] {
        let error = parse_pairs(text, Ok(&seen)).expect_err(text).to_string();
        assert!(error.contains(words), "{text}: {error}");
    }
    let error = parse_pairs("tag7,0.3,0.1,0.02", Ok(&[]))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("of the family 36h11 it shows: none"),
        "{error}"
    );
}
