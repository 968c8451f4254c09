//! Finds models by their names on the command line.

use super::catalogue;
use super::remote::{self, Providers};
use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::render::camera::TargetModelArguments;
use crate::verbs::runtime::setting::model_arguments::{ModelArguments, Purpose, SpendArguments};
use fab_agent::rollout::FirstQuestion;
use fab_base::interrupt::Interrupt;
use fab_model::calls::Budget;
use fab_model::lowering::Lowering;
use fab_model::replay::Replay;
use fab_model::{Model, ModelRole, Models};
use fab_providers::catalogue::Profile;
use fab_providers::remote::Remote;
use fab_standins::imperfect::Errors;
use fab_standins::{Geometric, Imperfect, Random};
use std::path::Path;
use std::sync::Arc;

/// The models that this build knows.
const MODELS: &str = "`geometric` (an embedded stand-in), `random` or `random:SEED` (draws from what is offered), `imperfect:RATE`, `imperfect:RATE:SEED` or `imperfect:RATE:SEED:ERRORS` (geometric with that share of wrong answers; ERRORS is `persistent` or `neighbour`), `replay:RUN` (the answers of an earlier run), and `PROVIDER:NAME` (`fabc models` lists them)";

/// Prefix of a replay's name.
const REPLAY: &str = "replay:";

/// The model if the command line names none.
const DEFAULT_MODEL: &str = "geometric";

/// The seed of a model if the command line gives none.
const DEFAULT_SEED: u64 = 0;

/// The models of both roles.
pub struct Answering {
    vision: Answerer,
    text: Answerer,
}

/// A model; the same one as `remote` if it has a provider.
#[derive(Clone)]
struct Answerer {
    model: Arc<dyn Model>,
    remote: Option<Arc<Remote>>,
}

impl Answering {
    /// Returns the provider's model of a role; `None` if it has no provider.
    pub fn remote(&self, role: ModelRole) -> Option<&Remote> {
        let answerer = match role {
            ModelRole::Vision => &self.vision,
            ModelRole::Text => &self.text,
        };
        answerer.remote.as_deref()
    }

    /// Fails if a question cannot be sent as it is, for example because the model does not support one of its settings.
    pub fn check(&self, questions: &[FirstQuestion]) -> Result<(), Failure> {
        for FirstQuestion { stage, request } in questions {
            if let Some(Err(error)) = { self.remote(request.role) }.map(|it| it.encoded(request)) {
                return Err(Failure::environment(format!("stage `{stage}`: {error}")));
            }
        }
        Ok(())
    }

    /// Returns whether a role's questions go to a provider.
    pub fn asks_a_provider(&self) -> bool {
        self.vision.remote.is_some() || self.text.remote.is_some()
    }

    /// Returns whether a role's model holds one answer for all starts.
    pub fn shares_answers(&self) -> bool {
        self.vision.model.shares_answers() || self.text.model.shares_answers()
    }

    /// Returns the model of each role.
    pub fn models(&self) -> Models<'_> {
        Models {
            vision: self.vision.model.as_ref(),
            text: self.text.model.as_ref(),
        }
    }
}

/// Finds the models that the command line names.
///
/// - `interrupt`: ends calls in progress.
pub fn models(
    arguments: &ModelArguments,
    purpose: Purpose,
    interrupt: &Interrupt,
    io: &Io,
) -> Result<Answering, Failure> {
    let [vision, text] = by_role("--model", &arguments.model)?;
    let [vision, text] = [vision, text].map(|name| name.unwrap_or(DEFAULT_MODEL));
    let [vision_url, text_url] = by_role("--base-url", &arguments.reach.base_url)?;
    // The catalogue is read when the first provider is named.
    let mut providers = None;
    let mut find = |name: &str, base_url: Option<&str>, role: ModelRole| {
        if let Some(model) = embedded(name, role)? {
            return Ok::<_, Failure>(Answerer {
                model: Arc::from(model),
                remote: None,
            });
        }
        let providers = match &mut providers {
            Some(providers) => providers,
            absent => absent.insert(Providers::new(&arguments.reach, interrupt, io)?),
        };
        let profile = providers.profile(name)?;
        let remote = Arc::new(providers.model(&profile, base_url, purpose)?);
        Ok(Answerer {
            model: remote.clone(),
            remote: Some(remote),
        })
    };
    let model = find(vision, vision_url, ModelRole::Vision)?;
    let is_shared = vision == text && vision_url == text_url && !vision.starts_with(REPLAY);
    Ok(Answering {
        text: if is_shared {
            model.clone()
        } else {
            find(text, text_url, ModelRole::Text)?
        },
        vision: model,
    })
}

