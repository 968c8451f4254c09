//! Tests of points as lines: in a file, and typed one after the other.

use super::*;
use fab_picture::Tag;
use proptest::prelude::*;

#[test]
fn files_with_and_without_names_are_read() {
    let wanted = [
        Pair {
            pixel: [10.5, 20.5],
            base_m: [0.3, -0.1, 0.02],
            tag: None,
        },
        Pair {
            pixel: [30.0, 40.0],
            base_m: [0.4, 0.1, 0.02],
            tag: None,
        },
    ];
    for text in [
        "10.5,20.5,0.3,-0.1,0.02\n30,40,0.4,0.1,0.02\n",
        "# a table\n\nu,v,x,y,z\n10.5, 20.5, 0.3, -0.1, 0.02  # first\n30,40,0.4,0.1,0.02",
        "10.5 20.5 0.3 -0.1 0.02\r\n30 40 0.4 0.1 0.02\r\n",
        "\"u\",\"v\",\"x\",\"y\",\"z\"\r\n\"10.5\",\"20.5\",\"0.3\",\"-0.1\",\"0.02\"\r\n30,40,0.4,0.1,0.02\r\n",
        "u;v;x;y;z\n10,5;20,5;0,3;-0,1;0,02\n\n30;40;0,4;0,1;0,02\n;;;;\n",
        "\"10,5\",\"20,5\",\"0,3\",\"-0,1\",\"0,02\"\n30,40,0.4,0.1,0.02\n",
        ",u,v,x,y,z\n0,10.5,20.5,0.3,-0.1,0.02\n1,30,40,0.4,0.1,0.02\n",
        "\tu\tv\tx\ty\tz\n0\t10.5\t20.5\t0.3\t-0.1\t0.02\n1\t30\t40\t0.4\t0.1\t0.02",
        ";u;v;x_mm;y_mm;z_mm\na;10,5;20,5;300;-100;20\nb;30;40;400;100;20",
        "u,v,x,y,z,,\n10.5,20.5,0.3,-0.1,0.02,,\n,,,,,,\n30,40,0.4,0.1,0.02,,\n",
        "X_m,Y_mm,z,u_px,v\n0.3,-100,0.02,10.5,20.5\n0.4,100,0.02,30,40",
    ] {
        assert_eq!(parse_pairs(text, Ok(&[])).unwrap(), wanted, "{text}");
    }
    assert_eq!(parse_pairs("# none\n", Ok(&[])).unwrap(), []);
}

#[test]
fn a_wrong_line_is_named() {
    let many = "1,2,3,4,5\n".repeat(MAX_PAIRS + 1);
    for (text, wanted) in [
        ("1,2,3,4\n", "line 1: 4 numbers; a point is `u,v,x,y,z`"),
        (
            "1,2,3,4,5,6\n",
            "line 1: 6 numbers, and there are 5 columns",
        ),
        (
            "1,2,0.3,0.4,0.5\n1,2,0.3,x,0.5\n",
            "line 2: `x` is not a number",
        ),
        ("1,2,0.3,,0.5\n", "line 1: `` is not a number"),
        ("1,2,nan,3,4\n", "line 1: `nan` is not a column"),
        ("1,2,3,inf,4\n", "line 1: `inf` is not a number"),
        ("u,v,x,y\n", "line 1: the column `z` is missing"),
        ("u,v,x,y,z,u\n", "line 1: the column `u` is there twice"),
        ("u,v,x_km,y,z\n", "line 1: `x_km` is not a column"),
        ("u,v,x,y,z,depth\n", "line 1: `depth` is not a column"),
        (
            "u,v,x,y,z\n120,5,20,5,0.3,1,1\n",
            "line 2: 7 numbers, and there are 5 columns",
        ),
        (&many, "line 401: there are more than 400 points"),
    ] {
        let error = parse_pairs(text, Ok(&[]))
            .map(|_| ())
            .unwrap_err()
            .to_string();
        let is_named = error.starts_with(wanted)
            || text.contains("nan") && error.contains("`nan` is not a number");
        assert!(is_named, "{error}");
    }
}

proptest! {
    #[test]
    fn a_line_leads_back_to_its_point(
        pixel in prop::array::uniform2(-1e6..1e6_f64),
        base_m in prop::array::uniform3(-3.0..3.0_f64),
    ) {
        let pair = Pair { pixel, base_m, tag: None };
        prop_assert_eq!(parse_pairs(&csv_line(&pair), Ok(&[])).unwrap(), [pair]);
    }

    #[test]
    fn no_text_brings_it_down(text in "(tag|[0-9a-z,;\t\". #:\r\n\\-]){0,80}") {
        let _ = parse_pairs(&text, Ok(&[TAG]));
    }
}

