//! Holds the shape of the tree: who may depend on whom, who may name what, how a file looks.
//!
//! In: every text file under the package's root, as it lies on disk. Out: one test per rule;
//! a failure lists `file:line: what is wrong` for every violation. The rules read text, not
//! types: they leave to clippy and the compiler whatever those can see.

#[path = "tidy/reading.rs"]
mod reading;

use reading::{Name, TextFile, code_only, dependencies, names, numbered, tree};

/// The crates that each crate may depend on, tests included; `fabc` at the root may use all.
const EDGES: [(&str, &[&str]); 4] = [
    ("grammar", &[]),
    ("compiler", &["grammar"]),
    ("sim", &[]),
    ("runtime", &["compiler", "sim"]),
];

/// Names that belong to one place: what is named, where that counts, the only place for it.
const RESERVED: [(Name, &str, &str); 9] = [
    (Name::Word("opencv"), "", "runtime/src/vision"),
    (
        Name::Crate("sim"),
        "runtime/src/",
        "runtime/src/world/simulated",
    ),
    (Name::Word("pest"), "", "grammar/src/"),
    (Name::Word("pest_derive"), "", "grammar/src/"),
    (Name::Word("Rule"), "", "grammar/src/"),
    (Name::Word("clap"), "", "src/"),
    (
        Name::Word("reqwest"),
        "runtime/src/",
        "runtime/src/model/remote",
    ),
    (Name::Word("axum"), "runtime/src/", "runtime/src/serve"),
    (Name::Word("roslibrust"), "", "runtime/src/arm/ros"),
];

/// The most lines of a Rust file; test tables belong into fixtures.
const MAX_LINES: usize = 400;

/// Files that may be longer, each with the reason.
const LONG_FILES: [(&str, &str); 0] = [];

/// Folders of one machine, in halves so that this file does not name them itself.
const MACHINE_FOLDERS: [&str; 4] = [
    concat!("/wo", "rk/"),
    concat!("/ro", "ot/"),
    concat!("/ho", "me/"),
    concat!("/Us", "ers/"),
];

/// The folder beside the checkout, which only the continuous-integration script may know.
const NEIGHBOUR_FOLDERS: [&str; 3] = [
    concat!("../sha", "red"),
    concat!("sha", "red/data"),
    concat!("sha", "red/design"),
];

#[test]
fn crates_depend_only_in_the_drawn_direction() {
    report(&edge_faults(&tree()));
}

#[test]
fn every_dependency_says_why_it_is_there() {
    report(&reason_faults(&tree()));
}

#[test]
fn reserved_names_stay_in_their_place() {
    report(&name_faults(&tree()));
}

#[test]
fn rust_files_start_with_their_purpose_and_stay_short() {
    report(&form_faults(&tree()));
}

#[test]
fn tests_left_to_make_test_peers_are_named_after_the_reason() {
    report(&ignore_faults(&tree()));
}

#[test]
fn no_file_names_a_folder_of_somebodys_machine() {
    report(&place_faults(&tree()));
}

#[test]
fn tests_that_lack_recorded_data_count_as_skipped() {
    report(&skip_faults(&tree()));
}

