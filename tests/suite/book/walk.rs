//! Processes one page as a reader would: writes its files, makes its edits, runs its commands, in one folder.
//!
//! | block | treatment |
//! |---|---|
//! | `fab` | a whole file, compiled as `example.fab`; its tests are run; `file=PATH` keeps it under that path |
//! | `fab task` | sections of a task that extends `half`, the first task of the language page |
//! | `fab wrong`, `fab task wrong` | the same, but it must fail: the next block, of `text`, has the diagnostics |
//! | `diff PATH` | an edit of a file: its unchanged and removed lines must occur there exactly once |
//! | `LANGUAGE file=PATH` | the file |
//! | `LANGUAGE from=PATH` | must occur in that file of the project, at any indentation |
//! | `console` | commands after `$ `, their output, and `? N` for an exit code N other than 0 |
//! | `console slow` | the same, in the slow test only |
//! | `console not-run: REASON` | parsed as a command line (`book_calls.rs`), but not run |
//! | `sh` | targets of the Makefile, and commands listed in `NOT_RUN` with the reason |
//! | `text` | nothing |
//! | `json` | read as JSON |
//!
//! Three comments configure a page. `<!-- starts-with: PATH, … -->` lists project files that are copied into the folder
//! first (`half.fab` means that task), `<!-- recorded: PATH -->` names recorded data that the slow test copies there,
//! and `<!-- varies: WORDS, … -->` lists the beginnings of lines whose numbers vary.

use super::matching::{fits, refreshed};
use super::page::{Block, Page};
use crate::suite::support::{fabc, root};
use fab_compiler::diag::{self, Color};
use fab_compiler::{Listed, LoadError, Loader, Wanted};
use similar::TextDiff;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// What a page may do to its files besides calling `fabc`.
const TOOLS: [&str; 6] = ["cat", "cp", "ls", "mkdir", "mv", "rm"];

/// Beginnings of commands in `sh` blocks that no test can run, and why.
const NOT_RUN: [(&str, &str); 6] = [
    ("git clone ", "needs the network"),
    (
        "cargo install ",
        "builds a release; `make run` does the same",
    ),
    ("cargo build --no-default-features", "`make lint` builds it"),
    ("cargo test ", "this is a part of it"),
    ("cargo insta ", "`make test-all` runs it"),
    (
        "sh scripts/with-env.sh sh scripts/count-instructions.sh",
        "needs valgrind; `make bench` runs it",
    ),
];

/// Blocks that another test runs: the page, the language, that test's file.
const TESTED_ELSEWHERE: [(&str, &str, &str); 5] = [
    (
        "docs/build.md",
        "python",
        "compiler/emit/tests/emitted/docs.rs",
    ),
    (
        "docs/build.md",
        "python-jinja2",
        "compiler/emit/tests/emitted/docs.rs",
    ),
    (
        "docs/build.md",
        "rust",
        "compiler/emit/tests/emitted/docs.rs",
    ),
    ("docs/simulator.md", "rust", "tests/suite/book.rs"),
    ("docs/review.md", "yaml", "tests/suite/review/docs.rs"),
];

/// The file name under which a block without one is compiled.
const EXAMPLE: &str = "example.fab";

/// The file of the task that `fab task` blocks extend.
const HALF: &str = "half.fab";

/// Whether slow blocks are run.
pub enum Pace {
    Fast,
    /// With the recorded data, if it is available.
    Slow(Option<PathBuf>),
}

/// The result of a page.
pub struct Walked {
    /// Differences from the page, each with its place.
    pub wrong: Vec<String>,
    /// Blocks that need new text: messages and outputs.
    pub changes: Vec<(Block, String)>,
    pub n_commands: usize,
    pub n_files: usize,
}

struct Walk<'p> {
    page: &'p Page,
    half: &'p str,
    pace: &'p Pace,
    folder: TempDir,
    walked: Walked,
}

