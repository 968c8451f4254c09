//! A suite as data: which tasks, from which starts, by which methods, and what is said of them.
//!
//! In: the text of a `.toml` file. Out: a [`Suite`] within bounds. TOML, because a suite is a flat list of names
//! and numbers with a comment beside some: it needs no grammar of its own, and its reader points at lines. What
//! the names mean (tasks, variants, models) is found out later, by whoever has files.

use super::metric::Metric;
use super::statistics::Statistic;
use serde::Deserialize;
use std::collections::BTreeMap;

/// The most starts of one task, repeats of one start, tasks, methods, and steps of a rollout.
const MOST: u32 = 1000;

/// A suite.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Suite {
    /// One sentence for people.
    pub about: String,
    /// Stands under the table, before what stands under every one.
    #[serde(default)]
    pub note: String,
    /// What is said of distances and improvements.
    pub statistic: Statistic,
    /// What is measured, a column each.
    pub metrics: Vec<Metric>,
    /// After how many actions; a rollout is as long as the last. Empty: as the task says.
    #[serde(default)]
    pub horizons: Vec<u32>,
    /// Rollouts per start of a model that varies.
    #[serde(default = "one")]
    pub repeats: u32,
    /// Where the cloth lies at first.
    pub starts: Starts,
    /// The same of single tasks, by their names, where it is not as `starts` says.
    #[serde(default, rename = "starts_of")]
    pub own_starts: BTreeMap<String, Starts>,
    /// Task files, relative to the suite's own.
    pub tasks: Vec<String>,
    /// How a task is done, a row each.
    #[serde(rename = "method")]
    pub methods: Vec<Method>,
    /// Differences between two methods at the same starts.
    #[serde(default, rename = "gap")]
    pub gaps: Vec<Gap>,
    /// What others report.
    #[serde(default, rename = "quoted")]
    pub quotes: Vec<Quote>,
}

/// Where the cloth lies at first; generated, and the same on every machine.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "lie", rename_all = "snake_case", deny_unknown_fields)]
pub enum Starts {
    /// Every size turned by every angle; the number of a start is `angles * size + angle`.
    Flat {
        /// Particles along the cloth's x; its other side keeps the task's ratio, rounded down.
        sides: Vec<u32>,
        /// Counter-clockwise as seen from above, degrees.
        turns_deg: Vec<f64>,
    },
    /// Lifted and dropped by seed. Start `i` has `sides[i % n]` by `sides[i / n % n]` particles and the seed
    /// `first_seed + i`.
    Crumpled {
        /// Particles along either side.
        sides: Vec<u32>,
        /// How many.
        count: u32,
        /// The seed of the first.
        first_seed: u64,
    },
    /// By hand, as the task says: flat or crumpled. A simulator, where the suite is rehearsed, crumples by the start's
    /// number as the seed, and turns a flat cloth by two degrees more each time.
    Operator {
        /// How many.
        count: u32,
    },
}

/// How a task is done.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Method {
    /// Its name in tables and folders.
    pub name: String,
    /// The variant of the task; none: the task itself.
    pub variant: Option<String>,
    /// Who decides; none: the policy of the command line.
    pub policy: Option<String>,
    /// The only model that it is for; none: the one of the command line.
    pub model: Option<String>,
    /// Rollouts per start, where they are not the suite's.
    pub repeats: Option<u32>,
    /// Whether a task without that variant is left out, and not an error.
    #[serde(default)]
    pub optional: bool,
    /// What a reader has to know of the row.
    pub note: Option<String>,
    /// What a reader has to know of the row where a stand-in answers.
    pub stand_in_note: Option<String>,
}

/// A difference between two methods.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gap {
    /// Its name in tables.
    pub name: String,
    /// The method from which is subtracted.
    pub of: String,
    /// The method that is subtracted.
    pub over: String,
}

/// A figure that somebody else reports.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quote {
    /// The task's name.
    pub task: String,
    /// Whose it is.
    pub method: String,
    /// What was measured.
    pub metric: Metric,
    /// After how many actions, where that was said.
    pub horizon: Option<u32>,
    /// What it is.
    pub statistic: Statistic,
    /// The figure.
    pub value: f64,
    /// Its spread, where one was said.
    pub spread: Option<f64>,
    /// Of how many rollouts, where that was said; gives a share Wilson's interval.
    pub n: Option<u32>,
    /// Where it stands.
    pub source: String,
}

/// Why a suite cannot be used.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum SuiteError {
    /// It is no TOML, or of another shape; the text names line and column.
    #[error("{0}")]
    Shape(String),
    /// A value is out of bounds.
    #[error("`{key}`: {why}")]
    Value {
        /// The key.
        key: String,
        /// What is wrong, and what would be right.
        why: String,
    },
}

impl Suite {
    /// Reads a suite.
    pub fn parse(text: &str) -> Result<Suite, SuiteError> {
        let suite: Suite = toml::from_str(text)
            .map_err(|error| SuiteError::Shape(error.to_string().trim_end().to_owned()))?;
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
            method
                .repeats
                .map_or(Ok(()), |it| within("method.repeats", it))?;
            if let (Some(policy), Some(model)) = (&method.policy, &method.model)
                && policy != "prompted"
            {
                return wrong(
                    "method.policy",
                    format!(
                        "`{policy}` asks no model, and `model` is `{model}`: state one of them"
                    ),
                );
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
                return wrong("quoted.value", "it is no finite number".to_owned());
            }
            quote.n.map_or(Ok(()), |n| within("quoted.n", n))?;
            if quote.statistic == Statistic::Share && !(0.0..=1.0).contains(&quote.value) {
                return wrong(
                    "quoted.value",
                    format!("{} is no share from 0 to 1", quote.value),
                );
            }
        }
        let mut all = self.own_starts.values().chain([&self.starts]);
        if all.any(Starts::is_laid_by_hand) {
            let distance = |metric: &&Metric| metric.row().fold_fraction.is_some();
            if let Some(metric) = self.metrics.iter().find(distance) {
                let why = format!(
                    "`{}` compares with simulated ends of the same start, and nobody knows how a cloth lies that is laid by hand",
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

    /// Returns where the cloth of a task lies at first.
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
                if let Some(turn) = turns_deg
                    .iter()
                    .find(|turn| turn.is_nan() || turn.abs() > 360.0)
                {
                    return wrong(
                        "starts.turns_deg",
                        format!("{turn} is not from -360 to 360"),
                    );
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
                    return wrong(
                        "starts.first_seed",
                        format!("{first_seed} leaves no room for {count} seeds"),
                    );
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

fn wrong<T>(key: &str, why: String) -> Result<T, SuiteError> {
    Err(SuiteError::Value {
        key: key.to_owned(),
        why,
    })
}

fn filled<T>(key: &str, list: &[T]) -> Result<(), SuiteError> {
    match list.len() {
        0 => wrong(key, "the list is empty; it needs at least one".to_owned()),
        count if count > MOST as usize => wrong(key, format!("{count} are more than {MOST}")),
        _ => Ok(()),
    }
}

fn within(key: &str, count: u32) -> Result<(), SuiteError> {
    match count {
        1..=MOST => Ok(()),
        _ => wrong(key, format!("{count} is not from 1 to {MOST}")),
    }
}

/// Holds a name to what every file system takes and a terminal prints.
fn file_name(key: &str, name: &str) -> Result<(), SuiteError> {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
    if (1..=64).contains(&name.len()) && name.chars().all(plain) {
        return Ok(());
    }
    wrong(
        key,
        format!("{name:?} is not 1 to 64 letters, digits, `_` or `-`"),
    )
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
