//! Files that a task uses: which are read, and which are refused.

use super::*;
use std::fs;
use std::os::unix::fs::symlink;

/// A folder with a task in it, and a file outside it.
fn folders() -> (tempfile::TempDir, PathBuf) {
    let root = tempfile::tempdir().expect("a temporary folder");
    let folder = root.path().join("tasks");
    fs::create_dir_all(folder.join("lib")).expect("a folder");
    fs::write(root.path().join("secret.fab"), "task secret { }").expect("a file");
    fs::write(folder.join("lib/base.fab"), "task base { }").expect("a file");
    (root, folder)
}

fn codes(folder: &Path, entry: &str, text: &str) -> Vec<String> {
    fs::write(folder.join(entry), text).expect("a file");
    let name = folder.join(entry).display().to_string();
    let compiled = compile(&name).expect("the entry can be read");
    compiled
        .diagnostics
        .iter()
        .filter(|it| it.severity == diag::Severity::Error)
        .map(|it| format!("{} {}", it.code.as_str(), it.message))
        .collect()
}

#[test]
fn a_link_that_leads_out_is_refused_and_named() {
    let (root, folder) = folders();
    symlink(root.path().join("secret.fab"), folder.join("link.fab")).expect("a link");
    symlink(root.path(), folder.join("up")).expect("a link");
    for path in ["link.fab", "up/secret.fab"] {
        let found = codes(&folder, "task.fab", &format!("use \"{path}\"\n"));
        let [message] = found.as_slice() else {
            panic!("{path}: {found:?}");
        };
        assert!(message.starts_with("F0002"), "{message}");
        assert!(message.contains(path), "{message}");
        assert!(
            message.contains("outside the first file's folder"),
            "{message}"
        );
    }
}

#[test]
fn a_link_that_stays_inside_is_followed() {
    let (_root, folder) = folders();
    symlink("lib/base.fab", folder.join("base.fab")).expect("a link");
    let text = "use \"base.fab\"\ntask t extends base { }\n";
    assert!(codes(&folder, "task.fab", text).is_empty());
}

#[test]
fn the_first_file_may_be_a_link_and_its_neighbours_are_those_of_the_link() {
    let (root, folder) = folders();
    let text = "use \"lib/base.fab\"\ntask t extends base { }\n";
    fs::write(root.path().join("task.fab"), text).expect("a file");
    symlink(root.path().join("task.fab"), folder.join("task.fab")).expect("a link");
    let compiled = compile(&folder.join("task.fab").display().to_string());
    assert!(!compiled.expect("the entry can be read").has_errors());
}

#[test]
fn paths_that_climb_are_refused_before_anything_is_read() {
    let (root, folder) = folders();
    let secret = root.path().join("secret.fab").display().to_string();
    for path in [
        "../secret.fab",
        "lib/../../secret.fab",
        "../tasks/lib/base.fab",
        "../lib/../secret.fab",
        &secret,
    ] {
        let found = codes(&folder, "task.fab", &format!("use \"{path}\"\n"));
        assert!(
            matches!(found.as_slice(), [message] if message.starts_with("F0005")),
            "{path}: {found:?}"
        );
    }
}

#[test]
fn a_library_beside_the_folder_is_read_and_links_out_of_it_are_not() {
    let (root, folder) = folders();
    let tasks = folder.join("own");
    fs::create_dir(&tasks).expect("a folder");
    symlink(root.path().join("secret.fab"), folder.join("lib/link.fab")).expect("a link");
    let text = "use \"../lib/base.fab\"\ntask t extends base { }\n";
    assert!(codes(&tasks, "task.fab", text).is_empty());
    let found = codes(&tasks, "task.fab", "use \"../lib/link.fab\"\n");
    assert!(
        matches!(found.as_slice(), [message] if message.starts_with("F0002")),
        "{found:?}"
    );
}

