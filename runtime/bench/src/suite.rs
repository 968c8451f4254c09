//! A suite as data: its tasks, starts, methods, and notes.
//!
//! In: the text of a `.toml` file. Out: a validated [`Suite`]. TOML, because a suite is a flat list of names and
//! numbers with some comments: it needs no grammar of its own, and errors have line numbers. Names (of tasks, variants,
//! models) are resolved later, by code with access to files.

use super::metric::Metric;
use super::statistics::Statistic;
use super::vary::{Variation, Vary};
use fab_program::Reasoning;
use serde::Deserialize;
use std::collections::BTreeMap;

/// The most starts of one task, repeats of one start, tasks, methods, and steps of a rollout.
const MOST: u32 = 1000;

/// The contents of a suite file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Suite {
    /// What the suite is for, one sentence; shown with its table.
    pub about: String,
    /// A note under the table, above the standard one.
    #[serde(default)]
    pub note: String,
    /// The statistic of distances and improvements.
    pub statistic: Statistic,
    /// The metrics, a column each.
    pub metrics: Vec<Metric>,
    /// Numbers of actions to evaluate at; a rollout is as long as the last. Empty: the task's own.
    #[serde(default)]
    pub horizons: Vec<u32>,
    /// Rollouts per start for a model that varies.
    #[serde(default = "one")]
    pub repeats: u32,
    /// Whether a server that enforces schemas gets one with each question. A suite that compares prompts, or quotes figures
    /// that were asked without, asks in the prompt's own format.
    #[serde(default = "yes")]
    pub structured: bool,
    /// The starts.
    pub starts: Starts,
    /// Starts of single tasks, by name, overriding `starts`.
    #[serde(default, rename = "starts_of")]
    pub own_starts: BTreeMap<String, Starts>,
    /// Task files, relative to the suite's own.
    pub tasks: Vec<String>,
    /// The methods, a row each.
    #[serde(rename = "method")]
    pub methods: Vec<Method>,
    /// Differences between two methods at the same starts.
    #[serde(default, rename = "gap")]
    pub gaps: Vec<Gap>,
    /// Others' figures.
    #[serde(default, rename = "quoted")]
    pub quotes: Vec<Quote>,
    /// The axes along which each start's world is varied, if any.
    #[serde(default)]
    pub vary: Option<Vary>,
}

/// The starts of a suite; generated, and the same on every machine.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "lie", rename_all = "snake_case", deny_unknown_fields)]
pub enum Starts {
    /// Every size turned by every angle; the number of a start is `angles * size + angle`.
    Flat {
        /// Particles along the cloth's x; the other side keeps the task's ratio, rounded down.
        sides: Vec<u32>,
        /// Counter-clockwise as seen from above, degrees.
        turns_deg: Vec<f64>,
    },
    /// Lifted and dropped at random. Start `i` has `sides[i % n]` by `sides[i / n % n]` particles and the seed
    /// `first_seed + i`.
    Crumpled {
        /// Particles along either side.
        sides: Vec<u32>,
        /// Number of starts.
        count: u32,
        /// The seed of the first one.
        first_seed: u64,
    },
    /// Laid by hand, as the task says: flat or crumpled. In a simulated rehearsal, start `i` is crumpled with seed `i`,
    /// or turned by two degrees more than the one before.
    Operator {
        /// Number of starts.
        count: u32,
    },
}

/// A method of doing a task.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Method {
    /// Its name in tables and folders.
    pub name: String,
    /// The variant of the task; `None`: the task itself.
    pub variant: Option<String>,
    /// The policy; `None`: that of the command line.
    pub policy: Option<String>,
    /// The only model that it applies to; `None`: that of the command line.
    pub model: Option<String>,
    /// How much the model thinks, in every stage of the task; the command line overrides it.
    pub reasoning: Option<Reasoning>,
    /// Rollouts per start, overriding the suite's number.
    pub repeats: Option<u32>,
    /// Whether a task without that variant is skipped instead of being an error.
    #[serde(default)]
    pub optional: bool,
    /// A caveat for readers of the row.
    pub note: Option<String>,
    /// A caveat for readers of the row if a stand-in answers.
    pub stand_in_note: Option<String>,
}

