//! Finds the keypoints of every file in `tests/`, and compares them with the file's expectations.
//!
//! New files are picked up automatically. A file's three parts are separated by lines of `---`: the lines of `keypoints
//! { … }`; the picture, one character per pixel; and the expected result, `NAME: JSON` per line, or `fails: MESSAGE`.
#![allow(clippy::unwrap_used)]

use super::Scene;
use fab_compiler::{LoadError, Loader};
use fab_picture::observation::Observation;
use fab_program::Program;
use image::{Rgb, RgbImage};
use std::fs;
use std::path::Path;

struct Text(String);

impl Loader for Text {
    fn load(&self, _: &str) -> Result<String, LoadError> {
        Ok(self.0.clone())
    }
}

/// Compiles a task with these keypoints, for pictures of this side.
fn program(keypoints: &str, side_px: usize) -> Program {
    let text = format!(
        r#"task tried {{
    cloth   square(100mm)
    camera  top_down(height: 300mm, fov: 45deg, image: {side_px}px)
    horizon 1
    keypoints {{
{keypoints}
        offered = points((1px, 1px), (2px, 2px))
    }}
    actions {{
        pick:  one of offered
        place: one of offered
    }}
    stage act {{
        model vision
        show  scene
        say   "{{{{ actions.format }}}}"
        read  action
    }}
}}
"#
    );
    let mut compiled = fab_compiler::compile("tried.fab", &Text(text)).unwrap();
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    compiled.programs.remove(0)
}

/// Paints `o` orange, `b` blue and `.` grey.
fn picture(rows: &[&str]) -> RgbImage {
    RgbImage::from_fn(
        rows.len() as u32,
        rows.len() as u32,
        |column, row| match rows[row as usize].as_bytes()[column as usize] {
            b'o' => Rgb([255, 128, 0]),
            b'b' => Rgb([0, 0, 255]),
            b'.' => Rgb([128, 128, 128]),
            other => panic!("no colour `{}`", char::from(other)),
        },
    )
}

#[test]
fn extractors_find_what_each_file_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/scene/tests");
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    assert!(!files.is_empty());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let parts: Vec<&str> = text.split("---\n").collect();
        let [keypoints, rows, expected] = parts[..] else {
            panic!("{}: three parts", file.display())
        };
        let rows: Vec<&str> = rows.lines().collect();
        let program = program(keypoints, rows.len());
        let observation = Observation::of_picture(&program.camera, picture(&rows), None).unwrap();
        let found = match Scene::of(&program, &observation, None) {
            Ok(scene) => {
                let found = scene.to_json();
                let names = expected
                    .lines()
                    .map(|line| line.split(": ").next().unwrap());
                names
                    .map(|name| format!("{name}: {}\n", found[name]))
                    .collect()
            }
            Err(error) => format!("fails: {error}\n"),
        };
        assert_eq!(found, expected, "{}", file.display());
    }
}
