//! `fabc test`: runs the tests that tasks carry.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::{shipped, sources, watch};
use clap::{Args, ValueHint};
use fab_base::wording::counted;
use fab_compiler::diag;
use fab_program::test::Trial;
use fab_program::{Expect, Program, Test};
use serde::Serialize;
use serde_json::Value;

#[derive(Args)]
pub struct TestArguments {
    /// The files whose tests are run, or names of shipped tasks.
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub files: Vec<String>,
    /// Only tests whose name contains this.
    #[arg(long, value_name = "WORDS")]
    pub only: Option<String>,
    /// Run again whenever a file that was read changes, until Ctrl-C.
    #[arg(long, conflicts_with = "json")]
    pub watch: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Runs every test of every file, once or after every change; exits with 1 if one fails.
pub fn run(arguments: &TestArguments, io: &Io) -> Result<Exit, Failure> {
    let test = || test(arguments, io);
    watch::run(arguments.watch, &arguments.files, &[], test, io)
}

#[derive(Default, Serialize)]
struct Tested {
    passed: usize,
    failed: usize,
    tests: Vec<TestedOne>,
    /// The files whose tests were not run, and why.
    errors: Vec<String>,
    diagnostics: Vec<Value>,
}

#[derive(Serialize)]
struct TestedOne {
    file: String,
    #[serde(flatten)]
    test: Test,
    #[serde(flatten)]
    trial: Trial,
}

fn test(arguments: &TestArguments, io: &Io) -> Result<Exit, Failure> {
    let mut exit = Exit::Done;
    let mut tested = Tested::default();
    for file in &arguments.files {
        let compiled = match shipped::find(file, io).and_then(|file| sources::compile(&file)) {
            Ok(compiled) => compiled,
            Err(failure) => {
                io.talk(&format!("error: {failure}"));
                tested.errors.push(failure.to_string());
                exit = Exit::Environment;
                continue;
            }
        };
        if !compiled.diagnostics.is_empty() {
            io.painted_talk(&sources::findings(&compiled, io.talk_color()));
        }
        if let Value::Array(found) = diag::to_json(&compiled.diagnostics, &compiled.sources) {
            tested.diagnostics.extend(found);
        }
        if compiled.has_errors() {
            tested.errors.push(format!("`{file}` cannot be compiled"));
            if exit == Exit::Done {
                exit = Exit::Author;
            }
            continue;
        }
        for test in compiled.tests {
            let is_of = |it: &&Program| it.task == test.task && it.variant == test.variant;
            let program = compiled.programs.iter().find(is_of);
            let words = arguments.only.as_deref().unwrap_or_default();
            let Some(program) = program.filter(|_| test.name.contains(words)) else {
                continue;
            };
            let trial = fab_program::test::run(program, &test);
            if !arguments.json {
                io.data(&line(file, &test, &trial));
            }
            tested.tests.push(TestedOne {
                file: file.clone(),
                test,
                trial,
            });
        }
    }
    if let (Some(words), true, Exit::Done) = (&arguments.only, tested.tests.is_empty(), exit) {
        return Err(Failure::usage(format!("no test's name contains `{words}`")));
    }
    let passed = tested.tests.iter().filter(|it| it.trial.is_expected);
    tested.passed = passed.count();
    tested.failed = tested.tests.len() - tested.passed;
    if tested.failed > 0 && exit == Exit::Done {
        exit = Exit::Author;
    }
    io.either(arguments.json, &tested, || {
        let passed = format!("{} passed, {} failed", tested.passed, tested.failed);
        match tested.errors.len() {
            0 => passed,
            n => format!("{passed}, {} not run", counted(n, "file")),
        }
    });
    Ok(exit)
}

fn line(file: &str, test: &Test, trial: &Trial) -> String {
    let verdict = if trial.is_expected { "ok  " } else { "FAIL" };
    let mut line = format!("{verdict} {file}:{}: {}", test.line, test.name);
    if !trial.is_expected {
        line.push_str(&format!("\n     expected: {}", expected(&test.expect)));
        let found = trial.finding.to_string().replace('\n', "\n       ");
        line.push_str(&format!("\n     found: {found}"));
    }
    for repair in &trial.repairs {
        line.push_str(&format!("\n     tolerated: {repair}"));
    }
    line
}

fn expected(expect: &Expect) -> String {
    match expect {
        Expect::Accept => "the answer is accepted".to_owned(),
        Expect::Reject { check } => format!("the check `{check}` refuses the answer"),
        Expect::Malformed => "the answer is malformed".to_owned(),
        Expect::Text { text } => format!("the answer's text is `{text}`"),
    }
}
