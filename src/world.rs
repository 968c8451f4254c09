//! `fabc world`: whether a world of the user's keeps what every world promises, and the bundled one as such a program.

use crate::cli::world::{CheckArguments, WorldArguments, WorldVerb};
use crate::exit::{Exit, Failure};
use crate::setting::worlds::{self, WorldChoice};
use crate::{output, setting};
use fab_program::Picker;
use fab_world::conformance::{Broken, Kept, PROMISES, camera};
use fab_world::serve::serve;
use fab_world::{ExternalWorld, SimulatedWorld, World, WorldError};
use serde_json::json;
use std::io::{BufReader, stdin, stdout};

/// Runs one of the verbs.
pub fn run(arguments: &WorldArguments) -> Result<Exit, Failure> {
    match &arguments.verb {
        WorldVerb::Check(arguments) => check(arguments),
        WorldVerb::Serve => {
            serve(BufReader::new(stdin()), &mut stdout())?;
            Ok(Exit::Done)
        }
    }
}

/// Checks every promise, and says each as it is known.
fn check(arguments: &CheckArguments) -> Result<Exit, Failure> {
    let interrupt = setting::interrupt()?;
    let make = || -> Result<Box<dyn World>, WorldError> {
        Ok(match &arguments.world {
            WorldChoice::Program(command) => Box::new(ExternalWorld::start(
                command,
                &camera(),
                Picker::default(),
                None,
                &interrupt,
            )?),
            _ => Box::new(SimulatedWorld::new(&camera(), Picker::default())?),
        })
    };
    if arguments.world == WorldChoice::Jaco {
        return Err(Failure::usage(
            "an arm is checked by `fabc robot check`; `fabc world check` is for `exec:\"CMD ARG...\"`",
        ));
    }
    let name = make().map_err(worlds::failure)?.name().to_owned();
    let mut found = Vec::new();
    for promise in PROMISES {
        let (state, why) = match promise.check(&make) {
            Ok(Kept::Whole) => ("kept", None),
            Ok(Kept::Refused(why)) => ("not offered", Some(why)),
            Err(Broken::World(WorldError::Interrupted)) if interrupt.is_raised() => {
                return Err(Failure::interrupted());
            }
            Err(broken) => ("broken", Some(broken.to_string())),
        };
        if !arguments.json {
            let why = why.as_ref().map_or(String::new(), |why| format!(": {why}"));
            output::data(&format!("{state:<12}{}{why}", promise.name));
        }
        found.push(json!({ "promise": promise.name, "state": state, "why": why }));
    }
    let n_broken = found.iter().filter(|it| it["state"] == "broken").count();
    if arguments.json {
        output::json(&json!({ "world": name, "promises": found, "broken": n_broken }));
    } else {
        output::data(&match n_broken {
            0 => format!("`{name}` breaks no promise"),
            1 => format!("`{name}` breaks 1 promise"),
            _ => format!("`{name}` breaks {n_broken} promises"),
        });
    }
    Ok(match n_broken {
        0 => Exit::Done,
        _ => Exit::Unreached,
    })
}
