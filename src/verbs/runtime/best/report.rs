//! Reports a search as text and JSON.
//!
//! In: what was found at each start. Out: best, expert, random actions and stand-in side by side, the step that limits,
//! and the line that would help.

use super::rows::Row;
use super::{AtStart, BestArguments, Unsearched};
use crate::verbs::new::simulator::point_text;
use crate::verbs::runtime::subgoals::offered::cure;
use fab_agent::best::unoffered::{Better, Lacking, Measured};
use fab_agent::best::{Choice, Found, Measure, Taken};
use fab_bench::statistics::{Clusters, Statistic, Summary, summary};
use fab_program::{Choices, Goal, Metric, Program, Proposal, space};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// The results of all starts.
pub struct Report<'a> {
    pub arguments: &'a BestArguments,
    pub program: &'a Program,
    pub measure: Measure,
    pub starts: &'a [AtStart],
    /// The start at which it was interrupted, if nothing was tried there.
    pub unsearched: Option<&'a Unsearched>,
    pub out: &'a Path,
}

/// Writes a time in the largest unit that keeps it readable.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{s:.0} s"),
        s if s < 5400.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

impl Report<'_> {
    /// Returns whether the best that was found at a start does not meet the goal, or no rollout ended there.
    pub fn misses_goal(&self) -> bool {
        let goal = self.program.goal.as_ref();
        let misses = |goal: &Goal| {
            let mut values = self.starts.iter().map(|at| at.found.value());
            values.any(|value| value.is_none_or(|value| !goal.is_met(value)))
        };
        goal.is_some_and(misses)
    }

    /// Returns the report for people.
    pub fn text(&self) -> String {
        let mut lines = Vec::new();
        for at in self.starts {
            lines.extend(self.start_lines(at));
        }
        if !self.starts.is_empty() {
            if self.starts.len() > 1 {
                lines.push(format!(
                    "{} starts, mean and 95 % interval",
                    self.starts.len()
                ));
                lines.extend(self.curve(self.measure.metric));
            }
            lines.extend(self.table(self.measure.metric, &self.rows()));
            lines.extend(self.too_small());
        }
        if let Some(Unsearched { start, rows }) = self.unsearched {
            let title = self.program.title();
            let start = &start.name;
            lines.push(format!(
                "{title}: start {start}, stopped before anything was tried"
            ));
            lines.extend(self.table(self.measure.metric, &self.summarised(&[rows])));
        } else if self.starts.is_empty() {
            lines.push("stopped before anything was tried".to_owned());
        }
        lines.push(format!("kept in {}", self.out.display()));
        lines.join("\n")
    }

    /// Tells what was found at one start.
    fn start_lines(&self, at: &AtStart) -> Vec<String> {
        let AtStart { start, found, .. } = at;
        let metric = found.measure.metric;
        let mut lines = vec![format!(
            "{}: start {}, {} (untouched: {})",
            at.program.title(),
            start.name,
            how_many(std::slice::from_ref(at)),
            shown(found.untouched, metric)
        )];
        if !found.sampled.is_empty() {
            lines.push(format!(
                "  sampled, not exhausted: {}",
                found.sampled.join(", ")
            ));
        }
        if found.interrupted {
            lines.push("  interrupted; the same `--out` goes on from here".to_owned());
        }
        let taken = match &found.best {
            Some(best) => best,
            None => {
                let what = match found.under_way.is_empty() {
                    true => "  nothing was tried yet",
                    false => "  no actions to the end of a rollout yet; the most promising so far:",
                };
                lines.push(what.to_owned());
                &found.under_way
            }
        };
        lines.extend(
            taken
                .iter()
                .map(|taken| step_line(&at.program, taken, metric)),
        );
        lines.extend(limit(found));
        lines.extend(self.beyond(at));
        if let (Some(goal), Some(value)) = (&self.program.goal, found.value())
            && !goal.is_met(value)
        {
            let limit = shown(goal.limit, metric);
            let why = match found.exhausted {
                true => "no answers can reach it here",
                false => "none of the actions tried reaches it",
            };
            lines.push(format!(
                "  the goal, {} {limit}, is missed at {}: {why}",
                sign(found.measure.more_is_better),
                shown(value, metric)
            ));
        }
        lines
    }

    /// Says which action that is not offered would be better.
    fn beyond(&self, at: &AtStart) -> Option<String> {
        let Some(better) = &at.unoffered.better else {
            return (at.unoffered.trials > 0).then(|| {
                let until = match at.unoffered.interrupted {
                    true => ", until it was interrupted",
                    false => "",
                };
                format!(
                    "  none of {} actions that are not offered was found to be better{until}",
                    at.unoffered.trials
                )
            });
        };
        let metric = at.found.measure.metric;
        let (value, instead_of) = (
            shown(better.value, metric),
            shown(better.instead_of, metric),
        );
        let when = match better.measured {
            Measured::AfterStep => {
                let from = match metric {
                    Metric::ParticleDistance => " from the experts",
                    _ => "",
                };
                format!("would leave {value}{from} after it, in place of {instead_of}")
            }
            Measured::AtEnd => format!("would end at {value}, in place of {instead_of}"),
        };
        let (what, cure) = lacking(&at.program, &better.lacking)?;
        Some(format!(
            "  not offered, and better: in step {} {what}, which {when}{cure}",
            better.step
        ))
    }

    /// Returns the best measure after each number of actions, over starts.
    fn curve(&self, metric: Metric) -> Vec<String> {
        let all = self.after();
        let lines = all.iter().enumerate().filter_map(|(index, values)| {
            let summary = summary_of(values)?;
            Some(format!(
                "  best after {:>2} action{}  {}",
                index + 1,
                if index == 0 { " " } else { "s" },
                with_interval(&summary, metric)
            ))
        });
        lines.collect()
    }

    /// Returns, for each number of actions, the best measure at each start; a rollout that ended earlier keeps its own.
    fn after(&self) -> Vec<Vec<f64>> {
        let curves = self.starts.iter().map(|at| &at.found.after);
        let longest = curves.clone().map(Vec::len).max().unwrap_or_default();
        let at = |index: usize| {
            let values = curves.clone();
            let values = values.filter_map(move |curve| curve.get(index).or(curve.last()));
            values.copied().collect()
        };
        (0..longest).map(at).collect()
    }

    fn table(&self, metric: Metric, rows: &[Summarised]) -> Vec<String> {
        let mut lines = vec![format!("  {:<18}  {}", "", heading(metric))];
        for row in rows {
            let name = match row.oracle {
                true => format!("{} (oracle)", row.name),
                false => row.name.to_owned(),
            };
            let value = match (row.value, &row.none) {
                (Some(summary), _) => with_interval(&summary, metric),
                (None, Some(_)) => "none".to_owned(),
                (None, None) => "-".to_owned(),
            };
            let mut notes = Vec::new();
            if let Some([reached, of]) = row.reached {
                notes.push(match of {
                    1 if reached == 1 => "goal reached".to_owned(),
                    1 => "goal missed".to_owned(),
                    _ => format!("{reached} of {of} reach the goal"),
                });
            }
            notes.extend(row.note.clone());
            notes.extend(unscored(row));
            notes.extend(row.none.clone());
            lines.push(
                format!("  {name:<18}  {value}  {}", notes.join("; "))
                    .trim_end()
                    .to_owned(),
            );
        }
        lines
    }

    /// Says that a policy did better than the search, which then tried too little.
    fn too_small(&self) -> Option<String> {
        let beaten = |at: &AtStart| {
            if at.found.interrupted {
                return None;
            }
            let best = at.found.measure.loss(at.found.value()?);
            let policies = at.rows.iter().skip(1);
            let mut better = policies.filter(|row| {
                let losses = row.at_end.iter().map(|value| at.found.measure.loss(*value));
                losses.fold(f64::INFINITY, f64::min) < best
            });
            better.next().map(|row| row.name)
        };
        let name = self.starts.iter().find_map(beaten)?;
        Some(format!(
            "  the row `{name}` does better at a start than all actions tried: the search was too small, raise `--trials`"
        ))
    }

    /// Summarises each kind of rollouts over all starts.
    fn rows(&self) -> Vec<Summarised> {
        let rows: Vec<&Vec<Row>> = self.starts.iter().map(|at| &at.rows).collect();
        self.summarised(&rows)
    }

    /// The same of some starts' rows.
    fn summarised(&self, starts: &[&Vec<Row>]) -> Vec<Summarised> {
        let Some(first) = starts.first() else {
            return Vec::new();
        };
        let of_all = |index: usize| starts.iter().filter_map(move |rows| rows.get(index));
        let row = |(index, row): (usize, &Row)| {
            let values: Vec<Vec<f64>> = of_all(index).map(|row| row.values.clone()).collect();
            let reached: Vec<bool> = of_all(index).flat_map(|row| row.reached.clone()).collect();
            let count = values.iter().map(Vec::len).sum::<usize>();
            let summary = summary(Statistic::Mean, &values, &Clusters::single(values.len()));
            Summarised {
                name: row.name,
                oracle: row.oracle,
                note: match row.name {
                    "best" => Some(how_many(self.starts)),
                    _ if count > starts.len() => Some(format!("mean of {count} rollouts")),
                    _ => None,
                },
                value: summary,
                reached: (!reached.is_empty())
                    .then(|| [reached.iter().filter(|it| **it).count(), reached.len()]),
                unscored: of_all(index).flat_map(|row| row.unscored.clone()).collect(),
                none: of_all(index).find_map(|row| row.none.clone()),
                rollouts: count,
            }
        };
        first.iter().enumerate().map(row).collect()
    }

    /// Returns the report for programs.
    pub fn json(&self) -> Value {
        let starts = self.starts.iter().map(|at| self.start_json(at));
        let after: Vec<Value> = self
            .after()
            .iter()
            .map(|values| {
                let summary = summary_of(values);
                json!({
                    "value": summary.map(|it| it.value),
                    "ci95": summary.and_then(|it| it.ci95),
                })
            })
            .collect();
        let row_json = |row: Summarised| {
            json!({
                "row": row.name,
                "oracle": row.oracle,
                "value": row.value.map(|it| it.value),
                "ci95": row.value.and_then(|it| it.ci95),
                "rollouts": row.rollouts,
                "reached": row.reached.map(|[reached, _]| reached),
                "unscored": row.unscored,
                "none": row.none,
            })
        };
        let rows = self.rows().into_iter().map(row_json);
        let unsearched = self.unsearched.map(|Unsearched { start, rows }| {
            let rows = self.summarised(&[rows]).into_iter().map(row_json);
            json!({"start": start.name, "seed": start.seed, "rows": rows.collect::<Vec<_>>()})
        });
        json!({
            "task": self.program.task,
            "variant": self.program.variant,
            "metric": self.measure.metric.as_str(),
            "goal": self.program.goal.as_ref().map(|goal| json!({
                "limit": goal.limit,
                "more_is_better": self.measure.more_is_better,
            })),
            "goal_missed": self.misses_goal(),
            "trials": self.arguments.trials,
            "beam": self.arguments.beam,
            "seed": self.arguments.seed,
            "out": self.out.display().to_string(),
            "starts": starts.collect::<Vec<_>>(),
            "after": after,
            "rows": rows.collect::<Vec<_>>(),
            "unsearched": unsearched,
        })
    }

    fn start_json(&self, at: &AtStart) -> Value {
        let AtStart { start, found, .. } = at;
        let taken = |taken: &[Taken]| -> Vec<Value> {
            let steps = taken.iter().map(|taken| taken_json(&at.program, taken));
            steps.collect()
        };
        json!({
            "start": start.name,
            "seed": start.seed,
            "untouched": found.untouched,
            "value": found.value(),
            "best": found.best.as_deref().map(taken),
            "under_way": taken(&found.under_way),
            "after": found.after,
            "limiting": found.limiting(),
            "unoffered": at.unoffered.better.as_ref().map(|better| better_json(at, better)),
            "unoffered_trials": at.unoffered.trials,
            "trials": found.trials,
            "known": found.known,
            "exhausted": found.exhausted,
            "sampled": found.sampled,
            "refused": found.refused,
            "unreadable": found.unreadable,
            "interrupted": found.interrupted,
        })
    }
}

