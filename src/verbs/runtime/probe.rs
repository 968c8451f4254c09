//! `fabc probe`: finds out how a model states positions, and what its interface takes.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::report::Report;
use crate::verbs::runtime::setting::catalogue;
use crate::verbs::runtime::setting::model_arguments::{CapArguments, ReachArguments};
use crate::verbs::runtime::setting::models::{self, Varied};
use clap::Args;
use fab_base::wording::counted;
use fab_model::ModelError;
use fab_model::calls::{Budget, CallRefused, Capped, Caps, Spent, Usage, Usd};
use fab_model::lowering::Lowering;
use fab_providers::catalogue::{Facts, PositionFormat};
use fab_providers::probe::{
    Abilities, MOST_QUESTIONS, Probe, SIDES_PX, Subject, abilities, entry, probe,
};
use fab_providers::remote::settings::Parameter;
use serde::Serialize;

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
    /// Draws the dots' places.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// What was found out.
#[derive(Serialize)]
struct Examination {
    /// `None`: the model takes no pictures.
    #[serde(flatten)]
    dots: Option<Probe>,
    /// The frame in which its answers fit best.
    best: Option<Lowering>,
    /// Whether that is the frame that was asked for, and each dot was named.
    agrees: bool,
    /// What the catalogue says of it.
    listed: Option<PositionFormat>,
    facts: Facts,
    reasons: Option<bool>,
    remarks: Vec<String>,
    interface_usage: Usage,
    interface_cost: Option<Usd>,
    /// The entry that says so.
    toml: String,
}

/// Asks, and reports the frame in which the answers fit and what the interface takes.
pub fn run(arguments: &ProbeArguments, io: &Io) -> Result<Exit, Failure> {
    let mut reach = arguments.reach.clone();
    let is_fixed = reach
        .omitted()
        .any(|setting| setting != Parameter::MaxTokens);
    if reach.marks || is_fixed {
        return Err(Failure::usage(
            "`probe` finds out which settings a model takes and how it writes coordinates: leave out `--marks`, and `--omit` but for `tokens`",
        ));
    }
    // An answer of an earlier day says nothing about today.
    reach.no_cache = true;
    let interrupt = io.interrupt()?;
    let varied = models::varied(&arguments.model, &reach, &interrupt, io)?;
    let most = SIDES_PX.len() as u64 + MOST_QUESTIONS;
    let most_calls = arguments.caps.max_calls.unwrap_or(2 * most);
    let caps = Caps {
        calls: Some(most_calls),
        ..arguments.caps.caps()
    };
    io.talk(&format!(
        "asking {} at most {most} questions: {} about pictures of dots, the others about what its interface takes; \
         with retries at most {}",
        varied.profile().title(),
        SIDES_PX.len(),
        counted(most_calls as usize, "call"),
    ));
    let budget = Budget::new(caps, Spent::default());
    let mut calls = Capped::by(&budget);
    let examination = examine(arguments, &varied, &mut calls, io);
    let examination = examination.map_err(|error| match error {
        ModelError::Interrupted => Failure::interrupted(),
        ModelError::NotSent(CallRefused::Budget(cap)) => {
            let option = cap.raise.map_or(String::new(), |option| {
                format!("; a probe begins anew: allow more with `{option}`")
            });
            let failure = calls.last_failure().map_or(String::new(), |why| {
                format!("\nthe last call gave no answer: {why}")
            });
            Failure::capped(format!("{}{option}{failure}", cap.why))
        }
        error => Failure::environment(error),
    })?;
    io.result(arguments.json, &examination);
    Ok(if examination.agrees {
        Exit::Done
    } else {
        Exit::Unreached
    })
}

fn examine(
    arguments: &ProbeArguments,
    varied: &Varied,
    calls: &mut Capped<'_>,
    io: &Io,
) -> Result<Examination, ModelError> {
    let profile = varied.profile();
    let mut able = abilities(varied, calls)?;
    let known = Facts {
        max_tokens_field: { able.facts.max_tokens_field }.or(profile.facts.max_tokens_field),
        ..profile.facts.clone()
    };
    let dots = if able.facts.vision == Some(false) {
        None
    } else {
        let (model, reasoning) = (varied.under(&known)?, arguments.reach.reasoning);
        Some(probe(model.as_ref(), arguments.seed, reasoning, calls)?)
    };
    able.reasons = { able.reasons }.max(dots.as_ref().and_then(|dots| dots.reasons));
    let facts = entry::facts(dots.as_ref(), &able);
    let remarks = remarks(&able, dots.as_ref());
    let (provider, today) = (&profile.provider.name, catalogue::today(io));
    Ok(Examination {
        best: dots.as_ref().and_then(Probe::best),
        agrees: dots.as_ref().is_some_and(Probe::agrees),
        listed: profile.facts.coordinates,
        toml: entry::toml(provider, &profile.id, &facts, &remarks, today),
        facts,
        reasons: able.reasons,
        remarks,
        interface_usage: able.usage,
        interface_cost: able.cost,
        dots,
    })
}

fn remarks(able: &Abilities, dots: Option<&Probe>) -> Vec<String> {
    let mut remarks = able.notes.clone();
    remarks.extend(able.reasons.map(|reasons| {
        let thinks = if reasons {
            "it thinks before it answers"
        } else {
            "its answers show no thoughts, and their token counts hide none"
        };
        thinks.to_owned()
    }));
    if dots.is_some_and(|dots| dots.coordinates().is_none()) {
        let open = "how it states positions is open: no unit and order fits clearly best";
        remarks.push(open.to_owned());
    }
    remarks
}

impl Report for Examination {
    fn text(&self) -> String {
        let mut lines: Vec<String> = Vec::new();
        lines.extend(self.dots.as_ref().map(text));
        lines.push(format!(
            "for a file of facts (`--models FILE`):\n\n{}",
            self.toml
        ));
        lines.join("\n\n")
    }
}

fn text(found: &Probe) -> String {
    let mut lines = vec![format!(
        "{}: {} of {} dots were named, asked for {}",
        found.model, found.read, found.dots, found.asked
    )];
    for tried in &found.tried {
        let error = &tried.error;
        lines.push(format!(
            "  {:<36}mean {:.1}, median {:.1}, largest {:.1} px",
            tried.lowering.to_string(),
            error.mean,
            error.median,
            error.max
        ));
    }
    lines.push(match found.best() {
        None => "no answer names places: this model cannot be asked for points".to_owned(),
        Some(best) => format!("its answers fit best as {best}"),
    });
    if let Some(usage) = found.usage {
        let cost = { found.cost }.map_or("cost unknown".to_owned(), |cost| cost.to_string());
        lines.push(format!(
            "used {} tokens in, {} for the dots; {cost}",
            usage.input_tokens,
            usage.output_in_words()
        ));
    }
    lines.join("\n")
}
