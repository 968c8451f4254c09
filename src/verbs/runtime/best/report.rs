//! Reports a search: the best actions, the step that limits, and a table of rows.

use super::rows::Row;
use crate::report::Report;
use fab_agent::best::{Choice, Found, Taken};
use fab_base::table::aligned;
use fab_bench::statistics;
use fab_program::{Goal, Metric, Program, Proposal, space};
use fab_world::start::Start;
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::Path;

/// What was found.
#[derive(Serialize)]
pub struct BestReport {
    task: String,
    variant: Option<String>,
    start: String,
    seed: Option<u64>,
    metric: &'static str,
    goal: Option<Goal>,
    pub goal_missed: bool,
    value: Option<f64>,
    best: Option<Vec<StepLine>>,
    under_way: Vec<StepLine>,
    /// The index of the step of the best actions that limits.
    limiting: Option<usize>,
    #[serde(flatten)]
    found: Found,
    rows: Vec<Row>,
    out: String,
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

impl BestReport {
    /// Words what was found.
    pub fn new(
        program: &Program,
        start: &Start,
        found: Found,
        rows: Vec<Row>,
        out: &Path,
    ) -> BestReport {
        let steps = |taken: &[Taken]| taken.iter().map(|it| StepLine::of(program, it)).collect();
        let (goal, value) = (program.goal.clone(), found.value());
        let misses = |goal: &Goal| value.is_none_or(|value| !goal.is_met(value));
        BestReport {
            task: program.task.clone(),
            variant: program.variant.clone(),
            start: start.name.clone(),
            seed: start.seed,
            metric: found.measure.metric.as_str(),
            goal_missed: goal.as_ref().is_some_and(misses),
            goal,
            value,
            best: found.best.as_deref().map(steps),
            under_way: steps(&found.under_way),
            limiting: found.limiting(),
            found,
            rows,
            out: out.display().to_string(),
        }
    }

    fn table(&self, metric: Metric) -> Vec<String> {
        let heading = match metric {
            Metric::ParticleDistance => "distance to the experts",
            Metric::Coverage => "coverage",
            Metric::NormalizedImprovement => "normalized improvement",
        };
        let mut table = vec![["", heading, ""].map(str::to_owned)];
        table.extend(self.rows.iter().map(|row| {
            let oracle = if row.oracle { " (oracle)" } else { "" };
            let value = statistics::mean(&row.values).map(|mean| shown(mean, metric));
            let mut notes = Vec::new();
            if row.values.len() > 1 {
                notes.push(format!("mean of {} rollouts", row.values.len()));
            }
            if !row.reached.is_empty() {
                let reached = row.reached.iter().filter(|it| **it).count();
                notes.push(format!("{reached} of {} reach the goal", row.reached.len()));
            }
            let whys: BTreeSet<&str> = row.unscored.iter().map(String::as_str).collect();
            let measured = if row.values.is_empty() {
                ""
            } else {
                ", measured at its end"
            };
            notes.extend({ whys.iter() }.map(|why| format!("no score ({why}){measured}")));
            let value = value.unwrap_or("none".to_owned());
            [format!("{}{oracle}", row.name), value, notes.join("; ")]
        }));
        aligned(&[], &table)
    }
}

impl Report for BestReport {
    fn text(&self) -> String {
        let (found, metric) = (&self.found, self.found.measure.metric);
        let how_many = if found.exhausted {
            format!("every action was tried, {} trials", found.trials)
        } else {
            format!("best of {} trials", found.trials)
        };
        let variant = self.variant.as_ref();
        let variant = variant.map_or(String::new(), |variant| format!("/{variant}"));
        let untouched = shown(found.untouched, metric);
        let mut lines = vec![format!(
            "{}{variant}: start {}, {how_many} (untouched: {untouched})",
            self.task, self.start
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
        lines.extend(self.table(metric).iter().map(|line| format!("  {line}")));
        if let (Some(goal), true) = (&self.goal, self.goal_missed) {
            let side = if found.measure.more_is_better {
                "above"
            } else {
                "below"
            };
            let why = if found.exhausted {
                "no answers can reach it here"
            } else {
                "none of the actions tried reaches it"
            };
            let limit = shown(goal.limit, metric);
            lines.push(format!("  the goal, {side} {limit}, is missed: {why}"));
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
