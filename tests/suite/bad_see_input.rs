//! Pictures and arguments that `fabc see` refuses: one message, with the given value and what would be right.

use super::bad_input::refused;
use super::see::{FOLDING, SIDE_PX, write_depth};
use super::support::{fabc, finish, project};
use image::{Rgb, RgbImage};
use serde_json::Value;
use std::fs;

#[test]
fn pictures_that_show_no_cloth_say_what_they_show() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    RgbImage::from_pixel(SIDE_PX, SIDE_PX, Rgb([9; 3]))
        .save(file("a.png"))
        .unwrap();
    let task = project(FOLDING);
    let all = "50176";
    let cases: [(u8, u8, &[&str]); 4] = [
        (
            165,
            165,
            &[
                "`cloth`",
                "out of view",
                all,
                "647.1 to 647.1 mm",
                "646.0 mm",
            ],
        ),
        (0, 165, &["`cloth`", "out of view", "647.1", "646.0 mm"]),
        (0, 0, &["`cloth`", "no reading"]),
        (
            90,
            90,
            &["`corners`", "50176 of its 50176 pixels", "background"],
        ),
    ];
    for (cloth, table, words) in cases {
        write_depth(&file("depth.png"), cloth, table);
        let arguments = ["see", &task, "--variant", "by_depth", "--image", "a.png"];
        let given = ["--depth", "depth.png", "--out", "out"];
        refused(folder.path(), &[&arguments[..], &given].concat(), 2, words);
        assert!(!file("out").exists(), "half-written");
    }
    let black = RgbImage::new(128, 128);
    black.save(file("black.png")).unwrap();
    let words = [
        "`cloth`",
        "of 16384 pixels 16384 have its hue",
        "0 its value (0.001 to 1)",
    ];
    refused(
        folder.path(),
        &["see", &task, "--image", "black.png"],
        2,
        &words,
    );
}

#[test]
fn pictures_that_do_not_fit_say_what_would() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    RgbImage::new(SIDE_PX, SIDE_PX).save(file("a.png")).unwrap();
    RgbImage::new(640, 480).save(file("large.png")).unwrap();
    write_depth::<u8>(&file("depth.png"), 164, 165);
    fs::write(file("text.png"), "no picture").unwrap();
    fs::create_dir(file("folder.png")).unwrap();
    let task = project(FOLDING);
    let both = [
        "640 x 480 px",
        "the depth picture 224 x 224",
        "in one shape",
    ];
    let steered = project("tests/fixtures/tasks/steered.fab");
    let cases: [(&[&str], i32, &[&str]); 10] = [
        (&["--image", "a.png"], 64, &["`cloth`", "`--depth PNG`"]),
        (&["--image", "large.png", "--depth", "depth.png"], 2, &both),
        (
            &["--image", "a.png", "--depth", "large.png"],
            2,
            &["`large.png`", "Rgb8", "grey"],
        ),
        (&["--image", "text.png"], 2, &["`text.png`", "PNG or JPEG"]),
        (
            &["--image", "folder.png"],
            2,
            &["`folder.png`", "directory"],
        ),
        (&["--image", "none.png"], 2, &["`none.png`"]),
        (
            &["--image", "a.png", "--depth", "text.png"],
            2,
            &["`text.png`", "PNG"],
        ),
        (&[], 64, &["--image"]),
        (
            &["--image", "a.png", "--last-place", "12"],
            64,
            &["`120,64`"],
        ),
        (
            &["--image", "a.png", "--last-place", "1,99999999999"],
            64,
            &["`120,64`"],
        ),
    ];
    for (arguments, code, words) in cases {
        let task = ["see", &task, "--variant", "by_depth"];
        refused(folder.path(), &[&task, arguments].concat(), code, words);
    }
    let said = finish(fabc(folder.path()).args(["see", &steered, "--image", "text.png", "--json"]));
    let json: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(json["exit"], 2, "{json}");
}

#[test]
fn a_layer_that_shows_the_last_pick_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(project(FOLDING)).unwrap();
    let layer = "annotate { way = arrow(last.pick, last.place, color: red) }\n    actions";
    let text = text
        .replacen("actions", layer, 1)
        .replacen(
            "model text\n",
            "model vision\n        show  scene with annotations\n",
            1,
        )
        .replacen("say   \"", "say   way_words, \"", 1)
        .replacen(
            "stage act",
            "component way_words when last \"Avoid the {{ way }}.\"\n\n    stage act",
            1,
        );
    fs::write(folder.path().join("way.fab"), text).unwrap();
    let mut square = RgbImage::new(128, 128);
    (40..80)
        .for_each(|row| (40..80).for_each(|column| square.put_pixel(column, row, Rgb([64; 3]))));
    square.save(folder.path().join("a.png")).unwrap();
    let arguments = ["see", "way.fab", "--image", "a.png", "--last-place"];
    let said = finish(fabc(folder.path()).args(arguments).args(["100,-5"]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    let told = "note: `way` shows the action before this one";
    assert!(said.stderr.contains(told), "{}", said.stderr);
}
