//! Outlines of cloths: what is read, what is rejected and how, and the shipped outlines.

use fab_sim::{Grid, GridError, Mask, MaskError};
use proptest::prelude::*;

const SPACING_M: f32 = 0.00625;

/// The shipped outlines: name, text, and particles along X, along Y and in all.
const OUTLINES: [(&str, &str, [usize; 3]); 3] = [
    (
        "t_shirt",
        include_str!("../../outlines/t_shirt.txt"),
        [50, 50, 1502],
    ),
    (
        "trousers",
        include_str!("../../outlines/trousers.txt"),
        [36, 50, 1354],
    ),
    (
        "square_with_hole",
        include_str!("../../outlines/square_with_hole.txt"),
        [50, 50, 2244],
    ),
];

#[test]
fn shipped_outlines_are_cloths_and_mirror_images_of_themselves() {
    for (name, text, [dimx, dimy, count]) in OUTLINES {
        let mask = Mask::parse(text, SPACING_M).unwrap_or_else(|error| panic!("{name}: {error}"));
        let grid = mask.grid();
        assert_eq!([grid.dimx, grid.dimy, mask.count()], [dimx, dimy, count]);
        assert!(!mask.is_full(), "{name}");
        assert_eq!(mask.to_string(), text, "{name}");
        for index in 0..grid.particle_count() {
            let mirrored = index - index % dimx + (dimx - 1 - index % dimx);
            assert_eq!(mask.has(index), mask.has(mirrored), "{name}: {index}");
        }
    }
}

#[test]
fn the_first_row_is_the_back_edge_and_columns_run_along_x() {
    let mask = Mask::parse("###.\n####\n", SPACING_M).unwrap_err();
    assert_eq!(mask, MaskError::Thread { row: 2, column: 4 });
    let mask = Mask::parse("####\n####\n..##\n", SPACING_M).unwrap();
    assert_eq!(mask.grid(), Grid::new(4, 3, SPACING_M).unwrap());
    let there: Vec<usize> = (0..20).filter(|&index| mask.has(index)).collect();
    assert_eq!(there, [0, 1, 2, 3, 4, 5, 6, 7, 10, 11]);
}

#[test]
fn what_is_no_outline_is_refused_with_its_place() {
    let cases = [
        ("", "a side of `0` particles is outside `2` to `200`"),
        ("\n##\n##", "a side of `0` particles"),
        ("##", "a side of `1` particles"),
        (
            "##\n#x",
            "row 2, column 2 of the outline holds `x`; a particle is `#`, none is `.`",
        ),
        ("##\n##\n#\t#", "row 3, column 2 of the outline holds `\\t`"),
        (
            "##\n\u{e9}#",
            "row 2, column 1 of the outline holds `\u{e9}`",
        ),
        (
            "##\n###",
            "row 2 of the outline has 3 columns and row 1 has 2; fill rows with `.`",
        ),
        ("###\n##", "row 2 of the outline has 2 columns"),
        ("##\n\n##", "row 2 of the outline has 0 columns"),
        ("..\n..", "the outline has 0 particles"),
        (
            "#..\n.##",
            "the outline has 3 particles; a cloth needs at least 4",
        ),
        (
            "##..\n##..\n...#",
            "the particle in row 3, column 4 of the outline is in no square of four",
        ),
        ("##.\n###", "the particle in row 2, column 3"),
        (
            "##.##\n##.##",
            "the outline is in parts: row 1, column 4 is not joined to row 1, column 1",
        ),
        (
            "##.\n###\n.##",
            "row 2, column 2 is not joined to row 1, column 1; parts that meet must share two",
        ),
    ];
    for (text, expected) in cases {
        let said = Mask::parse(text, SPACING_M).unwrap_err().to_string();
        assert!(said.contains(expected), "{text:?}: {said}");
    }
    for spacing_m in [0.0, -1.0, f32::NAN] {
        let error = Mask::parse("##\n##", spacing_m).unwrap_err();
        assert!(matches!(error, MaskError::Grid(GridError::Spacing(_))));
    }
}

#[test]
fn line_ends_of_any_editor_and_blanks_behind_make_no_difference() {
    let plain = Mask::parse("###\n###\n##.", SPACING_M).unwrap();
    for text in ["###\r\n###\r\n##.\r\n", "###  \n###\n##. \n\n \n"] {
        assert_eq!(Mask::parse(text, SPACING_M), Ok(plain.clone()), "{text:?}");
    }
}

#[test]
fn huge_outlines_are_refused() {
    let wide = format!("{0}\n{0}\n", "#".repeat(201));
    let expected = MaskError::Grid(GridError::Dim(201));
    assert_eq!(Mask::parse(&wide, SPACING_M), Err(expected.clone()));
    let tall = "##\n".repeat(1_000_000);
    assert_eq!(Mask::parse(&tall, SPACING_M), Err(expected));
}

#[test]
fn a_mask_that_leaves_nothing_out_is_the_full_one_however_it_was_made() {
    let grid = Grid::new(4, 3, SPACING_M).unwrap();
    let full = Mask::full(grid);
    assert_eq!(Mask::from(grid), full);
    assert_eq!(Mask::from_fn(grid, |_, _| true), Ok(full.clone()));
    assert_eq!(Mask::parse("####\n####\n####", SPACING_M), Ok(full.clone()));
    assert!(full.is_full() && full.count() == 12);
    assert!(full.has(11) && !full.has(12) && !full.has(usize::MAX));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Whatever the letters, the result is an error, or a mask that is drawn as it was read.
    #[test]
    fn any_text_is_refused_or_drawn_as_it_was_read(text in "[#.\r\n x]{0,60}|[#.]{4}\n[#.]{4}\n[#.]{4}") {
        if let Ok(mask) = Mask::parse(&text, SPACING_M) {
            let drawn = mask.to_string();
            prop_assert_eq!(Mask::parse(&drawn, SPACING_M), Ok(mask.clone()));
            prop_assert_eq!(drawn.matches('#').count(), mask.count());
        }
    }

    /// A round outline off the centre of a grid that is not square, so that no axis can be mistaken for the other.
    #[test]
    fn a_predicate_names_the_particles(dimx in 8usize..30, dimy in 8usize..30, radius in 2.5f32..4.0) {
        let grid = Grid::new(dimx, dimy, SPACING_M).unwrap();
        let inside = |ix: usize, iy: usize| {
            let [x, y] = [ix as f32 - 3.5, iy as f32 - 2.5];
            x.abs().max(y.abs()) <= radius && x * x + y * y <= radius * radius * 1.6
        };
        let mask = Mask::from_fn(grid, inside).unwrap();
        for index in 0..grid.particle_count() {
            prop_assert_eq!(mask.has(index), inside(index % dimx, index / dimx));
        }
    }
}
