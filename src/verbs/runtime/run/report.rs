//! The output of `fabc run`: a line per step while it runs, and a summary.

use crate::io::Io;
use fab_agent::action::Action;
use fab_agent::judgement::Judgement;
use fab_agent::outcome::Outcome;
use fab_agent::policy::Finding;
use fab_agent::record::{CoverageSource, RehearsedAnswer, Step, StepSpent};
use fab_agent::rollout::Ended;
use fab_agent::rollout::event::{At, Event};
use fab_agent::sheet::SHEET_FILE;
use fab_base::wording::{counted, shown};
use fab_model::calls::Spent;
use fab_program::reply::Malformed;
use fab_program::verify::Verdict;
use fab_program::{Goal, LEAST_SLIDE_MM, Metric, Program, space};
use fab_world::film::Film;
use fab_world::metrics::ClothMoved;
use fab_world::{Executed, Grasp, WorldError};
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

pub struct Progress<'io> {
    program: &'io Program,
    io: &'io Io,
    /// How many actions were shown in an earlier run.
    earlier: u32,
    horizon: u32,
    answer: String,
    /// The last step, if its result did not match its subgoal, with their overlap.
    failed: Option<(u32, f64)>,
}

impl<'io> Progress<'io> {
    /// Shows what happens in a rollout of a task after `earlier` actions.
    pub fn after(earlier: u32, program: &'io Program, io: &'io Io) -> Progress<'io> {
        Progress {
            program,
            io,
            earlier,
            horizon: 0,
            answer: String::new(),
            failed: None,
        }
    }

    pub fn show(&mut self, event: &Event) {
        let is_earlier = |at: &At| at.action <= self.earlier;
        let io = self.io;
        match event {
            Event::Start { header } => self.horizon = header.horizon,
            Event::Answer { text, .. } => self.answer.clone_from(text),
            Event::Verdict { at, asked } if !is_earlier(at) => {
                let words = match (&asked.note, refusal(&asked.result, &self.answer)) {
                    (Some(note), refusal) => {
                        format!("{note}; {}", refusal.as_deref().unwrap_or("accepted"))
                    }
                    (None, Some(refusal)) => refusal,
                    (None, None) => return,
                };
                let (step, stage, attempt) = (at.step, &asked.stage, asked.attempt);
                io.talk(&format!(
                    "  step {step}, {stage} attempt {attempt}: {words}"
                ));
            }
            Event::Picture { at, .. } if !is_earlier(at) => {
                if let Some(overlap) = self.failed.take_if(|(step, _)| *step == at.step) {
                    self.again(at, overlap.1);
                }
            }
            Event::Motion { at, line, spent } => {
                let failed = line.result.filter(|result| !result.is_enough);
                self.failed = failed.map(|result| (at.step, result.overlap));
                if !is_earlier(at) || line.stopped.is_some() {
                    self.step(at.step, line, spent);
                }
            }
            Event::Note { note } => io.talk(&format!("note: {note}")),
            _ => {}
        }
    }

    /// Shows that a step is taken again, since its result does not match its subgoal.
    fn again(&self, at: &At, overlap: f64) {
        let asked = self.program.verify.result.as_ref();
        let limit = asked.map_or(0.0, |it| it.overlap_above);
        // Rounded up, it could seem to be enough.
        let overlap = (overlap * 1000.0).floor() / 1000.0;
        let At { action, step } = at;
        self.io.talk(&format!(
            "step {step} again, kept as `step_{action}`: its result overlaps the subgoal's cloth by {overlap:.3}, and the task asks for more than {limit}"
        ));
    }

    /// Shows how a step ended.
    fn step(&self, step: u32, line: &Step, spent: &StepSpent) {
        let io = self.io;
        let tried = line.rehearsal.as_ref();
        let tried = tried.filter(|it| it.aside.is_none() && !it.candidates.is_empty());
        if let Some(tried) = tried {
            let took_s = spent.seconds.get("rehearse").and_then(Value::as_f64);
            let taken = line.accepted.as_ref().map(|accepted| accepted.attempt);
            let words = rehearsed(&tried.candidates, taken, took_s.unwrap_or_default());
            io.talk(&format!("  step {step}, {words}"));
        }
        let said = match (&line.executed, line.skipped, &line.stopped) {
            (_, _, Some(why)) => format!("ended: {why}"),
            (_, Some(why), None) => format!("skipped ({})", why.name()),
            (Some(executed), ..) => {
                let (took_s, spent) = (spent.took_s(), so_far(&spent.so_far));
                format!("{}   {took_s:.1} s{spent}", self.motion(line, executed))
            }
            _ => return,
        };
        // Ending after a requested plan is not ending early.
        if line.stopped != Some(WorldError::PlannedOnly.to_string()) {
            io.talk(&format!("step {step}/{}: {said}", self.horizon));
        }
    }

    fn motion(&self, line: &Step, executed: &Executed) -> String {
        let done = executed.grips.iter().map(|done| done.grasp);
        let grips = line.action.iter().flatten().zip(done);
        let grips: Vec<String> = grips.map(|(action, grasp)| grip(action, grasp)).collect();
        let mut said = grips.join("; ");
        for (name, value) in line.proposal().into_iter().flat_map(|it| it.fields) {
            if let Some(field) = self.program.field(&name).filter(|it| !it.is_point()) {
                said += &format!(", {name} {}", space::text(field, &value));
            }
        }
        said.extend(line.cloth.as_ref().map(cloth));
        let accepted = line.accepted.iter().filter(|it| !it.without.is_empty());
        said.extend(accepted.map(|it| format!(", accepted without `{}`", it.without.join("`, `"))));
        said
    }
}

