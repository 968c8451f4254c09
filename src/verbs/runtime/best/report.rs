//! Reports a search: the best actions, the step that limits, what was left untried, and a table of rows.

use super::rows::Row;
use crate::report::Report;
use fab_agent::best::{Found, Stop, Taken};
use fab_base::table::aligned;
use fab_base::wording::counted;
use fab_bench::statistics;
use fab_program::{Goal, Metric, Program, Proposal, space};
use fab_world::start::Start;
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::Path;

/// What was found.
#[derive(Serialize)]
pub struct BestReport<'a> {
    task: &'a str,
    variant: Option<&'a str>,
    start: &'a str,
    seed: Option<u64>,
    metric: &'static str,
    goal: Option<&'a Goal>,
    pub goal_missed: bool,
    /// The measure at the end of the best actions; null if no rollout has ended.
    value: Option<f64>,
    best: Vec<StepLine>,
    /// The index of the step of the best actions that limits.
    limiting: Option<usize>,
    exhausted: bool,
    #[serde(flatten)]
    found: &'a Found,
    rows: &'a [Row],
    out: String,
}

/// One step, with the answer that leads to it; null if the step is skipped.
#[derive(Serialize)]
struct StepLine {
    step: u32,
    answer: Option<String>,
    without: Vec<String>,
    value: f64,
    behind: f64,
}

impl StepLine {
    fn of(program: &Program, taken: &Taken) -> StepLine {
        let choice = taken.choice.as_ref();
        StepLine {
            step: taken.step,
            answer: choice.map(|choice| answer(program, &choice.proposal)),
            without: choice.map_or(Vec::new(), |choice| choice.without.clone()),
            value: taken.value,
            behind: taken.behind,
        }
    }

    fn text(&self, metric: Metric) -> String {
        let answer = self.answer.as_deref();
        let answer = answer.unwrap_or("no accepted answer: skipped");
        let without = if self.without.is_empty() {
            String::new()
        } else {
            format!(" (without {})", self.without.join(", "))
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

impl<'a> BestReport<'a> {
    /// Collects what was found.
    pub fn new(
        program: &'a Program,
        start: &'a Start,
        found: &'a Found,
        rows: &'a [Row],
        out: &Path,
    ) -> BestReport<'a> {
        let (goal, value) = (program.goal.as_ref(), found.value());
        let misses = |goal: &Goal| value.is_none_or(|value| !goal.is_met(value));
        let steps = found.best.iter();
        BestReport {
            task: &program.task,
            variant: program.variant.as_deref(),
            start: &start.name,
            seed: start.seed,
            metric: found.measure.metric.as_str(),
            goal_missed: goal.is_some_and(misses),
            goal,
            value,
            best: steps.map(|taken| StepLine::of(program, taken)).collect(),
            limiting: found.limiting(),
            exhausted: found.is_exhausted(),
            found,
            rows,
            out: out.display().to_string(),
        }
    }

    /// Says what was not tried, and why.
    fn untried(&self) -> String {
        let mut left = Vec::new();
        if self.found.left.actions > 0 {
            left.push(counted(self.found.left.actions, "listed action"));
        }
        if self.found.left.states > 0 {
            let states = counted(self.found.left.states, "reached state");
            left.push(format!("all actions of {states}"));
        }
        if !self.found.left.sampled.is_empty() {
            let sampled = self.found.left.sampled.join(", ");
            left.push(format!("what was not drawn of {sampled}"));
        }
        let more = match self.found.stop {
            None => "",
            Some(Stop::Trials) => "; `--trials` allows more",
            Some(Stop::Time) => "; `--seconds` allows more time",
            Some(Stop::Interrupt) => "; interrupted",
        };
        format!("left untried: {}{more}", left.join(", "))
    }

    fn table(&self) -> Vec<String> {
        let heading = match self.found.measure.metric {
            Metric::ParticleDistance => "distance to the experts",
            Metric::Coverage => "coverage",
            Metric::NormalizedImprovement => "normalized improvement",
        };
        let mut table = vec![["", heading, ""].map(str::to_owned)];
        for row in self.rows {
            let oracle = if row.oracle { " (oracle)" } else { "" };
            let mean = statistics::mean(&row.values);
            let mut notes = Vec::new();
            if row.values.len() > 1 {
                notes.push(format!("mean of {} rollouts", row.values.len()));
            }
            if !row.reached.is_empty() {
                let reached = row.reached.iter().filter(|it| **it).count();
                notes.push(format!("{reached} of {} reach the goal", row.reached.len()));
            }
            let whys: BTreeSet<&String> = row.unscored.iter().collect();
            let measured = if mean.is_some() {
                ", measured at its end"
            } else {
                ""
            };
            notes.extend(whys.iter().map(|why| format!("no score ({why}){measured}")));
            let mean = mean.map_or("none".to_owned(), |mean| {
                shown(mean, self.found.measure.metric)
            });
            table.push([format!("{}{oracle}", row.name), mean, notes.join("; ")]);
        }
        aligned(&[], &table)
    }
}

impl Report for BestReport<'_> {
    fn text(&self) -> String {
        let metric = self.found.measure.metric;
        let how_many = if self.exhausted {
            format!("every action was tried, {} trials", self.found.trials)
        } else {
            format!("best of {} trials", self.found.trials)
        };
        let variant = self
            .variant
            .map_or(String::new(), |variant| format!("/{variant}"));
        let untouched = shown(self.found.untouched, metric);
        let mut lines = vec![format!(
            "{}{variant}: start {}, {how_many} (untouched: {untouched})",
            self.task, self.start
        )];
        if !self.exhausted {
            lines.push(format!("  {}", self.untried()));
        }
        if self.best.is_empty() {
            lines.push("  no action is accepted".to_owned());
        } else if self.value.is_none() {
            lines.push("  no rollout has ended yet; the most promising actions so far:".to_owned());
        }
        for (index, step) in self.best.iter().enumerate() {
            let limits = match (self.limiting == Some(index), metric) {
                (false, _) => "",
                (true, Metric::ParticleDistance) => "  <- this step limits",
                (true, _) => "  <- this step gains least",
            };
            lines.push(format!("  {}{limits}", step.text(metric)));
        }
        lines.extend(self.table().iter().map(|line| format!("  {line}")));
        if let (Some(goal), true) = (self.goal, self.goal_missed) {
            let why = if self.exhausted {
                "no answers can reach it here"
            } else {
                "none of the actions tried reaches it"
            };
            let side = if self.found.measure.more_is_better {
                "above"
            } else {
                "below"
            };
            let limit = shown(goal.limit, metric);
            lines.push(format!("  the goal, {side} {limit}, is missed: {why}"));
        }
        lines.push(format!("rollouts are in {}", self.out));
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