/// Checks the checks: each text breaks exactly one rule, on a known line, or none.
#[test]
fn each_rule_finds_what_it_forbids_and_nothing_else() {
    let rules = [
        edge_faults,
        reason_faults,
        name_faults,
        form_faults,
        ignore_faults,
        place_faults,
        skip_faults,
    ];
    let tilde_home = concat!("see ~/wo", "rk/a and https://host/ho", "me/a\n");
    let machine_path = concat!("one\ncd '/wo", "rk/a'\n");
    let too_long = format!("//! Long.\n{}", "// more\n".repeat(MAX_LINES));
    let samples: [(&str, &str, Option<usize>); 24] = [
        (
            "compiler/Cargo.toml",
            "[dependencies]\ngrammar = { workspace = true }\n",
            None,
        ),
        (
            "compiler/Cargo.toml",
            "[dev-dependencies]\nsim.workspace = true\n",
            Some(2),
        ),
        (
            "sim/Cargo.toml",
            "[dependencies.x] # why\npackage = \"grammar\"\n",
            Some(1),
        ),
        (
            "sim/Cargo.toml",
            "[target.'cfg(unix)'.dependencies.grammar]\n",
            Some(1),
        ),
        (
            "Cargo.toml",
            "[workspace.dependencies]\nserde = \"1\"\n",
            None,
        ),
        (
            "Cargo.toml",
            "[dependencies]\n# its JSON\nserde = \"1\"\nurl = \"1\" # its links\n",
            None,
        ),
        (
            "Cargo.toml",
            "[dependencies]\nurl = { git = \"https://host/#a\" }\n",
            Some(2),
        ),
        (
            "runtime/src/vision/blur.rs",
            "//! Uses opencv.\nuse opencv::core;\n",
            None,
        ),
        (
            "runtime/src/scene.rs",
            "//! Speaks of opencv.\n// opencv::core\nf(\"opencv\");\n",
            None,
        ),
        (
            "runtime/src/scene.rs",
            "//! A.\n/* one\n*/ fn f<'a>() { '\"'; ::opencv::core::f() }\n",
            Some(3),
        ),
        (
            "runtime/src/world/simulated.rs",
            "//! A.\nuse fab_sim::Cloth;\n",
            None,
        ),
        (
            "runtime/src/world/mod.rs",
            "//! A.\nmod sim;\npub use self::sim::SimWorld;\n",
            None,
        ),
        (
            "runtime/src/agent.rs",
            "//! A.\nlet c = ::sim::Cloth;\n",
            Some(2),
        ),
        (
            "runtime/src/agent.rs",
            "//! A.\nuse sim as cloth;\n",
            Some(2),
        ),
        (
            "compiler/src/check.rs",
            "//! A.\nr#\"a \" Rule\"#; Rule::task;\n",
            Some(2),
        ),
        (
            "compiler/src/check.rs",
            "//! A.\nuse clap::Parser;\n",
            Some(2),
        ),
        ("src/main.rs", "//! A.\nuse clap::Parser;\n", None),
        ("src/main.rs", "// A.\n", Some(1)),
        ("src/main.rs", &too_long, Some(MAX_LINES + 1)),
        (
            "tests/a.rs",
            "//! A.\n#[test]\n#[ignore = \"slow\"]\nfn folds() {}\n",
            Some(4),
        ),
        (
            "tests/a.rs",
            "//! A.\n#[test]\nfn long_folds() {}\n",
            Some(3),
        ),
        (
            "tests/a.rs",
            "//! A.\n#[test]\n#[ignore]\nfn peer_folds() {}\n",
            None,
        ),
        ("README.md", tilde_home, None),
        ("scripts/a.sh", machine_path, Some(2)),
    ];
    for (path, text, expected) in samples {
        let files = [TextFile {
            path: path.into(),
            text: text.into(),
        }];
        let found: Vec<String> = rules.iter().flat_map(|rule| rule(&files)).collect();
        match expected {
            None => assert!(found.is_empty(), "{path} is clean, but: {found:?}\n{text}"),
            Some(line) => assert!(
                matches!(&found[..], [one] if one.starts_with(&format!("{path}:{line}: "))),
                "expected one fault on line {line} of {path}, found {found:?}\n{text}"
            ),
        }
    }
}

