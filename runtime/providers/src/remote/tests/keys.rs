//! Tests of API keys: where they come from, what is refused, and that nothing shows them.

use super::*;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

const CANARY: &str = "sk-canary-0123456789";

fn file(content: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("keys.toml");
    fs::write(&path, content).expect("a file");
    restrict(&path, 0o600);
    (folder, path)
}

#[cfg(unix)]
fn restrict(path: &Path, mode: u32) {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("permissions");
}

#[cfg(not(unix))]
fn restrict(_: &Path, _: u32) {}

fn in_file(path: &Path, name: &str) -> Result<Option<Key>, String> {
    Key::find(&[name], &|_| None, Some(path))
}

#[test]
fn the_environment_comes_before_the_file_and_the_first_name_before_the_second() {
    let (_folder, path) = file("FIRST = \"first-of-file\"\nSECOND = \"second-of-file\"\n");
    for (set, expected) in [
        (&[("FIRST", "a1"), ("SECOND", "a2")][..], Some("a1")),
        (&[("SECOND", " a2\r\n")], Some("a2")),
        (&[("FIRST", "  "), ("SECOND", "a2")], Some("a2")),
        (&[], Some("first-of-file")),
        (&[("OTHER", "x")], Some("first-of-file")),
    ] {
        let lookup = |name: &str| {
            let found = set.iter().find(|(set, _)| *set == name);
            found.map(|(_, value)| (*value).to_owned())
        };
        let key = Key::find(&["FIRST", "SECOND"], &lookup, Some(&path)).expect("keys");
        assert_eq!(key.as_ref().map(Key::expose), expected, "{set:?}");
    }
    let none = Key::find(&["ABSENT"], &|_| None, Some(&path)).expect("keys");
    assert!(none.is_none());
    assert!(
        Key::find(&["FIRST"], &|_| None, None)
            .expect("keys")
            .is_none()
    );
}

#[test]
fn values_that_no_header_can_carry_are_refused_and_not_repeated() {
    for value in [
        "",
        "  \n",
        "sk-canary-0123456789 and more",
        "sk-canary-0123456789\nHost: elsewhere",
        "sk-canary-ü0123456789",
    ] {
        let error = Key::new("OPENAI_API_KEY", value).expect_err("refused");
        let said = format!("{error} {error:?}");
        assert!(said.contains("OPENAI_API_KEY"), "{said}");
        assert!(!said.contains("canary"), "{said}");
    }
}

#[cfg(unix)]
#[test]
fn a_file_that_others_can_read_is_refused_with_the_command_that_mends_it() {
    let (_folder, path) = file(&format!("OPENAI_API_KEY = \"{CANARY}\"\n"));
    for (mode, is_refused) in [
        (0o600, false),
        (0o400, false),
        (0o640, true),
        (0o604, true),
        (0o620, true),
        (0o610, true),
    ] {
        restrict(&path, mode);
        assert_eq!(Key::names_in(&path).is_err(), is_refused, "mode {mode:o}");
        let found = in_file(&path, "OPENAI_API_KEY");
        match found {
            Ok(key) => {
                assert!(!is_refused, "mode {mode:o}");
                assert_eq!(key.expect("a key").expose(), CANARY);
            }
            Err(error) => {
                assert!(is_refused, "mode {mode:o}: {error}");
                assert!(error.contains("chmod 600"), "{error}");
                assert!(!error.contains(CANARY), "{error}");
            }
        }
    }
}

#[test]
fn broken_files_are_refused_without_quoting_them() {
    for (content, expected) in [
        ("A = 1\nOPENAI_API_KEY = sk-canary-0123456789\n", "line 2"),
        ("OPENAI_API_KEY = \"sk-canary-0123456789\nB = 2\n", "line 1"),
        (
            "A = \"a\"\n\nOPENAI_API_KEY = [\"sk-canary-0123456789\"]\n",
            "line 3",
        ),
        (
            "A = \"sk-canary-0123456789\"\nA = \"sk-canary-0123456789\"\n",
            "line 2",
        ),
        ("sk-canary-0123456789\n", "line 1"),
        (
            "A = \"a\"\nsk-canary-0123456789 = \"OPENAI_API_KEY\"\n",
            "line 2",
        ),
        ("Z = \"a\"\n[sk-canary-0123456789]\nB = 1\n", "line 2"),
    ] {
        let (_folder, path) = file(content);
        let error = in_file(&path, "OPENAI_API_KEY").expect_err("refused");
        let said = format!("{error} {error:?}");
        assert!(error.contains(expected), "{said}");
        assert!(!said.contains("canary"), "{said}");
        assert_eq!(Key::names_in(&path), Err(error), "one message per fault");
    }
    let (_folder, path) = file("OPENAI_API_KEY = \"\"\n");
    let error = in_file(&path, "OPENAI_API_KEY").expect_err("refused");
    assert!(error.contains("empty"), "{error}");
    let (folder, path) = file(&"# no key\n".repeat(10_000));
    let absent = folder.path().join("absent.toml");
    for path in [path.as_path(), &absent, folder.path()] {
        let error = in_file(path, "A").expect_err("unreadable");
        assert!(error.starts_with("cannot read the keys in"), "{error}");
    }
}

#[test]
fn the_names_in_a_file_are_told_and_its_keys_are_not() {
    let (_folder, path) = file("# mine\nOPENAI_API_KEY = \"sk-canary\"\nGEMINI_API_KEY = \"\"\n");
    let names = Key::names_in(&path).expect("a list");
    assert_eq!(names, ["GEMINI_API_KEY", "OPENAI_API_KEY"]);
}

#[test]
fn a_key_shows_its_name_alone() {
    let key = Key::new("OPENAI_API_KEY", CANARY).expect("a key");
    let said = format!("{key:?}");
    assert!(
        said.contains("OPENAI_API_KEY") && !said.contains("canary"),
        "{said}"
    );
    assert_eq!(key.name(), "OPENAI_API_KEY");
}
