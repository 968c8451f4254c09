//! `fabc run --video` and `fabc sim record` through the command itself, decoded again.

use super::sim_verbs::{MATERIAL, told};
use super::support::{Captured, bring_library, bring_robot, fabc, finish};
use image::{Rgb, RgbImage};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Two folds of a small cloth.
const TASK: &str = r#"
use "lib/folding.fab"

task small extends folding {
    cloth grid(25, 25)
    subgoals {
        demonstrate {
            fold corner(back_left) -> corner(front_right)
            fold corner(back_right) -> center
        }
    }
}
"#;

/// A folder with the task and the settings of an arm.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    bring_robot(folder.path(), &[]);
    fs::write(folder.path().join("small.fab"), TASK).unwrap();
    folder
}

fn said(folder: &Path, call: &str) -> Captured {
    finish(fabc(folder).args(call.split(' ')))
}

/// A decoded video: how long each picture is shown, hundredths of a second, and the last picture.
struct Decoded {
    delays_cs: Vec<u64>,
    last: RgbImage,
}

fn decoded(path: &Path) -> Decoded {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(fs::File::open(path).unwrap()).unwrap();
    let size = [decoder.width(), decoder.height()].map(u32::from);
    let mut last = RgbImage::new(size[0], size[1]);
    let mut delays_cs = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        delays_cs.push(u64::from(frame.delay));
        let width = usize::from(frame.width);
        for (number, pixel) in frame
            .buffer
            .chunks(4)
            .enumerate()
            .filter(|(_, it)| it[3] > 0)
        {
            let column = u32::from(frame.left) + (number % width) as u32;
            let row = u32::from(frame.top) + (number / width) as u32;
            last.put_pixel(column, row, Rgb([pixel[0], pixel[1], pixel[2]]));
        }
    }
    Decoded { delays_cs, last }
}

/// Checks a decoded video against what the JSON says of it.
fn check(video: &Value, decoded: &Decoded, path: &Path) {
    assert_eq!(video["pictures"], decoded.delays_cs.len(), "{video}");
    let shown_cs: u64 = decoded.delays_cs.iter().sum();
    assert_eq!(video["shown_s"], shown_cs as f64 / 100.0, "{video}");
    assert_eq!(video["bytes"], fs::metadata(path).unwrap().len(), "{video}");
    assert_eq!(video["left_out"], 0, "{video}");
}

