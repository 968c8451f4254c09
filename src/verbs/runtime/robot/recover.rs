//! `fabc robot recover`: reports how the last run left an arm, and lets it move again once a person has seen to it.
//!
//! In: the arm's settings, with its last run recorded beside them; a description of what was done. Out: an arm that
//! accepts motion, which is verified, and a line in that run's journal.

use super::terminal::line_of;
use super::{connect, preflight};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::{Args, ValueHint};
use fab_arm::driver::PortArm;
use fab_arm::journal::{self, RunState};
use fab_arm::port::Port;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Args)]
pub struct RecoverArguments {
    /// The arm's settings.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub robot: PathBuf,
    /// What was done, in words; default: asked on the terminal.
    #[arg(long, value_name = "WORDS")]
    pub how: Option<String>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

const QUESTION: &str = "Bring the arm to rest by hand, and take the cloth out of its fingers; `home` of the vendor's driver \
opens the hand. Once let go, the arm moves on any command: is its way free, and a physical stop in reach? What was done, in a few \
words (empty: change nothing):";

/// How an arm was left, and what a person did about it.
#[derive(Serialize)]
struct Recovery {
    /// `clear`, `unclear` or `unknown`.
    left: &'static str,
    #[serde(flatten)]
    state: Option<RunState>,
    /// Why it is unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<String>,
    recovered: Option<String>,
}

pub fn run(arguments: &RecoverArguments, io: &Io) -> Result<Exit, Failure> {
    let robot = &arguments.robot;
    let nothing = "it ends with the program that moves it, so there is nothing to recover";
    let settings = connect::settings_of_real(robot, nothing)?;
    preflight::claim(robot).map_err(Failure::environment)?;
    let mut arm = connect::arm(&settings).map_err(Failure::environment)?;
    recover(&mut arm, arguments, io)
}

/// Lets an arm move again, unless nobody says what was done; records it if the arm has had a run.
fn recover<P: Port + ?Sized>(
    arm: &mut PortArm<P>,
    arguments: &RecoverArguments,
    io: &Io,
) -> Result<Exit, Failure> {
    let run = journal::left(&arguments.robot);
    let told = preflight::told(&run);
    let left = match &run {
        Ok(state) if state.is_clear() => "clear",
        Ok(_) => "unclear",
        Err(_) => "unknown",
    };
    let recovered = if left == "clear" && !arm.is_stopped()? {
        None
    } else {
        io.talk(&told);
        let how = arguments.how.clone().unwrap_or_else(|| {
            io.talk(QUESTION);
            // At the end of input the answer is empty.
            io.read(line_of).unwrap_or_default()
        });
        let how = how.trim().to_owned();
        if how.is_empty() {
            return Err(Failure::environment(
                "nobody said what was done, so that the arm is left as it is",
            ));
        }
        arm.recover().map_err(|error| {
            Failure::environment(format!(
                "the arm does not verifiably accept motion again: {error}"
            ))
        })?;
        journal::record_recovery(&arguments.robot, &how).map_err(|error| {
            Failure::environment(format!(
                "the arm accepts motion again, which is not noted: {error}"
            ))
        })?;
        Some(how)
    };
    let document = Recovery {
        left,
        why: run.as_ref().err().map(ToString::to_string),
        state: run.ok().filter(|_| left == "unclear"),
        recovered,
    };
    io.either(arguments.json, &document, || match &document.recovered {
        None => format!("clear: {told}"),
        Some(how) => format!("recovered: {how}; the arm accepts motion again"),
    });
    Ok(Exit::Done)
}

#[cfg(test)]
mod tests;
