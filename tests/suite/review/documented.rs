//! What `docs/review.md` shows: the workflow is one, and keys and JSON fields are those there are.

use super::super::support::{fabc, finish, project};
use serde_json::Value;
use std::fs;

#[test]
fn the_workflow_is_one_that_can_be_run() {
    let text = fs::read_to_string(project("docs/examples/prompts.yml")).unwrap();
    let workflow: Value = serde_saphyr::from_str(&text).unwrap();
    assert!(workflow["on"].is_object() && workflow["name"].is_string());
    let jobs = workflow["jobs"].as_object().unwrap();
    assert!(!jobs.is_empty());
    for job in jobs.values() {
        assert!(job["runs-on"].is_string());
        for step in job["steps"].as_array().unwrap() {
            let does = [&step["uses"], &step["run"]];
            assert_eq!(
                does.iter().filter(|does| does.is_string()).count(),
                1,
                "{step}"
            );
        }
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
    super::made::each_kind(&folder.path().join("snapshots"));
    let said = finish(fabc(folder.path()).args(["review", "--json", "--reject", "half@start"]));
    let value: Value = serde_json::from_str(&said.stdout).unwrap();
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