/// A difference between two methods.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gap {
    /// Its name in tables.
    pub name: String,
    /// The minuend.
    pub of: String,
    /// The subtrahend.
    pub over: String,
}

/// A figure that others report.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quote {
    /// The task's name.
    pub task: String,
    /// Its author or method.
    pub method: String,
    /// What was measured.
    pub metric: Metric,
    /// Number of actions, if reported.
    pub horizon: Option<u32>,
    /// Its kind.
    pub statistic: Statistic,
    /// The figure.
    pub value: f64,
    /// Its spread, if reported.
    pub spread: Option<f64>,
    /// Number of rollouts, if reported; gives a share Wilson's interval.
    pub n: Option<u32>,
    /// Its source.
    pub source: String,
}

/// Why a suite cannot be used: it is not TOML or has another structure, or a value is out of bounds.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct SuiteError(String);

impl Suite {
    /// Reads a suite.
    pub fn parse(text: &str) -> Result<Suite, SuiteError> {
        let suite: Suite = toml::from_str(text)
            .map_err(|error| SuiteError(error.to_string().trim_end().to_owned()))?;
        suite.check()?;
        Ok(suite)
    }

    fn check(&self) -> Result<(), SuiteError> {
        filled("metrics", &self.metrics)?;
        filled("tasks", &self.tasks)?;
        filled("method", &self.methods)?;
        within("repeats", self.repeats)?;
        for (number, horizon) in self.horizons.iter().enumerate() {
            within("horizons", *horizon)?;
            if number > 0 && self.horizons[number - 1] >= *horizon {
                return wrong("horizons", format!("{:?} do not grow", self.horizons));
            }
        }
        for method in &self.methods {
            file_name("method.name", &method.name)?;
            within("method.repeats", method.repeats.unwrap_or(1))?;
            let most = Reasoning::MOST_TOKENS;
            if let Some(Reasoning::Tokens(tokens)) = method.reasoning
                && !(1..=most).contains(&tokens)
            {
                let why = format!("{tokens} is not from 1 to {most}");
                return wrong("method.reasoning", why);
            }
            let other = method.policy.iter().find(|policy| *policy != "prompted");
            let reasoning = method.reasoning.map(|it| ("reasoning", it.to_string()));
            let of_model = reasoning.or(method.model.clone().map(|it| ("model", it)));
            if let (Some(policy), Some((key, value))) = (other, of_model) {
                let why = format!(
                    "`{policy}` asks no model, and `{key}` is `{value}`: state one of them"
                );
                return wrong("method.policy", why);
            }
        }
        unique(
            "method.name",
            self.methods.iter().map(|it| it.name.as_str()),
        )?;
        unique("tasks", self.tasks.iter().map(String::as_str))?;
        for gap in &self.gaps {
            for name in [&gap.of, &gap.over] {
                if !self.methods.iter().any(|method| method.name == *name) {
                    return wrong("gap", format!("`{}` names no method `{name}`", gap.name));
                }
            }
        }
        for quote in &self.quotes {
            let finite = quote.spread.into_iter().chain([quote.value]);
            if !finite.into_iter().all(f64::is_finite) {
                return wrong("quoted.value", "it is not a finite number".to_owned());
            }
            within("quoted.n", quote.n.unwrap_or(1))?;
            if quote.statistic == Statistic::Share && !(0.0..=1.0).contains(&quote.value) {
                let why = format!("{} is not a share from 0 to 1", quote.value);
                return wrong("quoted.value", why);
            }
        }
        let mut all = self.own_starts.values().chain([&self.starts]);
        if all.any(Starts::is_laid_by_hand) {
            if self.vary.is_some() {
                let why = "a cloth laid by hand lies on a table, and only the bundled simulator's worlds can be varied; generate the starts (`lie = \"flat\"`, `\"crumpled\"`), or leave the table out";
                return wrong("vary", why.to_owned());
            }
            let distance = |metric: &&Metric| metric.row().fold_fraction.is_some();
            if let Some(metric) = self.metrics.iter().find(distance) {
                let why = format!(
                    "`{}` compares with simulated ends of the same start, and the particle positions of a cloth laid \
                     by hand are unknown",
                    metric.row().name
                );
                return wrong("metrics", why);
            }
        }
        for starts in self.own_starts.values() {
            starts.check()?;
        }
        self.starts.check()
    }