fn grip(action: &Action, grasp: Grasp) -> String {
    let (pick_px, place_px, taken_px) = (action.pick_px, action.place_px, action.pick_on_cloth_px);
    let beside = if taken_px == pick_px {
        String::new()
    } else {
        format!(", taken at {taken_px} on the cloth")
    };
    let missed = match grasp {
        Grasp::Missed => ", nothing grasped",
        Grasp::Unverified => ", grasp not verified",
        Grasp::Particle(_) | Grasp::Held => "",
    };
    format!("pick {pick_px}{beside}, place {place_px}{missed}")
}

/// Says which of the answers that were tried on twins was taken, by its measure and its place among them.
fn rehearsed(tried: &[RehearsedAnswer], taken: Option<u32>, seconds: f64) -> String {
    let measure = |index: usize| {
        let measure: Option<f64> = tried[index].measure;
        measure.map_or("no measure".to_owned(), |it| format!("{it:.2}"))
    };
    let is_taken = |it: &RehearsedAnswer| taken == Some(it.attempt);
    let choice = match tried.iter().position(is_taken) {
        None => "none taken".to_owned(),
        Some(0) => format!("the first taken ({})", measure(0)),
        Some(taken) => {
            let (number, own, first) = (taken + 1, measure(taken), measure(0));
            format!("answer {number} taken ({own}) in place of the first ({first})")
        }
    };
    format!(
        "rehearsed: {}, {choice}, {seconds:.1} s",
        counted(tried.len(), "answer")
    )
}

/// Says how far an action moved the cloth, and how much of that stayed.
fn cloth(moved: &ClothMoved) -> String {
    let slides = moved.slid_mm >= LEAST_SLIDE_MM;
    let way = match &moved.held {
        Some(held) => {
            let (carried, stayed) = (held.carried_mm, held.stayed_mm);
            let end = match (held.sprang_back, slides) {
                (true, true) => format!("opened again, rests {stayed:.0} mm away"),
                (true, false) => format!("sprang back to {stayed:.0}"),
                (false, _) => format!("rests {stayed:.0} mm away"),
            };
            format!("{carried:.0} mm, {end}")
        }
        None => format!("at most {:.0} mm", moved.farthest_mm),
    };
    let slid = slides.then(|| format!(", slid {:.0} mm", moved.slid_mm));
    format!(", cloth moved {way}{}", slid.unwrap_or_default())
}

/// Reports the calls so far and their cost, if there were any, as the end of a sentence.
pub fn so_far(spent: &Spent) -> String {
    match spent.calls {
        0 => String::new(),
        calls => format!(", {calls} calls, {}", spent.in_words()),
    }
}

/// Says what calls took.
pub fn calls(spent: &Spent) -> String {
    let (tokens, cost) = (spent.tokens_in_words(), spent.in_words());
    format!("calls: {}, {tokens}, {cost}", spent.calls)
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
        Finding::Malformed(Malformed { message, .. }) => Some(format!(
            "not readable: {message}\nthe answer: {}",
            shown(answer, MAX_SHOWN)
        )),
        // Of the others, the end of the step tells.
        Finding::Failed { outcome, why, .. } => {
            let is_told_later = [Outcome::PolicyFailed, Outcome::PolicyStopped].contains(outcome);
            (!is_told_later).then(|| why.clone())
        }
        _ => None,
    }
}

