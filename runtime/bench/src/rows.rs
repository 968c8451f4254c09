//! The figures of a suite, a row each, and others' figures among them.
//!
//! In: finished rollouts. Out: [`Row`]s, whose fields JSON and CSV have too. Every finished rollout counts,
//! however it ended: its last state is what is measured, and `outcomes` says how many ended how.

use super::metric::{Aggregate, Metric};
use super::play::{Played, Results};
use super::record::Step;
use super::statistics::{self, Statistic, Summary};
use super::suite::Quote;
use super::{Bench, Entry};
use fab_agent::outcome::Outcome;
use fab_program::{Goal, Program};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt;

/// What is said of a row whose suite is for a real table, by the world that stood in for it.
const REHEARSALS: [(&str, &str); 2] = [
    (
        "sim",
        "a rehearsal in the simulator, which says that the protocol runs and nothing of an arm",
    ),
    (
        "simulated_arm",
        "a rehearsal on a simulated arm and table, which says that the protocol runs and nothing of a real arm",
    ),
];

/// What a figure is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stated {
    /// A statistic of a method.
    Of(Statistic),
    /// The difference of a statistic between two methods.
    Difference(Statistic),
}

impl fmt::Display for Stated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Stated::Of(statistic) => f.write_str(statistic.as_str()),
            Stated::Difference(statistic) => write!(f, "difference of {}s", statistic.as_str()),
        }
    }
}

impl Serialize for Stated {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// One figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The task.
    pub task: String,
    /// How it was done, or by whom where it is quoted.
    pub method: String,
    /// What was measured.
    pub metric: Metric,
    /// After how many actions at most.
    pub horizon: Option<u32>,
    /// Starts.
    pub n: Option<usize>,
    /// Rollouts per start.
    pub repeats: Option<u32>,
    /// What the figure is: `median`, `mean`, `share`, or the difference of two of these.
    pub statistic: Stated,
    /// The figure.
    pub value: f64,
    /// Larger quartile distance of a median, standard deviation of a mean.
    pub spread: Option<f64>,
    /// Where it lies with 95 % confidence.
    pub ci95: Option<[f64; 2]>,
    /// Whether somebody else reports it.
    pub quoted: bool,
    /// Where that is reported.
    pub source: Option<String>,
    /// Examples in the prompts.
    pub data_size: Option<usize>,
    /// Questions per action.
    pub queries: Option<f64>,
    /// Wall time per action, seconds, scores left out.
    pub s_per_action: Option<f64>,
    /// Cost per action; 0 for a stand-in, null where no price is known.
    pub cost: Option<f64>,
    /// Rollouts by how they ended, with as many actions as `horizon` says.
    pub outcomes: BTreeMap<&'static str, usize>,
    /// Rollouts that the operator calls not reached, by why.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub causes: BTreeMap<&'static str, usize>,
    /// Wall time of render, vision, prompt, parse and verify per action, seconds.
    pub planning_s: Option<f64>,
    /// Who decided, with what a reader of the figures must know.
    pub policy: Option<String>,
    /// Whether that looked at the true places of particles.
    pub sees_particles: bool,
    /// The model, where one was asked.
    pub model: Option<String>,
    /// Whether that is a stand-in and no vision-language model.
    pub model_is_stand_in: bool,
    /// What a reader has to know.
    pub note: Option<String>,
}

/// Returns all rows: task by task, methods in the suite's order, then gaps between them, then what others report.
///
/// A method none of whose rollouts has finished has no row.
pub fn rows(bench: &Bench<'_>, results: &Results) -> Vec<Row> {
    let mut rows = Vec::new();
    for (number, task) in bench.tasks.iter().enumerate() {
        let entries = bench.entries.iter().enumerate();
        let entries: Vec<_> = entries.filter(|(_, entry)| entry.task == number).collect();
        for (index, entry) in &entries {
            let shown = Shown::new(bench, results, *index, entry);
            rows.extend(shown.iter().flat_map(Shown::rows));
        }
        for gap in &bench.suite.gaps {
            let find = |name: &str| {
                let found = entries.iter().find(|(_, entry)| entry.method.name == name);
                found.and_then(|(index, entry)| Shown::new(bench, results, *index, entry))
            };
            if let (Some(of), Some(over)) = (find(&gap.of), find(&gap.over)) {
                rows.extend(of.gaps(&over, &gap.name));
            }
        }
        let quotes = bench.suite.quotes.iter();
        rows.extend(quotes.filter(|quote| quote.task == task.name).map(quoted));
    }
    rows
}