/// Processes a page. `half` is the task that the sections of a `fab task` block extend.
pub fn walk(page: &Page, half: &str, pace: &Pace) -> Walked {
    let mut walk = Walk {
        page,
        half,
        pace,
        folder: tempfile::tempdir().unwrap(),
        walked: Walked {
            wrong: Vec::new(),
            changes: Vec::new(),
            n_commands: 0,
            n_files: 0,
        },
    };
    for path in page.stated("starts-with") {
        if path == HALF {
            fs::write(walk.folder.path().join(path), half).unwrap();
            continue;
        }
        copy(&root().join(&path), &walk.folder.path().join(&path));
    }
    if let Pace::Slow(Some(data)) = pace {
        for path in page.stated("recorded") {
            let place = walk.folder.path().join(&path);
            std::os::unix::fs::symlink(data.join(path), place).unwrap();
        }
    }
    for (index, block) in page.blocks.iter().enumerate() {
        let wrong = match walk.block(block, page.blocks.get(index + 1)) {
            Ok(()) => continue,
            Err(wrong) => format!("{}:{}: {wrong}", page.path, block.line),
        };
        walk.walked.wrong.push(wrong);
    }
    walk.walked
}

impl Walk<'_> {
    fn block(&mut self, block: &Block, next: Option<&Block>) -> Result<(), String> {
        let path = block.rest().strip_prefix("file=");
        if let Some(path) = path {
            let file = self.folder.path().join(path);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, &block.text).unwrap();
        }
        match (block.language(), block.rest()) {
            ("fab", "wrong") => self.is_refused(EXAMPLE, &block.text, next),
            ("fab", "task wrong") => self.is_refused(EXAMPLE, &task_of(block), next),
            ("fab", "") => self.compiles(EXAMPLE, &block.text),
            ("fab", "task") => self.compiles(EXAMPLE, &task_of(block)),
            ("fab", _) if path.is_some() => self.compiles(path.unwrap(), &block.text),
            ("diff", file) if !file.is_empty() => self.edit(file, &block.text),
            ("console", "") => self.run(block),
            ("console", "slow") => match self.pace {
                Pace::Slow(_) => self.run(block),
                Pace::Fast => block.steps().map(|_| ()),
            },
            ("console", rest) if rest.starts_with("not-run: ") => block.steps().map(|_| ()),
            ("sh", "") => block.text.lines().try_for_each(is_known),
            ("text", "") => Ok(()),
            ("json", "") => match serde_json::from_str::<serde_json::Value>(&block.text) {
                Ok(_) => Ok(()),
                Err(error) => Err(format!("this is no JSON: {error}")),
            },
            _ if path.is_some() => Ok(()),
            (_, rest) if rest.starts_with("from=") => quotes(&rest["from=".len()..], &block.text),
            (language, "") => {
                let elsewhere = TESTED_ELSEWHERE
                    .iter()
                    .find(|(page, known, _)| (*page, *known) == (&self.page.path, language));
                match elsewhere {
                    Some((.., test)) if root().join(test).exists() => Ok(()),
                    _ => Err(format!("no test runs a block of `{language}`")),
                }
            }
            (_, _) => Err(format!("no test runs a block of `{}`", block.info)),
        }
    }

    /// Compiles a correct file, and runs its tests.
    fn compiles(&mut self, name: &str, text: &str) -> Result<(), String> {
        self.walked.n_files += 1;
        let compiled = fab_compiler::compile(name, &self.files(name, text)).unwrap();
        // A file that readers are to write must not cause warnings either.
        let is_unclean = name != EXAMPLE && !compiled.diagnostics.is_empty();
        // A file that readers write may hold a material alone, for others to use.
        let lacks_task = name == EXAMPLE && compiled.programs.is_empty();
        if compiled.has_errors() || lacks_task || is_unclean {
            return Err(diag::to_text(
                &compiled.diagnostics,
                &compiled.sources,
                Color::Plain,
            ));
        }
        for test in &compiled.tests {
            let mut programs = compiled.programs.iter();
            let program = programs
                .find(|program| program.task == test.task && program.variant == test.variant);
            let trial = fab_program::test::run(program.unwrap(), test);
            if !trial.is_expected {
                return Err(format!("test `{}`: {}", test.name, trial.finding));
            }
        }
        Ok(())
    }

    /// Compiles a wrong file, and compares its diagnostics with the next block.
    fn is_refused(&mut self, name: &str, text: &str, next: Option<&Block>) -> Result<(), String> {
        self.walked.n_files += 1;
        let Some(stated) = next.filter(|next| next.info == "text") else {
            return Err("a block of `text` with the compiler's words is to follow".to_owned());
        };
        let compiled = fab_compiler::compile(name, &self.files(name, text)).unwrap();
        let said = diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain);
        if said.is_empty() {
            return Err("nothing is wrong with it".to_owned());
        }
        self.compare(stated, &said, fits(&stated.text, &said, &[]))
    }

    fn files(&self, name: &str, text: &str) -> Files<'_> {
        Files {
            folder: self.folder.path(),
            half: self.half,
            name: name.to_owned(),
            text: text.to_owned(),
        }
    }

    /// Changes a file as the diff block shows.
    fn edit(&self, file: &str, diff: &str) -> Result<(), String> {
        let of = |mark: char| -> String {
            let lines = diff
                .lines()
                .filter(|line| line.starts_with([' ', mark]) || line.is_empty());
            lines
                .map(|line| format!("{}\n", line.get(1..).unwrap_or_default()))
                .collect()
        };
        let (old, new) = (of('-'), of('+'));
        let path = self.folder.path().join(file);
        let text = fs::read_to_string(&path).map_err(|error| format!("`{file}`: {error}"))?;
        match text.matches(&old).count() {
            1 => fs::write(path, text.replacen(&old, &new, 1)).map_err(|error| error.to_string()),
            n => Err(format!(
                "`{file}` has {n} times what this edit replaces:\n{text}"
            )),
        }
    }

    fn run(&mut self, block: &Block) -> Result<(), String> {
        let varying = self.page.stated("varies");
        let (mut does_fit, mut shown) = (true, String::new());
        for step in block.steps()? {
            self.walked.n_commands += 1;
            let (printed, code) = self.output_of(&step.command)?;
            if step.code != code {
                // Not rewritten automatically: the author decides whether a command should fail.
                let (command, stated) = (&step.command, step.code);
                return Err(format!(
                    "`{command}` ends with {code}, not {stated}:\n{printed}"
                ));
            }
            does_fit &= fits(&step.output, &printed, &varying);
            shown.push_str(&step.shown);
            shown.push_str(&refreshed(&step.output, &printed, &varying));
            if code != 0 {
                shown.push_str(&format!("? {code}\n"));
            }
        }
        self.compare(block, &shown, does_fit)
    }

    /// Runs one command; returns its exit code and its output, with both streams mixed as on a terminal.
    fn output_of(&self, command: &str) -> Result<(String, i32), String> {
        let words = shlex::split(command).ok_or("a quote has no end")?;
        let (program, arguments) = words.split_first().ok_or("a command has a name")?;
        let folder = self.folder.path();
        let mut command = match program.as_str() {
            "fabc" => fabc(folder).process(),
            tool if TOOLS.contains(&tool) => Command::new(tool),
            other => return Err(format!("`{other}` is no command of a console block")),
        };
        for (name, _) in std::env::vars_os() {
            let name = name.to_string_lossy().into_owned();
            let is_ours = name.starts_with("FABC_") && name != "FABC_CACHE_DIR";
            if is_ours || name.ends_with("_API_KEY") {
                command.env_remove(name);
            }
        }
        let home = self.folder.path().join(".home");
        command
            .args(arguments)
            .current_dir(folder)
            .env("HOME", home);
        command.env_remove("XDG_CONFIG_HOME").env("COLUMNS", "100");
        let (mut reader, writer) = std::io::pipe().unwrap();
        command.stdout(writer.try_clone().unwrap()).stderr(writer);
        let mut running = command.stdin(std::process::Stdio::null()).spawn().unwrap();
        // It holds the writing ends of the pipe; without dropping it, reading would never end.
        drop(command);
        let mut printed = Vec::new();
        reader.read_to_end(&mut printed).unwrap();
        let code = running.wait().unwrap().code().unwrap_or(-1);
        let printed = String::from_utf8_lossy(&printed).into_owned();
        let here = [folder.canonicalize().unwrap(), folder.to_owned()];
        let shown = here.iter().fold(printed, |printed, here| {
            printed.replace(&here.display().to_string(), "/here")
        });
        Ok((shown, code))
    }

    /// Records a block's new text, or describes the difference.
    fn compare(&mut self, block: &Block, found: &str, does_fit: bool) -> Result<(), String> {
        if does_fit {
            return Ok(());
        }
        self.walked.changes.push((block.clone(), found.to_owned()));
        let difference = TextDiff::from_lines(block.text.as_str(), found);
        let shown = difference
            .unified_diff()
            .header("the page", "what comes")
            .to_string();
        Err(format!("`FABC_WRITE_DOCS=1` writes it anew\n{shown}"))
    }
}

