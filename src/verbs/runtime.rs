//! Verbs that need the simulator, pictures, models or an arm; this is the only gate for the feature `runtime`.
//!
//! [`setting`] has what several of them need besides a program.

pub mod bench;
pub mod calibrate;
pub mod demos;
pub mod doctor;
pub mod models;
pub mod probe;
pub mod resume;
pub mod robot;
pub mod run;
pub mod see;
pub mod serve;
pub mod sim;
pub mod subgoals;
pub mod world;

pub mod estimate;
pub mod look;
pub mod operator;
pub mod setting;

super::verbs! {
    /// Verbs that need the runtime.
    Verb:
    /// Finds a task's keypoints in a picture of yours, and draws its layers on it, without a model.
    See(see::SeeArguments),
    /// Draws the subgoal pictures of a task from its demonstration and pins them beside the file.
    Subgoals(subgoals::SubgoalsArguments),
    /// Folds as the scripted expert does, and writes what a model would have answered as in-context examples.
    Demos(demos::DemosArguments),
    /// Runs one rollout of a task.
    Run(run::RunArguments),
    /// Goes on with a rollout that was cut off or stopped, from its last whole step; no answer is bought twice.
    Resume(resume::ResumeArguments),
    /// Runs a suite of many rollouts, and prints its table with others' figures beside ours.
    Bench(bench::BenchArguments),
    /// Measures where the camera's pixels lie for the arm, from points that it touched.
    Calibrate(calibrate::CalibrateArguments),
    /// Looks after an arm: whether its settings can be used, and what a run left it in.
    Robot(robot::RobotArguments),
    /// Lists what is known of models: prices, pictures, coordinates, shutdown dates, each with its source.
    Models(models::ModelsArguments),
    /// Says what is set up, what is missing, and how to set it up.
    Doctor(doctor::DoctorArguments),
    /// Finds out how a model says where something is in a picture, with two questions.
    Probe(probe::ProbeArguments),
    /// Offers an embedded model or a recording as an OpenAI-compatible endpoint on this machine.
    Serve(serve::ServeArguments),
    /// Works on the cloth simulator itself: replays, speed, starts, pictures, meshes.
    Sim(sim::SimArguments),
    /// Checks a world of yours, a program in any language, against what every world promises.
    World(world::WorldArguments),
}

impl Verb {
    /// Returns the argument that names a task's file.
    pub fn file(&mut self) -> Option<&mut String> {
        let task = match self {
            Verb::See(see) => &mut see.task,
            Verb::Subgoals(subgoals) => &mut subgoals.task,
            Verb::Demos(demos) => &mut demos.task,
            Verb::Run(run) => &mut run.task,
            _ => return None,
        };
        Some(&mut task.file)
    }
}
