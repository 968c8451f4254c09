//! Checks the structure of the tree: which packages may depend on each other, where reserved names may occur, what a
//! package may include, how a file begins.
//!
//! In: every text file below the package's root on disk. Out: one test per rule; a failure lists
//! `file:line: what is wrong` for every violation. The rules read text, not types: everything that clippy and the
//! compiler can check is left to them.

#[path = "tidy/reading.rs"]
mod reading;

use reading::{
    Dependency, Name, Purpose, TextFile, code_only, dependencies, names, numbered, reached, tree,
};

/// One package of the workspace, and our packages that it may depend on.
struct Member {
    folder: &'static str,
    package: &'static str,
    needs: &'static [&'static str],
    /// Further packages that its tests and benchmarks may use.
    tests_need: &'static [&'static str],
}

/// Every member; `fabc` at the root may use all.
const MEMBERS: [Member; 19] = [
    member("grammar", "fab-grammar", &[], &[]),
    member("compiler/program", "fab-program", &[], &[]),
    member(
        "compiler",
        "fab-compiler",
        &["fab-grammar", "fab-program"],
        &["fab-emit"],
    ),
    member(
        "compiler/emit",
        "fab-emit",
        &["fab-program"],
        &["fab-compiler"],
    ),
    member("sim", "fab-sim", &[], &[]),
    member("runtime/base", "fab-base", &["fab-program"], &[]),
    member(
        "runtime/picture",
        "fab-picture",
        &["fab-base", "fab-program"],
        &[],
    ),
    member(
        "runtime/vision",
        "fab-vision",
        &["fab-picture", "fab-program"],
        &[],
    ),
    member(
        "runtime/model",
        "fab-model",
        &["fab-base", "fab-program"],
        &[],
    ),
    member(
        "runtime/providers",
        "fab-providers",
        &["fab-base", "fab-model", "fab-picture", "fab-program"],
        &["fab-test-provider"],
    ),
    member("tests/provider", "fab-test-provider", &["fab-model"], &[]),
    member(
        "runtime/local-server",
        "fab-local-server",
        &["fab-base"],
        &[],
    ),
    member(
        "runtime/standins",
        "fab-standins",
        &["fab-base", "fab-model", "fab-picture", "fab-program"],
        &[],
    ),
    member(
        "runtime/world",
        "fab-world",
        &["fab-base", "fab-picture", "fab-program", "fab-sim"],
        &[],
    ),
    member(
        "runtime/arm",
        "fab-arm",
        &[
            "fab-base",
            "fab-picture",
            "fab-program",
            "fab-sim",
            "fab-world",
        ],
        &[],
    ),
    member("runtime/arm-ros", "fab-arm-ros", &["fab-arm"], &[]),
    member("runtime/arm-ros2", "fab-arm-ros2", &["fab-arm"], &[]),
    member(
        "runtime/agent",
        "fab-agent",
        &[
            "fab-arm",
            "fab-base",
            "fab-model",
            "fab-picture",
            "fab-program",
            "fab-vision",
            "fab-world",
        ],
        &["fab-compiler", "fab-sim", "fab-standins"],
    ),
    member(
        "runtime/bench",
        "fab-bench",
        &[
            "fab-agent",
            "fab-arm",
            "fab-base",
            "fab-model",
            "fab-program",
            "fab-world",
        ],
        &["fab-compiler", "fab-standins"],
    ),
];

/// Packages that parse `.fab` text; embedding a compiled task needs none of them.
const PARSERS: [&str; 5] = [
    "fab-grammar",
    "fab-compiler",
    "pest",
    "pest_derive",
    "annotate-snippets",
];

/// Packages that find, bind or build a system library, besides all whose names end in `-sys`.
const SYSTEM: [&str; 8] = [
    "opencv",
    "bindgen",
    "cc",
    "cmake",
    "clang",
    "pkg-config",
    "vcpkg",
    "psm",
];

/// Names reserved for one place: the name, where the rule applies, the only place where it may occur.
const RESERVED: [(Name, &str, &str); 10] = [
    (Name::Word("opencv"), "", "runtime/vision/"),
    (
        Name::Crate("fab_sim"),
        "runtime/world/src/",
        "runtime/world/src/simulated",
    ),
    (Name::Word("pest"), "", "grammar/src/"),
    (Name::Word("pest_derive"), "", "grammar/src/"),
    (Name::Word("Rule"), "", "grammar/src/"),
    (Name::Word("clap"), "", "src/"),
    (
        Name::Word("reqwest"),
        "runtime/",
        "runtime/providers/src/remote",
    ),
    (Name::Word("axum"), "", "runtime/local-server/"),
    (Name::Word("roslibrust"), "", "runtime/arm-ros/"),
    (Name::Word("rustdds"), "", "runtime/arm-ros2/"),
];

