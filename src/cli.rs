//! The command line.

#[cfg(feature = "runtime")]
pub mod bench;
#[cfg(all(test, feature = "runtime"))]
mod book;
#[cfg(feature = "runtime")]
pub mod calibrate;
pub mod completions;
#[cfg(feature = "runtime")]
pub mod model_arguments;
#[cfg(feature = "runtime")]
pub mod models;
pub mod new;
pub mod render;
pub mod review;
#[cfg(feature = "runtime")]
pub mod robot;
#[cfg(feature = "runtime")]
pub mod sim;
pub mod snap;
#[cfg(feature = "runtime")]
pub mod world;

#[cfg(feature = "runtime")]
use crate::setting::worlds::WorldChoice;
use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint};
#[cfg(feature = "runtime")]
use fab_model::calls::Usd;
#[cfg(feature = "runtime")]
use fab_program::PixelPoint;
#[cfg(feature = "runtime")]
use model_arguments::{ModelArguments, PolicyArguments, SpendArguments, dollars};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

const EXIT_CODES: &str = "Exit codes: 0 done (and the goal reached), 1 the .fab file is wrong, 2 the environment failed, \
3 ended without reaching the goal, 64 wrong usage, 130 interrupted.";

/// Compiles cloth-manipulation tasks (.fab) to prompts and a verifier, and runs them.
#[derive(Parser)]
#[command(name = "fabc", version, after_help = EXIT_CODES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub verb: Verb,
}

/// What to do.
#[derive(Subcommand)]
pub enum Verb {
    /// Writes a commented task that runs at once.
    New(new::NewArguments),
    /// Says what is wrong with .fab files, and repairs what is certain.
    Check(CheckArguments),
    /// Runs the tests that tasks carry: what comes of an answer, without a model or a camera.
    Test(TestArguments),
    /// Says what a diagnostic means and what to do, by an example.
    Explain(ExplainArguments),
    /// Lists every word of the language with its arguments, ranges and meaning.
    Vocabulary(VocabularyArguments),
    /// Prints the exact messages that a model gets, without asking one.
    Render(render::RenderArguments),
    /// Pins what tasks say to models as snapshots beside their files; `--check` fails where they differ.
    Snap(snap::SnapArguments),
    /// Writes tasks as prompt templates, an answer schema and verifiers for other systems.
    Build(BuildArguments),
    /// Shows what changed in prompts, scenes and pictures, and accepts or rejects it.
    Review(review::ReviewArguments),
    /// Finds a task's keypoints in a picture of yours, and draws its layers on it, without a model.
    #[cfg(feature = "runtime")]
    See(SeeArguments),
    /// Draws the subgoal pictures of a task from its demonstration and pins them beside the file.
    #[cfg(feature = "runtime")]
    Subgoals(SubgoalsArguments),
    /// Folds as the scripted expert does, and writes what a model would have answered as in-context examples.
    #[cfg(feature = "runtime")]
    Demos(DemosArguments),
    /// Runs one rollout of a task.
    #[cfg(feature = "runtime")]
    Run(RunArguments),
    /// Goes on with a rollout that was cut off or stopped, from its last whole step; no answer is bought twice.
    #[cfg(feature = "runtime")]
    Resume(ResumeArguments),
    /// Runs a suite of many rollouts, and prints its table with others' figures beside ours.
    #[cfg(feature = "runtime")]
    Bench(bench::BenchArguments),
    /// Measures where the camera's pixels lie for the arm, from points that it touched.
    #[cfg(feature = "runtime")]
    Calibrate(calibrate::CalibrateArguments),
    /// Looks after an arm: whether its settings can be used, and what a run left it in.
    #[cfg(feature = "runtime")]
    Robot(robot::RobotArguments),
    /// Lists what is known of models: prices, pictures, coordinates, shutdown dates, each with its source.
    #[cfg(feature = "runtime")]
    Models(models::ModelsArguments),
    /// Says what is set up, what is missing, and how to set it up.
    #[cfg(feature = "runtime")]
    Doctor(models::DoctorArguments),
    /// Finds out how a model says where something is in a picture, with two questions.
    #[cfg(feature = "runtime")]
    Probe(models::ProbeArguments),
    /// Offers an embedded model or a recording as an OpenAI-compatible endpoint on this machine.
    #[cfg(feature = "runtime")]
    Serve(models::ServeArguments),
    /// Works on the cloth simulator itself: replays, speed, starts, pictures, meshes.
    #[cfg(feature = "runtime")]
    Sim(sim::SimArguments),
    /// Checks a world of yours, a program in any language, against what every world promises.
    #[cfg(feature = "runtime")]
    World(world::WorldArguments),
    /// Writes what a shell needs to complete words of this command line.
    Completions(completions::CompletionsArguments),
}

