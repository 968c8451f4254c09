//! Verbs that need the simulator, pictures, models or an arm: those that exist only with the feature `runtime`.
//!
//! [`setting`] has what several of them need besides a program.

pub mod bench;
pub mod best;
pub mod calibrate;
pub mod demos;
pub mod doctor;
pub mod models;
pub mod probe;
pub mod resume;
pub mod robot;
pub mod run;
pub mod see;
pub mod sim;
pub mod subgoals;
pub mod world;

pub mod estimate;
pub mod events;
pub mod operator;
pub mod setting;
pub mod step_scene;
pub mod video;

super::verbs! {
    /// Verbs that need the runtime.
    Verb:
    /// Finds a task's keypoints in a picture of yours, and draws its layers on it, without a model.
    See(see::SeeArguments),
    /// Draws the subgoal pictures of a task from its demonstration and pins them beside the file.
    Subgoals(subgoals::SubgoalsArguments),
    /// Runs the scripted expert and writes its actions as in-context examples.
    Demos(demos::DemosArguments),
    /// Runs one rollout of a task.
    Run(run::RunArguments),
    /// Resumes a rollout that was interrupted, stopped or lost its model, after its last complete step; no answer is bought
    /// twice. A rollout of an arm is refused.
    Resume(resume::ResumeArguments),
    /// Runs a suite of many rollouts, and prints its table, with published figures beside it.
    Bench(bench::BenchArguments),
    /// Searches the best that any answers to a task could do in the simulator, and what limits it.
    Best(best::BestArguments),
    /// Calibrates the camera to the arm's base frame, from points that the arm touched.
    Calibrate(calibrate::CalibrateArguments),
    /// Checks an arm's settings, and recovers the arm after a run.
    #[command(subcommand)]
    Robot(robot::RobotVerb),
    /// Lists what is known of models: prices, pictures, coordinates, each with its date.
    Models(models::ModelsArguments),
    /// Checks the setup: what works, what is missing, and how to install it.
    Doctor(doctor::DoctorArguments),
    /// Finds out how a model states positions in a picture, and what its interface refuses.
    Probe(probe::ProbeArguments),
    /// Works on the cloth simulator itself: replays, speed, starts, pictures, meshes.
    #[command(subcommand)]
    Sim(sim::SimVerb),
    /// Checks that your own world, a program in any language, meets the requirements of a world.
    #[command(subcommand)]
    World(world::WorldVerb),
}

impl Verb {
    /// Returns the argument that names a task's file; a shipped task may be named instead.
    pub fn file(&mut self) -> Option<&mut String> {
        let task = match self {
            Verb::See(see) => &mut see.task,
            Verb::Subgoals(subgoals) => &mut subgoals.task,
            Verb::Demos(demos) => &mut demos.task,
            Verb::Run(run) => &mut run.task,
            Verb::Best(best) => &mut best.task,
            Verb::Resume(_)
            | Verb::Bench(_)
            | Verb::Calibrate(_)
            | Verb::Robot(_)
            | Verb::Models(_)
            | Verb::Doctor(_)
            | Verb::Probe(_)
            | Verb::Sim(_)
            | Verb::World(_) => return None,
        };
        Some(&mut task.file)
    }
}
