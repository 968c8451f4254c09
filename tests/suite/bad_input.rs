//! Bad input: one clear message, the documented exit code, no partial output.

use super::support::{Captured, bring_library, fabc, finish};
use std::fs;
use std::path::Path;

/// A complete task on a cloth of 8 by 8 particles, based on the shipped library.
pub(super) fn write_task(folder: &Path, subgoals: &str) {
    bring_library(folder);
    let text = format!(
        "use \"lib/folding.fab\"\ntask small extends folding {{\n    cloth grid(8, 8)\n    subgoals {{\n{subgoals}\n    }}\n}}\n"
    );
    fs::write(folder.join("small.fab"), text).unwrap();
}

pub(super) fn demonstrated(folder: &Path) {
    write_task(
        folder,
        "demonstrate { fold corner(back_left) -> corner(front_right) }",
    );
}

/// Runs the command, and checks the code, that every expected word occurs once, and that it is one message.
pub(super) fn refused(folder: &Path, arguments: &[&str], code: i32, words: &[&str]) -> Captured {
    let said = finish(fabc(folder).args(arguments));
    assert_eq!(
        said.code, code,
        "{arguments:?}\n{}{}",
        said.stdout, said.stderr
    );
    for word in words {
        assert!(
            said.stderr.contains(word),
            "{arguments:?} does not say `{word}`:\n{}",
            said.stderr
        );
    }
    assert!(!said.stderr.contains("panicked"), "{}", said.stderr);
    assert_eq!(
        said.stderr
            .lines()
            .filter(|line| line.starts_with("error"))
            .count(),
        1,
        "not one message:\n{}",
        said.stderr
    );
    said
}

/// Returns whether no run folder is left, not even an empty one.
pub(super) fn no_run_in(folder: &Path) -> bool {
    fs::read_dir(folder.join("runs")).map_or(true, |mut entries| entries.next().is_none())
}

#[test]
fn a_missing_file() {
    let folder = tempfile::tempdir().unwrap();
    for verb in ["check", "render", "subgoals", "run"] {
        refused(folder.path(), &[verb, "nowhere.fab"], 2, &["`nowhere.fab`"]);
    }
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        0,
        "a refused call left something behind"
    );
}

#[test]
fn a_directory() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("tasks.fab")).unwrap();
    refused(
        folder.path(),
        &["run", "tasks.fab"],
        2,
        &["`tasks.fab`", "directory"],
    );
}

#[test]
fn a_file_that_is_not_text() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("task.fab"), [b't', b'a', 0xff, 0xfe]).unwrap();
    refused(
        folder.path(),
        &["run", "task.fab"],
        2,
        &["`task.fab`", "UTF-8", "byte 2"],
    );
}

#[test]
fn a_file_that_is_enormous() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("task.fab"), "# fold\n".repeat(300_000)).unwrap();
    let said = finish(fabc(folder.path()).args(["check", "task.fab"]));
    assert_eq!(said.code, 1);
    assert!(said.stdout.contains("F0001"), "{}", said.stdout);
    fs::write(folder.path().join("task.fab"), "# fold\n".repeat(700_000)).unwrap();
    refused(
        folder.path(),
        &["check", "task.fab"],
        2,
        &["longer than the limit of 4194304 bytes"],
    );
}

#[test]
fn an_empty_file() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("task.fab"), "").unwrap();
    refused(folder.path(), &["run", "task.fab"], 1, &["no task"]);
}

#[test]
fn an_unknown_model_task_stage_or_step() {
    let folder = tempfile::tempdir().unwrap();
    demonstrated(folder.path());
    refused(
        folder.path(),
        &["run", "small.fab", "--model", "gpt"],
        64,
        &["`gpt`", "`geometric`"],
    );
    refused(
        folder.path(),
        &["run", "small.fab", "--task", "large"],
        64,
        &["`large`", "`small`"],
    );
    refused(
        folder.path(),
        &["render", "small.fab", "--stage", "dream"],
        64,
        &["`dream`", "`describe`", "`plan`"],
    );
    refused(
        folder.path(),
        &["render", "small.fab", "--step", "9"],
        64,
        &["step 9"],
    );
    assert!(no_run_in(folder.path()), "a refused call made a run folder");
}

