//! One test per verb, through the command itself.

use super::support::{bring_library, fabc, finish, finish_process, interrupt, project};
use serde_json::Value;

fn json(text: &str) -> Value {
    serde_json::from_str(text)
        .unwrap_or_else(|error| panic!("stdout is not one JSON document: {error}\n{text}"))
}

#[test]
fn check_says_how_often_a_model_can_be_asked() {
    let folder = tempfile::tempdir().unwrap();
    let file = project("tasks/double_straight.fab");
    let said = finish(fabc(folder.path()).args(["check", &file]));
    assert_eq!((said.code, said.stderr.as_str()), (0, ""));
    assert!(
        said.stdout
            .contains("at most 12 model calls per step, 36 in 3 steps"),
        "{}",
        said.stdout
    );
    let said = finish(fabc(folder.path()).args(["check", "--json", &file]));
    let value = json(&said.stdout);
    assert_eq!(value["diagnostics"], serde_json::json!([]));
    assert_eq!(value["tasks"][0]["task"], "double_straight");
    assert_eq!(value["tasks"][0]["max_calls"], 36);
}

#[test]
fn check_says_what_the_simulator_cannot_do_with_a_material() {
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    let text = "\
use \"lib/folding.fab\"
use \"lib/materials.fab\"
material board {
    weight    180g/m2 from \"a scale\"
    thickness 0.5mm from \"a stack\"
    bending   warp: 90mm, weft: 90mm, bias: 90mm from \"a ruler\"
    recovery  80deg from \"a protractor\"
    stretch   warp: 0.02, weft: 0.02, bias: 0.08 from \"a pull\"
    friction  table: 0.4, itself: 0.6 from \"a tilted table\"
}
task stiff extends folding {
    cloth grid(55, 44, material: silk)
    goal  particle_distance < 8mm
    keypoints { cloth = mask(depth < 649.9mm) }
    subgoals { demonstrate { fold corner(back_left) -> corner(front_right) } }
    stage plan {
        model text, temperature 0.7
        say \"{{ instruction }} {{ corners }} {{ center }} {{ actions.format }}\"
        read action
    }
}
";
    std::fs::write(folder.path().join("stiff.fab"), text).unwrap();
    let said = finish(fabc(folder.path()).args(["check", "stiff.fab"]));
    assert_eq!(said.code, 0, "{}{}", said.stdout, said.stderr);
    let line = "\n    in the simulator, layers keep `1` mm apart and not the thickness of `0.1` mm";
    assert!(said.stdout.contains(line), "{line}\n{}", said.stdout);
    // A cloth that cannot be laid is a warning, since a real arm needs no simulator.
    std::fs::write(
        folder.path().join("stiff.fab"),
        text.replace("material: silk", "material: board"),
    )
    .unwrap();
    let said = finish(fabc(folder.path()).args(["check", "stiff.fab"]));
    let denied = finish(fabc(folder.path()).args(["check", "stiff.fab", "--deny-warnings"]));
    let checked = finish(fabc(folder.path()).args(["check", "stiff.fab", "--json"]));
    assert_eq!(
        [said.code, denied.code, checked.code],
        [0, 1, 0],
        "{}",
        said.stderr
    );
    let checked = json(&checked.stdout);
    let mut found = checked["diagnostics"].as_array().unwrap().iter();
    let stiff = found.find(|it| it["code"] == "F0512").unwrap();
    let message = stiff["message"].as_str().unwrap();
    let words =
        "the cloth cannot be laid in the simulator: a cloth with a bending length of up to `90` mm";
    assert!(message.starts_with(words), "{message}");
    let task = &checked["tasks"][0];
    assert_eq!(
        (&task["material"], &task["simulated"]),
        (&"board".into(), &Value::Null)
    );
    let line = format!("warning[F0512]: {message}");
    assert!(said.stdout.contains(&line), "{line}\n{}", said.stdout);
}

#[test]
fn check_reports_every_file_and_exits_with_1() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("wrong.fab"),
        "task tiny { cloth grid(5) }\n",
    )
    .unwrap();
    let said = finish(fabc(folder.path()).args([
        "check",
        "wrong.fab",
        &project("tasks/double_triangle.fab"),
    ]));
    assert_eq!(said.code, 1);
    assert!(said.stdout.contains("wrong.fab:1:"), "{}", said.stdout);
    assert!(
        said.stdout.contains("`double_triangle` has no errors"),
        "{}",
        said.stdout
    );
    let said = finish(fabc(folder.path()).args(["check", "--json", "wrong.fab"]));
    let value = json(&said.stdout);
    for field in [
        "code", "severity", "message", "file", "start", "end", "labels", "help", "edits",
    ] {
        assert!(
            value["diagnostics"][0].get(field).is_some(),
            "no `{field}` in {value}"
        );
    }
}

