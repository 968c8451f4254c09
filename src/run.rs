//! `fabc run`: one rollout, with a line of progress per step.

use crate::cli::RunArguments;
use crate::exit::{Exit, Failure};
use crate::{output, setting, sources};
use compiler::program::{Goal, Metric, Program};
use compiler::verify::Verdict;
use runtime::agent::{Attempt, Finding, Models};
use runtime::examples::Examples;
use runtime::expert::MakeWorld;
use runtime::interrupt::Interrupt;
use runtime::journal::RunFolder;
use runtime::outcome::Outcome;
use runtime::rollout::{self, Event, Job, RolloutReport};
use runtime::start::Start;
use runtime::subgoals::{Origin, SubgoalError, SubgoalSet};
use runtime::world::{Grasp, WorldError};
use std::path::Path;

/// Runs one rollout and reports it.
pub fn run(arguments: &RunArguments) -> Result<Exit, Failure> {
    let program = sources::compile_task(&arguments.task)?;
    let model = setting::model(&arguments.model)?;
    let beside = sources::folder_of(&arguments.task.file);
    let examples = Examples::load(&program, &beside).map_err(Failure::environment)?;
    let interrupt = setting::interrupt()?;
    let first = setting::world(&program).map_err(Failure::environment)?;
    let start = setting::start(
        &program,
        &beside,
        &arguments.start,
        first.as_ref(),
        &interrupt,
    )?;
    if let Some(number) = examples.demonstrates(&start) {
        return Err(Failure::environment(format!(
            "the start `{}` is that of demonstration {number}, which the model is told: a result from it would be no test; choose another start",
            start.name
        )));
    }
    // Lengths in `edge` and the flat area are those of the cloth that lies there; subgoals show the task's own.
    let shown = program;
    let program = setting::fitted(&arguments.task, &shown, &start)?;
    let folder = match &arguments.out {
        Some(path) => RunFolder::create(path),
        None => RunFolder::create_next(Path::new("runs"), &program.title().replace('/', "-")),
    };
    let folder = folder.map_err(Failure::environment)?;
    let make_world = || setting::world(&program);
    let subgoals = match prepare(&shown, &start, &beside, &make_world, &interrupt) {
        Ok(Some(subgoals)) => subgoals,
        Ok(None) => {
            folder.discard();
            return Err(Failure::interrupted());
        }
        Err(failure) => {
            folder.discard();
            return Err(failure);
        }
    };
    say_origin(subgoals.origin, &arguments.task.file);
    let stand_in = if model.nature() == runtime::model::Nature::StandIn {
        " (a stand-in, no vision-language model)"
    } else {
        ""
    };
    output::talk(&format!(
        "{}: start {}, model {}{stand_in}",
        program.title(),
        start.name,
        model.name()
    ));
    let job = Job {
        program: &program,
        start: &start,
        subgoals: &subgoals,
        examples: &examples,
        models: Models {
            vision: model.as_ref(),
            text: model.as_ref(),
        },
        make_world: &make_world,
        cache: &setting::cache(),
        interrupt: &interrupt,
        horizon: None,
        early_stop: true,
        repetition: 0,
    };
    let report = rollout::run(&job, folder, &mut show).map_err(Failure::environment)?;
    if arguments.json {
        output::json(
            &serde_json::to_value(&report).expect("a report has string keys and finite numbers"),
        );
    } else {
        output::data(&summary(&report, program.goal.as_ref()));
    }
    Ok(exit_of(&report))
}

/// Tries the start and gets the pictures; `None` where the user stopped it.
fn prepare(
    program: &Program,
    start: &Start,
    beside: &Path,
    make_world: &MakeWorld<'_>,
    interrupt: &Interrupt,
) -> Result<Option<SubgoalSet>, Failure> {
    let mut world = make_world().map_err(Failure::environment)?;
    world.reset(start).map_err(Failure::environment)?;
    match SubgoalSet::obtain(program, beside, world.as_mut(), interrupt) {
        Err(SubgoalError::World(WorldError::Interrupted)) => Ok(None),
        obtained => Ok(Some(obtained.map_err(Failure::environment)?)),
    }
}

fn say_origin(origin: Origin, file: &str) {
    match origin {
        Origin::Author | Origin::Pinned | Origin::Absent => {}
        Origin::PinnedByOther => output::talk(&format!(
            "note: the pinned subgoal pictures were drawn with other simulator parameters; `fabc subgoals {file}` draws them again"
        )),
        Origin::Drawn => output::talk(&format!(
            "no subgoal pictures are pinned: drawn for this run; `fabc subgoals {file}` pins them"
        )),
        Origin::DrawnAnew => output::talk(&format!(
            "warning: the pinned subgoal pictures show another fold, cloth or camera: drawn anew for this run; `fabc subgoals {file}` pins them"
        )),
    }
}

