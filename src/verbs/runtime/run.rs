//! `fabc run`: one rollout, with a line of progress per step.

mod planned;
pub mod report;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources::{self, TaskArguments};
use crate::verbs::runtime::estimate::{self, Asking};
use crate::verbs::runtime::events::EventArguments;
use crate::verbs::runtime::operator::TerminalOperator;
use crate::verbs::runtime::robot::preflight;
use crate::verbs::runtime::setting::arm::{ArmArguments, ArmMode};
use crate::verbs::runtime::setting::model_arguments::{
    ModelArguments, PolicyArguments, SpendArguments,
};
use crate::verbs::runtime::setting::policies::{self, Deciding};
use crate::verbs::runtime::setting::worlds::{self, WorldChoice};
use crate::verbs::runtime::setting::{self, StartArguments, models};
use crate::verbs::runtime::video::{self, VideoArguments};
use clap::{Args, ValueHint};
use fab_agent::examples::Examples;
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::policy::MakePolicy;
use fab_agent::rollout::{self, Job, RunError};
use fab_agent::subgoals::{Origin, SubgoalSet};
use fab_arm::settings::Settings;
use fab_model::calls::ledger;
use fab_world::film::Recorder;
use fab_world::{SimulatedWorld, World, WorldError};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use planned::PlannedRun;
use report::{Progress, RunReport};

#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct RunArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    #[command(flatten)]
    #[serde(default)]
    pub policy: PolicyArguments,
    #[command(flatten)]
    pub model: ModelArguments,
    #[command(flatten)]
    pub spend: SpendArguments,
    /// Where actions are executed: `sim`, `arm`, or `exec:"CMD ARG..."`, a program of yours.
    #[arg(long, value_name = "WORLD", default_value = "sim")]
    pub world: WorldChoice,
    #[command(flatten)]
    #[serde(default)]
    pub arm: ArmArguments,
    /// With `--world arm`: plan the first action, print and draw it (plan.json, plan.png), and connect to no arm.
    #[arg(long)]
    #[serde(default)]
    pub plan_only: bool,
    #[command(flatten)]
    pub start: StartArguments,
    /// Ask at the end whether the task was reached, and if not, why. Default: with a real arm, unless `--confirm none` is
    /// given or stdin is not a terminal.
    #[arg(long)]
    #[serde(default)]
    pub operator: bool,
    #[command(flatten)]
    #[serde(default, skip_serializing_if = "VideoArguments::is_absent")]
    pub video: VideoArguments,
    #[command(flatten)]
    #[serde(skip)]
    pub events: EventArguments,
    /// The run folder; default: the next free `runs/TASK-NNNN`.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Name of the file in a run folder that records how the run was started.
pub const RUN_FILE: &str = "run.json";

/// How a run was started, so that it can be resumed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Begun {
    pub directory: PathBuf,
    pub arguments: RunArguments,
}

pub fn run(arguments: &RunArguments, io: &Io) -> Result<Exit, Failure> {
    arguments.arm.check_world(&arguments.world)?;
    arguments.video.check(&arguments.world)?;
    play(arguments, None, io)
}