fn report(faults: &[String]) {
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

fn edge_faults(files: &[TextFile]) -> Vec<String> {
    let mut faults = Vec::new();
    for (owner, allowed) in EDGES {
        let manifest = format!("{owner}/Cargo.toml");
        for file in files.iter().filter(|file| file.path == manifest) {
            for dependency in dependencies(&file.text) {
                for (other, _) in EDGES.iter().filter(|(other, _)| dependency.is(other)) {
                    if !allowed.contains(other) {
                        let rule = format!(
                            "`{owner}` must not depend on `{other}`, only on {allowed:?} of ours"
                        );
                        faults.push(fault(file, dependency.line, &rule));
                    }
                }
            }
        }
    }
    faults
}

/// Our own crates need no reason: the edges between them are drawn above.
fn reason_faults(files: &[TextFile]) -> Vec<String> {
    let mut faults = Vec::new();
    for file in files
        .iter()
        .filter(|file| file.path.ends_with("Cargo.toml"))
    {
        for dependency in dependencies(&file.text) {
            let ours = EDGES.iter().any(|(name, _)| dependency.is(name));
            if !ours && !dependency.has_reason {
                let rule = format!(
                    "`{}` needs a comment that says what it is for",
                    dependency.name
                );
                faults.push(fault(file, dependency.line, &rule));
            }
        }
    }
    faults
}

fn name_faults(files: &[TextFile]) -> Vec<String> {
    let mut faults = Vec::new();
    for file in files.iter().filter(|file| file.path.ends_with(".rs")) {
        let code = code_only(&file.text);
        for (name, scope, place) in RESERVED {
            if !file.path.starts_with(scope) || file.path.starts_with(place) {
                continue;
            }
            let (Name::Word(word) | Name::Crate(word)) = name;
            for (line, content) in numbered(&code).filter(|(_, content)| names(content, name)) {
                let rule = format!("only {place} may name `{word}`: {}", content.trim());
                faults.push(fault(file, line, &rule));
            }
        }
    }
    faults
}

fn form_faults(files: &[TextFile]) -> Vec<String> {
    let mut faults = Vec::new();
    for file in files.iter().filter(|file| file.path.ends_with(".rs")) {
        if !file.text.starts_with("//!") {
            faults.push(fault(
                file,
                1,
                "a Rust file starts with `//!` and what it is for",
            ));
        }
        let n_lines = file.text.lines().count();
        let excepted = LONG_FILES.iter().any(|(path, _)| *path == file.path);
        if n_lines > MAX_LINES && !excepted && !file.path.contains("/fixtures/") {
            let rule = format!("{n_lines} lines, {MAX_LINES} at most: split it by subject");
            faults.push(fault(file, MAX_LINES + 1, &rule));
        }
    }
    faults
}

/// `make test-peers` picks tests by name, so an ignored test of another name would never run.
fn ignore_faults(files: &[TextFile]) -> Vec<String> {
    let mut faults = Vec::new();
    for file in files.iter().filter(|file| file.path.ends_with(".rs")) {
        let code = code_only(&file.text);
        let (mut is_test, mut is_ignored) = (false, false);
        for (line, content) in numbered(&code) {
            let content = content.trim();
            if content.starts_with("#[") {
                is_test |= content.starts_with("#[test]");
                is_ignored |= content.starts_with("#[ignore");
            } else if !content.is_empty() {
                let name = content.strip_prefix("fn ").unwrap_or_default();
                let left_out = name.starts_with("peer_") || name.starts_with("long_");
                if is_test && is_ignored != left_out {
                    let rule =
                        "a test is `#[ignore]`d exactly if its name starts with `peer_` or `long_`";
                    faults.push(fault(file, line, rule));
                }
                (is_test, is_ignored) = (false, false);
            }
        }
    }
    faults
}

fn place_faults(files: &[TextFile]) -> Vec<String> {
    let mut faults = Vec::new();
    for file in files {
        for (line, content) in numbered(&file.text) {
            for folder in MACHINE_FOLDERS {
                // A letter or a variable before it makes it a part of some other path.
                let absolute = content.match_indices(folder).any(|(at, _)| {
                    let before = content[..at].chars().next_back().unwrap_or(' ');
                    !before.is_alphanumeric() && !"._-~}$)*".contains(before)
                });
                if absolute {
                    faults.push(fault(
                        file,
                        line,
                        &format!("names a machine's own folder `{folder}`"),
                    ));
                }
            }
            if file.path != ".ci/run" && NEIGHBOUR_FOLDERS.iter().any(|name| content.contains(name))
            {
                faults.push(fault(
                    file,
                    line,
                    "only .ci/run may name the folder beside the checkout",
                ));
            }
        }
    }
    faults
}

/// What looks for recorded data has to be able to say that a test lacked it.
fn skip_faults(files: &[TextFile]) -> Vec<String> {
    let calls = ["var_os", "env::var"].map(|call| format!("{call}(\"FABC_REFERENCE_DATA\")"));
    let looks = |file: &&TextFile| calls.iter().any(|call| file.text.contains(call));
    let rule = "a test without its data notes its name in the file of FABC_SKIPPED_FILE";
    let rust = files.iter().filter(|file| file.path.ends_with(".rs"));
    rust.filter(looks)
        .filter(|file| !file.text.contains("FABC_SKIPPED_FILE"))
        .map(|file| fault(file, 1, rule))
        .collect()
}

fn fault(file: &TextFile, line: usize, rule: &str) -> String {
    format!("{}:{line}: {rule}", file.path)
}
