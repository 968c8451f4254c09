//! The part of the command line that says who answers, and what that may cost; `run` and `bench` share it.

use clap::Args;
use runtime::calls::Usd;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Who answers.
#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct ModelArguments {
    /// Who answers: `geometric` (an embedded stand-in without key and network), `random[:SEED]`, `imperfect:RATE[:SEED]`,
    /// `replay:FILE`, or `PROVIDER:NAME`; `vision=MODEL` and `text=MODEL` name one for a role.
    #[arg(long, value_name = "[ROLE=]MODEL", default_value = "geometric")]
    pub model: Vec<String>,
}

/// What may be asked, and what is kept of it.
#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct SpendArguments {
    /// Add every question with its answer to this recording, for `--model replay:FILE`.
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Stop before models may cost more than this, US dollars, for the whole run with its earlier parts.
    #[arg(long, value_name = "USD", value_parser = dollars)]
    pub max_cost: Option<Usd>,
    /// Stop before more calls than this are sent, for the whole run with its earlier parts.
    #[arg(long, value_name = "N")]
    pub max_calls: Option<u64>,
}

/// Reads an amount of money.
pub fn dollars(text: &str) -> Result<Usd, String> {
    let amount = text.parse().ok().and_then(Usd::from_dollars);
    amount.ok_or_else(|| "write an amount of US dollars, such as 2.50".to_owned())
}
