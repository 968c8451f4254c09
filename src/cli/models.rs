//! Arguments of the verbs that are about models and set-up.

use super::model_arguments::{ReachArguments, dollars};
use clap::{Args, ValueHint};
use fab_model::calls::Usd;
use fab_providers::catalogue::Date;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// How a file of facts is written.
const FORM: &str = "\
A file of facts has the form of the embedded one. The fields that an entry gives replace those there were, the others stay:

  [[model]]
  provider = \"vllm\"            # as in PROVIDER:NAME
  id = \"my-model\"              # or: part = \"qwen3\", for all models with these words in their id
  coordinates = { unit = \"per_mille\", order = \"xy\" }   # pixels, fraction, percent, per_mille; xy, yx
  price = [{ input = 2, cached_input = 0.1, output = 10 }]  # USD per million tokens
  as_of = \"2026-11-20\"         # both are required
  source = \"fabc probe\"";

/// Where facts about models are looked up.
#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct FactsArguments {
    /// Facts of yours, laid over the embedded ones; default: FABC_MODELS, or `fabc/models.toml` in your folder of settings.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub models: Option<PathBuf>,
}

/// Arguments of `models`.
#[derive(Args)]
#[command(after_help = FORM)]
pub struct ModelsArguments {
    /// Only those of this provider.
    #[arg(value_name = "PROVIDER")]
    pub provider: Option<String>,
    #[command(flatten)]
    pub facts: FactsArguments,
    /// The day whose prices and warnings count; default: today.
    #[arg(long, value_name = "DATE")]
    pub on: Option<Date>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `doctor`.
#[derive(Args)]
pub struct DoctorArguments {
    #[command(flatten)]
    pub facts: FactsArguments,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

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

/// Arguments of `serve`.
#[derive(Args)]
pub struct ServeArguments {
    /// What answers: an embedded model or a recording, as `run` takes them (`geometric`, `replay:FILE`, …). Models of
    /// providers are refused, since every program on this machine could spend your key.
    #[arg(long, value_name = "MODEL", default_value = "geometric")]
    pub model: String,
    /// The port on 127.0.0.1; 0 takes any free one.
    #[arg(long, value_name = "N", default_value_t = 8642)]
    pub port: u16,
    /// Print the address as one JSON document, and nothing further.
    #[arg(long)]
    pub json: bool,
}
