//! In-context examples: made by the scripted expert, told in the task's own words, refused if they come from test
//! starts.

use super::support::{bring_library, fabc, finish, project};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A task of one fold with a variant that is given demonstrations.
const ONE_FOLD: &str = r#"
use "lib/folding.fab"

task one_fold extends folding {
    cloth grid(50, 40)
    goal  particle_distance < 40mm
    subgoals { demonstrate { fold corner(back_left) -> corner(front_left) } }
    variant told { demos plan from "demos/one_fold.jsonl" }
}
"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    fs::write(folder.path().join("one_fold.fab"), ONE_FOLD).unwrap();
    folder
}

fn make(folder: &Path, seed: &str) -> Value {
    let said = finish(fabc(folder).args([
        "demos",
        "one_fold.fab",
        "--variant",
        "told",
        "--count",
        "2",
        "--seed",
        seed,
        "--json",
    ]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    serde_json::from_str(&said.stdout).unwrap()
}

fn rendered(folder: &Path) -> Vec<(String, String)> {
    let said = finish(fabc(folder).args([
        "render",
        "one_fold.fab",
        "--variant",
        "told",
        "--stage",
        "plan",
        "--json",
    ]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    let value: Value = serde_json::from_str(&said.stdout).unwrap();
    let messages = value["stages"][0]["messages"].as_array().unwrap();
    let text = |message: &Value| {
        let parts = message["parts"].as_array().unwrap();
        let texts = parts.iter().filter_map(|part| part["text"].as_str());
        texts.collect::<Vec<_>>().join("\n")
    };
    let spoken = messages.iter().map(|message| {
        let role = message["role"].as_str().unwrap().to_owned();
        (role, text(message))
    });
    spoken.collect()
}

#[test]
#[ignore = "long"]
fn the_expert_demonstrates_and_the_prompt_tells_it_in_the_tasks_own_words() {
    let folder = folder();
    let made = make(folder.path(), "3");
    assert_eq!((&made["demos"], &made["actions"]), (&2.into(), &2.into()));
    let first = fs::read(folder.path().join("demos/one_fold.jsonl")).unwrap();
    make(folder.path(), "3");
    let again = fs::read(folder.path().join("demos/one_fold.jsonl")).unwrap();
    assert_eq!(first, again, "equal seeds give equal demonstrations");
    make(folder.path(), "4");
    assert_ne!(
        first,
        fs::read(folder.path().join("demos/one_fold.jsonl")).unwrap()
    );

    let spoken = rendered(folder.path());
    let roles: Vec<&str> = spoken.iter().map(|(role, _)| role.as_str()).collect();
    assert_eq!(
        roles,
        ["system", "user", "assistant", "user", "assistant", "user"]
    );
    for (_, question) in [&spoken[1], &spoken[3]] {
        assert!(
            question.contains("- Method of folding: Pick the corner at the "),
            "{question}"
        );
        assert!(question.contains("- Cloth corners: ("), "{question}");
    }
    for (_, answer) in [&spoken[2], &spoken[4]] {
        assert!(answer.starts_with("Pick Point = ("), "{answer}");
        assert!(answer.contains("\nPlace Point = ("), "{answer}");
    }

    // Changing the task's wording changes the wording of its examples.
    let library = folder.path().join("lib/folding.fab");
    let text = fs::read_to_string(&library).unwrap();
    fs::write(
        &library,
        text.replace("- Cloth corners:", "- Offered corners:"),
    )
    .unwrap();
    for (_, question) in [&rendered(folder.path())[1], &rendered(folder.path())[5]] {
        assert!(question.contains("- Offered corners: ("), "{question}");
    }
}

#[test]
#[ignore = "long"]
fn a_start_that_is_an_example_is_no_test() {
    let folder = folder();
    make(folder.path(), "3");
    let text = fs::read_to_string(folder.path().join("demos/one_fold.jsonl")).unwrap();
    let demo: Value = serde_json::from_str(text.lines().nth(1).unwrap()).unwrap();
    let [dimx, dimy] = [0, 1].map(|side| demo["dims"][side].as_u64().unwrap());
    let start = turned(dimx, dimy, demo["turned_deg"].as_f64().unwrap());
    fs::write(folder.path().join("start.npy"), npy(&start)).unwrap();
    let dims = format!("{dimx}x{dimy}");
    let run = |variant: &[&str]| {
        let arguments = [
            "run",
            "one_fold.fab",
            "--start",
            "start.npy",
            "--dims",
            &dims,
            "--up",
            "z",
        ];
        finish(fabc(folder.path()).args(arguments).args(variant))
    };
    let said = run(&["--variant", "told"]);
    assert_eq!(said.code, 2, "{}", said.stderr);
    assert!(
        said.stderr
            .contains("is that of demonstration 1, which the model is shown"),
        "{}",
        said.stderr
    );
    assert!(!folder.path().join("runs").exists(), "nothing was run");
    assert_ne!(
        run(&[]).code,
        2,
        "without examples it is a test like any other"
    );
}

#[test]
fn a_suite_with_a_start_that_is_an_example_is_refused() {
    let folder = folder();
    make(folder.path(), "3");
    let file = folder.path().join("demos/one_fold.jsonl");
    let text = fs::read_to_string(&file).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut demo: Value = serde_json::from_str(&lines[1]).unwrap();
    (demo["dims"], demo["turned_deg"]) = (serde_json::json!([50, 40]), 30.into());
    lines[1] = demo.to_string();
    fs::write(&file, lines.join("\n") + "\n").unwrap();
    let suite = r#"
        about = "One fold, with examples."
        statistic = "mean"
        metrics = ["goal_reached"]
        tasks = ["one_fold.fab"]
        [starts]
        lie = "flat"
        sides = [50]
        turns_deg = [0, 30]
        [[method]]
        name = "told"
        variant = "told"
    "#;
    fs::write(folder.path().join("one.toml"), suite).unwrap();
    let said = finish(fabc(folder.path()).args(["bench", "one.toml"]));
    assert_eq!(said.code, 2, "{}", said.stderr);
    assert!(
        said.stderr
            .contains("is that of demonstration 1, which `told` shows the model"),
        "{}",
        said.stderr
    );
}

/// A flat cloth rotated counter-clockwise, as the simulator lays it: z up.
fn turned(dimx: u64, dimy: u64, degrees: f64) -> Vec<[f32; 3]> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let middle = |count: u64| (count - 1) as f64 / 2.0;
    let point = |ix: u64, iy: u64| {
        let right = (ix as f64 - middle(dimx)) * 0.00625;
        let back = (middle(dimy) - iy as f64) * 0.00625;
        [
            (cos * right - sin * back) as f32,
            (sin * right + cos * back) as f32,
            0.005,
        ]
    };
    (0..dimy)
        .flat_map(|iy| (0..dimx).map(move |ix| point(ix, iy)))
        .collect()
}

fn npy(points: &[[f32; 3]]) -> Vec<u8> {
    fab_base::npy::encode(points)
}

#[test]
fn what_is_wrong_with_demonstrations_is_said_with_its_line() {
    let folder = folder();
    let file = folder.path().join("demos/one_fold.jsonl");
    let run = || finish(fabc(folder.path()).args(["run", "one_fold.fab", "--variant", "told"]));
    let said = run();
    assert_eq!(said.code, 2);
    assert!(
        said.stderr
            .contains("`fabc demos FILE --variant NAME` makes the demonstrations"),
        "{}",
        said.stderr
    );

    make(folder.path(), "3");
    let whole = fs::read_to_string(&file).unwrap();
    let cases = [
        (String::new(), "it is empty"),
        (
            whole.replacen("\"format\":1", "\"format\":9", 1),
            "line 1 of the demonstrations",
        ),
        (
            whole.replacen("\"stage\":\"plan\"", "\"stage\":\"describe\"", 1),
            "for the stage `describe`",
        ),
        (
            whole.replacen("\"corners\":", "\"cornerz\":", 1),
            "line 2 of the demonstrations",
        ),
        (
            whole.replacen("\"pick\":", "\"pikc\":", 1),
            "step 1 chooses no `pick`",
        ),
        (
            whole.replacen("\"instruction\":", "\"instruct\":", 1),
            "the question cannot be written: `instruction`",
        ),
        (
            whole.replacen("\"dims\":[", "\"dims\":[9000000,", 1),
            "line 2",
        ),
        (
            whole.replacen("\"turned_deg\":", "\"turned_deg\":1e999,\"x\":", 1),
            "line 2",
        ),
        (format!("{whole}{{\n"), "line 4"),
    ];
    for (text, expected) in cases {
        fs::write(&file, &text).unwrap();
        let said = run();
        assert_eq!(said.code, 2, "{expected}: {}", said.stderr);
        assert!(
            said.stderr.contains(expected),
            "{expected} is not in {}",
            said.stderr
        );
    }
}

#[test]
#[ignore = "long"]
fn a_task_that_cannot_be_demonstrated_says_why() {
    let folder = folder();
    let task = |body: &str| {
        fs::write(folder.path().join("one_fold.fab"), body).unwrap();
        finish(fabc(folder.path()).args(["demos", "one_fold.fab", "--variant", "told"]))
    };
    let without = ONE_FOLD.replace("demos plan from \"demos/one_fold.jsonl\"", "horizon 1");
    let said = task(&without);
    assert_eq!(said.code, 64);
    assert!(
        said.stderr
            .contains("names no demonstrations: write `demos STAGE from"),
        "{}",
        said.stderr
    );
    // No offered point corresponds to the middle of the cloth.
    let nowhere = ONE_FOLD.replace("-> corner(front_left)", "-> point(0.25, 0.3)");
    let said = task(&nowhere);
    assert_eq!(said.code, 2);
    assert!(
        said.stderr.contains("only 0 of 10 demonstrations")
            && said
                .stderr
                .contains("no offered point is near the expert's place point"),
        "{}",
        said.stderr
    );
}

#[test]
fn shipped_demonstrations_fit_their_tasks() {
    let folder = tempfile::tempdir().unwrap();
    let mut found = 0;
    for entry in fs::read_dir(project("tasks")).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap_or_default();
        if !text.contains("variant in_context") {
            continue;
        }
        found += 1;
        let file = path.display().to_string();
        let arguments = [
            "render",
            &file,
            "--variant",
            "in_context",
            "--stage",
            "plan",
            "--json",
        ];
        let said = finish(fabc(folder.path()).args(arguments));
        assert_eq!(said.code, 0, "{file}: {}", said.stderr);
        let value: Value = serde_json::from_str(&said.stdout).unwrap();
        let messages = value["stages"][0]["messages"].as_array().unwrap();
        // A system message, ten examples of two messages each, and the question.
        assert_eq!(messages.len(), 22, "{file}");
    }
    assert!(found >= 3, "{found}");
}
