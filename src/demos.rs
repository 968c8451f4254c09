//! `fabc demos`: makes in-context examples of a task by the scripted expert.

use crate::cli::DemosArguments;
use crate::exit::{Exit, Failure};
use crate::{output, setting, sources};
use fab_agent::demos;
use fab_agent::demos::{Demo, Header, MakeError, Making};
use fab_base::files;
use fab_world::WorldError;
use serde::Serialize;
use serde_json::json;
use std::fs;

/// Demonstrates the task and writes the file that it names.
pub fn run(arguments: &DemosArguments) -> Result<Exit, Failure> {
    let program = sources::compile_task(&arguments.task)?;
    let interrupt = setting::interrupt()?;
    let make_world = || setting::world(&program);
    let making = Making {
        program: &program,
        count: arguments.count,
        seed: arguments.seed,
        make_world: &make_world,
        interrupt: &interrupt,
    };
    let mut announce = |what: &str| output::talk(what);
    let (header, made) = match demos::make(&making, &mut announce) {
        Ok(made) => made,
        Err(MakeError::World(WorldError::Interrupted)) => return Err(Failure::interrupted()),
        Err(MakeError::Task(why)) => return Err(Failure::usage(why)),
        Err(error) => return Err(Failure::environment(error)),
    };
    let path = match (&arguments.out, &program.demos) {
        (Some(path), _) => path.clone(),
        (None, Some(named)) => sources::folder_of(&arguments.task.file).join(&named.file.path),
        (None, None) => return Err(Failure::usage("the task names no file; give `--out`")),
    };
    let unwritable =
        |error| Failure::environment(format!("cannot write `{}`: {error}", path.display()));
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(unwritable)?;
    }
    files::write_whole(&path, lines(&header, &made).as_bytes()).map_err(unwritable)?;
    let actions: usize = made.iter().map(|demo| demo.steps.len()).sum();
    if arguments.json {
        output::json(&json!({
            "file": path.display().to_string(),
            "task": program.task,
            "variant": program.variant,
            "stage": header.stage,
            "demos": made.len(),
            "actions": actions,
            "seed": header.seed,
            "params": header.params,
        }));
    } else {
        output::data(&format!(
            "{}: {} demonstrations, {actions} actions, for the stage `{}`",
            path.display(),
            made.len(),
            header.stage
        ));
    }
    Ok(Exit::Done)
}

/// Writes the header and each demonstration on a line of its own.
fn lines(header: &Header, made: &[Demo]) -> String {
    let mut text = line(header);
    made.iter().for_each(|demo| text.push_str(&line(demo)));
    text
}

fn line(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("demonstrations have string keys and finite numbers") + "\n"
}
