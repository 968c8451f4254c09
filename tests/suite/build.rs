//! `fabc build`, through the command itself.

use super::support::{bring_library, fabc, finish, project, root};
use serde_json::Value;

#[test]
fn build_lists_the_files_that_it_writes_whole() {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(fabc(folder.path()).args([
        "build",
        &project("tasks/double_straight.fab"),
        "-o",
        "built",
        "--emit",
        "program,rust,python",
        "--json",
    ]));
    assert_eq!((said.code, said.stderr.as_str()), (0, ""));
    let value: Value = serde_json::from_str(&said.stdout).unwrap();
    let files: Vec<&str> = value["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|file| file.as_str().unwrap())
        .collect();
    // The task, its five ablations and the variant with examples have ten files each.
    assert_eq!(files.len(), 70, "{files:?}");
    for file in &files {
        let text = std::fs::read_to_string(folder.path().join(file)).unwrap();
        assert!(!text.is_empty(), "{file}");
    }
    let mut beside: Vec<String> = std::fs::read_dir(folder.path().join("built/double_straight"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    beside.sort();
    let expected = [
        "actions.schema.json",
        "program.json",
        "prompts",
        "verifier.py",
        "verifier.rs",
    ];
    assert_eq!(beside, expected, "nothing half written is left");
}

#[test]
fn build_gives_the_same_bytes_wherever_the_files_lie() {
    let built = [1, 2].map(|_| {
        let folder = tempfile::tempdir().unwrap();
        bring_library(folder.path());
        for file in ["double_triangle.fab", "lib/experts.fab"] {
            let task = root().join("tasks").join(file);
            std::fs::copy(task, folder.path().join(file)).unwrap();
        }
        let said = finish(fabc(folder.path()).args(["build", "double_triangle.fab", "-o", "."]));
        assert_eq!(said.code, 0, "{}", said.stderr);
        std::fs::read(folder.path().join("double_triangle/program.json")).unwrap()
    });
    assert_eq!(built[0], built[1]);
}

#[test]
fn build_fails_with_the_code_of_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let task = project("tasks/double_straight.fab");
    std::fs::write(
        folder.path().join("wrong.fab"),
        "task tiny { cloth grid(5) }\n",
    )
    .unwrap();
    std::fs::write(folder.path().join("taken"), "a file, no folder\n").unwrap();
    for (arguments, code, words) in [
        (vec!["wrong.fab", "-o", "built"], 1, "cannot be compiled"),
        (
            vec![&task, "-o", "taken"],
            2,
            "cannot write `taken/double_straight/",
        ),
        (
            vec!["absent.fab", "-o", "built"],
            2,
            "cannot read `absent.fab`",
        ),
        (vec![&task], 64, "--out"),
        (
            vec![&task, "-o", "built", "--task", "other"],
            64,
            "no runnable task `other`",
        ),
        (vec![&task, "-o", "built", "--emit", "java"], 64, "java"),
    ] {
        let said = finish(fabc(folder.path()).arg("build").args(&arguments));
        assert_eq!(said.code, code, "{arguments:?}: {}", said.stderr);
        assert!(said.stderr.contains(words), "{}", said.stderr);
        assert!(!folder.path().join("built").exists(), "{arguments:?}");
    }
}
