//! Unit tests of `task_files`.

#![allow(clippy::unwrap_used)]
use super::*;

#[test]
fn a_link_out_of_the_folder_is_refused() {
    let outer = tempfile::tempdir().expect("a temporary folder");
    let folder = outer.path().join("task");
    fs::create_dir(&folder).expect("a folder");
    fs::write(outer.path().join("secret.png"), "x").expect("a file");
    fs::write(folder.join("own.png"), "x").expect("a file");
    let file = |path: &str| FileRef {
        path: path.to_owned(),
    };
    assert!(resolve(&folder, &file("own.png")).is_ok());
    let refused = |path: &str| resolve(&folder, &file(path)).unwrap_err().to_string();
    assert!(refused("absent.png").starts_with("cannot read"));
    assert!(refused("../secret.png").contains("leads out of the task's folder"));
    #[cfg(unix)]
    {
        let link = folder.join("link.png");
        std::os::unix::fs::symlink(outer.path().join("secret.png"), link).expect("a link");
        assert!(refused("link.png").contains("leads out of the task's folder"));
    }
}