/// An entry with its finished rollouts.
struct Shown<'b> {
    bench: &'b Bench<'b>,
    entry: &'b Entry<'b>,
    program: &'b Program,
    /// By start.
    rollouts: Vec<Vec<&'b Played>>,
    /// What is said where something simulated stood in for the table on which an operator lays the cloth.
    rehearsal: Option<&'static str>,
}

fn rehearsal(world: &str) -> Option<&'static str> {
    let mut all = REHEARSALS.into_iter();
    all.find(|(name, _)| *name == world).map(|(_, note)| note)
}

impl<'b> Shown<'b> {
    /// None where no rollout has finished.
    fn new(
        bench: &'b Bench<'_>,
        results: &'b Results,
        index: usize,
        entry: &'b Entry<'_>,
    ) -> Option<Shown<'b>> {
        let mut rollouts = vec![Vec::new(); bench.tasks[entry.task].starts.len()];
        for played in results.rollouts.iter().filter(|it| it.entry == index) {
            rollouts[played.start].push(played);
        }
        let is_empty = rollouts.iter().all(Vec::is_empty);
        Some(Shown {
            bench,
            entry,
            program: entry.programs.values().next()?,
            rollouts,
            rehearsal: bench
                .suite
                .starts_of(&bench.tasks[entry.task].name)
                .is_laid_by_hand()
                .then(|| rehearsal(&results.world))
                .flatten(),
        })
        .filter(|_| !is_empty)
    }

    /// Returns the numbers of actions after which there are figures: how they are called, and where they cut.
    fn horizons(&self) -> Vec<(u32, u32)> {
        let stated = &self.bench.suite.horizons;
        if stated.is_empty() {
            // As long as the task lets a rollout be; one that takes a step again may be longer than that.
            return vec![(self.program.horizon, u32::MAX)];
        }
        stated.iter().map(|horizon| (*horizon, *horizon)).collect()
    }

    fn metrics(&self) -> impl Iterator<Item = Metric> {
        let stops = self.entry.stops_early(&self.bench.suite.metrics);
        // How much a folded cloth covers says nothing of the fold.
        let is_fold = self
            .goal()
            .is_some_and(|goal| !goal.metric.is_judged_each_step());
        let metrics = self.bench.suite.metrics.iter().copied();
        metrics.filter(move |metric| {
            let is_left_out = stops && metric.row().is_without_stop
                || is_fold && metric.row().measured_on.is_some();
            !is_left_out
        })
    }

    fn rows(&self) -> Vec<Row> {
        let mut rows = Vec::new();
        for (horizon, cut) in self.horizons() {
            for metric in self.metrics() {
                let statistic = self.statistic(metric);
                let samples = self.samples(metric, cut);
                if let Some(summary) = statistics::summary(statistic, &samples) {
                    let stated = Stated::Of(statistic);
                    rows.push(self.row(
                        self.entry.method.name.clone(),
                        metric,
                        (horizon, cut),
                        stated,
                        summary,
                    ));
                }
            }
        }
        rows
    }

    fn gaps(&self, over: &Shown<'_>, name: &str) -> Vec<Row> {
        let mut rows = Vec::new();
        for (horizon, cut) in self.horizons() {
            for metric in self.metrics() {
                let statistic = self.statistic(metric);
                let (a, b) = (self.samples(metric, cut), over.samples(metric, cut));
                if let Some(summary) = statistics::gap(statistic, &a, &b) {
                    let stated = Stated::Difference(statistic);
                    let row = self.row(name.to_owned(), metric, (horizon, cut), stated, summary);
                    rows.push(Row {
                        queries: None,
                        s_per_action: None,
                        planning_s: None,
                        cost: None,
                        outcomes: BTreeMap::new(),
                        causes: BTreeMap::new(),
                        ..row
                    });
                }
            }
        }
        rows
    }

    fn statistic(&self, metric: Metric) -> Statistic {
        match metric.row().aggregate {
            Aggregate::Share => Statistic::Share,
            Aggregate::AsStated => self.bench.suite.statistic,
        }
    }

    fn goal(&self) -> Option<&'b Goal> {
        self.program.goal.as_ref()
    }

    /// Returns the goal at which a rollout counts as stopped.
    fn stop(&self, metric: Metric) -> Option<&'b Goal> {
        self.goal().filter(|_| !metric.row().is_without_stop)
    }

    fn samples(&self, metric: Metric, cut: u32) -> Vec<Vec<f64>> {
        let of = |played: &&&Played| metric.value(played, cut, self.goal());
        let starts = self.rollouts.iter();
        starts
            .map(|repeats| repeats.iter().filter_map(|it| of(&it)).collect())
            .collect()
    }

    fn outcome(&self, played: &Played, metric: Metric, cut: u32) -> Outcome {
        played
            .rollout
            .outcome_at(cut, self.goal(), self.stop(metric))
    }

    fn row(
        &self,
        method: String,
        metric: Metric,
        (horizon, cut): (u32, u32),
        statistic: Stated,
        summary: Summary,
    ) -> Row {
        let rollouts = || self.rollouts.iter().flatten();
        let mut outcomes = BTreeMap::new();
        for played in rollouts() {
            *outcomes
                .entry(self.outcome(played, metric, cut).name())
                .or_default() += 1;
        }
        let mut causes = BTreeMap::new();
        let judged = rollouts().filter_map(|played| played.rollout.report.operator.as_ref());
        for cause in judged.filter_map(|judgement| judgement.why) {
            *causes.entry(cause.name()).or_default() += 1;
        }
        let steps: Vec<&Step> = rollouts()
            .flat_map(|played| played.rollout.steps_to(cut, self.stop(metric)))
            .collect();
        let per_action = |sum: f64| (!steps.is_empty()).then(|| sum / steps.len() as f64);
        let costs = steps.iter().map(|step| step.cost_usd);
        let cost = costs.sum::<Option<f64>>();
        let planning: Vec<f64> = steps
            .iter()
            .filter_map(|step| step.spent.planning_s)
            .collect();
        let policy = &self.entry.policy;
        let is_stand_in = policy.is_stand_in();
        let own = self
            .entry
            .method
            .stand_in_note
            .iter()
            .filter(|_| is_stand_in);
        let notes: Vec<&str> = own
            .chain(&self.entry.method.note)
            .map(String::as_str)
            .chain(self.rehearsal)
            .collect();
        Row {
            task: self.bench.tasks[self.entry.task].name.clone(),
            method,
            metric,
            horizon: Some(horizon),
            n: Some(self.rollouts.iter().filter(|it| !it.is_empty()).count()),
            repeats: Some(self.entry.repeats),
            statistic,
            value: summary.value,
            spread: summary.spread,
            ci95: summary.ci95,
            quoted: false,
            source: None,
            data_size: Some(self.entry.data_size()),
            queries: per_action(
                steps
                    .iter()
                    .flat_map(|step| &step.line.attempts)
                    .filter(|attempt| attempt.request.is_some())
                    .count() as f64,
            ),
            s_per_action: per_action(steps.iter().map(|step| step.seconds()).sum()),
            cost: cost.and_then(per_action),
            outcomes,
            causes,
            planning_s: statistics::mean(&planning),
            policy: Some(policy.title()),
            sees_particles: policy.sees_particles,
            model: policy.models.is_some().then(|| policy.name.clone()),
            model_is_stand_in: is_stand_in,
            note: (!notes.is_empty()).then(|| notes.join("; ")),
        }
    }
}

fn quoted(quote: &Quote) -> Row {
    Row {
        task: quote.task.clone(),
        method: quote.method.clone(),
        metric: quote.metric,
        horizon: quote.horizon,
        n: quote.n.map(|n| n as usize),
        repeats: None,
        statistic: Stated::Of(quote.statistic),
        value: quote.value,
        spread: quote.spread,
        ci95: quote
            .n
            .filter(|_| quote.statistic == Statistic::Share)
            .and_then(|n| statistics::wilson(quote.value, n as usize)),
        quoted: true,
        source: Some(quote.source.clone()),
        data_size: None,
        queries: None,
        s_per_action: None,
        cost: None,
        outcomes: BTreeMap::new(),
        causes: BTreeMap::new(),
        planning_s: None,
        policy: None,
        sees_particles: false,
        model: None,
        model_is_stand_in: false,
        note: None,
    }
}