#[test]
fn a_runs_video_decodes_ends_with_the_final_picture_and_is_the_same_again() {
    let folder = folder();
    let here = folder.path();
    let run = |call: &str| -> Value {
        let said = said(
            here,
            &format!("run small.fab --policy expert --json {call}"),
        );
        assert!([0, 3].contains(&said.code), "{}", said.stderr);
        serde_json::from_str(&said.stdout).unwrap()
    };
    let report = run("--out a --video");
    let path = here.join("a/video.gif");
    let film = decoded(&path);
    check(&report["video"], &film, &path);
    assert_eq!(report["video"]["file"], "a/video.gif");
    // Both folds are shown: 12.5 pictures a second while something moves.
    let count = film.delays_cs.len();
    assert!((40..130).contains(&count), "{count}");
    assert!(film.delays_cs.iter().filter(|&&delay| delay == 8).count() > count / 2);

    // With a file of its own: the same film.
    let again = run("--out b --video fold.gif");
    assert!(!here.join("b/video.gif").exists());
    assert_eq!(
        fs::read(path).unwrap(),
        fs::read(here.join("fold.gif")).unwrap()
    );

    // A run that is not filmed says nothing of a video, and no run leaves a half-written file.
    let plain = run("--out d");
    assert_eq!(plain.get("video"), None);
    let digest = |report: &Value| report["mean_particle_distance_mm"].clone();
    assert_eq!(digest(&plain), digest(&again));
    for run in ["a", "d"] {
        let names = fs::read_dir(here.join(run))
            .unwrap()
            .map(|it| it.unwrap().file_name());
        assert!(
            names
                .into_iter()
                .all(|name| !name.to_string_lossy().ends_with(".part"))
        );
    }
    let begun = |run: &str| fs::read_to_string(here.join(run).join("run.json")).unwrap();
    assert!(!begun("d").contains("video") && begun("b").contains(r#""video": "fold.gif""#));
}

#[test]
fn videos_that_cannot_be_are_refused_before_anything_happens() {
    let folder = folder();
    let robot = "--world arm --robot robot.toml";
    let cases = [
        (
            format!("run small.fab --video {robot}"),
            64,
            "`--world arm` has none",
        ),
        (
            "run small.fab --video --world exec:nothing".to_owned(),
            64,
            "`--world exec:nothing` has none; use `--world sim`",
        ),
        (
            "run small.fab --video fold.mp4".to_owned(),
            64,
            "`--video fold.mp4` is no GIF file; name one that ends in `.gif`",
        ),
        (
            "run small.fab --video absent/fold.gif".to_owned(),
            2,
            "cannot write `absent/fold.gif`: there is no folder `absent`",
        ),
        ("sim record -o a.gif".to_owned(), 64, "--move <X,Y:X,Y>"),
        (
            "sim record --move 0,0 -o a.gif".to_owned(),
            64,
            "such as `-0.12,0.12:0.1,-0.1`",
        ),
        (
            "sim record --move 0:0,0,0 -o a.gif".to_owned(),
            64,
            "write the pick and the place in metres",
        ),
        (
            "sim record --move 0,0:inf,0 -o a.gif".to_owned(),
            64,
            "write the pick and the place in metres",
        ),
        (
            "sim record --move 0,0:9,0 -o a.gif".to_owned(),
            2,
            "motion 1: ",
        ),
        (
            "sim record --move 0,0:0,0 -o a.png".to_owned(),
            64,
            "`--out a.png` is no GIF file",
        ),
        (
            "sim record --material coton --move 0,0:0,0 -o a.gif".to_owned(),
            64,
            "there is no material `coton`; did you mean `cotton`",
        ),
    ];
    let files = || fs::read_dir(folder.path()).unwrap().count();
    let before = files();
    for (call, code, message) in cases {
        let said = said(folder.path(), &call);
        assert_eq!(said.code, code, "{call}\n{}", said.stderr);
        assert!(said.stderr.contains(message), "{call}\n{}", said.stderr);
        assert_eq!(files(), before, "{call}");
    }
}

#[test]
fn given_picks_are_filmed_without_a_model() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let moves = "--size 24 --move -0.07,0.07:0.05,-0.05 --move 0.2,0.2:0.2,0.25";
    let call = format!("record {moves} -o fold.gif");
    let value = told(here, &call.split(' ').collect::<Vec<_>>());
    let path = here.join("fold.gif");
    check(&value["video"], &decoded(&path), &path);
    let grasped: Vec<_> = (0..2)
        .map(|it| value["moves"][it]["grasped"].clone())
        .collect();
    assert_eq!(grasped, [Value::from(0), Value::Null]);
    let said = said(here, &format!("sim {call}"));
    assert_eq!(said.code, 0);
    assert_eq!(said.stderr, "note: motion 2 grasped nothing\n");
    assert!(
        said.stdout.starts_with("video: fold.gif ("),
        "{}",
        said.stdout
    );
    assert_eq!(decoded(&path).last.dimensions(), (384, 288));
}

#[test]
#[cfg(target_os = "linux")]
fn after_an_interrupt_the_film_is_whole_up_to_there() {
    let folder = tempfile::tempdir().unwrap();
    let moves = " --move 0.1,0.1:-0.1,-0.1".repeat(20);
    let call = format!("sim record -o fold.gif{moves}");
    let mut command = fabc(folder.path());
    command.args(call.split(' '));
    let mut session = super::pty::Session::in_window(&command.process());
    session.until("motion 2");
    session.send("\u{3}");
    let (code, shown) = session.end();
    assert_eq!(code, Some(130), "{shown}");
    assert!(shown.contains("video: fold.gif ("), "{shown}");
    assert!(decoded(&folder.path().join("fold.gif")).delays_cs.len() > 10);
}

#[test]
fn a_film_shows_the_cloth_in_the_colours_of_its_material() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let film = |call: &str| {
        let call = format!("sim record --size 8 --move 0.2,0.2:0.2,0.25 --json -o {call}");
        let said = said(here, &call);
        assert_eq!(said.code, 0, "{}", said.stderr);
        let value: Value = serde_json::from_str(&said.stdout).unwrap();
        let file = value["video"]["file"].as_str().unwrap().to_owned();
        (value["params"].clone(), decoded(&here.join(file)).last)
    };
    // How much of the picture is nearer than this to a colour, in each channel.
    let near = |picture: &RgbImage, colour: [u8; 3]| {
        let is_near = |pixel: &&Rgb<u8>| (0..3).all(|it| pixel.0[it].abs_diff(colour[it]) < 12);
        picture.pixels().filter(is_near).count()
    };
    fs::write(here.join("own.fab"), MATERIAL).unwrap();
    let orange = fab_sim::Look::default().top;
    for (call, colour) in [
        ("plain.gif", orange),
        ("silk.gif --material silk", [0xb3, 0x20, 0x2c]),
        ("own.gif --material own.fab:mine", [0x20, 0xc0, 0x40]),
    ] {
        let (params, last) = film(call);
        assert!(near(&last, colour) > 100, "{call}");
        let is_plain = colour == orange;
        assert_eq!(near(&last, orange) > 100, is_plain, "{call}");
        assert_eq!(
            params == fab_sim::Params::default().hash(),
            is_plain,
            "{call}"
        );
    }
}
