//! The `fabc` command: parse, run one verb, report.
//!
//! This package is the only place that knows the command line, prints, reads the environment, and
//! sets exit codes. Data goes to stdout, talk to stderr.

mod cli;
#[cfg(feature = "runtime")]
mod estimate;
mod exit;
#[cfg(feature = "runtime")]
mod operator;
mod output;
mod snap;
mod snapshots;
mod sources;

#[cfg(feature = "runtime")]
mod bench;
mod build;
#[cfg(feature = "runtime")]
mod calibrate;
mod check;
mod completions;
#[cfg(feature = "runtime")]
mod demos;
#[cfg(feature = "runtime")]
mod doctor;
mod explain;
mod fix;
#[cfg(feature = "runtime")]
mod look;
#[cfg(feature = "runtime")]
mod models;
mod new;
#[cfg(feature = "runtime")]
mod probe;
mod render;
#[cfg(feature = "runtime")]
mod resume;
mod review;
#[cfg(feature = "runtime")]
mod robot;
#[cfg(feature = "runtime")]
mod run;
#[cfg(feature = "runtime")]
mod see;
#[cfg(feature = "runtime")]
mod serve;
#[cfg(feature = "runtime")]
mod sim;
#[cfg(feature = "runtime")]
mod subgoals;
mod test;
mod vocabulary;
mod watch;
#[cfg(feature = "runtime")]
mod world;

#[cfg(feature = "runtime")]
mod setting;

use clap::Parser;
use clap::error::ErrorKind;
use cli::{Cli, Verb};
use exit::Exit;
use std::process::ExitCode;

fn main() -> ExitCode {
    let exit = match Cli::try_parse() {
        Ok(cli) => run(cli.verb),
        Err(error) => {
            // A reader that closed the pipe has seen enough of the help.
            let _ = error.print();
            match error.kind() {
                ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => Exit::Done,
                _ => Exit::Usage,
            }
        }
    };
    let exit = match output::lost() {
        Some(why) if exit == Exit::Done => {
            output::talk(&format!(
                "error: the result could not be written to stdout: {why}"
            ));
            Exit::Environment
        }
        _ => exit,
    };
    ExitCode::from(exit.code())
}

fn run(verb: Verb) -> Exit {
    let wants_json = verb.wants_json();
    let done = match verb {
        Verb::Completions(arguments) => completions::run(&arguments),
        Verb::New(arguments) => new::run(&arguments),
        Verb::Check(arguments) if arguments.watch => {
            watch::run(&arguments.files, &[], || check::run(&arguments))
        }
        Verb::Check(arguments) => check::run(&arguments),
        Verb::Test(arguments) if arguments.watch => {
            watch::run(&arguments.files, &[], || test::run(&arguments))
        }
        Verb::Test(arguments) => test::run(&arguments),
        Verb::Explain(arguments) => explain::run(&arguments),
        Verb::Vocabulary(arguments) => vocabulary::run(&arguments),
        Verb::Render(arguments) if arguments.watch => {
            let entry = std::slice::from_ref(&arguments.task.file);
            watch::run(entry, &watch::inputs::rendered(&arguments), || {
                render::run(&arguments)
            })
        }
        Verb::Render(arguments) => render::run(&arguments),
        Verb::Snap(arguments) => snap::run(&arguments),
        Verb::Build(arguments) => build::run(&arguments),
        Verb::Review(arguments) => review::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::See(arguments) => see::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Subgoals(arguments) => subgoals::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Demos(arguments) => demos::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Run(arguments) => run::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Resume(arguments) => resume::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Bench(arguments) => bench::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Calibrate(arguments) => calibrate::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Robot(arguments) => robot::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Models(arguments) => models::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Doctor(arguments) => doctor::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Probe(arguments) => probe::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Serve(arguments) => serve::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::Sim(arguments) => sim::run(&arguments),
        #[cfg(feature = "runtime")]
        Verb::World(arguments) => world::run(&arguments),
    };
    done.unwrap_or_else(|failure| {
        output::talk(&format!("error: {failure}"));
        if wants_json {
            output::json(&failure.to_json());
        }
        failure.exit()
    })
}
