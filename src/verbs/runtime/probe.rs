//! `fabc probe`: finds out with a picture of dots how a model states positions.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::model_arguments::ModelArguments;
use crate::verbs::runtime::setting::model_arguments::Purpose;
use crate::verbs::runtime::setting::model_arguments::ReachArguments;
use crate::verbs::runtime::setting::model_arguments::dollars;
use crate::verbs::runtime::setting::{catalogue, models};
use clap::Args;
use fab_model::ModelError;
use fab_model::calls::Usd;
use fab_model::calls::{Budget, CallRefused, Capped, Caps, Spent};
use fab_providers::probe::{ErrorPx, Probe, SIDES_PX, probe};
use serde_json::json;

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

/// Asks, and reports the frame in which the answers fit.
pub fn run(arguments: &ProbeArguments, io: &Io) -> Result<Exit, Failure> {
    if arguments.reach.marks {
        return Err(Failure::usage(
            "`--marks` lets a model answer numbers of points, and `probe` asks for coordinates; leave it out",
        ));
    }
    let catalogue = catalogue::load(arguments.reach.facts.models.as_deref(), io)?;
    let interrupt = io.interrupt()?;
    let named = ModelArguments {
        model: vec![arguments.model.clone()],
        reach: arguments.reach.clone(),
    };
    let model = models::models(&named, Purpose::Asking, &interrupt, io)?.vision();
    let profile = catalogue.find(&arguments.model).ok();
    let listed = profile.and_then(|profile| profile.facts.coordinates);
    if listed.is_none() {
        io.talk("how this model says where something is is not known: it is asked in pixels");
    }
    io.talk(&format!(
        "asking {} about {} pictures of dots",
        model.name(),
        SIDES_PX.len()
    ));
    let caps = Caps {
        cost: arguments.max_cost,
        calls: arguments.max_calls,
    };
    let budget = Budget::new(caps, Spent::default());
    let found = probe(
        model.as_ref(),
        arguments.seed,
        arguments.reach.reasoning,
        &mut Capped::by(&budget),
    )
    .map_err(|error| match error {
        ModelError::Interrupted => Failure::interrupted(),
        ModelError::NotSent(CallRefused::Budget(why)) => Failure::capped(why),
        error => Failure::environment(error),
    })?;
    if arguments.json {
        let mut value =
            serde_json::to_value(&found).expect("a probe has string keys and finite numbers");
        value["best"] = json!(found.best());
        value["agrees"] = json!(found.agrees());
        value["listed"] = json!(listed);
        io.json(&value);
    } else {
        io.data(&text(&found));
    }
    Ok(if found.agrees() {
        Exit::Done
    } else {
        Exit::Unreached
    })
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
            "its answers fit best as {best}, and not as asked for ({}); say so in a file of facts (`fabc models --help`)",
            found.asked
        ),
    });
    if let Some(usage) = found.usage {
        let cost = found
            .cost
            .map_or("cost unknown".to_owned(), |cost| cost.to_string());
        lines.push(format!(
            "used {} tokens in, {}; {cost}",
            usage.input_tokens,
            usage.output_in_words()
        ));
    }
    lines.join("\n")
}
