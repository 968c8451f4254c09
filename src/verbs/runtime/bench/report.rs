//! The output of `fabc bench`: text, JSON and files.

use crate::exit::Failure;
use crate::io::write_file;
use crate::verbs::runtime::bench::Shard;
use crate::verbs::runtime::run::report::calls;
use crate::verbs::runtime::setting::policies;
use fab_agent::outcome::Outcome;
use fab_base::wording::{counted, quoted};
use fab_bench::play::{Results, StopReason};
use fab_bench::rows::Row;
use fab_bench::{Answers, Bench, statistics, table};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;

pub struct BenchReport<'a> {
    /// The suite's name.
    pub name: &'a str,
    pub bench: &'a Bench<'a>,
    pub results: &'a Results,
    pub rows: &'a [Row],
    /// Seconds since the command began.
    pub wall_s: f64,
}

/// Describes what a suite is about to do.
pub fn plan(name: &str, bench: &Bench<'_>, shard: Option<Shard>) -> String {
    let starts_of = |task: usize| bench.tasks[task].starts.len();
    let entries = bench.entries.iter();
    let rollouts = entries.map(|entry| starts_of(entry.task) * entry.repeats as usize);
    let rollouts = counted(rollouts.sum(), "rollout");
    let policies = bench.entries.iter();
    let policies = policies.map(|entry| policies::in_words(&entry.policy));
    let policies: Vec<_> = policies.collect::<BTreeSet<_>>().into_iter().collect();
    let part = shard.map_or(String::new(), |Shard { part, of }| {
        format!(", part {part} of {of} of the starts")
    });
    let shared = match bench.answers {
        Answers::PerStart => "",
        Answers::Shared => "starts share answers; ",
    };
    let varied = match bench.suite.variations().len() {
        0 => String::new(),
        count => format!(
            ", each start in its own world and in {}",
            counted(count, "varied world")
        ),
    };
    format!(
        "{name}: {rollouts} in `{}`{part}{varied}, {} at a time; {shared}{}",
        bench.out.display(),
        bench.side_by_side(),
        policies.join(", ")
    )
}

impl BenchReport<'_> {
    pub fn text(&self) -> String {
        if self.rows.is_empty() {
            return "no rollout has finished: there is nothing to tabulate".to_owned();
        }
        table::text(self.bench.suite, self.rows)
    }

    /// Returns the seconds of planning, mean over all actions.
    fn planning_s(&self) -> Option<f64> {
        let rollouts = self.results.rollouts.iter();
        let steps = rollouts.flat_map(|played| &played.rollout.steps);
        let planning: Vec<f64> = steps.filter_map(|step| step.spent.planning_s).collect();
        statistics::mean(&planning)
    }

    /// Returns the result as JSON.
    pub fn document(&self) -> Value {
        let BenchReport { bench, results, .. } = self;
        let rollouts = json!({
            "planned": results.planned,
            "finished": results.rollouts.len(),
            "found": results.found,
        });
        json!({
            "suite": self.name,
            "wall_s": self.wall_s,
            "params": results.params,
            "vary": bench.suite.vary,
            "answers": bench.answers,
            "structured": bench.suite.structured,
            "out": bench.out,
            "interrupted": results.stopped == Some(StopReason::Interrupted),
            "capped": results.stopped == Some(StopReason::Capped),
            "arm_left": results.arm_stop,
            "cut_off": results.cut_off,
            "calls": bench.budget.spent(),
            "rollouts": rollouts,
            "spent": results.spent,
            "planning_s": self.planning_s(),
            "rows": self.rows,
        })
    }

    /// Writes the tables; `document` is the result as JSON.
    pub fn write(&self, document: &Value, out: &Path) -> Result<(), Failure> {
        let json = serde_json::to_string_pretty(document)?;
        let markdown = table::markdown(self.name, self.bench.suite, self.rows);
        for (name, text) in [
            ("table.csv", table::csv(self.rows)),
            ("table.json", json + "\n"),
            ("table.md", markdown),
        ] {
            write_file(&out.join(name), text.as_bytes())?;
        }
        Ok(())
    }

    pub fn summary(&self) -> String {
        let spent = &self.results.spent;
        let mut lines = Vec::new();
        if let Some(stop) = self.results.stopped {
            let why = match stop {
                StopReason::Interrupted => "interrupted",
                StopReason::Capped => "stopped by a cap",
                StopReason::Arm => "stopped because of the arm",
            };
            lines.push(format!(
                "{why}: {} of {} rollouts are finished; run again with the same `--out` to continue",
                self.results.rollouts.len(),
                self.results.planned
            ));
        } else if self.results.found > 0 {
            lines.push(format!(
                "{} of {} rollouts had ended before and were not run again",
                self.results.found, self.results.planned
            ));
        }
        lines.extend(self.failed());
        lines.extend(self.cut_off());
        lines.extend(self.arm_stop());
        let spent_on_calls = self.bench.budget.spent();
        if spent_on_calls.calls > 0 {
            lines.push(calls(&spent_on_calls));
        }
        lines.push(format!(
            "starts {:.1} s, rollouts {:.1} s, in all {:.1} s",
            spent.starts_s, spent.rollouts_s, self.wall_s
        ));
        if let Some(planning_s) = self.planning_s() {
            lines.push(format!(
                "planning without the model: {:.0} ms per action (render, vision, prompt, parse, verify)",
                planning_s * 1000.0
            ));
        }
        lines.push(format!(
            "tables: {} (table.csv, table.json, table.md)",
            self.bench.out.display()
        ));
        lines.join("\n")
    }

    /// Reports why rollouts failed: for each kind of failure, the count and the first message.
    fn failed(&self) -> Vec<String> {
        use Outcome::{ModelFailed, PolicyFailed, WorldFailed};
        let line = |outcome: Outcome| {
            let rollouts = self.results.rollouts.iter();
            let reports = rollouts.map(|played| &played.rollout.report);
            let failed: Vec<_> = reports.filter(|it| it.outcome == outcome).collect();
            let why = failed.first()?.stopped.as_deref().unwrap_or_default();
            let (count, name) = (counted(failed.len(), "rollout"), outcome.name());
            Some(format!("warning: {count} ended `{name}`; the first: {why}"))
        };
        let failures = [ModelFailed, PolicyFailed, WorldFailed].into_iter();
        failures.filter_map(line).collect()
    }

    /// Names the rollouts on an arm that will not be resumed.
    fn cut_off(&self) -> Option<String> {
        let folders = &self.results.cut_off;
        (!folders.is_empty()).then(|| {
            format!(
                "warning: {} on the arm was interrupted earlier, and is neither resumed nor in the tables: {}; move its folder away to have it carried out from the beginning",
                counted(folders.len(), "rollout"),
                quoted(folders.iter().map(|folder| folder.display()))
            )
        })
    }

    /// Reports the rollout after which the arm's state prevented further ones, and why.
    fn arm_stop(&self) -> Option<String> {
        let stop = self.results.arm_stop.as_ref()?;
        let folder = stop.folder.display();
        let why = &stop.why;
        Some(if stop.is_clear {
            format!(
                "no further rollout was begun after `{folder}`, in which the arm or the camera failed: {why}; the arm is at rest"
            )
        } else {
            format!(
                "`{folder}` left the arm in the middle of a motion, and no further rollout was begun: {why}; see to it, and if it is a real one, say so with `fabc robot recover --robot FILE`"
            )
        })
    }
}
