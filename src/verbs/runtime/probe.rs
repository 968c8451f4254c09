//! `fabc probe`: finds out how a model states positions, and what its interface takes.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::report::Report;
use crate::verbs::runtime::setting::catalogue;
use crate::verbs::runtime::setting::model_arguments::{CapArguments, OmitArgument, ReachArguments};
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

/// Asks, and reports the frame in which the answers fit and what the interface takes.
pub fn run(arguments: &ProbeArguments, io: &Io) -> Result<Exit, Failure> {
    if arguments.reach.marks {
        return Err(Failure::usage(
            "`--marks` lets a model answer numbers of points, and `probe` asks for coordinates; leave it out",
        ));
    }
    let interrupt = io.interrupt()?;
    let mut reach = arguments.reach.clone();
    if { reach.omit.iter() }.any(|setting| *setting != OmitArgument::Tokens) {
        return Err(Failure::usage(
            "`probe` finds out which settings a model takes; only `--omit tokens` may be given",
        ));
    }
    // An answer of an earlier day says nothing about today.
    reach.no_cache = true;
    let varied = models::varied(&arguments.model, &reach, &interrupt, io)?;
    let most = SIDES_PX.len() as u64 + MOST_QUESTIONS;
    let caps = Caps {
        calls: Some(arguments.caps.max_calls.unwrap_or(2 * most)),
        ..arguments.caps.caps()
    };
    let budget = Budget::new(caps, Spent::default());
    let mut calls = Capped::by(&budget);
    let examination = examine(arguments, &varied, most, &mut calls, io);
    let examination = examination.map_err(|error| match error {
        ModelError::Interrupted => Failure::interrupted(),
        ModelError::NotSent(CallRefused::Budget(cap)) => {
            let failure = calls.last_failure().map_or(String::new(), |why| {
                format!("\nthe last call gave no answer: {why}")
            });
            let help = match cap.raise {
                Some(option) => format!("; a probe begins anew: allow more with `{option}`"),
                None => String::new(),
            };
            Failure::capped(format!("{}{help}{failure}", cap.why))
        }
        error => Failure::environment(error),
    })?;
    io.result(arguments.json, &examination);
    Ok(
        if examination.dots.is_some_and(|dots| dots.probe.agrees()) {
            Exit::Done
        } else {
            Exit::Unreached
        },
    )
}

/// What was found out.
#[derive(Serialize)]
struct Examination {
    /// `None`: the model takes no pictures.
    #[serde(flatten)]
    dots: Option<NamedDots>,
    #[serde(flatten)]
    interface: Interface,
}

/// How the model names places.
#[derive(Serialize)]
struct NamedDots {
    #[serde(flatten)]
    probe: Probe,
    best: Option<Lowering>,
    agrees: bool,
    /// What the catalogue says of it.
    listed: Option<PositionFormat>,
}

/// What its interface takes, and the entry that says so.
#[derive(Serialize)]
struct Interface {
    facts: Facts,
    reasons: Option<bool>,
    remarks: Vec<String>,
    interface_usage: Usage,
    interface_cost: Option<Usd>,
    toml: String,
}

impl NamedDots {
    fn of(probe: Probe, listed: Option<PositionFormat>) -> NamedDots {
        NamedDots {
            best: probe.best(),
            agrees: probe.agrees(),
            probe,
            listed,
        }
    }
}

/// Asks `most` questions at most.
fn examine(
    arguments: &ProbeArguments,
    varied: &Varied,
    most: u64,
    calls: &mut Capped<'_>,
    io: &Io,
) -> Result<Examination, ModelError> {
    let (seed, reasoning) = (arguments.seed, arguments.reach.reasoning);
    let n_pictures = SIDES_PX.len();
    let profile = varied.profile();
    let listed = profile.facts.coordinates;
    if listed.is_none() {
        io.talk("how this model says where something is is not known: it is asked in pixels");
    }
    let most_calls = arguments.caps.max_calls.unwrap_or(2 * most);
    io.talk(&format!(
        "asking {} at most {most} questions: {n_pictures} about pictures of dots, the others about what its interface \
         takes; with retries at most {}",
        profile.title(),
        counted(most_calls as usize, "call"),
    ));
    let mut able = abilities(varied, calls)?;
    let known = Facts {
        max_tokens_field: { able.facts.max_tokens_field }.or(profile.facts.max_tokens_field),
        ..profile.facts.clone()
    };
    let sees = able.facts.vision != Some(false);
    let dots = match sees.then(|| varied.under(&known)).transpose()? {
        None => None,
        Some(model) => Some(probe(model.as_ref(), seed, reasoning, calls)?),
    };
    able.reasons = { able.reasons }.max(dots.as_ref().and_then(|dots| dots.reasons));
    let facts = entry::facts(dots.as_ref(), &able);
    let remarks = remarks(&able, dots.as_ref());
    let (provider, today) = (&profile.provider.name, catalogue::today(io));
    Ok(Examination {
        interface: Interface {
            toml: entry::toml(provider, &profile.id, &facts, &remarks, today),
            facts,
            reasons: able.reasons,
            remarks,
            interface_usage: able.usage,
            interface_cost: able.cost,
        },
        dots: dots.map(|probe| NamedDots::of(probe, listed)),
    })
}

fn remarks(able: &Abilities, dots: Option<&Probe>) -> Vec<String> {
    let mut remarks = able.notes.clone();
    let thinks = able.reasons.map(|reasons| {
        if reasons {
            "it thinks before it answers".to_owned()
        } else {
            "its answers show no thoughts, and their token counts hide none".to_owned()
        }
    });
    remarks.extend(thinks);
    if dots.is_some_and(|dots| dots.coordinates().is_none()) {
        remarks.push(
            "how it states positions is open: no unit and order fits clearly best".to_owned(),
        );
    }
    remarks
}

impl Report for Examination {
    fn text(&self) -> String {
        let dots = self.dots.as_ref().map(|dots| text(&dots.probe) + "\n\n");
        let toml = &self.interface.toml;
        format!(
            "{}for a file of facts (`--models FILE`):\n\n{toml}",
            dots.unwrap_or_default()
        )
    }
}

fn text(found: &Probe) -> String {
    let mut lines = vec![format!(
        "{}: {} of {} dots were named",
        found.model, found.read, found.dots
    )];
    for tried in &found.tried {
        let asked = if tried.lowering == found.asked {
            "  (asked for)"
        } else {
            ""
        };
        let error = &tried.error;
        lines.push(format!(
            "  {:<36}mean {:.1}, median {:.1}, largest {:.1} px{asked}",
            tried.lowering.to_string(),
            error.mean,
            error.median,
            error.max
        ));
    }
    lines.push(match found.best() {
        None => "no answer names places: this model cannot be asked for points".to_owned(),
        Some(best) if best == found.asked => format!("its answers fit best as asked for: {best}"),
        Some(best) => format!(
            "its answers fit best as {best}, and not as asked for ({})",
            found.asked
        ),
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
