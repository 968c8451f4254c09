//! `fabc new fold --from-images`: its drafts run to their goal, and it explains what it cannot draft.

use super::new_tasks::{files, json, said};
use super::support::root;

/// The pinned pictures of a shipped task, in a folder beside the test's working folder.
fn pictures(task: &str, count: usize) -> Vec<String> {
    let folder = root().join(format!("tasks/{task}.subgoals"));
    (0..count)
        .map(|number| folder.join(format!("{number}.png")).display().to_string())
        .collect()
}

#[test]
#[ignore = "long"]
fn a_fold_drafted_from_pictures_says_what_it_guessed_and_runs_to_its_goal() {
    let folder = tempfile::tempdir().unwrap();
    let mut pictures = pictures("house", 3);
    std::fs::create_dir(folder.path().join("mine")).unwrap();
    std::fs::copy(&pictures[1], folder.path().join("mine/after.png")).unwrap();
    pictures[1] = "mine/after.png".to_owned();
    let mut arguments = vec!["new", "fold", "gable", "--json", "--from-images"];
    arguments.extend(pictures.iter().map(String::as_str));
    let begun = said(folder.path(), &arguments);
    assert_eq!((begun.code, begun.stderr.as_str()), (0, ""));
    let written = json(&begun);
    let files = serde_json::json!([
        "gable.fab",
        "lib/folding.fab",
        "gable.images/0.png",
        "gable.images/1.png",
        "gable.images/2.png"
    ]);
    assert_eq!(written["files"], files);
    let guesses = written["guesses"].as_array().unwrap();
    assert_eq!(guesses.len(), 3, "{guesses:?}");
    let second = guesses[2].as_str().unwrap();
    assert!(
        second.contains("`mine/after.png` to ") && second.contains("corner(back_right) -> center"),
        "{second}"
    );

    let text = std::fs::read_to_string(folder.path().join("gable.fab")).unwrap();
    assert!(!text.contains('@'), "{text}");
    for line in [
        "image \"gable.images/0.png\" arrow (41px, 41px) -> (112px, 112px)",
        "image \"gable.images/1.png\" arrow (182px, 41px) -> (112px, 112px)",
        "image \"gable.images/2.png\"\n",
        "sequence { fold corner(back_left) -> center, corner(back_right) -> center }",
    ] {
        assert!(text.contains(line), "no `{line}` in:\n{text}");
    }
    let checked = said(folder.path(), &["check", "gable.fab", "--json"]);
    assert_eq!(json(&checked)["diagnostics"], serde_json::json!([]));
    let tested = said(folder.path(), &["test", "gable.fab"]);
    assert_eq!(tested.code, 0, "{}", tested.stdout);
    let sheet = ["subgoals", "gable.fab", "--sheet", "gable.png"];
    assert_eq!(said(folder.path(), &sheet).code, 0);
    let ended = said(folder.path(), &["run", "gable.fab", "--json"]);
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    assert_eq!(json(&ended)["outcome"], "goal_reached");
}

#[test]
fn pictures_that_nothing_can_be_drafted_from_are_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("words.png"), "no picture").unwrap();
    let [flat, folded] = pictures("house", 2).try_into().unwrap();
    let before = files(folder.path());
    for (pictures, code, told) in [
        (
            vec!["words.png", flat.as_str()],
            2,
            "`words.png` is not a readable picture in PNG or JPEG",
        ),
        (
            vec!["nowhere.png", flat.as_str()],
            2,
            "cannot read `nowhere.png`",
        ),
        (
            vec![flat.as_str()],
            64,
            "1 picture given; there must be 2 to 101",
        ),
        (
            vec![flat.as_str(), flat.as_str()],
            2,
            "shows 100 % of the cloth",
        ),
        (
            vec![folded.as_str(), flat.as_str()],
            2,
            "but a fold must show less",
        ),
    ] {
        let mut arguments = vec!["new", "fold", "gable", "--from-images"];
        arguments.extend(pictures);
        let ended = said(folder.path(), &arguments);
        assert_eq!(ended.code, code, "{}", ended.stderr);
        assert!(ended.stderr.contains(told), "{}", ended.stderr);
        assert_eq!(files(folder.path()), before);
    }
}

#[test]
#[ignore = "long"]
fn drafts_of_shipped_folds_reach_their_goals() {
    for (task, count) in [("double_straight", 4), ("house", 3)] {
        let folder = tempfile::tempdir().unwrap();
        let pictures = pictures(task, count);
        let mut arguments = vec!["new", "fold", "mine", "--from-images"];
        arguments.extend(pictures.iter().map(String::as_str));
        let begun = said(folder.path(), &arguments);
        assert_eq!(begun.code, 0, "{}", begun.stderr);
        let ended = said(folder.path(), &["run", "mine.fab", "--json"]);
        let found = json(&ended);
        assert_eq!(found["outcome"], "goal_reached", "{task}: {}", ended.stdout);
    }
}

#[test]
fn a_picture_in_another_format_is_refused_with_the_command_that_converts_it() {
    let folder = tempfile::tempdir().unwrap();
    let wide = image::RgbImage::from_pixel(64, 16, image::Rgb([200; 3]));
    wide.save(folder.path().join("wide.png")).unwrap();
    std::fs::write(folder.path().join("empty.png"), "").unwrap();
    std::fs::write(folder.path().join("a b.webp"), b"RIFF\0\0\0\0WEBPVP8 ").unwrap();
    std::fs::write(folder.path().join("a.heic"), b"\0\0\0\x18ftypheic\0\0\0\0").unwrap();
    for (name, told) in [
        (
            "a b.webp",
            "`a b.webp` is a WebP picture; PNG and JPEG are read, and ImageMagick converts it: `magick FILE out.png`",
        ),
        ("a.heic", "`a.heic` is a HEIC picture"),
        ("empty.png", "`empty.png` is empty"),
        (
            "wide.png",
            "`wide.png` has 16 x 16 px; it must be a square of 32 to 2048",
        ),
    ] {
        let ended = said(
            folder.path(),
            &["new", "fold", "a", "--from-images", name, name],
        );
        assert_eq!(ended.code, 2, "{}", ended.stderr);
        assert!(ended.stderr.contains(told), "{}", ended.stderr);
    }
}

