//! The output of `fabc run`: a line per step while it runs, and a summary.

use crate::io::Io;
use crate::report::Report;
use fab_agent::action::Action;
use fab_agent::judgement::Judgement;
use fab_agent::outcome::Outcome;
use fab_agent::policy::Finding;
use fab_agent::record::{CoverageSource, JudgedBy, RehearsedAnswer, RehearsedStep};
use fab_agent::rollout::{Ended, Event};
use fab_agent::sheet::SHEET_FILE;
use fab_base::wording::{counted, shown};
use fab_model::calls::Spent;
use fab_program::verify::Verdict;
use fab_program::{Goal, LEAST_SLIDE_MM, Metric};
use fab_world::Grasp;
use fab_world::film::Film;
use fab_world::metrics::ClothMoved;
use serde::Serialize;
use std::path::Path;

/// Shows events on stderr.
pub struct Progress<'io> {
    io: &'io Io,
    /// How many actions were shown in an earlier run.
    earlier: u32,
    /// The most steps.
    horizon: u32,
    /// The last answer.
    answer: String,
}

impl Progress<'_> {
    /// Shows what happens after `earlier` actions.
    pub fn after(earlier: u32, io: &Io) -> Progress<'_> {
        Progress {
            io,
            earlier,
            horizon: 0,
            answer: String::new(),
        }
    }

    /// Shows one event.
    pub fn show(&mut self, event: &Event) {
        let is_earlier = event.at().is_some_and(|at| at.action <= self.earlier);
        if is_earlier && !matches!(event, Event::Stopped { .. }) {
            return;
        }
        let (io, horizon) = (self.io, self.horizon);
        match event {
            Event::Start { header } => self.horizon = header.horizon,
            Event::Answer { text, .. } => self.answer.clone_from(text),
            Event::Verdict { of, note, result } => {
                let words = match (note, refusal(result, &self.answer)) {
                    (Some(note), Some(refusal)) => format!("{note}; {refusal}"),
                    (Some(note), None) => format!("{note}; accepted"),
                    (None, Some(refusal)) => refusal,
                    (None, None) => return,
                };
                io.talk(&format!(
                    "  step {}, {} attempt {}: {words}",
                    of.at.step, of.stage, of.attempt
                ));
            }
            Event::Retried { at, overlap, limit } => io.talk(&format!(
                "step {} again, kept as `step_{}`: its result overlaps the subgoal's cloth by {:.3}, and the task asks for more than {limit}",
                at.step,
                at.action,
                // Rounded up, it could seem to be enough.
                (overlap * 1000.0).floor() / 1000.0
            )),
            Event::Stopped { at, why } => {
                io.talk(&format!("step {}/{horizon}: ended: {why}", at.step));
            }
            Event::Rehearsed {
                at,
                rehearsal,
                took_s,
            } => io.talk(&format!(
                "  step {}, {}",
                at.step,
                rehearsed(rehearsal, *took_s)
            )),
            Event::Motion {
                at,
                grips,
                other_values,
                without,
                executed,
                cloth: moved,
                took_s,
                spent,
                ..
            } => {
                let done = executed.grips.iter().map(|done| done.grasp);
                let grips = grips.iter().zip(done);
                let grips: Vec<String> = grips.map(|(action, grasp)| grip(action, grasp)).collect();
                let values: String = other_values.iter().map(|it| format!(", {it}")).collect();
                let without = match without.as_slice() {
                    [] => String::new(),
                    names => format!(", accepted without `{}`", names.join("`, `")),
                };
                io.talk(&format!(
                    "step {}/{horizon}: {}{values}{}{without}   {took_s:.1} s{}",
                    at.step,
                    grips.join("; "),
                    moved.as_ref().map(cloth).unwrap_or_default(),
                    so_far(spent)
                ));
            }
            Event::Skipped { at, why } => {
                io.talk(&format!(
                    "step {}/{horizon}: skipped ({})",
                    at.step,
                    why.name()
                ));
            }
            Event::Experts { missing, total } => {
                io.talk(&format!(
                    "simulating {missing} of {total} expert results to score against; they are kept for the next run"
                ));
            }
            Event::Note { note } => io.talk(&format!("note: {note}")),
            Event::Picture { .. } | Event::Question { .. } | Event::End { .. } => {}
        }
    }
}