impl Verb {
    /// Returns whether stdout must be one JSON document, whatever happens.
    pub fn wants_json(&self) -> bool {
        match self {
            Verb::New(arguments) => arguments.what.wants_json(),
            Verb::Check(arguments) => arguments.json,
            Verb::Test(arguments) => arguments.json,
            Verb::Explain(_) | Verb::Completions(_) => false,
            Verb::Vocabulary(arguments) => arguments.json,
            Verb::Render(arguments) => arguments.json,
            Verb::Snap(arguments) => arguments.json,
            Verb::Build(arguments) => arguments.json,
            Verb::Review(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::See(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::Subgoals(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::Demos(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::Run(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::Resume(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::Bench(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::Calibrate(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::World(arguments) => arguments.verb.wants_json(),
            #[cfg(feature = "runtime")]
            Verb::Robot(arguments) => arguments.verb.wants_json(),
            #[cfg(feature = "runtime")]
            Verb::Models(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::Doctor(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::Probe(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::Serve(arguments) => arguments.json,
            #[cfg(feature = "runtime")]
            Verb::Sim(arguments) => arguments.verb.wants_json(),
        }
    }
}

/// Arguments of `check`.
#[derive(Args)]
pub struct CheckArguments {
    /// The files to check.
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub files: Vec<String>,
    /// Repair what can be meant in one way only; the rest is reported.
    #[arg(long)]
    pub fix: bool,
    /// Do it again whenever a file that it used changes, until Ctrl-C.
    #[arg(long, conflicts_with = "json")]
    pub watch: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `test`.
#[derive(Args)]
pub struct TestArguments {
    /// The files whose tests are run.
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub files: Vec<String>,
    /// Only tests whose name contains this.
    #[arg(long, value_name = "WORDS")]
    pub only: Option<String>,
    /// Do it again whenever a file that it used changes, until Ctrl-C.
    #[arg(long, conflicts_with = "json")]
    pub watch: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Which task of a file is meant.
#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct TaskArguments {
    /// The file that declares the task.
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: String,
    /// The task, where the file declares several.
    #[arg(long, value_name = "NAME")]
    pub task: Option<String>,
    /// The variant of the task; default: the task itself.
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
}

/// Arguments of `explain`.
#[derive(Args)]
pub struct ExplainArguments {
    /// The code of a message, such as F0203; default: list all codes.
    #[arg(value_name = "CODE")]
    pub code: Option<String>,
    /// Write a page of Markdown for each code, and `index.md`, into this folder.
    #[arg(long, value_name = "DIR", conflicts_with = "code")]
    pub pages: Option<PathBuf>,
}

/// Arguments of `vocabulary`.
#[derive(Args)]
pub struct VocabularyArguments {
    /// Print one JSON document, for editors.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `build`.
#[derive(Args)]
pub struct BuildArguments {
    /// The file that declares the tasks.
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: String,
    /// The folder that gets one folder per task.
    #[arg(short = 'o', long = "out", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: PathBuf,
    /// Only this task.
    #[arg(long, value_name = "NAME")]
    pub task: Option<String>,
    /// What is written beside the prompts and the schema.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "program")]
    pub emit: Vec<EmitArgument>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// What `build` writes beside the prompts and the schema.
#[derive(Clone, Copy, ValueEnum)]
pub enum EmitArgument {
    /// program.json: the whole task as data, and the list of the other files.
    Program,
    /// verifier.rs: the checks as a Rust module without dependencies.
    Rust,
    /// verifier.py: the checks as a Python module without dependencies.
    Python,
}

/// Where the cloth lies at first.
#[cfg(feature = "runtime")]
#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct StartArguments {
    /// Particle positions (.npy), or a seed that turns the flat cloth; default: flat and straight.
    #[arg(long, value_name = "FILE.npy|SEED", value_hint = ValueHint::FilePath)]
    pub start: Option<String>,
    #[command(flatten)]
    pub frame: FrameArguments,
}

/// How the numbers of a file of particle positions are to be understood.
#[cfg(feature = "runtime")]
#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct FrameArguments {
    /// Grid of the .npy file, where nothing beside it says: particles along its x and its other side.
    #[arg(long, value_name = "55x44", requires = "up")]
    pub dims: Option<String>,
    /// Axis of the .npy file that points up, where nothing beside it says.
    #[arg(long, value_name = "AXIS", requires = "dims", value_parser = ["y", "z"])]
    pub up: Option<String>,
}

/// Arguments of `see`.
#[cfg(feature = "runtime")]
#[derive(Args)]
pub struct SeeArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    /// The picture, of the size that the task's camera takes.
    #[arg(long, value_name = "PNG", value_hint = ValueHint::FilePath)]
    pub image: PathBuf,
    /// Its depth, in grey: 255 levels a metre in 8 bits, or millimetres in 16; 0 is no reading.
    #[arg(long, value_name = "PNG", value_hint = ValueHint::FilePath)]
    pub depth: Option<PathBuf>,
    /// Where the action before this one placed the cloth, for layers that show it.
    #[arg(long, value_name = "U,V", value_parser = crate::see::pixel, allow_hyphen_values = true)]
    pub last_place: Option<PixelPoint>,
    /// Where it picked it.
    #[arg(long, value_name = "U,V", value_parser = crate::see::pixel, allow_hyphen_values = true, requires = "last_place")]
    pub last_pick: Option<PixelPoint>,
    /// Write a picture of each keypoint and layer into this folder, and `annotated.png`, what a model would see.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `subgoals`.
#[cfg(feature = "runtime")]
#[derive(Args)]
pub struct SubgoalsArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    /// Also draw all pictures with their arrows on one sheet.
    #[arg(long, value_name = "PNG", value_hint = ValueHint::FilePath)]
    pub sheet: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `demos`.
#[cfg(feature = "runtime")]
#[derive(Args)]
pub struct DemosArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    /// How many demonstrations, each from a start of its own; every one gives an example for each step.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub count: u32,
    /// Draws the starts.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// The file; default: the one that the task names.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `run`.
#[cfg(feature = "runtime")]
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
    /// Where actions are executed: `sim`, `jaco`, or `exec:"CMD ARG..."`, a program of yours.
    #[arg(long, value_name = "WORLD", default_value = "sim")]
    pub world: WorldChoice,
    #[command(flatten)]
    #[serde(default)]
    pub arm: robot::ArmArguments,
    /// With `--world jaco`: plan the first action, print and draw it (plan.json, plan.png), and connect to no arm.
    #[arg(long)]
    #[serde(default)]
    pub plan_only: bool,
    #[command(flatten)]
    pub start: StartArguments,
    /// Ask at the end whether the task was reached, and if not, why. Default: with a real arm, unless `--confirm none` is
    /// said or stdin is no terminal.
    #[arg(long)]
    #[serde(default)]
    pub operator: bool,
    /// The run folder; default: the next free `runs/TASK-NNNN`.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `resume`.
#[cfg(feature = "runtime")]
#[derive(Args)]
pub struct ResumeArguments {
    /// The run folder.
    #[arg(value_name = "RUN", value_hint = ValueHint::DirPath)]
    pub run: PathBuf,
    /// Another cap on what the whole run may cost, US dollars.
    #[arg(long, value_name = "USD", value_parser = dollars)]
    pub max_cost: Option<Usd>,
    /// Another cap on the calls of the whole run.
    #[arg(long, value_name = "N")]
    pub max_calls: Option<u64>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}
