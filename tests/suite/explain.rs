//! `fabc explain`: one code, all codes, and the pages of the book.

use super::support::{fabc, finish, root};
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
fn the_pages_that_it_writes_are_those_of_the_book() {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(fabc(folder.path()).args(["explain", "--pages", "a/b"]));
    assert_eq!((said.code, said.stderr.as_str()), (0, ""));
    let book = root().join("docs/diagnostics");
    let mut n_pages = 0;
    for line in said.stdout.lines() {
        n_pages += 1;
        let name = line.strip_prefix("a/b/").unwrap();
        let written = fs::read_to_string(folder.path().join(line)).unwrap();
        assert_eq!(
            written,
            fs::read_to_string(book.join(name)).unwrap(),
            "{name}"
        );
    }
    assert_eq!(n_pages, fs::read_dir(book).unwrap().count());
}

#[test]
fn what_it_cannot_do_is_said_with_its_values() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("taken"), "").unwrap();
    for (arguments, code, words) in [
        (
            &["explain", "F9999"][..],
            64,
            "there is no diagnostic `F9999`",
        ),
        (
            &["explain", "F0203", "--pages", "a"],
            64,
            "cannot be used with",
        ),
        (&["explain", "--pages", "taken"], 2, "cannot write `taken`"),
    ] {
        let said = finish(fabc(folder.path()).args(arguments));
        assert_eq!(said.code, code, "{}", said.stderr);
        assert!(said.stderr.contains(words), "{}", said.stderr);
    }
}
