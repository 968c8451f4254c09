//! The figures of a suite, one row each, including quoted ones.
//!
//! In: finished rollouts. Out: [`Row`]s, with the same fields as JSON and CSV. Every finished rollout counts, however
//! it ended: its last state is measured, and `outcomes` counts the outcomes.

use super::metric::Metric;
use super::play::{Played, Results};
use super::record::Step;
use super::statistics::{self, Clusters, Statistic, Summary};
use super::suite::Quote;
use super::{Answers, Bench, Entry};
use fab_program::{Goal, Program};
use serde::{Serialize, Serializer};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Notes for a suite meant for a real table, by the world that replaced the table.
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

/// The meaning of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FigureMeaning {
    /// A statistic of a method.
    Of(Statistic),
    /// The difference of a statistic between two methods.
    Difference(Statistic),
    /// The difference of a statistic of a method between varied worlds and the task's own.
    Change(Statistic),
}

impl fmt::Display for FigureMeaning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FigureMeaning::Of(statistic) => f.write_str(statistic.name()),
            FigureMeaning::Difference(statistic) => {
                write!(f, "difference of {}s", statistic.name())
            }
            FigureMeaning::Change(statistic) => write!(f, "change of {}s", statistic.name()),
        }
    }
}

impl Serialize for FigureMeaning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// One figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The task.
    pub task: String,
    /// The method, or the author of a quoted figure.
    pub method: String,
    /// The axis along which its worlds are varied, or `all`; null if they are the task's own.
    pub vary: Option<&'static str>,
    /// What was measured.
    pub metric: Metric,
    /// Greatest number of actions.
    pub horizon: Option<u32>,
    /// Starts.
    pub n: Option<usize>,
    /// Rollouts per start.
    pub repeats: Option<u32>,
    /// Whether starts share answers of the model; null if no answer is drawn.
    pub answers: Option<Answers>,
    /// Clusters of starts that share answers; null if they share none.
    pub clusters: Option<usize>,
    /// The kind of figure: `median`, `mean`, `share`, the difference of two of these, or a change by varied worlds.
    pub statistic: FigureMeaning,
    /// The figure.
    pub value: f64,
    /// Larger quartile distance of a median, standard deviation of a mean.
    pub spread: Option<f64>,
    /// Its 95 % confidence interval.
    pub ci95: Option<[f64; 2]>,
    /// Whether the figure is quoted from others.
    pub quoted: bool,
    /// Source of a quoted figure.
    pub source: Option<String>,
    /// What the rollouts took; nothing for a quoted figure.
    #[serde(flatten)]
    pub effort: Effort,
    /// The policy, with the caveats that a reader of the figures must know.
    pub policy: Option<String>,
    /// Whether the policy saw the true positions of particles.
    pub sees_particles: bool,
    /// The model, if one was asked.
    pub model: Option<String>,
    /// Whether that is a stand-in, not a vision-language model.
    pub model_is_stand_in: bool,
    /// A caveat for readers.
    pub note: Option<String>,
}

/// What the rollouts behind a figure took, and how they ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Effort {
    /// Examples in the prompts.
    pub data_size: Option<usize>,
    /// Questions per action; of a difference, how many more.
    pub queries: Option<f64>,
    /// Wall time per action, seconds, without scoring; of a difference, how much more.
    pub s_per_action: Option<f64>,
    /// Cost per action; 0 for a stand-in, null if a price or the usage of a call is unknown.
    pub cost: Option<f64>,
    /// The most that an action cost, with calls of unknown usage as reserved; null if no price is known.
    pub cost_at_most: Option<f64>,
    /// Tokens of the used answers that can be seen, per action; null if an answer reported none, or a model is embedded.
    pub visible_tokens: Option<f64>,
    /// Tokens of hidden reasoning in them, per action; null if no answer reported any.
    pub hidden_tokens: Option<f64>,
    /// Number of rollouts by outcome, within `horizon` actions.
    pub outcomes: BTreeMap<&'static str, usize>,
    /// Number of rollouts that the operator judged as not reached, by cause.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub causes: BTreeMap<&'static str, usize>,
    /// Wall time of render, vision, prompt, parse and verify per action, seconds.
    pub planning_s: Option<f64>,
}

