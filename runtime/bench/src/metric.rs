//! The metrics of suites: one row for each.
//!
//! Smoothing is measured twice (protocol, section 5): by SoftGym's grid, which the paper's numbers use and which
//! decides when a rollout stops, and by the true area. A value with the stop is frozen at the first step that met the
//! goal; a value without it comes from a rollout that continued. Measures by pictures, for cloths with unknown
//! particles, are metrics of their own: a rollout has values of one kind or the other.
//!
//! A row holds everything about a metric. Suites refer to it, tables and CSV read it, and the table of `docs/bench.md`
//! is generated from it.

use super::play::{ExpertDistance, Played};
use super::record::Step;
use super::statistics::Statistic;
use fab_agent::outcome::Outcome;
use fab_agent::policy::Finding;
use fab_agent::record::CoverageSource;
use fab_program::Goal;
use fab_program::verify::Verdict;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The coverage from which the paper counts a cloth on the real table as smooth.
const COVERED: f64 = 0.85;

/// A row of [`METRICS`].
#[derive(Debug)]
pub struct Row {
    /// Its name in suites, JSON and CSV.
    pub name: &'static str,
    /// Its column heading in tables for people.
    pub heading: &'static str,
    /// The unit of its figures: `mm`, `share` (improvements may be below 0), or `per action`.
    pub unit: &'static str,
    /// Which figures are better: `higher` or `lower`.
    pub better: &'static str,
    /// The number of decimal places printed.
    pub digits: usize,
    /// How the values of many rollouts are combined into one figure; `None`: with the statistic that the suite states.
    pub statistic: Option<Statistic>,
    /// What coverage must have been measured on for a rollout to have a value; `None` if that does not matter.
    pub measured_on: Option<CoverageSource>,
    /// Whether it needs a rollout that continued after meeting its goal.
    pub is_without_stop: bool,
    /// The fraction of its length at which each expert fold ends, if the metric uses experts.
    pub fold_fraction: Option<f64>,
    /// Reads its value from a rollout; `None` if the rollout has none.
    pub read: fn(&Row, &Reading<'_>) -> Option<f64>,
    /// Its meaning, in one line.
    pub about: &'static str,
    /// The caption below a table, if any.
    pub caption: Option<&'static str>,
}

/// The part of a rollout that a metric reads.
pub struct Reading<'r> {
    /// The rollout.
    pub played: &'r Played,
    /// The steps that count.
    pub steps: &'r [Step],
    /// Its outcome with these steps.
    pub outcome: Outcome,
}

impl Reading<'_> {
    /// Returns the value after the last step taken; without any step the improvement is zero.
    fn last(&self, of: fn(&Step) -> Option<f64>) -> Option<f64> {
        let mut taken = self.steps.iter().rev().filter(|step| step.line.is_taken());
        taken.next().map_or(Some(0.0), of)
    }
}

/// Every metric, in the order of the documents.
pub const METRICS: &[Row] = &[
    Row {
        name: "mean_particle_distance_mm",
        heading: "distance, mm",
        fold_fraction: Some(1.0),
        read: |row, reading| distance_mm(row, reading, |found| found.mean_m),
        about: "mean distance of particles from the nearest expert result with complete folds",
        ..DISTANCE
    },
    Row {
        name: "mean_particle_distance_mm_gamma_0.9",
        heading: "to gamma 0.9, mm",
        fold_fraction: Some(0.9),
        read: |row, reading| distance_mm(row, reading, |found| found.mean_m),
        about: "the same, with every fold of the experts ending at 0.9 of its way, as the recorded demonstrations do",
        ..DISTANCE
    },
    Row {
        name: "shape_distance_mm",
        heading: "shape, mm",
        fold_fraction: Some(1.0),
        read: |row, reading| distance_mm(row, reading, |found| found.shape_m),
        about: "the mean distance once the cloth is shifted and turned over the table to where it fits best: how differently it is folded, however far it slid",
        ..DISTANCE
    },
    Row {
        name: "normalized_improvement_source",
        heading: "NI, source",
        measured_on: Some(CoverageSource::Particles),
        read: |_, reading| reading.last(|step| step.line.measures.normalized_improvement),
        about: "normalized improvement by SoftGym's grid, as the paper's numbers; frozen at the first step that met the goal",
        caption: Some(
            "NI is the normalized improvement: by SoftGym's grid (source, the paper's numbers, which decide the stop), and by the area that is truly covered (true). With the stop, a rollout counts as it lay when it first met its goal.",
        ),
        ..PLAIN
    },
    Row {
        name: "normalized_improvement_true",
        heading: "NI, true",
        measured_on: Some(CoverageSource::Particles),
        read: |_, reading| reading.last(|step| step.line.measures.normalized_improvement_true),
        about: "the same by the area that is truly covered",
        ..PLAIN
    },
    Row {
        name: "normalized_improvement_source_without_stop",
        heading: "source, no stop",
        measured_on: Some(CoverageSource::Particles),
        is_without_stop: true,
        read: |_, reading| reading.last(|step| step.line.measures.normalized_improvement),
        about: "the first of these, of a rollout that goes on after its goal was met",
        ..PLAIN
    },
    Row {
        name: "normalized_improvement_true_without_stop",
        heading: "true, no stop",
        measured_on: Some(CoverageSource::Particles),
        is_without_stop: true,
        read: |_, reading| reading.last(|step| step.line.measures.normalized_improvement_true),
        about: "the second of these, of a rollout that goes on after its goal was met",
        ..PLAIN
    },
    Row {
        name: "normalized_improvement_picture",
        heading: "NI, picture",
        measured_on: Some(CoverageSource::Picture),
        read: |_, reading| reading.last(|step| step.line.measures.normalized_improvement),
        about: "normalized improvement by pictures, for a cloth with unknown particles",
        ..PLAIN
    },
    Row {
        name: "covered_0.85_source",
        heading: "covers 0.85, source",
        measured_on: Some(CoverageSource::Particles),
        read: covers,
        about: "whether the cloth covers at least 0.85 of its flat area in the end, by SoftGym's grid",
        caption: Some(COVERS),
        ..SHARE
    },
    Row {
        name: "covered_0.85_picture",
        heading: "covers 0.85, picture",
        measured_on: Some(CoverageSource::Picture),
        read: covers,
        about: "the same by pictures",
        caption: Some(COVERS),
        ..SHARE
    },
    Row {
        name: "picks_refused",
        heading: "refused",
        unit: "per action",
        better: "lower",
        read: |_, reading| {
            let refused = reading.steps.iter().map(refused).sum::<usize>();
            (!reading.steps.is_empty()).then(|| refused as f64 / reading.steps.len() as f64)
        },
        about: "answers that a check refused, per step",
        ..PLAIN
    },
    Row {
        name: "goal_reached",
        heading: "goal reached",
        read: |_, reading| {
            let is_judged = reading.played.rollout.report.goal_reached.is_some();
            is_judged.then(|| share(reading.outcome == Outcome::GoalReached))
        },
        about: "whether the task's goal was reached; none if the world cannot measure it",
        caption: Some("Goal reached: share of rollouts [Wilson's 95 % interval over starts]."),
        ..SHARE
    },
    Row {
        name: "reached_by_operator",
        heading: "reached, by the operator",
        read: |_, reading| {
            let judgement = reading.played.rollout.report.operator.as_ref();
            judgement.map(|judgement| share(judgement.reached))
        },
        about: "whether the operator says that the task was reached, of the rollouts that were judged",
        caption: Some(
            "Reached by the operator: share of the rollouts that were judged [Wilson's 95 % interval].",
        ),
        ..SHARE
    },
];