/// Runs one rollout, from its start or from where it was cut off in the folder `resumed`, and reports it.
pub fn play(arguments: &RunArguments, resumed: Option<&Path>, io: &Io) -> Result<Exit, Failure> {
    let reasoning = arguments.model.reach.reasoning;
    let program = sources::compile_task(&arguments.task, io)?.with_reasoning(reasoning);
    let beside = sources::folder_of(&arguments.task.file);
    let examples = Examples::load(&program, &beside)?;
    let interrupt = io.interrupt()?;
    let purpose = arguments.spend.purpose();
    let deciding = Deciding::of(&arguments.policy, &arguments.model, purpose, &interrupt, io)?;
    let mut arm = None;
    let moving = [ArmMode::Execute, ArmMode::PlanOnly][usize::from(arguments.plan_only)];
    if arguments.world == WorldChoice::Arm {
        arm = Some(setting::arm::check(&arguments.arm, moving, io)?.settings);
    } else if arguments.plan_only {
        return Err(Failure::usage(
            "`--plan-only` plans for an arm: give `--world arm` and its settings, `--robot FILE`",
        ));
    }
    let first = match &arguments.world {
        WorldChoice::Program(command) => worlds::external(command, &program, None, &interrupt),
        _ => setting::world(&program),
    }?;
    if resumed.is_some() && !first.repeats() {
        return Err(Failure::environment(format!(
            "the world `{}` says that it cannot lay a start again exactly, so no rollout in it can be resumed: begin a new run",
            first.name()
        )));
    }
    let start = match &arm {
        Some(settings) if setting::arm::is_real(settings) => {
            setting::arm::start(&program, arguments.start.start.as_ref())?
        }
        _ => {
            let (options, world) = (&arguments.start, first.as_ref());
            setting::start(&program, &beside, options, world, &interrupt, io)?
        }
    };
    // A world that is a program is started again for the rollout, since a robot exists only once.
    drop(first);
    let shown = examples.demonstrations.as_ref();
    if let Some(number) = shown.and_then(|it| it.demonstrates(&start)) {
        return Err(Failure::environment(format!(
            "the start `{}` is that of demonstration {number}, which the model is shown: a result from it would not be a test; choose another start",
            start.name
        )));
    }
    // Lengths in `edge` and the flat area follow the actual cloth; subgoals show the task's own.
    let shown = program;
    let program = setting::fitted(&arguments.task, &shown, &start, io)?.with_reasoning(reasoning);
    let make_expert_world = || setting::world(&program);
    let mut world = make_expert_world()?;
    world.reset(&start)?;
    let subgoals = setting::subgoals(&shown, &beside, world.as_mut(), &interrupt)?;
    // The path of the arm's journal; nothing moves before it is known.
    let journal = OnceLock::new();
    // The film; the run folder, where it is written, is made later.
    let film = OnceLock::new();
    let make_world = || match &arguments.world {
        WorldChoice::Sim => {
            let world = SimulatedWorld::of(&program)?;
            Ok(Box::new(match film.get() {
                Some(recorder) => world.with_recorder(Recorder::clone(recorder)),
                None => world,
            }) as Box<dyn World>)
        }
        WorldChoice::Arm => {
            setting::arm::world(&program, &arguments.arm, moving, journal.get(), io)
        }
        WorldChoice::Program(command) => {
            let run = journal.get().map(PathBuf::as_path);
            worlds::external(command, &program, run, &interrupt)
        }
    };
    let make_look = || match &arguments.world {
        WorldChoice::Arm => setting::arm::look(&program, &arguments.arm),
        _ => setting::world(&program),
    };
    let asks_operator =
        |settings: &Settings| setting::arm::has_operator(&arguments.arm, settings, io);
    let has_operator = arguments.operator || arm.as_ref().is_some_and(asks_operator);
    say_pictures(&subgoals, &arguments.task.file, io);
    let policy = policies::in_words(&deciding.make().description());
    let title = program.title();
    io.talk(&format!("{title}: start {}, {policy}", start.name));
    let budget = models::budget(&arguments.spend, &interrupt);
    let terminal = TerminalOperator(io);
    let job = Job {
        program: &program,
        start: &start,
        subgoals: &subgoals,
        examples: &examples,
        make_policy: &deciding,
        budget: &budget,
        make_world: &make_world,
        make_expert_world: &make_expert_world,
        cache: &setting::cache(io),
        interrupt: &interrupt,
        horizon: None,
        early_stop: true,
        operator: if has_operator { Some(&terminal) } else { None },
        repetition: 0,
        start_number: None,
    };
    if let Some(answering) = deciding.answering() {
        let mut questions = Vec::new();
        if answering.asks_a_provider() || arguments.spend.estimate {
            // An estimate neither lays a cloth nor connects to anything.
            let look = Job {
                make_world: &make_look,
                ..job
            };
            questions = rollout::first_questions(&look, answering.models())?;
        }
        answering.check(&questions)?;
        if arguments.spend.estimate {
            let asking = Asking {
                program: &program,
                questions: &questions,
                answering,
                horizon: job.horizon(),
                rollouts: 1,
                fresh: &vec![1; questions.len()],
            };
            estimate::say(&estimate::estimate(&asking, io), arguments.json, io);
            return Ok(Exit::Done);
        }
    }
    deciding.make().prepare(&program)?;
    let events = arguments.events.open(arguments.json, io)?;
    let folder = match (resumed, &arguments.out) {
        (Some(path), _) => RunFolder::reopen(path),
        (None, Some(path)) => RunFolder::create(path),
        (None, None) => {
            RunFolder::create_next(Path::new("runs"), &program.title().replace('/', "-"))
        }
    }?;
    let _ = journal.set(folder.path().to_owned());
    if let Some(recorder) = arguments.video.recorder(&program, folder.path())? {
        let _ = film.set(recorder);
    }
    // From here on, only this process writes into the folder.
    let noted = ledger::read(folder.path())?;
    let spent = noted.spent;
    budget.restore(&spent);
    let earlier = folder.earlier_steps();
    if resumed.is_some() {
        let so_far = report::so_far(&spent);
        io.talk(&format!("resuming after step {earlier}{so_far}"));
    } else {
        let begun = Begun {
            directory: std::env::current_dir()?,
            arguments: arguments.clone(),
        };
        let kept = folder.keep(RUN_FILE, &serde_json::to_vec_pretty(&begun)?);
        kept.map_err(Failure::environment)?;
    }
    let run = folder.path().to_owned();
    let mut progress = Progress::after(earlier, &program, io);
    let done = rollout::run(&job, folder, &mut |event| {
        progress.show(&event);
        events.write(&run, event);
    });
    let may_have_moved = !arguments.plan_only && arm.as_ref().is_some_and(setting::arm::is_real);
    if may_have_moved && let Some(left) = preflight::to_recover(arguments.arm.robot()) {
        io.talk(&format!("note: this is how the arm was left: {left}"));
    }
    let video = film.get().map(|recorder| video::finish(recorder, io));
    let report = done.map_err(|error| match error {
        // An interrupt also ends the wait for a cloth, so that a failed start then counts as interrupted.
        RunError::World(WorldError::Start { .. } | WorldError::Interrupted)
            if interrupt.is_raised() =>
        {
            Failure::interrupted()
        }
        error => Failure::environment(error),
    })?;
    let judged = report.operator.as_ref().map(|judgement| judgement.reached);
    let exit = exit_of(report.outcome, report.goal_reached, judged);
    if let Some(settings) = arm.filter(|_| arguments.plan_only) {
        let planned = PlannedRun::of(report)?;
        events.result(arguments.json, &planned, || planned.text(&settings))?;
    } else {
        let ended = RunReport { report, video };
        events.result(arguments.json, &ended, || ended.text(program.goal.as_ref()))?;
    }
    Ok(exit)
}

