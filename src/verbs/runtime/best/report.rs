//! Reports a search: the best actions, the step that limits, what was left untried, and a table of rows.

use super::rows::Row;
use fab_agent::best::{Found, Stop, Taken};
use fab_base::table::aligned;
use fab_base::wording::counted;
use fab_program::{Comparison, Goal, Metric, Program};
use fab_world::start::Start;
use serde::Serialize;
use std::path::Path;

/// What was found.
#[derive(Serialize)]
pub struct BestReport<'a> {
    #[serde(skip)]
    title: String,
    task: &'a str,
    variant: Option<&'a str>,
    start: &'a str,
    seed: Option<u64>,
    goal: Option<&'a Goal>,
    pub goal_missed: bool,
    #[serde(flatten)]
    found: &'a Found,
    rows: &'a [Row],
    out: String,
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
        let goal = program.goal.as_ref();
        let misses = |goal: &Goal| found.value.is_none_or(|value| !goal.is_met(value));
        BestReport {
            title: program.title(),
            task: &program.task,
            variant: program.variant.as_deref(),
            start: &start.name,
            seed: start.seed,
            goal_missed: goal.is_some_and(misses),
            goal,
            found,
            rows,
            out: out.display().to_string(),
        }
    }

    fn is_distance(&self) -> bool {
        self.found.metric == Metric::ParticleDistance
    }

    /// Writes a measure.
    fn shown(&self, value: f64) -> String {
        if self.is_distance() {
            format!("{:.1} mm", value * 1000.0)
        } else {
            format!("{value:.3}")
        }
    }

    fn step(&self, index: usize, taken: &Taken) -> String {
        let answer = taken.answer.as_deref();
        let answer = answer.unwrap_or("no accepted answer: skipped");
        let mut line = format!("  step {}: {answer}", taken.step);
        if !taken.without.is_empty() {
            line += &format!(" (without {})", taken.without.join(", "));
        }
        let (then, limits) = if self.is_distance() {
            let behind = self.shown(taken.behind);
            (format!("{behind} from the experts"), "this step limits")
        } else {
            (self.shown(taken.value), "this step gains least")
        };
        line += &format!("; then {then}");
        if self.found.limiting == Some(index) {
            line += &format!("  <- {limits}");
        }
        line
    }

    /// Says what was not tried, and why.
    fn untried(&self) -> String {
        let more = match self.found.stop {
            None => ": of their many actions some were drawn",
            Some(Stop::Trials) => "; `--trials` allows more",
            Some(Stop::Time) => "; `--seconds` allows more time",
            Some(Stop::Interrupt) => "; interrupted",
        };
        let states = counted(self.found.left, "reached state");
        format!("  left untried: actions of {states}{more}")
    }
}

impl BestReport<'_> {
    pub fn text(&self) -> String {
        let found = self.found;
        let mut lines = vec![format!(
            "{}: start {}, {} (untouched: {})",
            self.title,
            self.start,
            if found.exhausted {
                format!("every action was tried, {} trials", found.trials)
            } else {
                format!("best of {} trials", found.trials)
            },
            self.shown(found.untouched)
        )];
        if !found.exhausted {
            lines.push(self.untried());
        }
        if found.best.is_empty() {
            lines.push("  no action is accepted".to_owned());
        } else if found.value.is_none() {
            lines.push("  no rollout has ended yet; the most promising actions so far:".to_owned());
        }
        let steps = found.best.iter().enumerate();
        lines.extend(steps.map(|(index, taken)| self.step(index, taken)));
        let measure = match self.found.metric {
            Metric::ParticleDistance => "distance to the experts".to_owned(),
            metric => metric.as_str().replace('_', " "),
        };
        let heading = [String::new(), measure, String::new()];
        let rows = self
            .rows
            .iter()
            .map(|row| row.cells(|value| self.shown(value)));
        let table: Vec<[String; 3]> = std::iter::once(heading).chain(rows).collect();
        lines.extend(aligned(&[], &table).iter().map(|line| format!("  {line}")));
        if let (Some(goal), true) = (self.goal, self.goal_missed) {
            let why = if found.exhausted {
                "no answers can reach it here"
            } else {
                "none of the actions tried reaches it"
            };
            let side = match goal.is {
                Comparison::Greater | Comparison::AtLeast => "above",
                _ => "below",
            };
            let limit = self.shown(goal.limit);
            lines.push(format!("  the goal, {side} {limit}, is missed: {why}"));
        }
        lines.push(format!("rollouts are in {}", self.out));
        lines.join("\n")
    }
}