#[test]
fn explain_tells_of_every_code_and_refuses_others() {
    let folder = tempfile::tempdir().unwrap();
    for entry in fab_compiler::diag::CODES {
        let said = finish(fabc(folder.path()).args(["explain", entry.code.as_str()]));
        assert_eq!(said.code, 0);
        assert!(said.stdout.contains(entry.title()) && said.stdout.contains(&*entry.explanation()));
    }
    let said = finish(fabc(folder.path()).args(["explain", "F9999"]));
    assert_eq!(said.code, 64);
    assert!(said.stderr.contains("`F9999`"), "{}", said.stderr);
}

#[test]
fn render_writes_messages_and_the_pictures_that_a_model_gets() {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(fabc(folder.path()).args([
        "render",
        &project("tasks/double_straight.fab"),
        "--out",
        "shown",
        "--json",
    ]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    let value = json(&said.stdout);
    assert_eq!(value["stages"][0]["stage"], "describe");
    let parts = value["stages"][0]["messages"][0]["parts"]
        .as_array()
        .unwrap();
    assert_eq!(
        parts.iter().filter(|part| part["type"] == "image").count(),
        2
    );
    let text = std::fs::read_to_string(folder.path().join("shown/plan.txt")).unwrap();
    assert!(text.contains("Pick Point = (x, y)"), "{text}");
    for picture in ["describe_1.png", "describe_2.png"] {
        let picture = fab_picture::png::load(&folder.path().join("shown").join(picture)).unwrap();
        assert_eq!(picture.dimensions(), (224, 224));
    }
}

#[test]
fn subgoals_draws_and_pins_one_picture_more_than_there_are_steps() {
    let folder = tempfile::tempdir().unwrap();
    small_fold(folder.path());
    let said = finish(fabc(folder.path()).args([
        "subgoals",
        "small.fab",
        "--sheet",
        "sheet.png",
        "--json",
    ]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    assert_eq!(
        json(&said.stdout)["files"],
        serde_json::json!([
            "small.subgoals/0.png",
            "small.subgoals/1.png",
            "small.subgoals/pins.json",
            "sheet.png"
        ])
    );
    let sheet = fab_picture::png::load(&folder.path().join("sheet.png")).unwrap();
    assert_eq!(sheet.dimensions(), (224 * 2 + 8, 224));
    // Pinned pictures are used silently; after a change of the fold they are not used.
    let said = finish(fabc(folder.path()).args(["run", "small.fab"]));
    assert!(!said.stderr.contains("pin"), "{}", said.stderr);
    let changed = std::fs::read_to_string(folder.path().join("small.fab"))
        .unwrap()
        .replace("front_right", "front_left");
    std::fs::write(folder.path().join("small.fab"), changed).unwrap();
    let said = finish(fabc(folder.path()).args(["run", "small.fab"]));
    assert!(said.stderr.contains("show another fold"), "{}", said.stderr);
}

/// Writes a task of one fold on a small cloth that extends the shipped library.
fn small_fold(folder: &std::path::Path) {
    bring_library(folder);
    let text = "use \"lib/folding.fab\"\n\ntask small extends folding {\n    cloth grid(25, 25)\n    subgoals {\n        demonstrate {\n            fold corner(back_left) -> corner(front_right)\n        }\n    }\n}\n";
    std::fs::write(folder.join("small.fab"), text).unwrap();
}

#[test]
fn run_folds_a_new_task_of_a_dozen_lines() {
    let folder = tempfile::tempdir().unwrap();
    small_fold(folder.path());
    let said = finish(fabc(folder.path()).args(["run", "small.fab", "--json"]));
    let value = json(&said.stdout);
    assert_eq!(
        (said.code, value["outcome"].as_str()),
        (0, Some("horizon_reached")),
        "{}",
        said.stderr
    );
    assert!(
        value["mean_particle_distance_mm"].as_f64().unwrap() < 20.0,
        "{value}"
    );
    assert_eq!(value["run_dir"], "runs/small-0001");
}

/// Runs a shipped task and returns its report.
fn run_shipped(task: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(fabc(folder.path()).args([
        "run",
        &project(&format!("tasks/{task}.fab")),
        "--json",
        "--out",
        "run",
    ]));
    assert_eq!(said.code, 0, "{}{}", said.stderr, said.stdout);
    assert!(said.stderr.contains("stand-in"), "{}", said.stderr);
    let value = json(&said.stdout);
    for field in [
        "task",
        "variant",
        "outcome",
        "goal_reached",
        "mean_particle_distance_mm",
        "coverage",
        "normalized_improvement",
        "steps",
        "policy",
        "start",
        "program",
        "params",
        "run_dir",
        "wall_s",
    ] {
        assert!(value.get(field).is_some(), "no `{field}` in {value}");
    }
    let sheet = fab_picture::png::load(&folder.path().join("run/sheet.png")).unwrap();
    assert!(sheet.width() > 3 * 224);
    value
}

#[test]
#[ignore = "long"]
fn run_reaches_the_goal_of_double_straight() {
    let report = run_shipped("double_straight");
    assert_eq!(report["outcome"], "goal_reached");
    assert_eq!(report["policy"]["models"]["vision"]["nature"], "stand_in");
    assert!(
        report["mean_particle_distance_mm"].as_f64().unwrap() < 40.0,
        "{report}"
    );
}

#[test]
#[ignore = "long"]
fn run_reaches_the_goal_of_double_triangle() {
    let report = run_shipped("double_triangle");
    assert_eq!(
        (report["outcome"].as_str(), report["steps"].as_u64()),
        (Some("goal_reached"), Some(2))
    );
}

#[test]
#[ignore = "long"]
fn run_reaches_the_goals_of_the_other_folds() {
    for (task, steps) in [
        ("all_corners_inward", 4),
        ("corners_edges_inward", 4),
        ("cupboard", 4),
        ("house", 2),
        ("open_envelope", 3),
        ("sash", 2),
        ("shop_fold", 4),
        ("thirds", 4),
    ] {
        let report = run_shipped(task);
        assert_eq!(
            (report["outcome"].as_str(), report["steps"].as_u64()),
            (Some("goal_reached"), Some(steps)),
            "{task}"
        );
    }
}

#[test]
fn version_and_help_end_with_0_and_a_wrong_flag_with_64() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(finish(fabc(folder.path()).arg("--version")).code, 0);
    assert_eq!(finish(fabc(folder.path()).arg("--help")).code, 0);
    assert_eq!(
        finish(fabc(folder.path()).args(["run", "--no-such-flag"])).code,
        64
    );
    assert_eq!(finish(fabc(folder.path()).arg("fold")).code, 64);
    assert_eq!(finish(&mut fabc(folder.path())).code, 64);
}

#[test]
fn an_interrupt_ends_a_run_with_130_and_keeps_what_was_finished() {
    use std::io::{BufRead, BufReader};
    let folder = tempfile::tempdir().unwrap();
    let mut child = fabc(folder.path())
        .args([
            "run",
            &project("tasks/double_straight.fab"),
            "--out",
            "run",
            "--json",
        ])
        .process()
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut talk = BufReader::new(child.stderr.take().unwrap()).lines();
    // The first step is done; the second takes a while.
    assert!(
        talk.by_ref()
            .any(|line| line.unwrap().starts_with("step 1/3"))
    );
    interrupt(child.id());
    talk.for_each(|line| assert!(line.is_ok()));
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert_eq!(
        json(&String::from_utf8(output.stdout).unwrap())["outcome"],
        "interrupted"
    );
    let journal = std::fs::read_to_string(folder.path().join("run/rollout.jsonl")).unwrap();
    let lines: Vec<Value> = journal.lines().map(json).collect();
    assert_eq!(lines[1]["executed"]["grips"][0]["grasp"]["particle"], 0);
    assert_eq!(lines.last().unwrap()["report"]["outcome"], "interrupted");
}

#[test]
fn json_is_one_document_also_where_nothing_was_done() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("wrong.fab"),
        "task tiny extends nothing {\n}\n",
    )
    .unwrap();
    for (arguments, code) in [
        (&["check", "nowhere.fab"][..], 2),
        (&["render", "nowhere.fab"], 2),
        (&["subgoals", "nowhere.fab"], 2),
        (&["run", "nowhere.fab"], 2),
        (&["run", "wrong.fab"], 1),
        (
            &[
                "run",
                &project("tasks/double_straight.fab"),
                "--model",
                "none",
            ],
            64,
        ),
    ] {
        let said = finish(fabc(folder.path()).args(arguments).arg("--json"));
        assert_eq!(said.code, code, "{arguments:?}");
        let value = json(&said.stdout);
        let errors = [&value["error"], &value["errors"][0]];
        assert!(
            errors.iter().any(|error| error.is_string()),
            "{arguments:?} prints {value}"
        );
    }
    let said = finish(fabc(folder.path()).args(["run", "wrong.fab", "--json"]));
    assert_eq!(json(&said.stdout)["diagnostics"][0]["code"], "F0301");
}

#[test]
fn a_result_or_a_help_text_that_cannot_be_written_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = project("tasks/double_straight.fab");
    for arguments in [
        &["check", &file][..],
        &["--help"],
        &["--version"],
        &["check", "--help"],
        &["completions", "bash"],
    ] {
        let Ok(full) = std::fs::OpenOptions::new().write(true).open("/dev/full") else {
            return;
        };
        let mut command = fabc(folder.path());
        let said = finish_process(command.args(arguments).process().stdout(full));
        assert_eq!(said.code, 2, "{arguments:?}: {}", said.stderr);
        let words = "error: the result could not be written to stdout: ";
        assert!(said.stderr.contains(words), "{}", said.stderr);
    }
}