/// Returns all rows: task by task, methods in the suite's order, then gaps between them, then quoted figures. The rows of
/// varied worlds, each with its change, follow those of the task's own.
///
/// A method without a finished rollout has no row.
pub fn rows(bench: &Bench<'_>, results: &Results) -> Vec<Row> {
    let mut rows = Vec::new();
    for (number, task) in bench.tasks.iter().enumerate() {
        let entries = bench.entries.iter().enumerate();
        let entries: Vec<_> = entries.filter(|(_, entry)| entry.task == number).collect();
        let find = |name: &str, varied: Option<&str>| {
            let found = entries
                .iter()
                .find(|(_, entry)| entry.method.name == name && entry.variation.name() == varied);
            found.and_then(|(index, entry)| EntryResults::new(bench, results, *index, entry))
        };
        for (index, entry) in &entries {
            let Some(shown) = EntryResults::new(bench, results, *index, entry) else {
                continue;
            };
            rows.extend(shown.rows());
            if entry.variation.name().is_some()
                && let Some(own) = find(&entry.method.name, None)
            {
                let name = &entry.method.name;
                rows.extend(shown.differences(&own, name, FigureMeaning::Change));
            }
        }
        let mut variations = vec![None];
        variations.extend(bench.suite.variations().iter().map(|it| it.name()));
        for gap in &bench.suite.gaps {
            for varied in &variations {
                let both = [&gap.of, &gap.over].map(|name| find(name, *varied));
                if let [Some(of), Some(over)] = both {
                    rows.extend(of.differences(&over, &gap.name, FigureMeaning::Difference));
                }
            }
        }
        let quotes = bench.suite.quotes.iter();
        rows.extend(quotes.filter(|quote| quote.task == task.name).map(quoted));
    }
    rows
}

/// A figure to compute.
#[derive(Clone, Copy)]
struct Figure {
    metric: Metric,
    /// The number of actions to show.
    horizon: u32,
    /// The number of actions that count.
    cut: u32,
    statistic: Statistic,
}

/// An entry with its finished rollouts.
struct EntryResults<'b> {
    bench: &'b Bench<'b>,
    entry: &'b Entry<'b>,
    program: &'b Program,
    /// By start.
    rollouts: Vec<Vec<&'b Played>>,
    /// The note if a simulation replaced the table on which an operator lays the cloth.
    rehearsal: Option<&'static str>,
}