/// What became of a rollout, and of its film if there was to be one.
#[derive(Serialize)]
pub struct RunReport {
    #[serde(flatten)]
    pub report: Ended,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub video: Option<Option<Film>>,
}

impl RunReport {
    pub fn text(&self, goal: Option<&Goal>) -> String {
        let mut lines = summary(&self.report, goal);
        let film = self.video.as_ref();
        lines.extend(film.map(|it| {
            it.as_ref()
                .map_or("video: none".to_owned(), Film::to_string)
        }));
        lines.join("\n")
    }
}

fn summary(report: &Ended, goal: Option<&Goal>) -> Vec<String> {
    let mut lines = vec![format!("outcome: {}", report.outcome.name())];
    let why = report.stopped.as_deref();
    let why = why.filter(|why| *why != report.outcome.name());
    lines.extend(why.map(|why| format!("stopped: {why}")));
    if let Some(mm) = report.mean_particle_distance_mm {
        let goal = goal.filter(|goal| goal.metric == Metric::ParticleDistance);
        let goal = goal.map(|goal| format!(" (goal: below {:.0} mm)", goal.limit * 1000.0));
        lines.push(format!(
            "mean particle distance to the nearest expert result: {mm:.1} mm{}",
            goal.unwrap_or_default()
        ));
        let judged_by = report.judged_by.iter();
        let elsewhere = judged_by.filter(|judged_by| judged_by.world != report.header.world);
        lines.extend(elsewhere.map(|judged_by| {
            let (world, [x, y]) = (&judged_by.world, judged_by.grid);
            format!("judged by expert results of `{world}`, on a grid of {x} x {y} particles")
        }));
    }
    if goal.is_some_and(|goal| goal.metric.is_judged_each_step()) {
        lines.extend(coverage(report));
    }
    lines.extend(report.operator.as_ref().map(judged));
    let policy = &report.header.policy;
    let model = policy.models.as_ref().map(|_| &policy.name);
    lines.push(match model {
        Some(model) if policy.is_stand_in() => {
            format!("model: {model}, a stand-in and no vision-language model")
        }
        Some(model) => format!("model: {model}"),
        None => format!("policy: {}", policy.title()),
    });
    lines.push(questions(report));
    lines.extend(spent(report));
    let took = &report.took;
    let seconds = took.seconds.iter();
    let seconds =
        seconds.filter_map(|(what, spent)| Some(format!("{what} {:.2}", spent.as_f64()?)));
    let seconds = seconds.collect::<Vec<_>>().join(", ");
    lines.push(format!("seconds: {seconds}, in all {:.1}", took.wall_s));
    let has_sheet = Path::new(&took.run_dir).join(SHEET_FILE).exists();
    let sheet = has_sheet.then(|| format!(" (contact sheet: {SHEET_FILE})"));
    let sheet = sheet.unwrap_or_default();
    lines.push(format!("run folder: {}{sheet}", took.run_dir));
    lines
}

fn coverage(report: &Ended) -> Option<String> {
    let measure = match report.coverage_source {
        Some(CoverageSource::Picture) => "by pictures",
        _ => "source",
    };
    let both = |source: f64, truly: Option<f64>| {
        let truly = truly.map_or(String::new(), |truly| format!(", {truly:.3} (true)"));
        format!("{source:.3} ({measure}){truly}")
    };
    let measures = &report.measures;
    let covered = both(measures.coverage?, measures.coverage_true);
    let gained = measures.normalized_improvement.map(|gained| {
        let gained = both(gained, measures.normalized_improvement_true);
        format!("; normalized improvement {gained}")
    });
    Some(format!("coverage {covered}{}", gained.unwrap_or_default()))
}

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
    if report.took.spent.calls == 0 {
        return None;
    }
    let faults = report.took.faults.iter();
    let faults = faults.map(|(fault, count)| format!("{fault} {count}"));
    let faults = faults.collect::<Vec<_>>().join(", ");
    let calls = calls(&report.took.spent);
    Some(match faults.as_str() {
        "" => calls,
        faults => format!("{calls} ({faults})"),
    })
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
    let planning_ms = report.took.planning_s.map(|seconds| seconds * 1000.0);
    counts.extend(planning_ms.map(|ms| format!("{ms:.0} ms of planning per action")));
    counts.join(", ")
}

#[cfg(test)]
mod tests;
