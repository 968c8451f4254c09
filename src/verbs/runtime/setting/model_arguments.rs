//! The arguments that select models and limit their cost; `run` and `bench` share them.

use super::catalogue::FactsArguments;
use clap::Args;
use fab_model::Reasoning;
use fab_model::calls::{Caps, Usd};
use fab_providers::remote::settings::Parameter;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Who answers.
#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct ModelArguments {
    /// Who answers: `geometric` (an embedded stand-in without key and network), `random[:SEED]`, `imperfect:RATE[:SEED[:ERRORS]]`,
    /// `replay:RUN`, or `PROVIDER:NAME` (see `fabc models`); `vision=MODEL` and `text=MODEL` name one for a role.
    /// Default: `geometric`.
    #[arg(long, value_name = "[ROLE=]MODEL")]
    pub model: Vec<String>,
    #[command(flatten)]
    pub reach: ReachArguments,
}

/// Who decides.
#[derive(Args, Clone, Debug, Default, Serialize, Deserialize)]
pub struct PolicyArguments {
    /// Who decides: `prompted` asks `--model`; `random[:SEED]` draws from the action space; `expert` follows the task's
    /// demonstration; `smoother` is a network that smooths, `onnx:FILE` one of yours; `exec:"CMD ARG..."` is a program of
    /// yours, `exec+particles:` one that looks at true particles. Default: `prompted`.
    #[arg(long, value_name = "POLICY")]
    policy: Option<String>,
    /// How long one answer of a program may take, seconds. Default: 120.
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..=3600))]
    policy_timeout: Option<u32>,
}

impl PolicyArguments {
    /// Returns the policy's name.
    pub fn name(&self) -> &str {
        self.policy.as_deref().unwrap_or("prompted")
    }

    /// Returns the same time limit for a policy of another name.
    pub fn named(&self, policy: String) -> PolicyArguments {
        PolicyArguments {
            policy: Some(policy),
            ..self.clone()
        }
    }

    /// Returns the time limit for one answer of a program.
    pub fn limit(&self) -> Duration {
        Duration::from_secs(self.policy_timeout.unwrap_or(120).into())
    }
}

/// How providers are reached, and what is known of their models.
#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct ReachArguments {
    /// Where the provider is reached, in place of its usual address; `vision=URL` and `text=URL` for a role.
    #[arg(long, value_name = "[ROLE=]URL")]
    pub base_url: Vec<String>,
    #[command(flatten)]
    pub facts: FactsArguments,
    /// Leave out settings of stages that the model does not support.
    #[arg(long, value_name = "SETTING", value_delimiter = ',', value_parser = Parameter::ALL.map(Parameter::name))]
    pub omit: Vec<String>,
    /// How much the model thinks before it answers, in place of what stages state: `none`, `low`, `medium`, `high`, or a
    /// number of hidden tokens.
    #[arg(long, value_name = "LEVEL")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reasoning: Option<Reasoning>,
    /// Let the model choose numbered points instead of writing coordinates.
    #[arg(long)]
    pub marks: bool,
    /// How long one call may take, seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=3600))]
    pub timeout: u32,
    /// Ask every question anew, even if an earlier run kept its answer.
    #[arg(long)]
    pub no_cache: bool,
    /// Ask models whose price is not known.
    #[arg(long)]
    pub allow_unknown_price: bool,
}

/// What may be asked, and what is kept of it.
#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct SpendArguments {
    /// Print what would be asked and what that costs, and send nothing.
    #[arg(long)]
    pub estimate: bool,
    #[command(flatten)]
    #[serde(flatten)]
    pub caps: CapArguments,
}

/// When asking stops.
#[derive(Args, Clone, Copy, Debug, Serialize, Deserialize)]
pub struct CapArguments {
    /// Stop before models may cost more than this, US dollars, with all earlier parts of the run.
    #[arg(long, value_name = "USD", value_parser = dollars)]
    pub max_cost: Option<Usd>,
    /// Stop before more calls than this are sent, with all earlier parts of the run.
    #[arg(long, value_name = "N")]
    pub max_calls: Option<u64>,
}

impl CapArguments {
    /// Returns the caps.
    pub fn caps(self) -> Caps {
        Caps {
            cost: self.max_cost,
            calls: self.max_calls,
        }
    }

    /// Returns these caps, and others where these are not given.
    pub fn or(self, other: CapArguments) -> CapArguments {
        CapArguments {
            max_cost: self.max_cost.or(other.max_cost),
            max_calls: self.max_calls.or(other.max_calls),
        }
    }
}

impl ReachArguments {
    /// Returns the settings that are left out.
    pub fn omitted(&self) -> impl Iterator<Item = Parameter> {
        let is_omitted = |it: &Parameter| self.omit.iter().any(|name| name == it.name());
        Parameter::ALL.into_iter().filter(is_omitted)
    }
}

/// Why models are looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To ask them.
    Asking,
    /// To estimate the cost of asking them; no key is needed.
    Estimating,
}

impl SpendArguments {
    /// Returns why models are looked up.
    pub fn purpose(&self) -> Purpose {
        if self.estimate {
            Purpose::Estimating
        } else {
            Purpose::Asking
        }
    }
}

/// Parses an amount of money.
pub fn dollars(text: &str) -> Result<Usd, String> {
    let amount = text.parse().ok().and_then(Usd::from_dollars);
    amount.ok_or_else(|| "write an amount of US dollars, such as 2.50".to_owned())
}
