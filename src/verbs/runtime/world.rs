//! `fabc world`: checks a user's world against the contract of worlds, and serves the bundled one as such a program.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::worlds::WorldChoice;
use clap::{Args, Subcommand};
use fab_base::wording::counted;
use fab_program::Picker;
use fab_world::conformance::{Conformance, PROMISES, Violation, camera};
use fab_world::serve::serve;
use fab_world::{ExternalWorld, SimulatedWorld, World, WorldError};
use serde_json::json;
use std::io::BufReader;

/// What to do with a world.
#[derive(Subcommand)]
pub enum WorldVerb {
    /// Says which promises of a world yours keeps.
    Check(WorldCheckArguments),
    /// Serves the bundled simulator over stdin and stdout, as a world of yours would.
    Serve,
}

#[derive(Args)]
pub struct WorldCheckArguments {
    /// The world: `exec:"CMD ARG..."`, or `sim` to see what is promised.
    #[arg(value_name = "WORLD")]
    pub world: WorldChoice,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

pub fn run(verb: &WorldVerb, io: &Io) -> Result<Exit, Failure> {
    match verb {
        WorldVerb::Check(arguments) => check(arguments, io),
        WorldVerb::Serve => {
            serve(BufReader::new(std::io::stdin()), &mut std::io::stdout())?;
            Ok(Exit::Done)
        }
    }
}

/// Checks every promise, and reports each result at once.
fn check(arguments: &WorldCheckArguments, io: &Io) -> Result<Exit, Failure> {
    let interrupt = io.interrupt()?;
    let make = || -> Result<Box<dyn World>, WorldError> {
        let (camera, picker) = (camera(), Picker::default());
        if let WorldChoice::Program(command) = &arguments.world {
            let world = ExternalWorld::start(command, &camera, picker, None, &interrupt);
            return Ok(Box::new(world?));
        }
        Ok(Box::new(SimulatedWorld::new(&camera, picker)?))
    };
    if arguments.world == WorldChoice::Arm {
        return Err(Failure::usage(
            "an arm is checked by `fabc robot check`; `fabc world check` is for `exec:\"CMD ARG...\"`",
        ));
    }
    let name = make()?.name().to_owned();
    let (mut promises, mut broken) = (Vec::new(), 0);
    for promise in PROMISES {
        let (state, why) = match promise.check(&make) {
            Ok(Conformance::Whole) => ("kept", None),
            Ok(Conformance::Refused(why)) => ("not offered", Some(why)),
            Err(Violation::World(WorldError::Interrupted)) if interrupt.is_raised() => {
                return Err(Failure::interrupted());
            }
            Err(violation) => {
                broken += 1;
                ("broken", Some(violation.to_string()))
            }
        };
        if !arguments.json {
            let why = why.as_ref().map_or(String::new(), |why| format!(": {why}"));
            io.data(&format!("{state:<12}{}{why}", promise.name));
        }
        promises.push(json!({ "promise": promise.name, "state": state, "why": why }));
    }
    let document = json!({ "world": name, "promises": promises, "broken": broken });
    io.either(arguments.json, &document, || match broken {
        0 => format!("`{name}` breaks no promise"),
        n => format!("`{name}` breaks {}", counted(n, "promise")),
    });
    Ok(match broken {
        0 => Exit::Done,
        _ => Exit::Unreached,
    })
}
