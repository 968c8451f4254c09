//! `fabc explain`: one code, and all codes.

use super::support::{fabc, finish};
use std::fs;

#[test]
fn a_code_is_explained_by_an_example_with_its_real_message() {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(fabc(folder.path()).args(["explain", "f0203"]));
    assert_eq!((said.code, said.stderr.as_str()), (0, ""));
    let parts = [
        "error[F0203]: a quantity is of the wrong kind\n\n",
        "\n        goal particle_distance < 40deg\n",
        "error[F0203]: expected a length on the table, found an angle\n --> example.fab:4:30\n",
        "\nRight would be:\n",
    ];
    let places: Vec<Option<usize>> = parts.iter().map(|part| said.stdout.find(part)).collect();
    assert!(
        places.iter().all(Option::is_some) && places.is_sorted(),
        "{}",
        said.stdout
    );
    fs::write(folder.path().join("half.fab"), fab_compiler::explain::HALF).unwrap();
    let (_, example) = said.stdout.split_once("For example:\n\n").unwrap();
    let (example, _) = example.split_once("\nerror").unwrap();
    let example: String = example
        .lines()
        .map(|line| format!("{}\n", line.get(4..).unwrap_or("")))
        .collect();
    fs::write(folder.path().join("example.fab"), example).unwrap();
    let checked = finish(fabc(folder.path()).args(["check", "example.fab"]));
    assert_eq!(checked.code, 1);
    assert!(
        checked.stdout.contains("error[F0203]"),
        "{}",
        checked.stdout
    );
}

#[test]
fn without_a_code_all_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(fabc(folder.path()).arg("explain"));
    assert_eq!(said.code, 0);
    assert_eq!(said.stdout, fab_compiler::explain::list());
}

#[test]
fn an_unknown_code_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(fabc(folder.path()).args(["explain", "F9999"]));
    assert_eq!(said.code, 64, "{}", said.stderr);
    assert!(
        said.stderr.contains("there is no diagnostic `F9999`"),
        "{}",
        said.stderr
    );
}