/// Default values for a row.
const PLAIN: Row = Row {
    name: "",
    heading: "",
    unit: "share",
    better: "higher",
    digits: 3,
    statistic: None,
    measured_on: None,
    is_without_stop: false,
    fold_fraction: None,
    read: |_, _| None,
    about: "",
    caption: None,
};

const DISTANCE: Row = Row {
    unit: "mm",
    better: "lower",
    digits: 1,
    ..PLAIN
};

const SHARE: Row = Row {
    digits: 2,
    statistic: Some(Statistic::Share),
    ..PLAIN
};

const COVERS: &str = "Covers 0.85: share of the rollouts in which the cloth covers at least 0.85 of its flat area in the end [Wilson's 95 % interval].";

/// Returns how many answers of a step were refused by a check.
fn refused(step: &Step) -> usize {
    let results = step.line.attempts.iter().map(|asked| &asked.result);
    let verdicts = results.filter_map(|result| match result {
        Finding::Action { verdict, .. } => Some(verdict),
        _ => None,
    });
    verdicts
        .filter(|it| matches!(it, Verdict::Reject { .. }))
        .count()
}

fn share(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

fn covers(_: &Row, reading: &Reading<'_>) -> Option<f64> {
    let covered = reading.last(|step| step.line.measures.coverage);
    Some(share(covered.is_some_and(|covered| covered >= COVERED)))
}

fn distance_mm(row: &Row, reading: &Reading<'_>, of: fn(&ExpertDistance) -> f64) -> Option<f64> {
    let mut distances = reading.played.distances.iter();
    let found = distances.find(|found| Some(found.fold_fraction) == row.fold_fraction);
    found.map(|found| of(found) * 1000.0)
}

/// A metric: one row of [`METRICS`].
#[derive(Clone, Copy, Debug)]
pub struct Metric(&'static Row);

impl Metric {
    /// Finds the metric of a name.
    pub fn find(name: &str) -> Option<Metric> {
        METRICS.iter().find(|row| row.name == name).map(Metric)
    }

    /// Returns its row.
    pub fn row(self) -> &'static Row {
        self.0
    }

    /// Returns its value for a rollout, counting only the first `cut` steps.
    ///
    /// `None` if the rollout has no value, or was measured on something else.
    pub fn value(self, played: &Played, cut: u32, goal: Option<&Goal>) -> Option<f64> {
        let rollout = &played.rollout;
        if self.0.measured_on.is_some() && self.0.measured_on != rollout.report.coverage_source {
            return None;
        }
        let stop = goal.filter(|_| !self.0.is_without_stop);
        let reading = Reading {
            played,
            steps: rollout.steps_to(cut, stop),
            outcome: rollout.outcome_at(cut, goal, stop),
        };
        (self.0.read)(self.0, &reading)
    }

    /// Returns whether it needs known particles.
    pub fn needs_particles(self) -> bool {
        self.0.measured_on == Some(CoverageSource::Particles) || self.0.fold_fraction.is_some()
    }
}

impl PartialEq for Metric {
    fn eq(&self, other: &Metric) -> bool {
        self.0.name == other.0.name
    }
}

impl Serialize for Metric {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name)
    }
}

impl<'de> Deserialize<'de> for Metric {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Metric, D::Error> {
        let name = String::deserialize(deserializer)?;
        Metric::find(&name).ok_or_else(|| {
            let names: Vec<&str> = METRICS.iter().map(|row| row.name).collect();
            let names = names.join("`, `");
            serde::de::Error::custom(format!("there is no metric `{name}`, only `{names}`"))
        })
    }
}

#[cfg(test)]
mod tests;