#[cfg(feature = "runtime")]
#[test]
fn a_check_looks_for_the_files_that_a_task_names() {
    let (root, folder) = folders();
    let png = |width, height| fab_picture::png::encode(&image::RgbImage::new(width, height));
    let right = png(224, 224);
    let mut damaged = right.clone();
    damaged[45] ^= 1;
    fs::write(folder.join("right.png"), &right).expect("a file");
    fs::write(folder.join("wide.png"), png(640, 480)).expect("a file");
    let named_jpeg = folder.join("jpeg.png");
    let jpeg =
        image::RgbImage::new(224, 224).save_with_format(named_jpeg, image::ImageFormat::Jpeg);
    jpeg.expect("a file");
    fs::write(folder.join("cut.png"), &right[..right.len() - 6]).expect("a file");
    fs::write(folder.join("damaged.png"), damaged).expect("a file");
    fs::write(folder.join("text.png"), "not a picture").expect("a file");
    fs::create_dir(folder.join("folder.png")).expect("a folder");
    symlink(root.path().join("secret.fab"), folder.join("link.png")).expect("a link");
    let found = |path: &str| {
        let text = format!(
            "task t {{
                camera top_down(height: 650mm, fov: 45deg, image: 224px)
                subgoals {{ image \"right.png\" arrow (1px, 2px) -> (3px, 4px) image \"{path}\" }}
            }}\n"
        );
        let file = folder.join("task.fab");
        fs::write(&file, text).expect("a file");
        let compiled = compile_looking(&file.display().to_string());
        let compiled = compiled.expect("the entry can be read");
        let found = compiled.diagnostics.iter().map(|it| it.code.as_str());
        found
            .filter(|code| code.starts_with("F00"))
            .collect::<Vec<_>>()
    };
    for (path, expected) in [
        ("right.png", &[][..]),
        ("jpeg.png", &[]),
        ("wide.png", &["F0008"]),
        ("text.png", &["F0007"]),
        ("cut.png", &["F0007"]),
        ("damaged.png", &["F0007"]),
        ("folder.png", &["F0007"]),
        ("link.png", &["F0007"]),
        ("missing.png", &["F0007"]),
    ] {
        assert_eq!(found(path), expected, "{path}");
    }
}

#[test]
fn a_check_looks_into_starts_and_demonstrations() {
    let (_root, folder) = folders();
    let floats = |shape: &[u64], value: f32| {
        let count = shape.iter().product::<u64>();
        npy::encode_floats(shape, (0..count).map(|_| value))
    };
    let right = floats(&[4, 3], 0.5);
    let rows: [(&str, Wanted, &[u8], Option<&str>); 11] = [
        ("right.npy", Wanted::Positions, &right, None),
        ("mass.npy", Wanted::Positions, &floats(&[4, 4], 0.5), None),
        (
            "marked.jsonl",
            Wanted::Demonstrations,
            b"\xef\xbb\xbf{\"format\": 1}\n\n{}\n",
            None,
        ),
        (
            "text.npy",
            Wanted::Positions,
            b"positions",
            Some("it does not begin as a .npy file does"),
        ),
        (
            "cut.npy",
            Wanted::Positions,
            &right[..right.len() - 9],
            Some("it is cut off"),
        ),
        (
            "flat.npy",
            Wanted::Positions,
            &floats(&[6, 2], 0.5),
            Some("it has the shape [6, 2], not [particles, 3] or [particles, 4]"),
        ),
        (
            "nan.npy",
            Wanted::Positions,
            &floats(&[4, 3], f32::NAN),
            Some("a coordinate in it is not a number"),
        ),
        (
            "right.jsonl",
            Wanted::Demonstrations,
            b"{\"format\": 1}\n{}\n",
            None,
        ),
        (
            "empty.jsonl",
            Wanted::Demonstrations,
            b"",
            Some("its first line does not state a `format`"),
        ),
        (
            "text.jsonl",
            Wanted::Demonstrations,
            b"garbage\n",
            Some("line 1 is no JSON object: expected value at line 1 column 1"),
        ),
        (
            "other.jsonl",
            Wanted::Demonstrations,
            b"{}\n",
            Some("its first line does not state a `format`"),
        ),
    ];
    for (name, wanted, bytes, why) in rows {
        let path = folder.join(name);
        fs::write(&path, bytes).expect("a file");
        let expected = match why {
            None => Ok(Listed::Other),
            Some(why) => Err(why.to_owned()),
        };
        assert_eq!(listed(&folder, &path, wanted), expected, "{name}");
    }
}
