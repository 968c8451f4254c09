//! Times the compiler: one task, a thousand tasks, and that the cost of any input is linear in its length.
//!
//! The first part compiles each generated input at 100 kB and at 1 MB in one run and prints the ratio of the two
//! times. It ends with an error if a ratio exceeds [`MOST_RATIO`] or a stated limit is missed. The second part is the
//! divan benchmarks. A word on the command line selects the inputs and benchmarks that contain it.

#![allow(missing_docs)]

#[path = "../tests/suite/common/inputs.rs"]
mod inputs;

/// A small task with every section that a task needs.
const TASK: &str = include_str!("../tests/suite/common/task.fab");

use divan::{Bencher, black_box};
use fab_compiler::{Compiled, LoadError, Loader, diag};
use fab_emit::Target;
use std::collections::BTreeMap;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// The largest accepted ratio: ten times the instructions, in memory that no longer fits the caches.
const MOST_RATIO: f64 = 16.0;

/// How often an input is measured again before its ratio counts as too large.
const ROUNDS: usize = 4;

/// Shorter times measure the machine, not the compiler.
const LEAST: Duration = Duration::from_millis(30);

fn main() -> ExitCode {
    let filter = std::env::args()
        .skip(1)
        .find(|argument| !argument.starts_with('-'))
        .unwrap_or_default();
    let is_kept = stated_limits() & ratios(&filter);
    divan::main();
    if is_kept {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// Texts in memory, by name.
struct Memory(BTreeMap<String, String>);

impl Memory {
    fn one(text: String) -> Memory {
        Memory(BTreeMap::from([("input.fab".to_owned(), text)]))
    }
}

impl Loader for Memory {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        self.0.get(name).cloned().ok_or_else(|| LoadError {
            message: format!("there is no file `{name}`"),
        })
    }
}

/// Compiles a file and writes its diagnostics in both forms, or its programs.
fn compile(name: &str, files: &Memory) -> Compiled {
    let compiled = fab_compiler::compile(name, files).expect("the entry is in memory");
    black_box(diag::to_text(
        &compiled.diagnostics,
        &compiled.sources,
        diag::Color::Plain,
    ));
    black_box(diag::to_json(&compiled.diagnostics, &compiled.sources).to_string());
    compiled
}

/// Compiles a file and writes what `fabc build` does: prompts, schema and program; returns the bytes.
fn emit(name: &str, files: &Memory) -> usize {
    let compiled = compile(name, files);
    let artifacts = fab_emit::emit(&compiled.programs, &[Target::Program]);
    let artifacts = artifacts.expect("the tasks have names of their own");
    black_box(&artifacts);
    artifacts.iter().map(|artifact| artifact.text.len()).sum()
}

/// Returns the shortest of some runs, because other load on the machine only adds time.
///
/// Short work is repeated until the clock can measure it.
fn shortest(runs: usize, mut work: impl FnMut()) -> Duration {
    let mut repeats = 1u32;
    let mut time = || loop {
        let begun = Instant::now();
        (0..repeats).for_each(|_| work());
        let taken = begun.elapsed();
        if taken >= LEAST || repeats >= 1 << 12 {
            return taken / repeats;
        }
        repeats *= 4;
    };
    (0..runs).map(|_| time()).min().unwrap_or_default()
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Prints the times of one task and of a thousand; returns whether both are within the stated limits.
fn stated_limits() -> bool {
    let one = Memory::one(inputs::two_hundred_lines(TASK));
    assert!(emit("input.fab", &one) > 0, "the task is right");
    let one_task = shortest(20, || {
        emit("input.fab", &one);
    });
    let folder = folder_of_a_thousand();
    let thousand_files = shortest(3, || {
        for number in 0..1000 {
            assert!(emit(&format!("task_{number}.fab"), &folder) > 0);
        }
    });
    let file = Memory::one(file_of_a_thousand());
    assert_eq!(compile("input.fab", &file).programs.len(), 1000);
    let thousand_tasks = shortest(3, || {
        emit("input.fab", &file);
    });
    let mut is_kept = true;
    for (what, time, limit_ms) in [
        ("a task of 200 lines", one_task, 2.0),
        ("1,000 files that use a library", thousand_files, 1000.0),
        ("1,000 tasks in one file", thousand_tasks, 1000.0),
    ] {
        let taken_ms = milliseconds(time);
        let verdict = if taken_ms < limit_ms {
            ""
        } else {
            "  TOO SLOW"
        };
        println!("{what:48} {taken_ms:9.2} ms of {limit_ms:6.0} ms{verdict}");
        is_kept &= taken_ms < limit_ms;
    }
    is_kept
}

/// Prints the times of each input at two sizes; returns whether every ratio is small enough.
fn ratios(filter: &str) -> bool {
    let mut worst = 0.0f64;
    println!(
        "\n{:48} {:>12} {:>12} {:>7}",
        "input", "100 kB", "1 MB", "ratio"
    );
    for input in inputs::all().filter(|input| input.name.contains(filter)) {
        let small = Memory::one(input.text(100_000));
        let large = Memory::one(input.text(1_000_000));
        let (mut small_time, mut large_time) = (Duration::MAX, Duration::MAX);
        let mut ratio = f64::INFINITY;
        // Other processes slow even the processor's clock, so one good round is enough.
        for _ in 0..ROUNDS {
            small_time = small_time.min(shortest(3, || drop(compile("input.fab", &small))));
            large_time = large_time.min(shortest(2, || drop(compile("input.fab", &large))));
            ratio = large_time.as_secs_f64() / small_time.as_secs_f64();
            if ratio <= MOST_RATIO {
                break;
            }
        }
        worst = worst.max(ratio);
        let verdict = if ratio <= MOST_RATIO {
            ""
        } else {
            "  TOO SLOW"
        };
        println!(
            "{:48} {:9.2} ms {:9.2} ms {ratio:7.1}{verdict}",
            input.name,
            milliseconds(small_time),
            milliseconds(large_time)
        );
    }
    println!("{:48} {worst:33.1} of {MOST_RATIO}\n", "largest ratio");
    worst <= MOST_RATIO
}

/// Returns a library, and a thousand files that each extend its task.
fn folder_of_a_thousand() -> Memory {
    let mut files = BTreeMap::from([("lib/base.fab".to_owned(), TASK.to_owned())]);
    for number in 0..1000 {
        let text = format!(
            "use \"lib/base.fab\"\n\ntask task_{number} extends small {{\n    override component role \"You fold cloth number {number}.\"\n}}\n"
        );
        files.insert(format!("task_{number}.fab"), text);
    }
    Memory(files)
}

/// Returns one file with a task and 999 tasks that extend it.
fn file_of_a_thousand() -> String {
    let mut text = TASK.to_owned();
    for number in 1..1000 {
        text.push_str(&format!("\ntask task_{number} extends small {{\n    override component role \"You fold cloth number {number}.\"\n}}\n"));
    }
    text
}

#[divan::bench]
fn two_hundred_lines(bencher: Bencher) {
    let files = Memory::one(inputs::two_hundred_lines(TASK));
    bencher.bench_local(|| emit("input.fab", &files));
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn a_thousand_files(bencher: Bencher) {
    let files = folder_of_a_thousand();
    bencher.bench_local(|| {
        (0..1000)
            .map(|number| emit(&format!("task_{number}.fab"), &files))
            .sum::<usize>()
    });
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn a_thousand_tasks(bencher: Bencher) {
    let files = Memory::one(file_of_a_thousand());
    bencher.bench_local(|| emit("input.fab", &files));
}