#[test]
fn a_slip_shows_while_typing() {
    let terms = terms();
    let grid = Truth::usual().grid(4, 0.8);
    let mut session = Session::new(&terms, Vec::new(), Ok(&[]), None);
    for pair in &grid[..6] {
        assert!(matches!(
            session.line(&csv_line(pair)),
            LineOutcome::Added(_)
        ));
    }
    let LineOutcome::Added(said) = session.line(&csv_line(&grid[6])) else {
        panic!("a point")
    };
    assert_eq!(
        said,
        "point 7: 0.0 mm from where the 6 before it put it (`undo` removes it)"
    );
    let mut wrong = grid[7];
    wrong.base_m[0] += 0.05;
    let LineOutcome::Added(said) = session.line(&csv_line(&wrong)) else {
        panic!("a point")
    };
    assert_eq!(
        said,
        "point 8: 50.0 mm from where the 7 before it put it (`undo` removes it)"
    );
    assert_eq!(
        session.line("undo"),
        LineOutcome::Undone("point 8 is taken back".to_owned())
    );
    assert_eq!(session.pairs(), &grid[..7]);
    for (line, wanted) in [
        ("1,2,3", "3 numbers; a point is"),
        (
            "700,2,0.3,0.1,0",
            "point 8 is at the pixel 700.0, 2.0, outside of the picture",
        ),
        ("70,2,300,100,0", "positions are metres"),
        ("help", "`help` is not a number"),
    ] {
        let said = session.line(line);
        assert!(
            matches!(&said, LineOutcome::Invalid(why) if why.contains(wanted)),
            "{said:?}"
        );
    }
    assert_eq!(session.line(" "), LineOutcome::Unchanged(String::new()));
    assert!(
        matches!(session.line("list"), LineOutcome::Unchanged(list) if list.lines().count() == 7)
    );
    assert_eq!(session.line("done"), LineOutcome::Finished);
    assert_eq!(session.pairs().len(), 7);
}

#[test]
fn an_arm_says_where_its_tool_is() {
    let terms = terms();
    let grid = Truth::usual().grid(4, 0.8);
    let mut places = vec![
        Err("the arm said nothing for 2 s".to_owned()),
        Ok(grid[0].base_m),
    ];
    let tool = move || places.pop().unwrap();
    let mut session = Session::new(&terms, Vec::new(), Ok(&[]), Some(Box::new(tool)));
    let [u, v] = grid[0].pixel;
    assert!(
        matches!(session.line("1,2,3,4,5"), LineOutcome::Invalid(why) if why.contains("a point is typed as `u,v`"))
    );
    assert!(matches!(
        session.line(&format!("{u},{v}")),
        LineOutcome::Added(_)
    ));
    assert_eq!(session.pairs(), [grid[0]]);
    assert_eq!(
        session.line(&format!("{u},{v}")),
        LineOutcome::Invalid("the arm said nothing for 2 s".to_owned())
    );
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
    assert_eq!([pairs[0].tag, pairs[1].tag], [Some(TagName(7)), None]);
    assert_eq!(csv_line(&pairs[0]), "200.5,133.25,0.3,0.1,0.02 # tag7");
    assert_eq!(
        parse_pairs("tag7 0.3 0.1 0.02", Ok(&seen)).unwrap(),
        pairs[..1]
    );
    for (text, words) in [
        (
            "tag9,0.3,0.1,0.02",
            "does not show `tag9`; it shows tag7, tag8, tag8",
        ),
        ("tag8,0.3,0.1,0.02", "the picture shows `tag8` twice"),
        (
            "tag7:top,0.3,0.1,0.02",
            "`tag7:top` is not a tag; write one such as `tag7`",
        ),
        ("tag,0.3,0.1,0.02", "`tag` is not a tag"),
        ("tag-1,0.3,0.1,0.02", "`tag-1` is not a tag"),
        (
            "0.3,tag7,0.1,0.02",
            "stands in place of the columns `u` and `v`",
        ),
        ("tag7,0.3,0.1", "4 numbers; a point is"),
        ("tag7,1,0.3,0.1,0.02", "5 numbers, and there are 5 columns"),
        (
            "v,u,x,y,z\ntag7,0.3,0.1,0.02",
            "stands in place of the columns `u` and `v`",
        ),
    ] {
        let error = parse_pairs(text, Ok(&seen)).expect_err(text).to_string();
        assert!(error.contains(words), "{text}: {error}");
    }
    let error = parse_pairs("tag7,0.3,0.1,0.02", Ok(&[]))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("it shows no tag of the family 36h11"),
        "{error}"
    );
    let terms = terms();
    let tool = || Ok([0.3, 0.1, 0.02]);
    let mut session = Session::new(&terms, Vec::new(), Ok(&seen), Some(Box::new(tool)));
    assert!(matches!(session.line("tag7"), LineOutcome::Added(_)));
    assert_eq!(session.pairs(), &pairs[..1]);
}

#[test]
fn a_grid_lies_in_the_window() {
    assert_eq!(grid(&window(), 1, 1), [[320.0, 240.0]]);
    let pixels = grid(&window(), 4, 3);
    assert_eq!(pixels.len(), 12);
    assert_eq!((pixels[0], pixels[11]), ([128.0, 48.0], [512.0, 432.0]));
}