/// The model for which messages are shown.
pub struct TargetModel {
    /// The form in which it gets points and pictures.
    pub lowering: Lowering,
    /// Its profile; `None` for embedded models, and if no model is named.
    pub profile: Option<Profile>,
}

impl TargetModel {
    /// Finds the model that the command line names.
    pub fn of(shown: &TargetModelArguments, io: &Io) -> Result<TargetModel, Failure> {
        let (known, profile) = match &shown.model {
            None => (Lowering::PIXELS, None),
            Some(name) => match embedded(name, ModelRole::Text)? {
                Some(model) => (model.lowering(), None),
                None => {
                    let catalogue = catalogue::load(shown.facts.models.as_deref(), io)?;
                    let profile = catalogue.find(name).map_err(Failure::usage)?;
                    (profile.facts.lowering(), Some(profile))
                }
            },
        };
        let lowering = remote::lowering(known, shown.marks);
        Ok(TargetModel { lowering, profile })
    }
}

/// Parses `X`, or `vision=X` and `text=Y`; returns the values for vision and for text, if there are any.
pub fn by_role<'v>(flag: &str, values: &'v [String]) -> Result<[Option<&'v str>; 2], Failure> {
    let (mut both, mut vision, mut text) = (None, None, None);
    let mut has_more = false;
    for value in values {
        let (place, value) = match value.split_once('=') {
            Some(("vision", value)) => (&mut vision, value),
            Some(("text", value)) => (&mut text, value),
            _ => (&mut both, value.as_str()),
        };
        has_more |= place.replace(value).is_some();
    }
    has_more |= both.is_some() && vision.is_some() && text.is_some();
    let (vision, text) = (vision.or(both), text.or(both));
    if has_more || vision.is_some() != text.is_some() {
        return Err(Failure::usage(format!(
            "`{flag}` names one thing for each role: write `{flag} X` for both, or `{flag} vision=X {flag} text=Y`"
        )));
    }
    Ok([vision, text])
}

/// Finds a model that needs no provider; `None` for any other name.
pub fn embedded(name: &str, role: ModelRole) -> Result<Option<Box<dyn Model>>, Failure> {
    if let Some(file) = name.strip_prefix(REPLAY) {
        let replay = Replay::load(Path::new(file), role)?;
        return Ok(Some(Box::new(replay)));
    }
    let parts: Vec<&str> = name.split(':').collect();
    let found: Option<Box<dyn Model>> = match parts[..] {
        ["geometric"] => Some(Box::new(Geometric)),
        ["random"] => Some(Box::new(Random::seeded(DEFAULT_SEED))),
        ["random", seed] => match seed.parse() {
            Ok(seed) => Some(Box::new(Random::seeded(seed))),
            Err(_) => None,
        },
        ["imperfect", rate, ref more @ ..] => imperfect(rate, more),
        [_] | ["geometric" | "random", ..] => None,
        _ => return Ok(None),
    };
    found.map(Some).ok_or_else(|| {
        Failure::usage(format!(
            "there is no model `{name}`; there is {MODELS}; SEED is a whole number, RATE from 0 to 1"
        ))
    })
}

/// Returns geometric with a share of wrong answers; `more` may have a seed, and a kind of errors after it.
fn imperfect(rate: &str, more: &[&str]) -> Option<Box<dyn Model>> {
    let (seed, errors) = match *more {
        [] => (DEFAULT_SEED, Errors::Mixed),
        [seed] => (seed.parse().ok()?, Errors::Mixed),
        [seed, errors] => {
            let errors = Errors::WORDS.iter().find(|(word, _)| *word == errors)?.1;
            (seed.parse().ok()?, errors)
        }
        _ => return None,
    };
    let model = Imperfect::new(rate.parse().ok()?, seed, errors)?;
    Some(Box::new(model))
}

/// Makes the budget from the command line; an interrupt ends waits for calls under way.
pub fn budget(arguments: &SpendArguments, interrupt: &Interrupt) -> Budget {
    Budget::new(arguments.caps.caps(), interrupt)
}