/// A kind of rollouts over all starts.
struct Summarised {
    name: &'static str,
    oracle: bool,
    value: Option<Summary>,
    rollouts: usize,
    /// How many reach the goal, and of how many.
    reached: Option<[usize; 2]>,
    note: Option<String>,
    /// Why rollouts have no score; they are measured where they ended.
    unscored: Vec<String>,
    none: Option<String>,
}

/// Says why rollouts have no score, each reason once.
fn unscored(row: &Summarised) -> Option<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for why in &row.unscored {
        *counts.entry(why).or_default() += 1;
    }
    let whys: Vec<String> = counts
        .into_iter()
        .map(|(why, count)| match row.rollouts {
            1 => why.to_owned(),
            _ => format!("{count} times {why}"),
        })
        .collect();
    (!whys.is_empty()).then(|| format!("no score ({}), measured at its end", whys.join("; ")))
}

/// Says what an action space lacks, and how to offer it, as the end of a sentence.
fn lacking(program: &Program, lacking: &Lacking) -> Option<(String, String)> {
    Some(match lacking {
        Lacking::Point {
            field,
            point,
            at,
            scene,
        } => {
            let cure = cure(program, scene, program.field(field)?, point, *at);
            (format!("{field} {}, at {at}", point_text(point)), cure)
        }
        Lacking::Values(fields) => {
            let names: Vec<&str> = fields.iter().map(|(name, _)| name.as_str()).collect();
            let lines = fields.iter().map(|(name, choices)| {
                let values: Vec<String> = match choices {
                    Choices::Directions { choices } => {
                        let values = choices.iter().map(|it| it.deg);
                        values.map(|deg| format!("{deg}deg")).collect()
                    }
                    Choices::Lengths { choices, unit } => {
                        let values = choices.iter().map(|it| it.value);
                        values
                            .map(|value| format!("{value}{}", unit.name))
                            .collect()
                    }
                    _ => Vec::new(),
                };
                format!("`{name}: one of {}`", values.join(", "))
            });
            let lines: Vec<String> = lines.collect();
            let what = format!("another {}", names.join(" and "));
            (what, format!(": offer it, {}", lines.join(" and ")))
        }
    })
}