/// The files of the page's folder, the compiled file, and `half.fab`.
struct Files<'w> {
    folder: &'w Path,
    half: &'w str,
    name: String,
    text: String,
}

/// What the examples of diagnostics find beside them.
const EXAMPLES: fab_compiler::explain::Files<'static> = fab_compiler::explain::Files("");

impl Loader for Files<'_> {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        if name == self.name {
            return Ok(self.text.clone());
        }
        match fs::read_to_string(self.folder.join(name)) {
            Err(_) if name == HALF => Ok(self.half.to_owned()),
            read => read.map_err(|_| LoadError {
                message: format!("there is no file `{name}`"),
            }),
        }
    }

    fn look(&self, path: &str, wanted: Wanted) -> Listed {
        EXAMPLES.look(path, wanted)
    }

    fn trial(&self, title: &str) -> Option<fab_program::Trial> {
        EXAMPLES.trial(title)
    }

    fn refuses_cloth(&self, material: &fab_program::Material, spacing_m: f64) -> Option<String> {
        EXAMPLES.refuses_cloth(material, spacing_m)
    }
}

/// Wraps sections into a task that extends `half`.
fn task_of(block: &Block) -> String {
    let lines = block.text.lines().map(|line| format!("    {line}\n"));
    let sections: String = lines.collect();
    let experts = match sections.contains("experts folded") {
        true => "experts folded { sequence { fold corner(back_left) -> corner(front_left) } }",
        false => "",
    };
    format!("use \"half.fab\"\n{experts}\ntask example extends half {{\n{sections}}}\n")
}

