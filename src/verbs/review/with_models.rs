//! The part of `fabc review` that needs models and pictures: the cost of a change, and pictures side by side.

mod pictures;

use super::cost::Pricing;
use super::difference::Compared;
use super::find::Pending;
use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::runtime::setting::catalogue::{self, FactsArguments};
use clap::Args;
use fab_model::calls::Usage;
use std::path::PathBuf;

/// What is shown of a change beside its text.
#[derive(Args)]
pub struct ReviewShownArguments {
    /// Print what the change costs with this `PROVIDER:NAME`.
    #[arg(long, value_name = "MODEL")]
    pub model: Option<String>,
    #[command(flatten)]
    pub facts: FactsArguments,
    /// Write the pictures before and after, and their difference, into this folder; default: a temporary one, when they are shown.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl ReviewShownArguments {
    /// Returns the named folder for pictures, if there is one.
    pub fn folder(&self) -> Option<PathBuf> {
        self.out.clone()
    }
}

/// Returns today's prices of the named model, if there is one.
pub fn pricing(arguments: &ReviewShownArguments, io: &Io) -> Result<Option<Pricing>, Failure> {
    let Some(model) = &arguments.model else {
        return Ok(None);
    };
    let profile = catalogue::profile(model, arguments.facts.models.as_deref(), io)?;
    let price = profile.price_on(catalogue::today(io)).ok_or_else(|| {
        Failure::usage(format!(
            "the price of `{model}` is not known; say it in a file of facts (--models)"
        ))
    })?;
    let usd = move |input_tokens| {
        let usage = Usage {
            input_tokens,
            ..Usage::default()
        };
        price.cost(usage).dollars()
    };
    Ok(Some(Pricing {
        model: profile.title(),
        usd: Box::new(usd),
    }))
}

/// Compares the pictures of a pending snapshot side by side.
pub fn compare(pending: &Pending) -> Compared {
    let Some((before, after)) = pending.pictures() else {
        return Compared {
            png: None,
            words: "a text became a picture, or a picture a text".to_owned(),
            n_changed: None,
            bounds: None,
        };
    };
    let file = pending.path.with_added_extension("png");
    let accepted = pending.path.with_extension("png");
    pictures::compare([before, after], [&accepted, &file])
}