/// Reports the origin of subgoal pictures if it is unusual.
pub fn say_pictures(subgoals: &SubgoalSet, file: &str, io: &Io) {
    let note = match subgoals.origin {
        Origin::Author | Origin::Pinned | Origin::Absent => return,
        Origin::PinnedByOther => {
            "note: the pinned subgoal pictures were drawn with other simulator parameters, colours or manners; {} draws them again"
        }
        Origin::Drawn => "no subgoal pictures are pinned: drawn for this run; {} pins them",
        Origin::DrawnAnew => {
            "warning: the pinned subgoal pictures are not all there as they were drawn, or show another fold, cloth or camera: drawn anew for this run; {} pins them"
        }
    };
    io.talk(&note.replace("{}", &format!("`fabc subgoals {file}`")));
}

/// Returns the exit code for an outcome; `goal_reached` is `None` without a goal, `judged` without an operator.
pub fn exit_of(outcome: Outcome, goal_reached: Option<bool>, judged: Option<bool>) -> Exit {
    match outcome {
        // A person who saw the cloth overrides the measure.
        Outcome::GoalReached | Outcome::HorizonReached if judged == Some(false) => Exit::Unreached,
        Outcome::GoalReached | Outcome::Planned => Exit::Done,
        Outcome::HorizonReached if goal_reached.is_none() => Exit::Done,
        Outcome::ModelFailed | Outcome::PolicyFailed | Outcome::WorldFailed => Exit::Environment,
        Outcome::Interrupted => Exit::Interrupted,
        Outcome::HorizonReached
        | Outcome::AttemptsExhausted
        | Outcome::MalformedReply
        | Outcome::NoCandidates
        | Outcome::ClothOutOfView
        | Outcome::PolicyStopped
        | Outcome::RehearsalRefused
        | Outcome::BudgetExhausted => Exit::Unreached,
    }
}