fn better_json(at: &AtStart, better: &Better) -> Value {
    let (what, cure) = lacking(&at.program, &better.lacking).unwrap_or_default();
    json!({
        "action": better.index,
        "step": better.step,
        "what": what,
        "value": better.value,
        "instead_of": better.instead_of,
        "measured": better.measured,
        "cure": cure.trim_start_matches([':', ';', ' ']),
    })
}

fn taken_json(program: &Program, taken: &Taken) -> Value {
    let (answer, without) = match &taken.choice {
        Choice::Act {
            proposal, without, ..
        } => (Some(answer(program, proposal)), without.clone()),
        Choice::Skip => (None, Vec::new()),
    };
    json!({
        "step": taken.step,
        "answer": answer,
        "without": without,
        "value": taken.value,
        "behind": taken.behind,
    })
}

/// Writes an action as an answer states it, on one line.
fn answer(program: &Program, proposal: &Proposal) -> String {
    let fields = proposal.fields.iter().filter_map(|(name, value)| {
        let field = program.field(name)?;
        Some(space::statement(field, &space::text(field, value)))
    });
    fields.collect::<Vec<_>>().join(", ")
}

fn step_line(program: &Program, taken: &Taken, metric: Metric) -> String {
    let (what, without) = match &taken.choice {
        Choice::Act {
            proposal, without, ..
        } => (answer(program, proposal), without.join(", ")),
        Choice::Skip => ("no accepted answer: skipped".to_owned(), String::new()),
    };
    let without = match without.is_empty() {
        true => String::new(),
        false => format!(" (without {without})"),
    };
    let then = match metric {
        Metric::ParticleDistance => {
            format!("then {} from the experts", shown(taken.behind, metric))
        }
        _ => format!("then {}", shown(taken.value, metric)),
    };
    format!("  step {}: {what}{without}; {then}", taken.step)
}

