//! The examples in `docs/build.md` do what the page says.

use super::common::workspace;
use super::{drivers, programs};
use std::process::Command;

/// Returns the first code block of that kind.
fn block(kind: &str) -> String {
    let page = std::fs::read_to_string(workspace().join("docs/build.md")).unwrap();
    let fence = format!("```{kind}\n");
    let begin = page.find(&fence).unwrap() + fence.len();
    page[begin..begin + page[begin..].find("```").unwrap()].to_owned()
}

/// Runs Python source in the folder of the built files and returns what it prints.
fn run(python: &std::ffi::OsStr, kind: &str) -> String {
    let built = drivers::build(
        &programs::shipped("double_straight"),
        &format!("docs_{kind}"),
    );
    let said = Command::new(python)
        .args(["-B", "-W", "error", "-c", &block(kind)])
        .current_dir(&built.folder)
        .output()
        .unwrap();
    assert!(
        said.status.success(),
        "{}",
        String::from_utf8_lossy(&said.stderr)
    );
    String::from_utf8(said.stdout).unwrap()
}

#[test]
fn the_python_example_prints_what_the_page_says() {
    let Some(python) = drivers::python("the_python_example_prints_what_the_page_says") else {
        return;
    };
    assert_eq!(run(python.as_ref(), "python"), "None\nmoves\n");
}

#[test]
fn the_rust_example_holds() {
    let built = drivers::build(&programs::shipped("double_straight"), "docs_rust");
    let source = built.folder.join("example.rs");
    std::fs::write(&source, block("rust")).unwrap();
    let executable = built.folder.join("example");
    drivers::rustc(&["--edition", "2021"], &source, &executable);
    let said = Command::new(executable).output().unwrap();
    assert!(
        said.status.success(),
        "{}",
        String::from_utf8_lossy(&said.stderr)
    );
}

#[test]
#[ignore = "needs Python with jinja2 3.1.6"]
fn peer_python_fills_a_prompt_as_the_page_says() {
    let python = std::env::var_os("FABC_PEER_PYTHON").expect("make test-all names a Python");
    assert_eq!(
        run(&python, "python-jinja2"),
        "- Method of folding: fold left\n- Cloth corners: (20, 30), (200, 30)\n- Cloth center: (110, 80)\n"
    );
}
