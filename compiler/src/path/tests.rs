//! Paths are resolved, and none leads out of the folder.

use super::*;

#[test]
fn paths_are_relative_to_the_file_and_normalised() {
    assert_eq!(beside("tasks/a.fab", "lib/b.fab"), "tasks/lib/b.fab");
    assert_eq!(beside("tasks/lib/b.fab", "./../c.fab"), "tasks/c.fab");
    assert_eq!(beside("a.fab", "../../c.fab"), "../../c.fab");
    assert_eq!(beside("/x/a.fab", "../../c.fab"), "/c.fab");
    assert_eq!(beside("a.fab", "b//c.fab"), "b/c.fab");
}

#[test]
fn no_path_leads_out_of_the_folder() {
    assert_eq!(within("a.fab", "lib/../b.fab"), Some("b.fab".to_owned()));
    assert_eq!(within("lib/a.fab", "../b.fab"), Some("b.fab".to_owned()));
    for path in ["../b.fab", "..", "lib/../../b.fab", "./.././b.fab"] {
        assert_eq!(within("a.fab", path), None, "{path}");
    }
    assert_eq!(within("lib/a.fab", "../../task/b.fab"), None);
    assert_eq!(within("a.fab", "../lib/b.fab"), None);
}

#[test]
fn a_library_may_lie_beside_the_folder_and_nothing_else() {
    for (file, path) in [
        ("a.fab", "../lib/b.fab"),
        ("../lib/a.fab", "b.fab"),
        ("deep/a.fab", "../../lib/b.fab"),
    ] {
        assert_eq!(
            within_or_library(file, path),
            Some("../lib/b.fab".to_owned())
        );
    }
    assert_eq!(
        within_or_library("../lib/a.fab", "sub/b.fab"),
        Some("../lib/sub/b.fab".to_owned())
    );
    for (file, path) in [
        ("a.fab", "../b.fab"),
        ("a.fab", "../lib"),
        ("a.fab", "../library/b.fab"),
        ("a.fab", "../../lib/b.fab"),
        ("a.fab", "../lib/../b.fab"),
        ("../lib/a.fab", "../b.fab"),
        ("../lib/a.fab", "../../lib/b.fab"),
    ] {
        assert_eq!(within_or_library(file, path), None, "{file} {path}");
    }
}