/// Says what one gripper did.
fn grip(action: &Action, grasp: Grasp) -> String {
    let beside = if action.pick_px == action.pick_on_cloth_px {
        String::new()
    } else {
        format!(", taken at {} on the cloth", action.pick_on_cloth_px)
    };
    let missed = match grasp {
        Grasp::Missed => ", nothing grasped",
        Grasp::Unverified => ", grasp not verified",
        Grasp::Particle(_) | Grasp::Held => "",
    };
    format!(
        "pick {}{beside}, place {}{missed}",
        action.pick_px, action.place_px
    )
}

/// Says which of the answers that were tried on twins was taken, by its measure and its place among them.
fn rehearsed(line: &RehearsedStep, seconds: f64) -> String {
    let tried = &line.candidates;
    let measure = |index: usize| {
        let measure: Option<f64> = tried[index].measure;
        measure.map_or("no measure".to_owned(), |it| format!("{it:.2}"))
    };
    let is_taken = |it: &RehearsedAnswer| line.chosen == Some(it.attempt);
    let choice = match tried.iter().position(is_taken) {
        None => "none taken".to_owned(),
        Some(0) => format!("the first taken ({})", measure(0)),
        Some(taken) => format!(
            "answer {} taken ({}) in place of the first ({})",
            taken + 1,
            measure(taken),
            measure(0)
        ),
    };
    format!(
        "rehearsed: {}, {choice}, {}, {seconds:.1} s",
        counted(tried.len(), "answer"),
        counted(line.calls as usize, "more question")
    )
}

/// Says how far an action moved the cloth, and how much of that stayed.
fn cloth(moved: &ClothMoved) -> String {
    let slides = moved.slid_mm >= LEAST_SLIDE_MM;
    let held = match &moved.held {
        Some(held) if held.sprang_back && slides => format!(
            ", cloth moved {:.0} mm, opened again, rests {:.0} mm away",
            held.carried_mm, held.stayed_mm
        ),
        Some(held) if held.sprang_back => format!(
            ", cloth moved {:.0} mm, sprang back to {:.0}",
            held.carried_mm, held.stayed_mm
        ),
        Some(held) => format!(
            ", cloth moved {:.0} mm, rests {:.0} mm away",
            held.carried_mm, held.stayed_mm
        ),
        None => format!(", cloth moved at most {:.0} mm", moved.farthest_mm),
    };
    if slides {
        format!("{held}, slid {:.0} mm", moved.slid_mm)
    } else {
        held
    }
}

/// Reports the calls so far and their cost, if there were any, as the end of a sentence.
pub fn so_far(spent: &Spent) -> String {
    match spent.calls {
        0 => String::new(),
        calls => format!(", {calls} calls, {}", spent.in_words()),
    }
}

/// How much of an answer that cannot be read is printed, characters.
const MAX_SHOWN: usize = 300;

/// Returns why an attempt failed, if it did.
fn refusal(result: &Finding, answer: &str) -> Option<String> {
    match result {
        Finding::Action {
            verdict: Verdict::Reject { check, message, .. },
            ..
        } => Some(format!("refused by `{check}`: {message}")),
        Finding::Malformed { message, .. } => Some(format!(
            "not readable: {message}\nthe answer: {}",
            shown(answer, MAX_SHOWN)
        )),
        // The end of the step reports it.
        Finding::Failed {
            outcome: Outcome::PolicyFailed | Outcome::PolicyStopped,
            ..
        } => None,
        Finding::Failed { why, .. } => Some(why.clone()),
        Finding::Text { .. }
        | Finding::Action {
            verdict: Verdict::Accept,
            ..
        } => None,
    }
}

/// What became of a rollout, and of its film if there was to be one.
#[derive(Serialize)]
pub struct RunReport<'a> {
    #[serde(flatten)]
    pub report: Ended,
    #[serde(skip)]
    pub goal: Option<&'a Goal>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub video: Option<Option<Film>>,
}

impl Report for RunReport<'_> {
    fn text(&self) -> String {
        let summary = summary(&self.report, self.goal);
        match &self.video {
            None => summary,
            Some(None) => format!("{summary}\nvideo: none"),
            Some(Some(film)) => format!("{summary}\n{film}"),
        }
    }
}

