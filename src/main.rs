//! The `fabc` program: [`fabc::run`] with this process's own streams and signals.

use fabc::Io;
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(fabc::run(std::env::args_os(), &Io::process()))
}
