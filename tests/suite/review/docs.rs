//! Checks `docs/review.md`: its workflow is valid, and its keys and JSON fields are the real ones.

use super::super::support::{fabc, finish, finish_process, project};
use serde_json::Value;
use std::fs;
#[cfg(unix)]
use std::process::Command;

fn workflow() -> Value {
    let text = fs::read_to_string(project("docs/examples/prompts.yml")).unwrap();
    serde_saphyr::from_str(&text).unwrap()
}

#[test]
fn the_workflow_is_one_that_can_be_run() {
    let workflow = workflow();
    assert!(workflow["on"].is_object() && workflow["name"].is_string());
    let jobs = workflow["jobs"].as_object().unwrap();
    assert!(!jobs.is_empty());
    for job in jobs.values() {
        assert!(job["runs-on"].is_string());
        let mut ids = Vec::new();
        for step in job["steps"].as_array().unwrap() {
            let does = [&step["uses"], &step["run"]];
            assert_eq!(
                does.iter().filter(|does| does.is_string()).count(),
                1,
                "{step}"
            );
            let when = step["if"].as_str().unwrap_or_default();
            let named = when.split("steps.").skip(1);
            let named: Vec<&str> = named.filter_map(|rest| rest.split('.').next()).collect();
            assert!(named.iter().all(|id| ids.contains(id)), "{when}");
            // The step that reports changes is skipped if fabc could not be built.
            assert!(!when.contains("failure()") || !named.is_empty(), "{when}");
            ids.extend(step["id"].as_str());
        }
        let comparing = job["steps"].as_array().unwrap().iter();
        let comparing = comparing.filter(|step| step["id"] == "compare");
        let runs: Vec<&str> = comparing.filter_map(|step| step["run"].as_str()).collect();
        assert!(
            matches!(runs[..], [run] if run.contains("--check")),
            "{runs:?}"
        );
    }
}

#[cfg(unix)]
#[test]
fn the_workflow_says_which_variable_is_not_set() {
    let workflow = workflow();
    let steps = workflow["jobs"]["snapshots"]["steps"].as_array().unwrap();
    let fetch = steps.iter().find(|step| step["name"] == "Fetch fabc");
    let script = fetch.unwrap()["run"].as_str().unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (repository, reference, missing) in [
        ("", "v1", "FABC_REPOSITORY"),
        ("nowhere", "", "FABC_REF"),
        ("", "", "FABC_REPOSITORY"),
    ] {
        let mut shell = Command::new("sh");
        shell
            .args(["-e", "-c", script])
            .env("RUNNER_TEMP", folder.path())
            .env("FABC_REPOSITORY", repository)
            .env("FABC_REF", reference);
        let said = finish_process(&mut shell);
        assert_eq!(said.code, 1, "{}", said.stderr);
        let words = format!("::error::the variable {missing} is not set");
        assert!(said.stdout.starts_with(&words), "{}", said.stdout);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

#[test]
fn the_chapter_names_every_option_and_field() {
    let chapter = fs::read_to_string(project("docs/review.md")).unwrap();
    let help = finish(fabc(project("").as_ref()).args(["review", "--help"])).stdout;
    let options = help
        .split_whitespace()
        .filter(|word| word.starts_with("--"));
    for option in options.map(|word| word.trim_matches(|letter| ",.;[]".contains(letter))) {
        let is_common = ["--help", "--models"].contains(&option);
        assert!(is_common || chapter.contains(option), "{option}");
    }
    let folder = tempfile::tempdir().unwrap();
    super::fixtures::each_kind(&folder.path().join("snapshots"));
    let review = |arguments: &[&str]| -> Value {
        let said = finish(
            fabc(folder.path())
                .args(["review", "--json"])
                .args(arguments),
        );
        serde_json::from_str(&said.stdout).unwrap()
    };
    let pending = review(&[]);
    let id = pending["groups"][1]["id"].as_str().unwrap();
    let value = review(&["--reject", id]);
    let maps = [
        &value,
        &value["groups"][0],
        &value["groups"][0]["snapshots"][0],
    ];
    for key in maps.iter().flat_map(|map| map.as_object().unwrap().keys()) {
        assert!(chapter.contains(key.as_str()), "{key}");
    }
    for kind in value["groups"].as_array().unwrap() {
        assert!(chapter.contains(&format!("`{}`", kind["kind"].as_str().unwrap())));
    }
}