impl<'b> EntryResults<'b> {
    /// `None` if no rollout has finished.
    fn new(
        bench: &'b Bench<'_>,
        results: &'b Results,
        index: usize,
        entry: &'b Entry<'_>,
    ) -> Option<EntryResults<'b>> {
        let mut rollouts = vec![Vec::new(); bench.tasks[entry.task].starts.len()];
        for played in results.rollouts.iter().filter(|it| it.entry == index) {
            rollouts[played.start].push(played);
        }
        if rollouts.iter().all(Vec::is_empty) {
            return None;
        }
        let starts = bench.suite.starts_of(&bench.tasks[entry.task].name);
        let mut rehearsals = REHEARSALS.iter().filter(|_| starts.is_laid_by_hand());
        let rehearsal = rehearsals.find(|(world, _)| *world == results.world);
        Some(EntryResults {
            bench,
            entry,
            program: entry.programs.values().next()?,
            rollouts,
            rehearsal: rehearsal.map(|(_, note)| *note),
        })
    }

    /// Returns the figures to compute: each metric after each number of actions.
    fn figures(&self) -> Vec<Figure> {
        let stated = &self.bench.suite.horizons;
        let mut horizons: Vec<_> = stated.iter().map(|horizon| (*horizon, *horizon)).collect();
        if horizons.is_empty() {
            // As long as the task permits; a rollout with retried steps may be longer.
            horizons.push((self.program.horizon, u32::MAX));
        }
        let figure = |(horizon, cut), metric: Metric| Figure {
            metric,
            horizon,
            cut,
            statistic: metric.row().statistic.unwrap_or(self.bench.suite.statistic),
        };
        let figures = horizons.into_iter();
        figures
            .flat_map(|horizon| self.metrics().map(move |metric| figure(horizon, metric)))
            .collect()
    }

    fn metrics(&self) -> impl Iterator<Item = Metric> {
        let stops = self.entry.stops_early(&self.bench.suite.metrics);
        // Coverage of a folded cloth says nothing about the fold.
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
        let clusters = Clusters::joined(&self.answers_used());
        let row = |figure: Figure| {
            let samples = self.samples(figure);
            let summary = statistics::summary(figure.statistic, &samples, &clusters)?;
            let stated = FigureMeaning::Of(figure.statistic);
            let name = &self.entry.method.name;
            Some(Row {
                clusters: self.shares().then(|| clusters.count(&samples)),
                ..self.row(name, figure, stated, summary)
            })
        };
        self.figures().into_iter().filter_map(row).collect()
    }

    /// Returns by how much these figures exceed others at the same starts.
    fn differences(
        &self,
        over: &EntryResults<'_>,
        name: &str,
        meaning: fn(Statistic) -> FigureMeaning,
    ) -> Vec<Row> {
        let mut used = self.answers_used();
        for (used, more) in used.iter_mut().zip(over.answers_used()) {
            used.extend(more);
        }
        let clusters = Clusters::joined(&used);
        let row = |figure: Figure| {
            let (a, b) = (self.samples(figure), over.samples(figure));
            let summary = statistics::gap(figure.statistic, &a, &b, &clusters)?;
            let stated = meaning(figure.statistic);
            let [row, other] = [self, over].map(|of| of.row(name, figure, stated, summary));
            let more = |of: fn(&Effort) -> Option<f64>| Some(of(&row.effort)? - of(&other.effort)?);
            Some(Row {
                answers: row.answers.max(over.answers()),
                clusters: (self.shares() || over.shares()).then(|| clusters.count(&a)),
                effort: Effort {
                    data_size: row.effort.data_size,
                    queries: more(|it| it.queries),
                    s_per_action: more(|it| it.s_per_action),
                    ..Effort::default()
                },
                ..row
            })
        };
        self.figures().into_iter().filter_map(row).collect()
    }

    /// Returns whether starts share answers; `None` if no answer is drawn.
    fn answers(&self) -> Option<Answers> {
        let draws = self.entry.varies && self.entry.policy.models.is_some();
        draws.then_some(self.bench.answers)
    }

    fn shares(&self) -> bool {
        self.answers() == Some(Answers::Shared)
    }

    /// Returns the questions whose answers the rollouts of each start used, with who was asked; empty if starts share none.
    fn answers_used(&self) -> Vec<BTreeSet<(&str, &str)>> {
        let starts = self.rollouts.iter().map(|repeats| {
            let repeats = repeats.iter().filter(|_| self.shares());
            let steps = repeats.flat_map(|played| &played.rollout.steps);
            let asked = steps.flat_map(|step| &step.line.attempts);
            let keys = asked.filter_map(|asked| asked.sent.request_key.as_deref());
            keys.map(|key| (self.entry.policy.name.as_str(), key))
                .collect()
        });
        starts.collect()
    }

    fn goal(&self) -> Option<&'b Goal> {
        self.program.goal.as_ref()
    }

    fn samples(&self, figure: Figure) -> Vec<Vec<f64>> {
        let of = |played: &&Played| figure.metric.value(played, figure.cut, self.goal());
        let starts = self.rollouts.iter();
        starts
            .map(|repeats| repeats.iter().filter_map(of).collect())
            .collect()
    }

    fn row(&self, method: &str, figure: Figure, statistic: FigureMeaning, summary: Summary) -> Row {
        let policy = &self.entry.policy;
        let is_stand_in = policy.is_stand_in();
        let of_method = &self.entry.method;
        let own = of_method.stand_in_note.iter().filter(|_| is_stand_in);
        let notes = own.chain(&of_method.note).map(String::as_str);
        let notes: Vec<&str> = notes.chain(self.rehearsal).collect();
        Row {
            task: self.bench.tasks[self.entry.task].name.clone(),
            method: method.to_owned(),
            vary: self.entry.variation.name(),
            metric: figure.metric,
            horizon: Some(figure.horizon),
            n: Some(self.rollouts.iter().filter(|it| !it.is_empty()).count()),
            repeats: Some(self.entry.repeats),
            answers: self.answers(),
            clusters: None,
            statistic,
            value: summary.value,
            spread: summary.spread,
            ci95: summary.ci95,
            quoted: false,
            source: None,
            effort: self.effort(figure),
            policy: Some(policy.title()),
            sees_particles: policy.sees_particles,
            model: policy.models.is_some().then(|| policy.name.clone()),
            model_is_stand_in: is_stand_in,
            note: (!notes.is_empty()).then(|| notes.join("; ")),
        }
    }

    fn effort(&self, Figure { metric, cut, .. }: Figure) -> Effort {
        // The goal at which a rollout counts as stopped.
        let stop = self.goal().filter(|_| !metric.row().is_without_stop);
        let rollouts = || self.rollouts.iter().flatten();
        let mut outcomes = BTreeMap::new();
        for played in rollouts() {
            *outcomes
                .entry(played.rollout.outcome_at(cut, self.goal(), stop).name())
                .or_default() += 1;
        }
        let mut causes = BTreeMap::new();
        let judged = rollouts().filter_map(|played| played.rollout.report.operator.as_ref());
        for cause in judged.filter_map(|judgement| judgement.why) {
            *causes.entry(cause.name()).or_default() += 1;
        }
        let steps = rollouts().flat_map(|played| played.rollout.steps_to(cut, stop));
        let steps: Vec<&Step> = steps.collect();
        let per_action = |sum: f64| (!steps.is_empty()).then(|| sum / steps.len() as f64);
        let costs = steps.iter().map(|step| step.cost_usd);
        let at_most = steps.iter().map(|step| step.cost_usd_at_most);
        let asked = || steps.iter().flat_map(|step| &step.line.attempts);
        let used = || asked().filter(|it| it.reply.is_some()).map(|it| it.usage);
        let visible = used().map(|usage| usage.map(|it| it.visible_tokens() as f64));
        let hidden = used().filter_map(|usage| usage?.reasoning_tokens);
        let hidden = hidden.map(|tokens| tokens as f64);
        let planning = steps.iter().filter_map(|step| step.spent.planning_s);
        let n_sent = asked().filter(|it| it.sent.request.is_some()).count();
        Effort {
            data_size: Some(self.entry.data_size()),
            queries: per_action(n_sent as f64),
            s_per_action: per_action(steps.iter().map(|step| step.spent.took_s()).sum()),
            cost: costs.sum::<Option<f64>>().and_then(per_action),
            cost_at_most: at_most.sum::<Option<f64>>().and_then(per_action),
            visible_tokens: visible.sum::<Option<f64>>().and_then(per_action),
            hidden_tokens: hidden.reduce(|sum, more| sum + more).and_then(per_action),
            outcomes,
            causes,
            planning_s: statistics::mean(&planning.collect::<Vec<_>>()),
        }
    }
}

fn quoted(quote: &Quote) -> Row {
    Row {
        task: quote.task.clone(),
        method: quote.method.clone(),
        vary: None,
        metric: quote.metric,
        horizon: quote.horizon,
        n: quote.n.map(|n| n as usize),
        repeats: None,
        answers: None,
        clusters: None,
        statistic: FigureMeaning::Of(quote.statistic),
        value: quote.value,
        spread: quote.spread,
        ci95: match (quote.statistic, quote.n) {
            (Statistic::Share, Some(n)) => statistics::wilson(quote.value, n as usize),
            _ => None,
        },
        quoted: true,
        source: Some(quote.source.clone()),
        effort: Effort::default(),
        policy: None,
        sees_particles: false,
        model: None,
        model_is_stand_in: false,
        note: None,
    }
}
