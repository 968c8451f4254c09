//! `check --fix`: which files are written, and how.
//!
//! Which edits are applied is tested with the compiler (`compiler/tests/suite/fixes.rs`).

use super::support::{fabc, finish, project};
use std::fs;
use std::path::Path;

const SLIP: &str = "use \"lib/base.fab\"\ntask tried extends base {\n    keypoints { more := centroid(cloth) }\n}\n";

/// Writes a file with one slip, and the library that it uses.
fn with_slip(folder: &Path, name: &str) {
    fs::create_dir_all(folder.join("lib")).unwrap();
    let library = folder.join("lib/base.fab");
    fs::copy(project("tests/fixtures/faults/lib/base.fab"), library).unwrap();
    fs::write(folder.join(name), SLIP).unwrap();
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn a_file_that_was_not_named_is_not_changed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    with_slip(folder, "task.fab");
    let library = read(folder, "lib/base.fab").replace("45deg", "45°");
    fs::write(folder.join("lib/base.fab"), &library).unwrap();

    let said = finish(fabc(folder).args(["check", "--fix", "task.fab"]));
    assert_eq!(said.code, 1, "{}", said.stdout);
    assert_eq!(
        said.stderr,
        "task.fab: 1 change\n\
         lib/base.fab: not changed, because it was not named; it has 1 certain correction\n"
    );
    assert!(read(folder, "task.fab").contains("more = centroid"));
    assert_eq!(read(folder, "lib/base.fab"), library);

    // A diff shows what would be written, also where one file needs another to be fixed, and writes nothing.
    let arguments = ["check", "--fix", "--diff", "task.fab", "lib/base.fab"];
    let said = finish(fabc(folder).args(arguments));
    assert_eq!(
        (said.code, said.stderr.as_str()),
        (1, "lib/base.fab: 1 change, not made\n")
    );
    let diff = "--- lib/base.fab\n+++ lib/base.fab\n@@ -";
    assert!(said.stdout.starts_with(diff), "{}", said.stdout);
    assert_eq!(read(folder, "lib/base.fab"), library);

    // The task is reported after its library is fixed, although it is named before it.
    let said = finish(fabc(folder).args(["check", "--fix", "task.fab", "lib/base.fab"]));
    assert_eq!(
        (said.code, said.stderr.as_str()),
        (0, "lib/base.fab: 1 change\n")
    );
    assert!(read(folder, "lib/base.fab").contains("45deg"));
}

#[test]
fn a_diff_is_shown_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    with_slip(folder, "task.fab");
    let diff = "--- task.fab\n+++ task.fab\n@@ -1,4 +1,4 @@\n use \"lib/base.fab\"\n task tried extends base {\n\
        -    keypoints { more := centroid(cloth) }\n+    keypoints { more = centroid(cloth) }\n }\n";
    let said = finish(fabc(folder).args(["check", "--fix", "--diff", "task.fab"]));
    assert_eq!(
        (said.code, said.stderr.as_str()),
        (1, "task.fab: 1 change, not made\n")
    );
    // The report after it is about the file as it is.
    assert!(
        said.stdout.starts_with(&format!("{diff}error[F")),
        "{}",
        said.stdout
    );
    assert_eq!(read(folder, "task.fab"), SLIP);

    let said = finish(fabc(folder).args(["check", "--fix", "--diff", "--json", "task.fab"]));
    let value: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(value["diff"], diff);
    assert_eq!(value["diagnostics"].as_array().map(Vec::len), Some(1));
    assert_eq!(read(folder, "task.fab"), SLIP);

    // Without a change there is no diff; without `--fix` there is nothing to show.
    let said = finish(fabc(folder).args(["check", "--fix", "--diff", "lib/base.fab"]));
    assert_eq!((said.code, said.stderr.as_str()), (0, ""));
    assert!(
        said.stdout.starts_with("lib/base.fab: task"),
        "{}",
        said.stdout
    );
    let said = finish(fabc(folder).args(["check", "--diff", "task.fab"]));
    assert_eq!(said.code, 64);
}

#[test]
fn denied_warnings_end_with_code_1() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    with_slip(folder, "task.fab");
    let check = |condition: &str, option: &[&str]| {
        let check = format!("check a {{ {condition} }} else \"A.\"");
        let text = SLIP.replace("keypoints { more := centroid(cloth) }", &check);
        fs::write(folder.join("task.fab"), text).unwrap();
        let arguments = [&["check", "task.fab"], option].concat();
        let said = finish(fabc(folder).args(arguments));
        (said.code, said.stderr)
    };
    let denied = &["--deny-warnings"][..];
    let far = "distance(pick, place) > 20px";
    let never = "distance(pick, pick) > 20px";
    assert_eq!(check(never, &[]), (0, String::new()));
    let message = "error: 1 warning, and `--deny-warnings` allows none\n";
    assert_eq!(check(never, denied), (1, message.to_owned()));
    assert_eq!(check(far, denied), (0, String::new()));
    assert_eq!(check("nonsense", denied).0, 1);
}

#[test]
fn a_read_only_file_is_not_changed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    with_slip(folder, "task.fab");
    let file = folder.join("task.fab");
    let mut permissions = fs::metadata(&file).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&file, permissions).unwrap();

    let said = finish(fabc(folder).args(["check", "--fix", "task.fab"]));
    assert_eq!(said.code, 1);
    assert_eq!(
        said.stderr,
        "task.fab: not changed, because it is read-only; it has 1 certain correction\n"
    );
    assert_eq!(read(folder, "task.fab"), SLIP);
}

#[cfg(unix)]
#[test]
fn links_and_permissions_stay() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let number = |name: &str| fs::metadata(folder.join(name)).unwrap().ino();
    let mode = |name: &str| {
        fs::metadata(folder.join(name))
            .unwrap()
            .permissions()
            .mode()
    };

    // The file is replaced, and a symbolic link still leads to it.
    with_slip(folder, "other.fab");
    let permissions = PermissionsExt::from_mode(0o640);
    fs::set_permissions(folder.join("other.fab"), permissions).unwrap();
    symlink("other.fab", folder.join("link.fab")).unwrap();
    let before = number("other.fab");
    finish(fabc(folder).args(["check", "--fix", "link.fab"]));
    assert!(read(folder, "other.fab").contains("more = centroid"));
    assert!(folder.join("link.fab").is_symlink());
    assert_ne!(number("other.fab"), before);
    assert_eq!(mode("other.fab") & 0o777, 0o640);
}

#[test]
fn json_says_whether_an_edit_is_certain() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let certain = |condition: &str| {
        with_slip(folder, "task.fab");
        let check = format!("verify {{ check a {{ {condition} }} else \"A.\" }}");
        let text = SLIP.replace("keypoints { more := centroid(cloth) }", &check);
        fs::write(folder.join("task.fab"), text).unwrap();
        let said = finish(fabc(folder).args(["check", "--json", "task.fab"]));
        let value: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
        value["diagnostics"][0]["edits"][0]["certain"].clone()
    };
    let far = "distance(pick, place) > 20px";
    assert_eq!(certain(&format!("{far} && {far}")), true);
    assert_eq!(certain("distance(pick, plaec) > 20px"), false);
}