#[test]
fn a_subgoal_picture_that_is_none_or_enormous() {
    let folder = tempfile::tempdir().unwrap();
    // The task is not in the working folder: its pictures are beside the task.
    let here = &folder.path().join("tasks");
    fs::create_dir(here).unwrap();
    write_task(
        here,
        "image \"a.png\" arrow (10px, 10px) -> (90px, 90px)\nimage \"b.png\"",
    );
    refused(folder.path(), &["run", "tasks/small.fab"], 2, &["a.png"]);
    fs::write(here.join("a.png"), "no picture").unwrap();
    refused(
        folder.path(),
        &["run", "tasks/small.fab"],
        2,
        &["a.png", "not a readable picture in PNG or JPEG"],
    );
    fs::write(here.join("a.png"), png_header(60_000, 60_000)).unwrap();
    refused(
        folder.path(),
        &["run", "tasks/small.fab"],
        2,
        &["60000 by 60000 pixels", "8192"],
    );
    let good = fab_picture::png::encode(&image::RgbImage::new(224, 224));
    fs::write(here.join("a.png"), &good).unwrap();
    fs::write(here.join("b.png"), &good[..good.len() / 2]).unwrap();
    refused(folder.path(), &["run", "tasks/small.fab"], 2, &["b.png"]);
    assert!(
        no_run_in(folder.path()),
        "a refused picture made a run folder"
    );
}

/// The first bytes of a PNG file that announces a size.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut chunk = b"IHDR".to_vec();
    chunk.extend(width.to_be_bytes());
    chunk.extend(height.to_be_bytes());
    chunk.extend([8, 2, 0, 0, 0]);
    let mut bytes = b"\x89PNG\r\n\x1a\n\x00\x00\x00\x0d".to_vec();
    bytes.extend(&chunk);
    bytes.extend(crc32(&chunk).to_be_bytes());
    bytes.extend(b"\x00\x00\x00\x00IDAT\x35\xaf\x06\x1e");
    bytes
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            if crc & 1 == 1 {
                (crc >> 1) ^ 0xedb8_8320
            } else {
                crc >> 1
            }
        })
    })
}

#[test]
fn a_run_folder_that_cannot_be_written() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    demonstrated(here);
    fs::write(here.join("taken"), "a file").unwrap();
    refused(
        here,
        &["run", "small.fab", "--out", "taken"],
        2,
        &["`taken`"],
    );
    refused(
        here,
        &["run", "small.fab", "--out", "taken/run"],
        2,
        &["taken/run"],
    );
    fs::create_dir(here.join("full")).unwrap();
    fs::write(here.join("full/mine.txt"), "mine").unwrap();
    refused(
        here,
        &["run", "small.fab", "--out", "full"],
        2,
        &["`full`", "not empty"],
    );
    refused(
        here,
        &["run", "small.fab", "--out", "/proc/fabc-run"],
        2,
        &["/proc/fabc-run"],
    );
}

#[test]
fn a_task_that_is_wrong_is_not_run() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("task.fab"),
        "task tiny extends nothing {\n    cloth grid(5, 5)\n}\n",
    )
    .unwrap();
    let said = finish(fabc(folder.path()).args(["run", "task.fab"]));
    assert_eq!(said.code, 1);
    assert!(
        said.stderr.contains("task.fab:1:19") && said.stderr.contains("`nothing`"),
        "{}",
        said.stderr
    );
    assert!(no_run_in(folder.path()));
}

#[test]
fn a_closed_pipe_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    demonstrated(folder.path());
    let mut child = fabc(folder.path())
        .args(["render", "small.fab"])
        .process()
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}
