//! `fabc demos`: makes in-context examples of a task with the scripted expert.

use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::shipped;
use crate::sources::{self, TaskArguments};
use crate::verbs::runtime::setting;
use clap::{Args, ValueHint};
use fab_agent::demos::{self, DemoRequest};
use serde::Serialize;
use serde_json::json;
use std::fs;
use std::path::PathBuf;

#[derive(Args)]
pub struct DemosArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    /// How many demonstrations, each from a start of its own; every one gives an example for each step.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub count: u32,
    /// Draws the starts.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// The file; default: the one that the task names.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Demonstrates the task and writes the file that it names.
pub fn run(arguments: &DemosArguments, io: &Io) -> Result<Exit, Failure> {
    let program = sources::compile_task(&arguments.task, io)?;
    if arguments.out.is_none() {
        shipped::check_own(&arguments.task.file, io)?;
    }
    let interrupt = io.interrupt()?;
    let make_world = || setting::world(&program);
    let making = DemoRequest {
        program: &program,
        count: arguments.count,
        seed: arguments.seed,
        make_world: &make_world,
        interrupt: &interrupt,
    };
    let mut announce = |what: &str| io.talk(what);
    let made = demos::make(&making, &mut announce);
    let (header, made) = made.map_err(setting::unfit_usage)?;
    let path = match (&arguments.out, &program.demos) {
        (Some(path), _) => path.clone(),
        (None, Some(named)) => sources::folder_of(&arguments.task.file).join(&named.file.path),
        (None, None) => return Err(Failure::usage("the task names no file; give `--out`")),
    };
    if let Some(folder) = path.parent() {
        // The message names the file, not its folder.
        fs::create_dir_all(folder).map_err(|error| Failure::unwritable(&path, error))?;
    }
    let text = line(&header) + &made.iter().map(line).collect::<String>();
    write_file(&path, text.as_bytes())?;
    let (file, stage, demos) = (path.display().to_string(), &header.stage, made.len());
    let actions: usize = made.iter().map(|demo| demo.steps.len()).sum();
    let document = json!({
        "file": file,
        "task": program.task,
        "variant": program.variant,
        "stage": stage,
        "demos": demos,
        "actions": actions,
        "seed": header.seed,
        "params": header.params,
    });
    io.either(arguments.json, &document, || {
        format!("{file}: {demos} demonstrations, {actions} actions, for the stage `{stage}`")
    });
    Ok(Exit::Done)
}

fn line(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("demonstrations have string keys and finite numbers") + "\n"
}