    /// Returns the kinds of worlds in which each method is run besides the task's own.
    pub fn variations(&self) -> Vec<Variation> {
        self.vary.iter().flat_map(Vary::variations).collect()
    }

    /// Returns the starts of a task.
    pub fn starts_of(&self, task: &str) -> &Starts {
        self.own_starts.get(task).unwrap_or(&self.starts)
    }
}

impl Starts {
    /// Returns whether a person lays the cloth.
    pub fn is_laid_by_hand(&self) -> bool {
        matches!(self, Starts::Operator { .. })
    }

    fn check(&self) -> Result<(), SuiteError> {
        let sides = match self {
            Starts::Flat { sides, turns_deg } => {
                filled("starts.turns_deg", turns_deg)?;
                let count = sides.len() as u64 * turns_deg.len() as u64;
                within("starts", u32::try_from(count).unwrap_or(u32::MAX).max(1))?;
                let mut turns = turns_deg.iter();
                if let Some(turn) = turns.find(|turn| !(-360.0..=360.0).contains(*turn)) {
                    let why = format!("{turn} is not from -360 to 360");
                    return wrong("starts.turns_deg", why);
                }
                sides
            }
            Starts::Crumpled {
                sides,
                count,
                first_seed,
            } => {
                within("starts.count", *count)?;
                if first_seed.checked_add(u64::from(*count)).is_none() {
                    let why = format!("{first_seed} leaves no room for {count} seeds");
                    return wrong("starts.first_seed", why);
                }
                sides
            }
            Starts::Operator { count } => return within("starts.count", *count),
        };
        filled("starts.sides", sides)?;
        match sides.iter().find(|side| !(2..=MOST).contains(*side)) {
            Some(side) => wrong("starts.sides", format!("{side} is not from 2 to {MOST}")),
            None => Ok(()),
        }
    }
}

fn one() -> u32 {
    1
}

fn yes() -> bool {
    true
}

fn wrong<T>(key: &str, why: String) -> Result<T, SuiteError> {
    Err(SuiteError(format!("`{key}`: {why}")))
}

fn filled<T>(key: &str, list: &[T]) -> Result<(), SuiteError> {
    match list.len() {
        0 => wrong(key, "the list is empty; it needs at least one".to_owned()),
        count if count > MOST as usize => wrong(key, format!("{count} are more than {MOST}")),
        _ => Ok(()),
    }
}

fn within(key: &str, count: u32) -> Result<(), SuiteError> {
    if (1..=MOST).contains(&count) {
        return Ok(());
    }
    wrong(key, format!("{count} is not from 1 to {MOST}"))
}

/// Restricts a name to what every file system accepts and a terminal can print.
fn file_name(key: &str, name: &str) -> Result<(), SuiteError> {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
    if (1..=64).contains(&name.len()) && name.chars().all(plain) {
        return Ok(());
    }
    let why = format!("{name:?} is not 1 to 64 letters, digits, `_` or `-`");
    wrong(key, why)
}

fn unique<'n>(key: &str, names: impl Iterator<Item = &'n str>) -> Result<(), SuiteError> {
    let mut seen = std::collections::BTreeSet::new();
    for name in names {
        if !seen.insert(name) {
            return wrong(key, format!("`{name}` is there twice"));
        }
    }
    Ok(())
}