/// Summarizes a rollout.
fn summary(report: &Ended, goal: Option<&Goal>) -> String {
    let mut lines = vec![format!("outcome: {}", report.outcome.name())];
    let words = report.stopped.as_deref();
    lines.extend(
        words
            .filter(|why| *why != report.outcome.name())
            .map(|why| format!("stopped: {why}")),
    );
    if let Some(mm) = report.mean_particle_distance_mm {
        let goal = goal
            .filter(|goal| goal.metric == Metric::ParticleDistance)
            .map_or(String::new(), |goal| {
                format!(" (goal: below {:.0} mm)", goal.limit * 1000.0)
            });
        lines.push(format!(
            "mean particle distance to the nearest expert result: {mm:.1} mm{goal}"
        ));
        let judged_by = report.judged_by.iter();
        lines.extend(
            judged_by
                .filter(|judged_by| judged_by.world != report.world)
                .map(|JudgedBy { world, grid: [x, y] }| {
                    format!("judged by expert results of `{world}`, on a grid of {x} x {y} particles")
                }),
        );
    }
    if let Some(coverage) = report.measures.coverage
        && goal.is_some_and(|goal| goal.metric.is_judged_each_step())
    {
        let measure = match report.coverage_source {
            Some(CoverageSource::Picture) => "by pictures",
            _ => "source",
        };
        let both = |source: f64, truly: Option<f64>| {
            let truly = truly.map_or(String::new(), |truly| format!(", {truly:.3} (true)"));
            format!("{source:.3} ({measure}){truly}")
        };
        let gained = report.measures.normalized_improvement;
        let gained = gained.map_or(String::new(), |gained| {
            let truly = report.measures.normalized_improvement_true;
            format!("; normalized improvement {}", both(gained, truly))
        });
        lines.push(format!(
            "coverage {}{gained}",
            both(coverage, report.measures.coverage_true)
        ));
    }
    lines.extend(report.operator.as_ref().map(judged));
    lines.push(match &report.model {
        Some(model) if report.model_is_stand_in => {
            format!("model: {model}, a stand-in and no vision-language model")
        }
        Some(model) => format!("model: {model}"),
        None => format!("policy: {}", report.policy),
    });
    lines.push(questions(report));
    lines.extend(spent(report));
    let seconds = report
        .took
        .seconds
        .iter()
        .filter_map(|(what, spent)| Some(format!("{what} {:.2}", spent.as_f64()?)));
    lines.push(format!(
        "seconds: {}, in all {:.1}",
        seconds.collect::<Vec<_>>().join(", "),
        report.took.wall_s
    ));
    if report.took.experts_simulated > 0 {
        lines.push(format!(
            "of that, {} expert results were simulated for the first time",
            report.took.experts_simulated
        ));
    }
    let sheet = if Path::new(&report.took.run_dir).join(SHEET_FILE).exists() {
        format!(" (contact sheet: {SHEET_FILE})")
    } else {
        String::new()
    };
    lines.push(format!("run folder: {}{sheet}", report.took.run_dir));
    lines.join("\n")
}

/// Reports the operator's judgement.
fn judged(judgement: &Judgement) -> String {
    let said = match (judgement.reached, judgement.why) {
        (true, _) => "reached".to_owned(),
        (false, Some(why)) => format!("not reached, for {}", why.name()),
        (false, None) => "not reached".to_owned(),
    };
    let words = judgement.words.iter();
    let words: String = words.map(|words| format!(": {words}")).collect();
    format!("the operator says: {said}{words}")
}

/// Reports what was paid for models, if there were calls.
fn spent(report: &Ended) -> Option<String> {
    if report.took.calls == 0 {
        return None;
    }
    let spent = &report.took.spent;
    let mut text = format!(
        "calls: {}, {}, {}",
        spent.calls,
        spent.tokens_in_words(),
        spent.in_words()
    );
    let faults = report.took.faults.iter();
    let faults: Vec<String> = faults
        .map(|(fault, count)| format!("{fault} {count}"))
        .collect();
    if !faults.is_empty() {
        text.push_str(&format!(" ({})", faults.join(", ")));
    }
    Some(text)
}

/// Reports how questions ended, with the names of failures.
fn questions(report: &Ended) -> String {
    let mut counts = vec![format!("questions: {}", report.queries)];
    let refusals = report.refusals.iter();
    counts.extend(refusals.map(|(check, count)| format!("refused by `{check}`: {count}")));
    if report.malformed_replies > 0 {
        counts.push(format!("not readable: {}", report.malformed_replies));
    }
    let skipped = report.skipped.iter();
    counts.extend(skipped.map(|(why, count)| format!("steps skipped ({why}): {count}")));
    if let Some(planning_s) = report.took.planning_s {
        counts.push(format!(
            "{:.0} ms of planning per action",
            planning_s * 1000.0
        ));
    }
    counts.join(", ")
}

#[cfg(test)]
mod tests;
