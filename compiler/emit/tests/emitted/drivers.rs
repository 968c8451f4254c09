//! Runs emitted verifiers as separate programs: lines of cases in, lines of verdicts out.

use super::case::Case;
use super::recorded_data::count_as_skipped;
use fab_emit::Target;
use fab_program::{Choices, Program};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The emitted files of a program, on disk.
pub struct Built {
    /// The program's own folder.
    pub folder: PathBuf,
}

/// Writes everything that is emitted for a program into a folder of this test.
pub fn build(program: &Program, test: &str) -> Built {
    let target = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(test);
    let all = [Target::Program, Target::Rust, Target::Python];
    for artifact in fab_emit::emit(std::slice::from_ref(program), &all).unwrap() {
        let path = target.join(&artifact.path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, artifact.text).unwrap();
    }
    Built {
        folder: target.join(fab_emit::folder(program)),
    }
}

/// Returns the Python of this machine; a test without one counts as skipped.
pub fn python(test: &str) -> Option<&'static str> {
    let is_there = Command::new("python3").arg("--version").output().is_ok();
    if !is_there {
        count_as_skipped(test);
    }
    is_there.then_some("python3")
}

/// Compiles Rust source; fails with the compiler's message.
pub fn rustc(arguments: &[&str], source: &Path, made: &Path) {
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let said = Command::new(compiler)
        .args(arguments)
        .arg("-o")
        .args([made, source])
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&said.stderr);
    assert!(said.status.success() && errors.is_empty(), "{errors}");
}

/// Judges cases with the compiled Rust module.
pub fn by_rust(program: &Program, built: &Built, cases: &[Case]) -> Vec<[String; 2]> {
    let source = built.folder.join("driver.rs");
    let driver = include_str!("driver.rs.txt")
        .replace("LAST", &last_in_rust(program))
        .replace("FIELDS", &fields_in_rust(program));
    std::fs::write(&source, driver).unwrap();
    let executable = built.folder.join("driver");
    rustc(&["--edition", "2021"], &source, &executable);
    answers(Command::new(executable), program, cases)
}

/// Judges cases with the Python module.
pub fn by_python(
    python: &str,
    program: &Program,
    built: &Built,
    cases: &[Case],
) -> Vec<[String; 2]> {
    let driver = built.folder.join("driver.py");
    let kinds: Vec<&str> = program
        .actions
        .iter()
        .map(|field| kind(&field.choices))
        .collect();
    let text = include_str!("driver.py.txt").replace("KINDS", &format!("{kinds:?}"));
    std::fs::write(&driver, text).unwrap();
    let mut command = Command::new(python);
    command.args(["-B", "-W", "error"]).arg(driver);
    answers(command, program, cases)
}

fn kind(choices: &Choices) -> &'static str {
    match choices {
        Choices::Points { .. } | Choices::Region { .. } => "point",
        Choices::Directions { .. } => "direction",
        Choices::Lengths { .. } => "length",
        Choices::Words { .. } => "word",
    }
}

/// The identifier of a field in the modules; names that are reserved words get a `_`.
fn identifier(name: &str) -> &str {
    match name {
        "direction" => "direction_deg",
        "type" => "type_",
        "lambda" => "lambda_",
        name => name,
    }
}

fn fields_in_rust(program: &Program) -> String {
    let fields = program.actions.iter().map(|field| {
        let name = identifier(&field.name);
        match field.choices {
            Choices::Points { .. } | Choices::Region { .. } => {
                format!("{name}: tokens.point(), ")
            }
            Choices::Words { .. } => format!("{name}: tokens.word().leak(), "),
            _ => format!("{name}: tokens.float(), "),
        }
    });
    fields.collect()
}

fn last_in_rust(program: &Program) -> String {
    let directions = program
        .actions
        .iter()
        .filter(|field| kind(&field.choices) == "direction");
    let fields = directions.map(|field| format!("{}: tokens.float(), ", identifier(&field.name)));
    format!(
        "pick: tokens.point(), place: tokens.point(), {}",
        fields.collect::<String>()
    )
}

/// Sends all cases to a driver and reads its answer to each.
fn answers(mut driver: Command, program: &Program, cases: &[Case]) -> Vec<[String; 2]> {
    let mut running = driver
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::inherit())
        .spawn()
        .unwrap();
    let lines: Vec<String> = cases.iter().map(|case| case.told(program) + "\n").collect();
    let mut stdin = running.stdin.take().unwrap();
    let told = std::thread::spawn(move || stdin.write_all(lines.concat().as_bytes()));
    let said = running.wait_with_output().unwrap();
    told.join().unwrap().unwrap();
    assert!(said.status.success());
    let text = String::from_utf8(said.stdout).unwrap();
    let answers: Vec<[String; 2]> = text
        .lines()
        .map(|line| {
            let (full, relaxed) = line.split_once(' ').unwrap();
            [full.to_owned(), relaxed.to_owned()]
        })
        .collect();
    assert_eq!(answers.len(), cases.len());
    answers
}
