//! The `fabc` command: parse, run one verb, report.
//!
//! [`run`] does inside this process what the program does in a process of its own. Everything a command reads and writes
//! passes its [`Io`], but for keys and for lines between programs. Only this package knows the command line, prints, reads
//! the environment (but for the variables of proxies and of ROS, which the network code reads), and chooses exit codes.
//! Data goes to stdout, talk to stderr.
//!
//! ```
//! let io = fabc::Io::in_memory();
//! let code = fabc::run(["fabc", "check", "tasks/double_triangle.fab"], &io);
//! assert_eq!(code, 0);
//! assert!(io.captured().stdout.contains("task `double_triangle` has no errors"));
//! ```

// A build with only the authors' verbs does not use all shared code.
#![cfg_attr(not(feature = "runtime"), allow(dead_code))]

mod exit;
mod io;
mod shipped;
mod snapshots;
mod sources;
mod verbs;
mod watch;

pub use clap::Error as UsageError;
pub use io::{Captured, Io};

use clap::error::ErrorKind;
use clap::{ArgMatches, CommandFactory, FromArgMatches};
use exit::Exit;
use std::ffi::OsString;
use verbs::Cli;

/// Runs one command; returns its exit code.
///
/// - `args`: the words of the command line, starting with the program's name.
/// - `io`: what the command reads, writes and looks up.
pub fn run<A: Into<OsString> + Clone>(args: impl IntoIterator<Item = A>, io: &Io) -> u8 {
    let parsed = Cli::command().try_get_matches_from(args);
    let exit = match parsed.and_then(|matches| Ok((Cli::from_arg_matches(&matches)?, matches))) {
        Ok((mut cli, matches)) => act(&mut cli, &matches, io),
        Err(error) => {
            io.help(&error);
            match error.kind() {
                ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => Exit::Done,
                _ => Exit::Usage,
            }
        }
    };
    if let Some(why) = io.lost().filter(|_| exit == Exit::Done) {
        io.talk(&format!(
            "error: the result could not be written to stdout: {why}"
        ));
        return Exit::Environment.code();
    }
    exit.code()
}

/// Returns the declaration of the command line.
pub fn command() -> clap::Command {
    Cli::command()
}

fn act(cli: &mut Cli, matches: &ArgMatches, io: &Io) -> Exit {
    cli.verb.run(io).unwrap_or_else(|failure| {
        io.talk(&format!("error: {failure}"));
        if verbs::wants_json(matches) {
            io.json(&failure.to_json());
        }
        failure.exit
    })
}
