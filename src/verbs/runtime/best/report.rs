//! Reports a search: the best actions at each start, the step that limits, and a table of rows.

use super::BestArguments;
use super::rows::Row;
use crate::report::Report;
use fab_agent::best::{Choice, Found, Measure, Taken};
use fab_base::table::{Align, aligned};
use fab_bench::statistics::{Clusters, Statistic, summary};
use fab_program::{Metric, Program, Proposal, space};
use fab_world::start::Start;
use serde::Serialize;
use std::path::Path;

/// The results of all starts.
#[derive(Serialize)]
pub struct BestReport {
    task: String,
    variant: Option<String>,
    metric: &'static str,
    goal: Option<GoalLine>,
    pub goal_missed: bool,
    trials: u32,
    beam: u32,
    seed: u64,
    out: String,
    starts: Vec<AtStart>,
    /// The best measure after each number of actions, over starts.
    after: Vec<Mean>,
    rows: Vec<Summarised>,
    #[serde(skip)]
    title: String,
    #[serde(skip)]
    measure: Measure,
}

#[derive(Serialize)]
struct GoalLine {
    limit: f64,
    more_is_better: bool,
}

/// What was found at one start.
#[derive(Serialize)]
pub struct AtStart {
    start: String,
    seed: Option<u64>,
    value: Option<f64>,
    best: Option<Vec<StepLine>>,
    under_way: Vec<StepLine>,
    limiting: Option<usize>,
    #[serde(flatten)]
    found: Found,
}

/// One step, with the answer that leads to it; null if the step was skipped.
#[derive(Serialize)]
struct StepLine {
    step: u32,
    answer: Option<String>,
    without: Vec<String>,
    value: f64,
    behind: f64,
}

/// A mean over starts.
#[derive(Clone, Copy, Serialize)]
struct Mean {
    value: Option<f64>,
    ci95: Option<[f64; 2]>,
}

/// A kind of rollouts over all starts.
#[derive(Serialize)]
struct Summarised {
    row: &'static str,
    oracle: bool,
    #[serde(flatten)]
    mean: Mean,
    rollouts: usize,
    /// How many reach the goal.
    reached: Option<usize>,
    unscored: Vec<String>,
    none: Option<String>,
}

impl AtStart {
    /// Words the actions that were found.
    pub fn new(program: &Program, start: &Start, found: Found) -> AtStart {
        let steps = |taken: &[Taken]| taken.iter().map(|it| StepLine::of(program, it)).collect();
        AtStart {
            start: start.name.clone(),
            seed: start.seed,
            value: found.value(),
            best: found.best.as_deref().map(steps),
            under_way: steps(&found.under_way),
            limiting: found.limiting(),
            found,
        }
    }

    fn lines(&self, metric: Metric) -> Vec<String> {
        let found = &self.found;
        let how_many = match found.exhausted {
            true => format!("every action was tried, {} trials", found.trials),
            false => format!("best of {} trials", found.trials),
        };
        let untouched = shown(found.untouched, metric);
        let mut lines = vec![format!(
            "start {}, {how_many} (untouched: {untouched})",
            self.start
        )];
        if !found.sampled.is_empty() {
            let sampled = found.sampled.join(", ");
            lines.push(format!("  sampled, not exhausted: {sampled}"));
        }
        if found.interrupted {
            lines.push("  interrupted; the same `--out` goes on from here".to_owned());
        }
        if self.best.is_none() {
            lines.push("  no rollout ends yet; the most promising actions so far:".to_owned());
        }
        let steps = self.best.as_ref().unwrap_or(&self.under_way);
        for (index, step) in steps.iter().enumerate() {
            let limits = match (self.limiting == Some(index), metric) {
                (false, _) => "",
                (true, Metric::ParticleDistance) => "  <- this step limits",
                (true, _) => "  <- this step gains least",
            };
            lines.push(format!("  {}{limits}", step.text(metric)));
        }
        lines
    }
}

impl StepLine {
    fn of(program: &Program, taken: &Taken) -> StepLine {
        let (answer, without) = match &taken.choice {
            Choice::Skip => (None, Vec::new()),
            Choice::Act {
                proposal, without, ..
            } => (Some(answer(program, proposal)), without.clone()),
        };
        StepLine {
            step: taken.step,
            answer,
            without,
            value: taken.value,
            behind: taken.behind,
        }
    }

    fn text(&self, metric: Metric) -> String {
        let answer = self
            .answer
            .as_deref()
            .unwrap_or("no accepted answer: skipped");
        let without = match self.without.is_empty() {
            true => String::new(),
            false => format!(" (without {})", self.without.join(", ")),
        };
        let then = match metric {
            Metric::ParticleDistance => format!("{} from the experts", shown(self.behind, metric)),
            _ => shown(self.value, metric),
        };
        format!("step {}: {answer}{without}; then {then}", self.step)
    }
}

/// Writes an action as an answer states it, on one line.
fn answer(program: &Program, proposal: &Proposal) -> String {
    let fields = proposal.fields.iter().filter_map(|(name, value)| {
        let field = program.field(name)?;
        Some(space::statement(field, &space::text(field, value)))
    });
    fields.collect::<Vec<_>>().join(", ")
}

impl Mean {
    fn of(by_start: &[Vec<f64>]) -> Mean {
        let mean = summary(Statistic::Mean, by_start, &Clusters::single(by_start.len()));
        Mean {
            value: mean.map(|it| it.value),
            ci95: mean.and_then(|it| it.ci95),
        }
    }

