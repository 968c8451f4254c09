//! Snapshot folders made by hand, line by line, so that they do not depend on who writes them.

use image::{Rgb, RgbImage};
use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::Path;

/// A prompt text of three components, in the file format; the two lines of one component can vary.
pub fn prompt(task: &str, dots: &str, tokens: u32) -> String {
    format!(
        "\
---
source: {task}.fab
description: what `{task}` asks
info:
  task: {task}
  stage: describe
  scene: start
  tokens: {tokens}
  origin:
    - 1-1 describe.say {task}.fab:12
    - 2-3 visual_context lib/folding.fab:28
    - 4-4 frame
---
You fold a cloth in the task {task}.
{dots}
Arrows show the next fold.
Answer with a pick and a place.
"
    )
}

/// A pinned scene in the file format: what was seen, and its points.
pub fn scene(seen_of: &str, center: &str, corners: &str) -> String {
    format!(
        "\
---
source: half.fab
info:
  task: half
  scene: start
---
{{
  \"seen_of\": \"{seen_of}\",
  \"start\": null,
  \"step\": 1,
  \"last\": null,
  \"points\": {{
    \"center\": {center},
    \"corners\": {corners}
  }},
  \"areas\": {{
    \"cloth\": 900.0
  }}
}}
"
    )
}

/// Writes an accepted snapshot.
pub fn accepted(folder: &Path, name: &str, text: &str) {
    write(folder, &format!("{name}.snap"), text.as_bytes());
}

/// Writes a pending snapshot.
pub fn pending(folder: &Path, name: &str, text: &str) {
    write(folder, &format!("{name}.snap.new"), text.as_bytes());
}

/// Writes a file and creates its folder.
pub fn write(folder: &Path, name: &str, bytes: &[u8]) {
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join(name), bytes).unwrap();
}

/// Writes the prompts of many tasks that one edit changes.
pub fn one_edit(folder: &Path, n_tasks: usize) {
    for number in 1..=n_tasks {
        let task = format!("fold_{number:02}");
        let name = format!("{task}.describe@start");
        accepted(
            folder,
            &name,
            &prompt(&task, "The red dots are corners.", 810),
        );
        pending(
            folder,
            &name,
            &prompt(&task, "The blue dots are corners.", 812),
        );
    }
}

/// Writes one of each kind: an edit of two snapshots, a scene, a picture, new snapshots, and one of another tool.
pub fn each_kind(folder: &Path) {
    one_edit(folder, 2);
    accepted(
        folder,
        "half@start.points",
        &scene("0a", "[[30,40]]", "[[30,40],[30,90]]"),
    );
    pending(
        folder,
        "half@start.points",
        &scene("0b", "[[31,40]]", "[[30,40]]"),
    );
    let picture = |drawn_from: &str| {
        format!(
            "---\nsource: half.fab\ninfo:\n  task: half\n  scene: start\n  picture: subgoal 1 with arrow\n  drawn_from: {drawn_from}\nextension: png\nsnapshot_kind: binary\n---\n"
        )
    };
    accepted(folder, "half@start.subgoal_1", &picture("0c"));
    write(folder, "half@start.subgoal_1.snap.png", &png(24, 16, None));
    pending(folder, "half@start.subgoal_1", &picture("0d"));
    write(
        folder,
        "half@start.subgoal_1.snap.new.png",
        &png(24, 20, Some([5, 3])),
    );
    pending(folder, "half.describe@start", &prompt("half", "Dots.", 700));
    pending(folder, "half.act@start", &prompt("half", "More dots.", 90));
    pending(
        folder,
        "crate__theirs",
        "---\nsource: a.rs\nexpression: x\n---\nx\n",
    );
}

/// Returns a grey PNG file, with an optional red square of four pixels.
pub fn png(width: u32, height: u32, square: Option<[u32; 2]>) -> Vec<u8> {
    let mut picture = RgbImage::from_pixel(width, height, Rgb([90; 3]));
    if let Some([left, top]) = square {
        for (column, row) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            picture.put_pixel(left + column, top + row, Rgb([255, 0, 0]));
        }
    }
    let mut bytes = Vec::new();
    picture
        .write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png)
        .unwrap();
    bytes
}

/// Returns the files of a folder by name.
pub fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries
        .filter(|entry| entry.path().is_file())
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            (name, fs::read(entry.path()).unwrap())
        })
        .collect()
}

/// Returns the names of a folder's pending snapshots.
pub fn left(folder: &Path) -> Vec<String> {
    let names = files(folder).into_keys();
    names
        .filter_map(|name| name.strip_suffix(".snap.new").map(str::to_owned))
        .collect()
}
