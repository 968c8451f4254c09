//! `fabc probe`: finds out how a model states positions, and what its interface takes.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::catalogue;
use crate::verbs::runtime::setting::model_arguments::OmitArgument;
use crate::verbs::runtime::setting::model_arguments::ReachArguments;
use crate::verbs::runtime::setting::model_arguments::dollars;
use crate::verbs::runtime::setting::models::{self, Examined};
use clap::Args;
use fab_model::ModelError;
use fab_model::calls::Usd;
use fab_model::calls::{Budget, CallRefused, Capped, Caps, Spent};
use fab_providers::catalogue::{Facts, PositionFormat};
use fab_providers::probe::{
    Abilities, ErrorPx, MOST_QUESTIONS, Probe, SIDES_PX, Subject, abilities, entry, probe,
};
use serde_json::{Value, json};

/// Arguments of `probe`.
#[derive(Args)]
pub struct ProbeArguments {
    /// The model, as `run` takes it.
    #[arg(value_name = "MODEL")]
    pub model: String,
    #[command(flatten)]
    pub reach: ReachArguments,
    /// Stop before the questions may cost more than this, US dollars.
    #[arg(long, value_name = "USD", value_parser = dollars)]
    pub max_cost: Option<Usd>,
    /// Stop before more calls than this are sent.
    #[arg(long, value_name = "N")]
    pub max_calls: Option<u64>,
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
    let examined = models::examined(&arguments.model, &reach, &interrupt, io)?;
    let most = SIDES_PX.len() as u64 + MOST_QUESTIONS;
    let caps = Caps {
        cost: arguments.max_cost,
        calls: Some(arguments.max_calls.unwrap_or(2 * most)),
    };
    let budget = Budget::new(caps, Spent::default());
    let mut calls = Capped::by(&budget);
    examine(arguments, examined, most, &mut calls, io).map_err(|error| match error {
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
    })
}

/// Asks `most` questions at most.
fn examine(
    arguments: &ProbeArguments,
    examined: Examined,
    most: u64,
    calls: &mut Capped<'_>,
    io: &Io,
) -> Result<Exit, ModelError> {
    match examined {
        Examined::Embedded(model) => {
            io.talk(&format!(
                "asking {} about {} pictures of dots; no call is sent",
                model.name(),
                SIDES_PX.len()
            ));
            let found = probe(
                model.as_ref(),
                arguments.seed,
                arguments.reach.reasoning,
                calls,
            )?;
            say(&found, None, None, arguments.json, io);
            Ok(exit(&found))
        }
        Examined::Provided(varied) => {
            let profile = varied.profile();
            let listed = profile.facts.coordinates;
            if listed.is_none() {
                io.talk(
                    "how this model says where something is is not known: it is asked in pixels",
                );
            }
            let calls_at_most = match arguments.max_calls.unwrap_or(2 * most) {
                1 => "1 call".to_owned(),
                count => format!("{count} calls"),
            };
            io.talk(&format!(
                "asking {} at most {most} questions: {} about pictures of dots, the others about what its interface \
                 takes; with retries at most {calls_at_most}",
                profile.title(),
                SIDES_PX.len(),
            ));
            let mut able = abilities(varied.as_ref(), calls)?;
            let known = Facts {
                max_tokens_field: able
                    .facts
                    .max_tokens_field
                    .or(profile.facts.max_tokens_field),
                ..profile.facts.clone()
            };
            let sees = able.facts.vision != Some(false);
            let dots = match sees.then(|| varied.under(&known)).transpose()? {
                None => None,
                Some(model) => Some(probe(
                    model.as_ref(),
                    arguments.seed,
                    arguments.reach.reasoning,
                    calls,
                )?),
            };
            able.reasons = able
                .reasons
                .max(dots.as_ref().and_then(|dots| dots.reasons));
            let facts = entry::facts(dots.as_ref(), &able);
            let remarks = remarks(&able, dots.as_ref());
            let toml = entry::toml(
                &profile.provider.name,
                &profile.id,
                &facts,
                &remarks,
                catalogue::today(io),
            );
            let shown = Entry {
                able,
                facts,
                remarks,
                toml,
            };
            match dots {
                Some(found) => {
                    say(&found, listed, Some(&shown), arguments.json, io);
                    Ok(exit(&found))
                }
                None => {
                    match arguments.json {
                        true => io.json(&shown.json()),
                        false => io.data(&shown.text()),
                    }
                    Ok(Exit::Unreached)
                }
            }
        }
    }
}

/// What was found about the interface, and the entry that says so.
struct Entry {
    able: Abilities,
    facts: Facts,
    remarks: Vec<String>,
    toml: String,
}

impl Entry {
    fn json(&self) -> Value {
        json!({
            "facts": self.facts,
            "reasons": self.able.reasons,
            "remarks": self.remarks,
            "interface_usage": self.able.usage,
            "interface_cost": self.able.cost,
            "toml": self.toml,
        })
    }

    fn text(&self) -> String {
        format!("for a file of facts (`--models FILE`):\n\n{}", self.toml)
    }
}

fn remarks(able: &Abilities, dots: Option<&Probe>) -> Vec<String> {
    let mut remarks = able.notes.clone();
    if let Some(reasons) = able.reasons {
        let words = match reasons {
            true => "it thinks before it answers",
            false => "its answers show no thoughts, and their token counts hide none",
        };
        remarks.push(words.to_owned());
    }
    if dots.is_some_and(|dots| dots.coordinates().is_none()) {
        remarks.push(
            "how it states positions is open: no unit and order fits clearly best".to_owned(),
        );
    }
    remarks
}

fn exit(found: &Probe) -> Exit {
    if found.agrees() {
        Exit::Done
    } else {
        Exit::Unreached
    }
}

fn say(
    found: &Probe,
    listed: Option<PositionFormat>,
    entry: Option<&Entry>,
    wants_json: bool,
    io: &Io,
) {
    if wants_json {
        let mut value =
            serde_json::to_value(found).expect("a probe has string keys and finite numbers");
        value["best"] = json!(found.best());
        value["agrees"] = json!(found.agrees());
        value["listed"] = json!(listed);
        if let Some(Value::Object(more)) = entry.map(Entry::json) {
            for (key, more) in more {
                value[key] = more;
            }
        }
        io.json(&value);
        return;
    }
    let parts = std::iter::once(text(found)).chain(entry.map(Entry::text));
    io.data(&parts.collect::<Vec<_>>().join("\n\n"));
}

fn text(found: &Probe) -> String {
    let mut lines = vec![format!(
        "{}: {} of {} dots were named",
        found.model, found.read, found.dots
    )];
    let words = |error: &ErrorPx| {
        format!(
            "mean {:.1}, median {:.1}, largest {:.1} px",
            error.mean, error.median, error.max
        )
    };
    for tried in &found.tried {
        let asked = if tried.lowering == found.asked {
            "  (asked for)"
        } else {
            ""
        };
        lines.push(format!(
            "  {:<36}{}{asked}",
            tried.lowering.to_string(),
            words(&tried.error)
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
        let cost = found
            .cost
            .map_or("cost unknown".to_owned(), |cost| cost.to_string());
        lines.push(format!(
            "used {} tokens in, {} for the dots; {cost}",
            usage.input_tokens,
            usage.output_in_words()
        ));
    }
    lines.join("\n")
}