/// What the code of twins may name in its tests alone; each pair is a place and a word. A twin may know of the judged cloth only
/// what a camera shows, and whoever has a world can ask it where the particles lie.
const KEPT_FROM_TWINS: [(&str, &str); 6] = [
    ("runtime/world/src/twin", "dyn World"),
    ("runtime/world/src/twin", "particles"),
    ("runtime/agent/src/twins", "World"),
    ("runtime/agent/src/twins", "SimulatedWorld"),
    ("runtime/agent/src/twins", "Start"),
    ("runtime/agent/src/twins", "particles"),
];

/// Folders of one machine, split so that this file does not contain the names.
const MACHINE_FOLDERS: [&str; 4] = [
    concat!("/wo", "rk/"),
    concat!("/ro", "ot/"),
    concat!("/ho", "me/"),
    concat!("/Us", "ers/"),
];

/// The folder beside the checkout, which only the continuous-integration script may name.
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
fn what_embedders_link_needs_no_parser_and_no_system_library() {
    report(&reach_faults(&tree()));
}

#[test]
fn packages_include_nothing_from_outside_their_folder() {
    report(&include_faults(&tree()));
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
fn twins_are_given_no_world_and_no_particles() {
    report(&twin_faults(&tree()));
}

#[test]
fn rust_files_start_with_their_purpose() {
    report(&form_faults(&tree()));
}

#[test]
#[ignore = "long"]
fn ignored_tests_are_named_after_the_reason() {
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

/// Tests the rules themselves: each text breaks exactly one rule, on a known line, or none.
#[test]
fn each_rule_finds_what_it_forbids_and_nothing_else() {
    let rules = [
        edge_faults,
        reach_faults,
        include_faults,
        reason_faults,
        name_faults,
        twin_faults,
        form_faults,
        ignore_faults,
        place_faults,
        skip_faults,
    ];
    let tilde_home = concat!("see ~/wo", "rk/a and https://host/ho", "me/a\n");
    let machine_path = concat!("one\ncd '/wo", "rk/a'\n");
    let samples: [(&str, &str, Option<usize>); 38] = [
        (
            "compiler/Cargo.toml",
            "[dependencies]\nfab-grammar = { workspace = true }\n",
            None,
        ),
        (
            "compiler/Cargo.toml",
            "[dependencies]\nfab-sim.workspace = true\n",
            Some(2),
        ),
        (
            "compiler/program/Cargo.toml",
            "[dependencies]\nfab-grammar = { workspace = true }\n",
            Some(2),
        ),
        (
            "compiler/program/Cargo.toml",
            "[dependencies]\npest = \"2\" # reads text\n",
            Some(2),
        ),
        (
            "compiler/emit/Cargo.toml",
            "[dependencies]\nfab-compiler = { path = \"..\" }\n",
            Some(2),
        ),
        (
            "compiler/emit/Cargo.toml",
            "[dev-dependencies]\nfab-compiler = { path = \"..\" }\n",
            None,
        ),
        (
            "compiler/emit/Cargo.toml",
            "[dev-dependencies]\nfab-compiler = { workspace = true }\n",
            Some(2),
        ),
        (
            "Cargo.lock",
            "[[package]]\nname = \"fab-program\"\ndependencies = [\n \"proptest\",\n]\n\n\
             [[package]]\nname = \"proptest\"\ndependencies = [\n \"cc\",\n]\n",
            None,
        ),
        (
            "Cargo.lock",
            "[[package]]\nname = \"fab-program\"\ndependencies = [\n \"sha2 0.11.1\",\n]\n\n\
             [[package]]\nname = \"sha2\"\ndependencies = [\n \"libc\",\n]\n",
            None,
        ),
        (
            "Cargo.lock",
            "[[package]]\nname = \"fab-program\"\ndependencies = [\n \"a 1.0.0\",\n]\n\n\
             [[package]]\nname = \"a\"\ndependencies = [\n \"zstd-sys\",\n]\n",
            Some(1),
        ),
        (
            "compiler/src/new.rs",
            "//! A.\nconst A: &str = include_str!(\"../../tasks/a.fab\");\n",
            Some(2),
        ),
        (
            "src/new/mod.rs",
            "//! A.\nconst A: &str = include_str!(\"../../tasks/a.fab\");\n",
            None,
        ),
        (
            "src/main.rs",
            "//! A.\n#[path = \"../runtime/base/src/files.rs\"]\nmod store;\n",
            Some(2),
        ),
        (
            "sim/src/lib.rs",
            "//! A.\n#[cfg(test)]\n#[path = \"../../tests/data.rs\"]\nmod data;\n",
            None,
        ),
        (
            "sim/Cargo.toml",
            "[dependencies.x] # why\npackage = \"fab-grammar\"\n",
            Some(1),
        ),
        (
            "sim/Cargo.toml",
            "[target.'cfg(unix)'.dependencies.fab-grammar]\n",
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
            "runtime/vision/src/blur.rs",
            "//! Uses opencv.\nuse opencv::core;\n",
            None,
        ),
        (
            "runtime/agent/src/scene.rs",
            "//! Speaks of opencv.\n// opencv::core\nf(\"opencv\");\n",
            None,
        ),
        (
            "runtime/agent/src/scene.rs",
            "//! A.\n/* one\n*/ fn f<'a>() { '\"'; ::opencv::core::f() }\n",
            Some(3),
        ),
        (
            "runtime/world/src/simulated.rs",
            "//! A.\nuse fab_sim::Cloth;\n",
            None,
        ),
        (
            "runtime/world/src/lib.rs",
            "//! A.\nmod sim;\npub use self::sim::SimWorld;\n",
            None,
        ),
        (
            "runtime/world/src/expert.rs",
            "//! A.\nlet c = ::fab_sim::Cloth;\n",
            Some(2),
        ),
        (
            "runtime/world/src/expert.rs",
            "//! A.\nuse fab_sim as cloth;\n",
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
        (
            "runtime/agent/src/twins.rs",
            "//! A.\nfn of(world: &dyn World) {}\n",
            Some(2),
        ),
        (
            "runtime/world/src/twin.rs",
            "//! A.\nlet all = world.particles();\n",
            Some(2),
        ),
        (
            "runtime/world/src/twin.rs",
            "//! A `dyn World` has particles.\n#[cfg(test)]\nmod tests {\n    world.particles();\n}\n",
            None,
        ),
        ("src/main.rs", "// A.\n", Some(1)),
        (
            "tests/a.rs",
            "//! A.\n#[test]\n#[ignore = \"slow\"]\nfn folds() {}\n",
            Some(4),
        ),
        (
            "tests/a.rs",
            "//! A.\n#[test]\nfn peer_folds() {}\n",
            Some(3),
        ),
        (
            "tests/a.rs",
            "//! A.\n#[test]\n#[ignore = \"needs ROS\"]\nfn peer_folds() {}\n",
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

const fn member(
    folder: &'static str,
    package: &'static str,
    needs: &'static [&'static str],
    tests_need: &'static [&'static str],
) -> Member {
    Member {
        folder,
        package,
        needs,
        tests_need,
    }
}

fn is_ours(dependency: &Dependency) -> bool {
    MEMBERS
        .iter()
        .any(|member| member.package == dependency.package())
}

fn edge_faults(files: &[TextFile]) -> Vec<String> {
    let mut faults = Vec::new();
    for member in MEMBERS {
        let manifest = format!("{}/Cargo.toml", member.folder);
        for file in files.iter().filter(|file| file.path == manifest) {
            for dependency in dependencies(&file.text).iter().filter(|it| is_ours(it)) {
                let (owner, other) = (member.package, dependency.package());
                let for_tests = dependency.purpose == Purpose::Tests;
                if for_tests && !dependency.by_path_alone {
                    // Only a dependency with nothing but a path is left out when the package is published.
                    let rule = format!("`{other}` is for tests: `{other} = {{ path = \"…\" }}`");
                    faults.push(fault(file, dependency.line, &rule));
                }
                let allowed = member.needs.contains(&other)
                    || (for_tests && member.tests_need.contains(&other));
                if !allowed {
                    let rule = format!(
                        "`{owner}` must not depend on `{other}`, only on {:?} of ours",
                        member.needs
                    );
                    faults.push(fault(file, dependency.line, &rule));
                }
            }
        }
    }
    faults
}

/// `fab-program` is linked into a robot's own program, so all packages that it depends on are checked.
fn reach_faults(files: &[TextFile]) -> Vec<String> {
    let mut faults = Vec::new();
    let is_forbidden =
        |name: &str| PARSERS.contains(&name) || SYSTEM.contains(&name) || name.ends_with("-sys");
    for file in files {
        match file.path.as_str() {
            "compiler/program/Cargo.toml" => {
                let found = dependencies(&file.text);
                // `edge_faults` checks our own packages.
                for it in found
                    .iter()
                    .filter(|it| !is_ours(it) && is_forbidden(it.package()))
                {
                    let rule = format!("`fab-program` must not need `{}`", it.package());
                    faults.push(fault(file, it.line, &rule));
                }
            }
            "Cargo.lock" => {
                for name in reached(&file.text, "fab-program", &["proptest"]) {
                    if is_forbidden(&name) {
                        let rule = format!("`fab-program` must not reach `{name}`");
                        faults.push(fault(file, 1, &rule));
                    }
                }
            }
            _ => {}
        }
    }
    faults
}

/// A package is built from its own folder only; files that only tests include are not packaged.
fn include_faults(files: &[TextFile]) -> Vec<String> {
    const OPENINGS: [&str; 4] = [
        "include_str!(\"",
        "include_bytes!(\"",
        "include!(\"",
        "#[path = \"",
    ];
    let mut faults = Vec::new();
    for file in files.iter().filter(|file| file.path.ends_with(".rs")) {
        let package = package_of(&file.path);
        let own = &file.path[package.len()..];
        if !own.trim_start_matches('/').starts_with("src/") {
            continue;
        }
        let mut line_before = "";
        for (line, content) in numbered(&file.text) {
            let opening = OPENINGS
                .iter()
                .find_map(|opening| content.trim_start().split_once(opening))
                .filter(|(before, _)| !before.starts_with("//"));
            let target = opening.and_then(|(_, rest)| rest.split('"').next());
            if let Some(target) = target.filter(|_| line_before.trim() != "#[cfg(test)]") {
                let whole = resolved(&file.path, target);
                if package_of(&whole) != package || whole.starts_with("..") {
                    let rule = format!("`{target}` lies outside of the package's folder");
                    faults.push(fault(file, line, &rule));
                }
            }
            line_before = content;
        }
    }
    faults
}

/// Returns the folder of the package that holds a path; empty for the root package.
fn package_of(path: &str) -> &'static str {
    let holds = |folder: &str| {
        path.strip_prefix(folder)
            .is_some_and(|rest| rest.starts_with('/'))
    };
    let folders = MEMBERS.iter().map(|member| member.folder);
    let inner = folders.filter(|folder| holds(folder));
    inner.max_by_key(|folder| folder.len()).unwrap_or("")
}

/// Resolves a path named in a file, relative to the root.
fn resolved(file: &str, target: &str) -> String {
    let mut parts: Vec<&str> = file.split('/').collect();
    parts.pop();
    for part in target.split('/') {
        match part {
            ".." if parts.last().is_some_and(|last| *last != "..") => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// Our own crates need no reason: `MEMBERS` lists the edges between them.
fn reason_faults(files: &[TextFile]) -> Vec<String> {
    let mut faults = Vec::new();
    for file in files
        .iter()
        .filter(|file| file.path.ends_with("Cargo.toml"))
    {
        for dependency in dependencies(&file.text) {
            if !is_ours(&dependency) && !dependency.has_reason {
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

/// Twins get a camera's pictures, and nothing that could be asked for more.
fn twin_faults(files: &[TextFile]) -> Vec<String> {
    let mut faults = Vec::new();
    for (place, word) in KEPT_FROM_TWINS {
        for file in files.iter().filter(|file| file.path.starts_with(place)) {
            let code = code_only(&file.text);
            let code = code.split("#[cfg(test)]\nmod tests").next();
            let lines = numbered(code.unwrap_or_default());
            for (line, content) in lines.filter(|(_, it)| names(it, Name::Word(word))) {
                let rule = format!("twins may not name `{word}`: {}", content.trim());
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
    }
    faults
}

/// A test that `make test` leaves out gives the reason: it is long, or needs a third-party program.
/// `scripts/test-long.sh` recognizes the latter by name.
fn ignore_faults(files: &[TextFile]) -> Vec<String> {
    let mut faults = Vec::new();
    for file in files.iter().filter(|file| file.path.ends_with(".rs")) {
        let (mut is_test, mut reason) = (false, None);
        for (line, content) in numbered(&file.text) {
            let content = content.trim();
            if content.starts_with("#[") {
                is_test |= content.starts_with("#[test]");
                if let Some(after) = content.strip_prefix("#[ignore") {
                    reason = Some(after.trim_matches([' ', '=', '"', ']']));
                }
            } else if !content.is_empty() {
                let name = content.strip_prefix("fn ").unwrap_or_default();
                let is_named = match reason {
                    Some("long") | None => !name.starts_with("peer_"),
                    Some(needs) => needs.starts_with("needs ") && name.starts_with("peer_"),
                };
                if is_test && !is_named {
                    let rule = "a test is left out with `#[ignore = \"long\"]`, or with \
                                `#[ignore = \"needs ...\"]` and a name that starts with `peer_`";
                    faults.push(fault(file, line, rule));
                }
                (is_test, reason) = (false, None);
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
                // After a letter or a variable it is part of some other path.
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

/// Code that looks for recorded data must be able to report that a test lacked it.
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
