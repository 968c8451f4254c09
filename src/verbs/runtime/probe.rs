//! `fabc probe`: finds out how a model states positions, and what its interface refuses.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::catalogue;
use crate::verbs::runtime::setting::model_arguments::{CapArguments, Purpose, ReachArguments};
use crate::verbs::runtime::setting::models;
use crate::verbs::runtime::setting::remote::Providers;
use clap::Args;
use fab_base::wording::counted;
use fab_model::calls::{Budget, CallRefused, Caps, Fault, Ledger, Spent};
use fab_model::lowering::Lowering;
use fab_model::{Model, ModelError, ModelRole};
use fab_providers::catalogue::{Facts, Profile};
use fab_providers::probe::{Dots, Findings, MOST_QUESTIONS, probe};
use serde::Serialize;
use std::collections::BTreeMap;

/// Arguments of `probe`.
#[derive(Args)]
pub struct ProbeArguments {
    /// The model, as `run` takes it.
    #[arg(value_name = "MODEL")]
    pub model: String,
    #[command(flatten)]
    pub reach: ReachArguments,
    #[command(flatten)]
    pub caps: CapArguments,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Draws the dots' places.
const SEED: u64 = 1;

/// What was found out.
#[derive(Serialize)]
struct Examination {
    /// The model, as `PROVIDER:NAME`.
    model: String,
    #[serde(flatten)]
    findings: Findings,
    /// The frame in which its answers fit best.
    best: Option<Lowering>,
    /// Whether that is the frame that was asked for, and each dot was named.
    agrees: bool,
    spent: Spent,
    /// The entry that says so.
    toml: String,
}

/// Asks, and reports the frame in which the answers fit and what the interface refuses.
pub fn run(arguments: &ProbeArguments, io: &Io) -> Result<Exit, Failure> {
    let mut reach = arguments.reach.clone();
    if reach.marks || !reach.omit.is_empty() {
        return Err(Failure::usage(
            "`probe` finds out which settings a model takes and how it writes coordinates: leave out `--marks` and `--omit`",
        ));
    }
    if models::embedded(&arguments.model, ModelRole::Vision)?.is_some() {
        return Err(Failure::usage(format!(
            "`{}` has no interface to find out about: name a provider's model, `PROVIDER:NAME`",
            arguments.model
        )));
    }
    // An answer of an earlier day says nothing about today.
    reach.no_cache = true;
    let [base_url, _] = models::by_role("--base-url", &reach.base_url)?;
    let interrupt = io.interrupt()?;
    let providers = Providers::new(&reach, &interrupt, io)?;
    let profile = providers.profile(&arguments.model)?;
    // Fails here rather than between questions if there is no key or no address.
    providers.model(&profile, base_url, Purpose::Asking)?;
    let under = |facts: &Facts| {
        let profile = Profile {
            facts: facts.clone(),
            ..profile.clone()
        };
        match providers.model(&profile, base_url, Purpose::Asking) {
            Ok(model) => Ok(Box::new(model) as Box<dyn Model>),
            Err(failure) => Err(ModelError::Unsupported {
                model: profile.title(),
                why: failure.to_string(),
            }),
        }
    };
    let most_calls = arguments.caps.max_calls.unwrap_or(2 * MOST_QUESTIONS);
    io.talk(&format!(
        "asking {} at most {MOST_QUESTIONS} questions about its interface and about pictures of dots; with retries at most {}",
        profile.title(),
        counted(most_calls as usize, "call"),
    ));
    let caps = Caps {
        calls: Some(most_calls),
        ..arguments.caps.caps()
    };
    let budget = Budget::new(caps, &interrupt);
    let mut calls = Ledger::unwritten(&budget);
    let findings = probe(&profile, &under, SEED, reach.reasoning, &mut calls);
    let findings = findings.map_err(|error| failure(error, calls.faults()))?;
    let examination = Examination {
        model: profile.title(),
        best: findings.dots.as_ref().and_then(Dots::best),
        agrees: findings.dots.as_ref().is_some_and(Dots::agrees),
        spent: budget.spent(),
        toml: findings.toml(&profile, catalogue::today(io)),
        findings,
    };
    io.either(arguments.json, &examination, || examination.text());
    Ok(if examination.agrees {
        Exit::Done
    } else {
        Exit::Unreached
    })
}

/// Says why there are no findings; a cap is reached early if calls failed, so `faults` are told with it.
fn failure(error: ModelError, faults: &BTreeMap<Fault, u32>) -> Failure {
    match error {
        ModelError::NotSent(CallRefused::Interrupted) => Failure::interrupted(),
        ModelError::NotSent(CallRefused::Budget(cap)) => {
            let failed = faults
                .iter()
                .map(|(fault, count)| format!("; failed calls: {fault} {count}"));
            let failed: String = failed.collect();
            Failure::capped(format!("the probe is not complete: {cap}{failed}"))
        }
        error => Failure::environment(error),
    }
}

impl Examination {
    fn text(&self) -> String {
        let mut lines = Vec::new();
        if let Some(dots) = &self.findings.dots {
            lines.push(format!(
                "{}: {} of {} dots were named, asked for {}",
                self.model, dots.read, dots.drawn, dots.asked
            ));
            lines.extend(dots.tried.iter().map(|tried| {
                let lowering = tried.lowering.to_string();
                format!("  {lowering:<36}mean error {:.1} px", tried.error_px)
            }));
        }
        lines.push(match self.best {
            None => "no answer names places: this model cannot be asked for points".to_owned(),
            Some(best) => format!("its answers fit best as {best}"),
        });
        let spent = &self.spent;
        lines.push(format!(
            "used {}; {}",
            spent.tokens_in_words(),
            spent.in_words()
        ));
        lines.push(format!(
            "\nfor a file of facts (`--models FILE`):\n\n{}",
            self.toml
        ));
        lines.join("\n")
    }
}