/// Checks that a block occurs in a file of the project, whose lines may be indented more deeply.
fn quotes(path: &str, quoted: &str) -> Result<(), String> {
    let source =
        fs::read_to_string(root().join(path)).map_err(|error| format!("{path}: {error}"))?;
    let bare = |text: &str| -> String {
        let lines = text.lines();
        lines.map(|line| format!("\n{}", line.trim())).collect()
    };
    match bare(&source).contains(&bare(quoted)) {
        true => Ok(()),
        false => Err(format!("this does not stand in {path} any more")),
    }
}

/// Checks that a line of a `sh` block is a target of the Makefile or a listed command.
fn is_known(line: &str) -> Result<(), String> {
    let command = line.split(" #").next().unwrap_or_default().trim();
    let makefile = fs::read_to_string(root().join("Makefile")).unwrap();
    let is_target = |target: &str| makefile.contains(&format!("\n{target}:"));
    let is_known = match command.strip_prefix("make ") {
        Some(target) => is_target(target.split(' ').next().unwrap_or_default()),
        None => command.is_empty() || NOT_RUN.iter().any(|(known, _)| command.starts_with(known)),
    };
    match is_known {
        true => Ok(()),
        false => Err(format!(
            "`{command}` is no target of the Makefile, and not listed as not to be run"
        )),
    }
}

fn copy(from: &Path, to: &PathBuf) {
    if from.is_dir() {
        fs::create_dir_all(to).unwrap();
        for entry in fs::read_dir(from).unwrap() {
            let entry = entry.unwrap();
            copy(&entry.path(), &to.join(entry.file_name()));
        }
    } else {
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        fs::copy(from, to).unwrap();
    }
}
