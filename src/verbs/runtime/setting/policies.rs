//! Finds policies by their names on the command line and in suites.

use super::models::{self, Answering};
use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::runtime::setting::model_arguments::{ModelArguments, PolicyArguments, Purpose};
use fab_agent::policy::{
    Description, Expert, External, MakePolicy, Onnx, Policy, Prompted, Random, Sight,
};
use fab_base::child::CommandLine;
use fab_base::interrupt::Interrupt;
use std::path::Path;
use std::time::Duration;

const POLICIES: &str = "`prompted` (asks the models of `--model`), `random` or `random:SEED` (draws from the action space), `expert` (follows the task's demonstration), `smoother` (a network that smooths), `onnx:FILE` (a network of yours), `exec:\"CMD ARG...\"` (a program of yours), and `exec+particles:\"CMD ARG...\"` (one that looks at the true particles)";

/// The seed of the random policy if its name has none.
const DEFAULT_SEED: u64 = 0;

/// A policy, with its resources.
pub enum Deciding {
    Prompted(Box<Answering>),
    Random(Random),
    Expert,
    Network(Onnx),
    Program {
        command: CommandLine,
        sight: Sight,
        limit: Duration,
    },
}

/// Says who decides, and whether a stand-in answers in place of a vision-language model.
pub fn in_words(policy: &Description) -> String {
    let name = &policy.name;
    match &policy.models {
        Some(_) if policy.is_stand_in() => {
            format!("model {name} (a stand-in, no vision-language model)")
        }
        Some(_) => format!("model {name}"),
        None => policy.title(),
    }
}

impl Deciding {
    /// Finds a policy by name; starts nothing.
    pub fn of(
        arguments: &PolicyArguments,
        models: &ModelArguments,
        purpose: Purpose,
        interrupt: &Interrupt,
        io: &Io,
    ) -> Result<Deciding, Failure> {
        let name = arguments.name();
        if name == "prompted" {
            let answering = models::models(models, purpose, interrupt, io)?;
            return Ok(Deciding::Prompted(Box::new(answering)));
        }
        let found = Deciding::without_models(name, arguments.limit())?;
        let why = match purpose {
            _ if !models.model.is_empty() => {
                format!("`--policy {name}` asks no model: leave out `--model`")
            }
            Purpose::Asking => return Ok(found),
            Purpose::Estimating => format!(
                "`--estimate` says what asking models costs, and `--policy {name}` asks none"
            ),
        };
        Err(Failure::usage(why))
    }

    fn without_models(name: &str, limit: Duration) -> Result<Deciding, Failure> {
        let program = |sight, command| {
            let command = CommandLine::parse(command);
            let command =
                command.map_err(|why| Failure::usage(format!("`--policy {name}`: {why}")));
            command.map(|command| Deciding::Program {
                command,
                sight,
                limit,
            })
        };
        let unknown =
            || Failure::usage(format!("there is no policy `{name}`; there is {POLICIES}"));
        match name.split_once(':') {
            None if name == "expert" => Ok(Deciding::Expert),
            None if name == "smoother" => Ok(Deciding::Network(Onnx::smoother())),
            None if name == "random" => Ok(Deciding::Random(Random { seed: DEFAULT_SEED })),
            Some(("random", seed)) => match seed.parse() {
                Ok(seed) => Ok(Deciding::Random(Random { seed })),
                Err(_) => Err(unknown()),
            },
            Some(("onnx", file)) => match Onnx::read(Path::new(file)) {
                Ok(network) => Ok(Deciding::Network(network)),
                Err(error) => Err(Failure::usage(format!("`--policy {name}`: {error}"))),
            },
            Some(("exec", command)) => program(Sight::Camera, command),
            Some(("exec+particles", command)) => program(Sight::Particles, command),
            _ => Err(unknown()),
        }
    }

    /// Returns the models that it asks, if it asks any.
    pub fn answering(&self) -> Option<&Answering> {
        match self {
            Deciding::Prompted(answering) => Some(answering),
            _ => None,
        }
    }

    /// Returns the command line that a rollout starts, if it starts one.
    pub fn command(&self) -> Option<&CommandLine> {
        match self {
            Deciding::Program { command, .. } => Some(command),
            _ => None,
        }
    }
}

impl MakePolicy for Deciding {
    fn make(&self) -> Box<dyn Policy + '_> {
        match self {
            Deciding::Prompted(answering) => Box::new(Prompted::new(answering.models())),
            Deciding::Random(random) => Box::new(*random),
            Deciding::Expert => Box::new(Expert),
            Deciding::Network(network) => Box::new(network.clone()),
            Deciding::Program {
                command,
                sight,
                limit,
            } => Box::new(External::new(command.clone(), *sight, *limit)),
        }
    }
}