/// Says which step loses most.
fn limit(found: &Found) -> Option<String> {
    let (best, index) = (found.best.as_deref()?, found.limiting()?);
    let taken = best.get(index)?;
    let before = index.checked_sub(1).and_then(|before| best.get(before));
    Some(match found.measure.metric {
        Metric::ParticleDistance => format!(
            "  step {} limits: {} from the experts before it, {} after it",
            taken.step,
            shown(
                before.map_or(0.0, |before| before.behind),
                found.measure.metric
            ),
            shown(taken.behind, found.measure.metric)
        ),
        _ => format!(
            "  step {} gains least: {} before it, {} after it",
            taken.step,
            shown(
                before.map_or(found.untouched, |before| before.value),
                found.measure.metric
            ),
            shown(taken.value, found.measure.metric)
        ),
    })
}

fn how_many(starts: &[AtStart]) -> String {
    let trials: u64 = starts.iter().map(|at| u64::from(at.found.trials)).sum();
    match starts.iter().all(|at| at.found.exhausted) {
        true => format!("every action was tried, {trials} trials"),
        false => format!("best of {trials} trials"),
    }
}

fn heading(metric: Metric) -> &'static str {
    match metric {
        Metric::ParticleDistance => "distance to the experts",
        Metric::Coverage => "coverage",
        Metric::NormalizedImprovement => "normalized improvement",
    }
}

fn sign(more_is_better: bool) -> &'static str {
    match more_is_better {
        true => "above",
        false => "below",
    }
}

/// Writes a measure.
fn shown(value: f64, metric: Metric) -> String {
    match metric {
        Metric::ParticleDistance => format!("{:.1} mm", value * 1000.0),
        Metric::Coverage | Metric::NormalizedImprovement => format!("{value:.3}"),
    }
}

fn summary_of(values: &[f64]) -> Option<Summary> {
    let by_start: Vec<Vec<f64>> = values.iter().map(|value| vec![*value]).collect();
    summary(
        Statistic::Mean,
        &by_start,
        &Clusters::single(by_start.len()),
    )
}

fn with_interval(summary: &Summary, metric: Metric) -> String {
    let value = shown(summary.value, metric);
    match summary.ci95 {
        Some([low, high]) => {
            format!("{value} [{}, {}]", shown(low, metric), shown(high, metric))
        }
        None => value,
    }
}