#[test]
#[ignore = "long"]
fn photographs_of_a_phone_are_cut_and_the_draft_reaches_its_goal() {
    let folder = tempfile::tempdir().unwrap();
    let paths: Vec<String> = (0..3).map(|number| format!("{number}.jpg")).collect();
    for (path, shipped) in paths.iter().zip(pictures("house", 3)) {
        let shipped = image::open(shipped).unwrap().to_rgb8();
        let table = *shipped.get_pixel(0, 0);
        let square =
            image::imageops::resize(&shipped, 960, 960, image::imageops::FilterType::Triangle);
        let mut photograph = image::RgbImage::from_pixel(1280, 960, table);
        image::imageops::replace(&mut photograph, &square, 160, 0);
        photograph.save(folder.path().join(path)).unwrap();
    }
    let mut arguments = vec!["new", "fold", "gable", "--from-images"];
    arguments.extend(paths.iter().map(String::as_str));
    let begun = said(folder.path(), &arguments);
    assert_eq!(begun.code, 0, "{}", begun.stderr);
    let told = "the middle square of each is taken, scaled to 480 x 480 px";
    assert!(begun.stderr.contains(told), "{}", begun.stderr);
    let first = image::open(folder.path().join("gable.images/0.png")).unwrap();
    assert_eq!((first.width(), first.height()), (480, 480));
    let ended = said(folder.path(), &["run", "gable.fab", "--json"]);
    assert_eq!(json(&ended)["outcome"], "goal_reached", "{}", ended.stderr);
}

#[test]
#[ignore = "long"]
fn what_is_stated_of_camera_and_cloth_stands_in_the_file_and_the_task_runs() {
    let folder = tempfile::tempdir().unwrap();
    let pictures = pictures("house", 2);
    let mut arguments = vec!["new", "fold", "big", "--cloth", "50cm", "--from-images"];
    arguments.extend(pictures.iter().map(String::as_str));
    let begun = said(folder.path(), &arguments);
    assert_eq!(begun.code, 0, "{}", begun.stderr);
    let text = std::fs::read_to_string(folder.path().join("big.fab")).unwrap();
    for line in [
        "cloth grid(81, 81)",
        "camera top_down(height: 962mm, fov: 45deg, image: 224px)",
        "cloth = mask(depth < 958mm)",
    ] {
        assert!(text.contains(line), "no `{line}` in:\n{text}");
    }
    let ended = said(folder.path(), &["run", "big.fab", "--json"]);
    assert_eq!(json(&ended)["outcome"], "goal_reached", "{}", ended.stderr);
    for (length, told) in [
        ("500", "write a number with its unit"),
        ("3m", "right is from 20mm to 1200mm"),
    ] {
        arguments[4] = length;
        let ended = said(folder.path(), &arguments);
        assert_eq!(ended.code, 64, "{}", ended.stderr);
        assert!(ended.stderr.contains(told), "{}", ended.stderr);
    }
}

#[test]
#[ignore = "long"]
fn a_step_that_no_fold_explains_gets_no_arrow_and_words_on_what_to_write() {
    let folder = tempfile::tempdir().unwrap();
    let paint = |name: &str, [left, top, right, bottom]: [u32; 4]| {
        let picture = image::RgbImage::from_fn(224, 224, |column, row| {
            let is_cloth = (left..right).contains(&column) && (top..bottom).contains(&row);
            image::Rgb(if is_cloth { [200, 60, 20] } else { [230; 3] })
        });
        picture.save(folder.path().join(name)).unwrap();
    };
    paint("0.png", [40, 40, 184, 184]);
    paint("1.png", [100, 40, 124, 184]);
    let ended = said(
        folder.path(),
        &["new", "fold", "a", "--from-images", "0.png", "1.png"],
    );
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    for told in [
        "no fold found; the best guess is ",
        "Write by hand: `image \"a.images/0.png\" arrow (",
    ] {
        assert!(ended.stderr.contains(told), "{}", ended.stderr);
    }
    let text = std::fs::read_to_string(folder.path().join("a.fab")).unwrap();
    assert!(
        text.contains("        image \"a.images/0.png\"\n"),
        "{text}"
    );
    assert_eq!(said(folder.path(), &["check", "a.fab"]).code, 0);
}

#[test]
#[ignore = "long"]
fn a_file_in_the_folders_place_and_a_picture_in_a_pictures_place_are_named() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ro"), "").unwrap();
    let ended = said(folder.path(), &["new", "fold", "a", "--in", "ro"]);
    assert_eq!(ended.code, 2, "{}", ended.stderr);
    assert!(
        ended.stderr.contains("cannot write `ro"),
        "{}",
        ended.stderr
    );
    std::fs::create_dir(folder.path().join("ii.images")).unwrap();
    std::fs::write(folder.path().join("ii.images/0.png"), "").unwrap();
    let pictures = pictures("house", 2);
    let mut arguments = vec!["new", "fold", "ii", "--from-images"];
    arguments.extend(pictures.iter().map(String::as_str));
    let ended = said(folder.path(), &arguments);
    let told = "`ii.images/0.png` already exists; choose another name, or remove it";
    assert!(ended.stderr.contains(told), "{}", ended.stderr);
}