    fn text(self, metric: Metric) -> String {
        match (self.value, self.ci95) {
            (None, _) => "none".to_owned(),
            (Some(value), None) => shown(value, metric),
            (Some(value), Some(ends)) => {
                let [low, high] = ends.map(|end| shown(end, metric));
                format!("{} [{low}, {high}]", shown(value, metric))
            }
        }
    }
}

impl Summarised {
    /// Summarises one row over all starts.
    fn of(index: usize, row: &Row, starts: &[Vec<Row>]) -> Summarised {
        let of_all = || starts.iter().filter_map(|rows| rows.get(index));
        let values: Vec<Vec<f64>> = of_all().map(|row| row.values.clone()).collect();
        let reached: Vec<bool> = of_all().flat_map(|row| row.reached.clone()).collect();
        Summarised {
            row: row.name,
            oracle: row.oracle,
            mean: Mean::of(&values),
            rollouts: values.iter().map(Vec::len).sum(),
            reached: (!reached.is_empty()).then(|| reached.iter().filter(|it| **it).count()),
            unscored: of_all().flat_map(|row| row.unscored.clone()).collect(),
            none: of_all().find_map(|row| row.none.clone()),
        }
    }

    fn cells(&self, metric: Metric) -> [String; 3] {
        let name = match self.oracle {
            true => format!("{} (oracle)", self.row),
            false => self.row.to_owned(),
        };
        let mut notes = Vec::new();
        notes.extend(
            self.reached
                .map(|it| format!("{it} of {} reach the goal", self.rollouts)),
        );
        let mut whys = self.unscored.clone();
        whys.sort();
        whys.dedup();
        if !whys.is_empty() {
            let (n, whys) = (self.unscored.len(), whys.join("; "));
            notes.push(format!("{n} without a score ({whys}), measured at the end"));
        }
        notes.extend(self.none.clone());
        [name, self.mean.text(metric), notes.join("; ")]
    }
}

impl BestReport {
    /// Summarises the starts.
    ///
    /// - `rows`: what policies do at each start.
    pub fn new(
        arguments: &BestArguments,
        program: &Program,
        measure: Measure,
        starts: Vec<AtStart>,
        rows: &[Vec<Row>],
        out: &Path,
    ) -> BestReport {
        let goal = program.goal.as_ref();
        let misses = |at: &AtStart| goal.is_some_and(|it| at.value.is_none_or(|v| !it.is_met(v)));
        let longest = starts.iter().map(|at| at.found.after.len()).max();
        // A rollout that ended earlier keeps its measure.
        let after = |index: usize| {
            let of_start = |at: &AtStart| {
                let after = &at.found.after;
                after
                    .get(index)
                    .or(after.last())
                    .copied()
                    .into_iter()
                    .collect()
            };
            Mean::of(&starts.iter().map(of_start).collect::<Vec<_>>())
        };
        let first = rows.first().map(Vec::as_slice).unwrap_or_default().iter();
        BestReport {
            task: program.task.clone(),
            variant: program.variant.clone(),
            metric: measure.metric.as_str(),
            goal: goal.map(|goal| GoalLine {
                limit: goal.limit,
                more_is_better: measure.more_is_better,
            }),
            goal_missed: starts.iter().any(misses),
            trials: arguments.trials,
            beam: arguments.beam,
            seed: arguments.seed,
            out: out.display().to_string(),
            after: (0..longest.unwrap_or_default()).map(after).collect(),
            rows: { first.enumerate() }
                .map(|(index, row)| Summarised::of(index, row, rows))
                .collect(),
            title: program.title(),
            measure,
            starts,
        }
    }
}

impl Report for BestReport {
    fn text(&self) -> String {
        let metric = self.measure.metric;
        let mut lines = Vec::new();
        for at in &self.starts {
            let of_start = at.lines(metric);
            lines.push(format!("{}: {}", self.title, of_start[0]));
            lines.extend_from_slice(&of_start[1..]);
        }
        if self.starts.len() > 1 {
            lines.push(format!(
                "{} starts, mean and 95 % interval",
                self.starts.len()
            ));
            let after = self.after.iter().zip(1..);
            lines.extend(
                after.map(|(mean, n)| format!("  best after {n} actions: {}", mean.text(metric))),
            );
        }
        let heading = match metric {
            Metric::ParticleDistance => "distance to the experts",
            Metric::Coverage => "coverage",
            Metric::NormalizedImprovement => "normalized improvement",
        };
        let mut table = vec![["", heading, ""].map(str::to_owned)];
        table.extend(self.rows.iter().map(|row| row.cells(metric)));
        let table = aligned([Align::Left; 3], &table);
        lines.extend(table.iter().map(|line| format!("  {line}")));
        if let (Some(goal), true) = (&self.goal, self.goal_missed) {
            let side = if goal.more_is_better {
                "above"
            } else {
                "below"
            };
            let why = match self.starts.iter().all(|at| at.found.exhausted) {
                true => "no answers can reach it here",
                false => "none of the actions tried reaches it",
            };
            let limit = shown(goal.limit, metric);
            lines.push(format!("the goal, {side} {limit}, is missed: {why}"));
        }
        lines.push(format!("kept in {}", self.out));
        lines.join("\n")
    }
}

/// Writes a measure.
fn shown(value: f64, metric: Metric) -> String {
    match metric {
        Metric::ParticleDistance => format!("{:.1} mm", value * 1000.0),
        Metric::Coverage | Metric::NormalizedImprovement => format!("{value:.3}"),
    }
}