/// Shows one event on stderr.
fn show(event: Event<'_>) {
    match event {
        Event::Asked { step, attempt } => {
            if let Some(refusal) = refusal(attempt) {
                output::talk(&format!(
                    "  step {step}, {} attempt {}: {refusal}",
                    attempt.stage, attempt.number
                ));
            }
        }
        Event::Stepped {
            step,
            horizon,
            action,
            grasp,
            seconds,
        } => {
            let moved = if action.pick_px == action.pick_on_cloth_px {
                String::new()
            } else {
                format!(", taken at {} on the cloth", action.pick_on_cloth_px)
            };
            let missed = if grasp == Grasp::Missed {
                ", nothing grasped"
            } else {
                ""
            };
            output::talk(&format!(
                "step {step}/{horizon}: pick {}{moved}, place {}{missed}   {seconds:.1} s",
                action.pick_px, action.place_px
            ));
        }
        Event::Skipped { step, horizon, why } => {
            output::talk(&format!("step {step}/{horizon}: skipped ({})", why.name()));
        }
        Event::SimulatingExperts { missing, total } => {
            output::talk(&format!(
                "simulating {missing} of {total} expert results to score against; they are kept for the next run"
            ));
        }
        Event::Note(note) => output::talk(&format!("note: {note}")),
    }
}

/// Returns why an attempt led to nothing, where it did.
fn refusal(attempt: &Attempt) -> Option<String> {
    match &attempt.finding {
        Finding::Action {
            verdict: Verdict::Reject { check, message, .. },
            ..
        } => Some(format!("refused by `{check}`: {message}")),
        Finding::Malformed { message, .. } => Some(format!("not readable: {message}")),
        Finding::Failed { why } => Some(why.clone()),
        Finding::Text { .. }
        | Finding::Action {
            verdict: Verdict::Accept,
            ..
        } => None,
    }
}

fn summary(report: &RolloutReport, goal: Option<&Goal>) -> String {
    let mut lines = vec![format!("outcome: {}", report.outcome.name())];
    if let Some(mm) = report.mean_particle_distance_mm {
        let goal = goal
            .filter(|goal| goal.metric == Metric::ParticleDistance)
            .map_or(String::new(), |goal| {
                format!(" (goal: below {:.0} mm)", goal.limit * 1000.0)
            });
        lines.push(format!(
            "mean particle distance to the nearest expert result: {mm:.1} mm{goal}"
        ));
    }
    if let Some(coverage) = report.coverage
        && goal.is_some_and(|goal| goal.metric.is_judged_each_step())
    {
        let both = |source: f64, truly: Option<f64>| {
            let truly = truly.map_or(String::new(), |truly| format!(", {truly:.3} (true)"));
            format!("{source:.3} (source){truly}")
        };
        let gained = report.normalized_improvement;
        let gained = gained.map_or(String::new(), |gained| {
            let truly = report.normalized_improvement_true;
            format!("; normalized improvement {}", both(gained, truly))
        });
        lines.push(format!(
            "coverage {}{gained}",
            both(coverage, report.coverage_true)
        ));
    }
    let stand_in = if report.model_is_stand_in {
        ", a stand-in and no vision-language model"
    } else {
        ""
    };
    lines.push(format!("model: {}{stand_in}", report.model));
    lines.push(questions(report));
    let seconds = report
        .seconds
        .iter()
        .filter_map(|(what, spent)| Some(format!("{what} {:.2}", spent.as_f64()?)));
    lines.push(format!(
        "seconds: {}, in all {:.1}",
        seconds.collect::<Vec<_>>().join(", "),
        report.wall_s
    ));
    if report.experts_simulated > 0 {
        lines.push(format!(
            "of that, {} expert results were simulated for the first time",
            report.experts_simulated
        ));
    }
    lines.push(format!(
        "run folder: {} (contact sheet: sheet.png)",
        report.run_dir
    ));
    lines.join("\n")
}

/// Says what came of the questions, with what went wrong by name.
fn questions(report: &RolloutReport) -> String {
    let mut counts = vec![format!("questions: {}", report.queries)];
    let refusals = report.refusals.iter();
    counts.extend(refusals.map(|(check, count)| format!("refused by `{check}`: {count}")));
    if report.malformed_replies > 0 {
        counts.push(format!("not readable: {}", report.malformed_replies));
    }
    let skipped = report.skipped.iter();
    counts.extend(skipped.map(|(why, count)| format!("steps skipped ({why}): {count}")));
    if let Some(planning_s) = report.planning_s {
        counts.push(format!(
            "{:.0} ms of planning per action",
            planning_s * 1000.0
        ));
    }
    counts.join(", ")
}

fn exit_of(report: &RolloutReport) -> Exit {
    match report.outcome {
        Outcome::GoalReached => Exit::Done,
        Outcome::HorizonReached if report.goal_reached.is_none() => Exit::Done,
        Outcome::ModelFailed | Outcome::WorldFailed => Exit::Environment,
        Outcome::Interrupted => Exit::Interrupted,
        Outcome::HorizonReached
        | Outcome::AttemptsExhausted
        | Outcome::MalformedReply
        | Outcome::NoCandidates
        | Outcome::ClothOutOfView
        | Outcome::BudgetExhausted => Exit::Unreached,
    }
}
