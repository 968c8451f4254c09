//! Input that `fabc bench` refuses, with its messages and exit codes.

use super::bench::project;
use super::support::{fabc, finish};
use std::fs;

const SUITE: &str = r#"
about = "One small fold."
statistic = "mean"
metrics = ["goal_reached"]
tasks = ["../tiny.fab"]
[starts]
lie = "flat"
sides = [28]
turns_deg = [0]
[[method]]
name = "plain"
"#;

#[test]
fn wrong_arguments_are_named_with_what_would_be_right() {
    let folder = project(SUITE);
    fs::create_dir(folder.path().join("empty")).unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    let cases: [(&[&str], i32, &str); 14] = [
        (
            &["none"],
            64,
            "there is no suite `none`: looked for the file `tasks/suites/none.toml` in the working folder; `tasks/suites` holds `tiny`",
        ),
        (&["a/b.toml"], 64, "looked for the file `a/b.toml`"),
        (
            &["tiny", "--model", "gpt"],
            64,
            "there is no model `gpt`; there is `geometric`",
        ),
        (&["tiny", "--model", "imperfect:2"], 64, "RATE from 0 to 1"),
        (
            &["tiny", "--model", "random:x"],
            64,
            "there is no model `random:x`",
        ),
        (&["tiny", "--limit", "0"], 64, "0 is not in 1.."),
        (&["tiny", "--jobs", "0"], 64, "0 is not in 1.."),
        (&["tiny", "--repeats", "0"], 64, "0 is not in 1.."),
        (
            &["tiny", "--shard", "3/2"],
            64,
            "write a part and how many there are",
        ),
        (&["tiny", "--shard", "0/2"], 64, "such as 1/3"),
        (
            &["tiny", "--shard", "2/2"],
            2,
            "no task of the suite has a start",
        ),
        (
            &["tiny", "--starts", "empty"],
            2,
            "it has no manifest.json and no .npy file",
        ),
        (
            &["tiny", "--starts", "absent"],
            2,
            "the recorded starts `absent` cannot be used",
        ),
        (
            &["tiny", "--out", "file/out"],
            2,
            "cannot make the folder `file/out`",
        ),
    ];
    for (arguments, code, wanted) in cases {
        let said = finish(fabc(folder.path()).arg("bench").args(arguments));
        assert_eq!(said.code, code, "{arguments:?}: {}", said.stderr);
        assert!(
            said.stderr.contains(wanted),
            "{arguments:?}: {}",
            said.stderr
        );
        assert!(said.stdout.is_empty(), "{arguments:?}: {}", said.stdout);
    }
}

#[test]
fn wrong_suites_are_named_with_the_line() {
    let cases = [
        (
            "about = \"One small fold.\"",
            "about = 3",
            2,
            "TOML parse error at line 2",
        ),
        (
            "\"goal_reached\"",
            "\"success\"",
            2,
            "there is no metric `success`",
        ),
        ("../tiny.fab", "../none.fab", 2, "cannot read"),
        (
            "../tiny.fab",
            "../lib/folding.fab",
            1,
            "declares no task that can run",
        ),
        (
            "name = \"plain\"",
            "name = \"plain\"\nvariant = \"none\"",
            2,
            "has no variant `none`",
        ),
        (
            "name = \"plain\"",
            "name = \"plain\"\nmodel = \"none\"",
            64,
            "there is no model `none`",
        ),
        ("sides = [28]", "sides = [900]", 1, "a side has 2 to"),
        (
            "[[method]]",
            "[vary]\ncamera_hight_mm = [640, 660]\n[[method]]",
            2,
            "TOML parse error at line 10, column 1",
        ),
        (
            "[[method]]",
            "[vary]\ncamera_height_mm = [660, 640]\n[[method]]",
            2,
            "`vary.camera_height_mm`: 660 is greater than 640; the lowest value comes first",
        ),
    ];
    for (from, to, code, wanted) in cases {
        assert!(SUITE.contains(from));
        let folder = project(&SUITE.replace(from, to));
        let said = finish(fabc(folder.path()).args(["bench", "tiny"]));
        assert_eq!(said.code, code, "{to}: {}", said.stderr);
        assert!(said.stderr.contains(wanted), "{to}: {}", said.stderr);
    }
}

#[test]
fn only_the_simulator_runs_suites_with_varied_worlds() {
    let folder = project(&SUITE.replace("[[method]]", "[vary]\nsize = [0.9, 1.1]\n[[method]]"));
    let worlds: [&[&str]; 2] = [&["arm", "--robot", "absent.toml"], &["exec:cat"]];
    for world in worlds {
        let said = finish(
            fabc(folder.path())
                .args(["bench", "tiny", "--world"])
                .args(world),
        );
        assert_eq!(said.code, 2, "{}", said.stderr);
        let wanted = format!("only the bundled simulator can, not `--world {}`", world[0]);
        assert!(said.stderr.contains(&wanted), "{}", said.stderr);
    }
}

#[test]
fn with_json_an_error_is_a_document_too() {
    let folder = project(SUITE);
    let said = finish(fabc(folder.path()).args(["bench", "none", "--json"]));
    let document: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!((said.code, &document["exit"]), (64, &64.into()));
}
