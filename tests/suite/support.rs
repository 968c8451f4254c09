//! Code shared by the tests: the command, recorded data, small tasks, scripted models.

use fab_agent::arm_sight::SIGHT;
use fab_agent::examples::Examples;
use fab_agent::journal::RunFolder;
use fab_agent::policy::{MakePolicy, Prompted};
use fab_agent::record::RECORD_FILE;
use fab_agent::rollout;
use fab_agent::rollout::{Ended, Event, Job, RunError};
use fab_agent::subgoals::SubgoalSet;
use fab_arm::supervisor::{NoWatchdog, Supervisor};
use fab_arm::world::{ArmWorld, Files, Parts};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_compiler::{LoadError, Loader};
use fab_model::Models;
use fab_model::calls::{Budget, Calls};
use fab_model::{Model, ModelError, ModelKind, Part, Reply, Request};
use fab_program::Program;
use fab_standins::Geometric;
use fab_world::expert::MakeWorld;
use fab_world::start::Start;
use fab_world::{Look, SimulatedWorld, World, WorldError};
use std::collections::{BTreeMap, VecDeque};
use std::ffi::{OsStr, OsString};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;

/// The project's root.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A path below the project's root, as text.
pub fn project(path: &str) -> String {
    root().join(path).display().to_string()
}

/// The command in this working folder, with an expert cache that all tests share.
pub fn fabc(folder: &Path) -> Fabc {
    Fabc {
        folder: folder.to_owned(),
        arguments: Vec::new(),
        variables: BTreeMap::from([
            ("NO_COLOR".into(), "1".into()),
            (
                "FABC_CACHE_DIR".into(),
                root().join("target/test-cache").into(),
            ),
        ]),
        removed: Vec::new(),
        stdin: Vec::new(),
        program: env!("CARGO_BIN_EXE_fabc").into(),
    }
}

/// A command that is built like a [`Command`].
pub struct Fabc {
    folder: PathBuf,
    arguments: Vec<OsString>,
    variables: BTreeMap<OsString, OsString>,
    removed: Vec<OsString>,
    stdin: Vec<u8>,
    program: PathBuf,
}

impl Fabc {
    pub fn arg(&mut self, argument: impl AsRef<OsStr>) -> &mut Fabc {
        self.arguments.push(argument.as_ref().to_owned());
        self
    }

    pub fn args(&mut self, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> &mut Fabc {
        for argument in arguments {
            self.arg(argument);
        }
        self
    }

    pub fn env(&mut self, name: impl AsRef<OsStr>, value: impl AsRef<OsStr>) -> &mut Fabc {
        let (name, value) = (name.as_ref().to_owned(), value.as_ref().to_owned());
        self.variables.insert(name, value);
        self
    }

    /// Removes a variable from the environment of a separate process.
    pub fn env_remove(&mut self, name: impl AsRef<OsStr>) -> &mut Fabc {
        self.variables.remove(name.as_ref());
        self.removed.push(name.as_ref().to_owned());
        self
    }

    /// Sets the bytes that are typed or piped to it.
    pub fn stdin(&mut self, bytes: impl Into<Vec<u8>>) -> &mut Fabc {
        self.stdin = bytes.into();
        self
    }

    /// Runs the program at another path, which is a link to it.
    pub fn program(&mut self, path: PathBuf) -> &mut Fabc {
        self.program = path;
        self
    }

    /// Returns it as a process to start.
    pub fn process(&self) -> Command {
        let mut command = Command::new(&self.program);
        command
            .current_dir(&self.folder)
            .args(&self.arguments)
            .envs(&self.variables);
        for name in &self.removed {
            command.env_remove(name);
        }
        command
    }
}

/// The output of a finished command.
#[derive(Debug)]
pub struct Captured {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

/// Runs a command to its end, with its own environment alone.
pub fn finish(command: &mut Fabc) -> Captured {
    let inherited = ["PATH", "TMPDIR", "LD_LIBRARY_PATH"];
    let inherited = inherited.map(|name| (name, std::env::var_os(name)));
    let mut process = Command::new(&command.program);
    process
        .env_clear()
        .env("HOME", root().join("target/test-home"))
        .envs(
            inherited
                .into_iter()
                .filter_map(|(name, value)| Some((name, value?))),
        )
        .envs(&command.variables)
        .current_dir(&command.folder)
        .args(&command.arguments);
    process
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut running = process.spawn().unwrap();
    // A command that does not read its input closes the pipe.
    let _ = running.stdin.take().unwrap().write_all(&command.stdin);
    captured(running.wait_with_output().unwrap())
}

/// Runs a process to its end.
pub fn finish_process(command: &mut Command) -> Captured {
    captured(command.output().unwrap())
}

fn captured(output: Output) -> Captured {
    Captured {
        code: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// Reads source files from the project.
pub struct ProjectFiles;

impl Loader for ProjectFiles {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        std::fs::read_to_string(root().join(name)).map_err(|error| LoadError {
            message: error.to_string(),
        })
    }
}

/// Compiles a shipped task.
pub fn task(name: &str) -> Program {
    let compiled = fab_compiler::compile(&format!("tasks/{name}.fab"), &ProjectFiles).unwrap();
    assert!(
        compiled.diagnostics.is_empty(),
        "{:?}",
        compiled.diagnostics
    );
    compiled.programs.into_iter().next().unwrap()
}

/// Copies the shipped libraries beside a test's own task.
pub fn bring_library(folder: &Path) {
    std::fs::create_dir_all(folder.join("lib")).unwrap();
    for entry in std::fs::read_dir(root().join("tasks/lib")).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), folder.join("lib").join(entry.file_name())).unwrap();
    }
}

/// Writes the shipped settings of the simulated arm as `robot.toml`, with edits, beside its calibration.
pub fn bring_robot(folder: &Path, edits: &[(&str, &str)]) {
    let shipped = root().join("tasks/real");
    let mut settings = std::fs::read_to_string(shipped.join("simulated.toml")).unwrap();
    for (from, to) in edits {
        assert!(settings.contains(from), "{from}");
        settings = settings.replace(from, to);
    }
    std::fs::write(folder.join("robot.toml"), settings).unwrap();
    for ending in ["toml", "png"] {
        let name = format!("simulated.calibration.{ending}");
        std::fs::copy(shipped.join(&name), folder.join(&name)).unwrap();
    }
}

/// A shipped task on a cloth so small that a rollout takes a moment. It has no goal and does not check results, since
/// so small a pack lies differently each time.
pub fn small_task() -> Program {
    let mut program = task("double_triangle");
    program.verify.result = None;
    program.cloth.dimx = 28;
    program.cloth.dimy = 28;
    program.experts.clear();
    program.goal = None;
    program
}

/// A fresh simulated world for a program.
pub fn world(program: &Program) -> Result<Box<dyn World>, WorldError> {
    Ok(Box::new(SimulatedWorld::new(
        &program.camera,
        program.picker,
    )?))
}

/// The simulated arm that these settings describe, without a watchdog.
///
/// - `folder`: where it keeps the journal of its motions.
pub fn simulated_arm(
    robot: &Path,
    image_px: u32,
    supervisor: Box<dyn Supervisor>,
    folder: Option<&Path>,
) -> ArmWorld {
    let parts = Parts {
        files: Files::load(robot).unwrap(),
        sight: SIGHT,
        material: None,
        image_px,
        supervisor,
        watchdog: Box::new(NoWatchdog),
        folder: folder.map(Path::to_owned),
    };
    ArmWorld::simulated(parts).unwrap()
}

/// Everything about a rollout except its models; a test changes the fields that matter to it.
pub struct Trial<'p> {
    pub program: &'p Program,
    pub start: Start,
    pub examples: Examples,
    pub subgoals: SubgoalSet,
    pub look: Look,
    pub cache: Cache,
    pub interrupt: Interrupt,
    pub horizon: Option<u32>,
    pub early_stop: bool,
    pub repetition: u32,
    pub start_number: Option<u64>,
    pub budget: Budget,
}

impl<'p> Trial<'p> {
    /// A rollout from the flat cloth, with the pictures that are pinned or drawn for a task in `folder`.
    pub fn new(program: &'p Program, folder: &Path, look: Look) -> Trial<'p> {
        let interrupt = Interrupt::default();
        let mut world = SimulatedWorld::new(&program.camera, program.picker)
            .unwrap()
            .with_look(look.clone());
        let subgoals = SubgoalSet::obtain(program, folder, &mut world, &interrupt).unwrap();
        let start = Start::flat(&program.cloth);
        Trial {
            program,
            start,
            subgoals,
            examples: Examples::load(program, folder).unwrap(),
            look,
            cache: Cache::none(),
            interrupt,
            horizon: None,
            early_stop: true,
            repetition: 0,
            start_number: None,
            budget: Budget::default(),
        }
    }

    /// Runs it with the stand-in in both roles, into the new folder `run`.
    pub fn run_stand_in(&self, run: &Path) -> Ended {
        let models = Models {
            vision: &Geometric,
            text: &Geometric,
        };
        self.run(models, run, &mut |_| {})
    }

    /// Runs it into the new folder `run`, or resumes the rollout in that folder.
    pub fn run(&self, models: Models<'_>, run: &Path, watch: &mut dyn FnMut(Event)) -> Ended {
        self.try_run(models, run, watch).unwrap()
    }

    /// Does the same; returns an error if it cannot be executed or recorded.
    pub fn try_run(
        &self,
        models: Models<'_>,
        run: &Path,
        watch: &mut dyn FnMut(Event),
    ) -> Result<Ended, RunError> {
        self.decided(&Prompted::new(models), run, watch)
    }

    /// Does the same with a policy that does not ask models.
    pub fn decided(
        &self,
        make_policy: &dyn MakePolicy,
        run: &Path,
        watch: &mut dyn FnMut(Event),
    ) -> Result<Ended, RunError> {
        let make_world = || -> Result<Box<dyn World>, WorldError> {
            let world = SimulatedWorld::new(&self.program.camera, self.program.picker)?;
            Ok(Box::new(world.with_look(self.look.clone())))
        };
        self.decided_in(&make_world, make_policy, run, watch)
    }

    /// Does the same in another world.
    pub fn decided_in(
        &self,
        make_world: &MakeWorld<'_>,
        make_policy: &dyn MakePolicy,
        run: &Path,
        watch: &mut dyn FnMut(Event),
    ) -> Result<Ended, RunError> {
        let job = Job {
            program: self.program,
            start: &self.start,
            subgoals: &self.subgoals,
            examples: &self.examples,
            make_policy,
            budget: &self.budget,
            make_world,
            make_expert_world: make_world,
            cache: &self.cache,
            interrupt: &self.interrupt,
            horizon: self.horizon,
            early_stop: self.early_stop,
            operator: None,
            repetition: self.repetition,
            start_number: self.start_number,
        };
        let folder = match run.join(RECORD_FILE).exists() {
            true => RunFolder::reopen(run),
            false => RunFolder::create(run),
        };
        rollout::run(&job, folder.unwrap(), watch)
    }
}

/// A model that gives scripted answers and records its questions.
pub struct Scripted {
    replies: Mutex<VecDeque<String>>,
    pub asked: Mutex<Vec<Request>>,
}

impl Scripted {
    pub fn new(replies: &[&str]) -> Scripted {
        Scripted {
            replies: Mutex::new(replies.iter().map(|reply| (*reply).to_owned()).collect()),
            asked: Mutex::default(),
        }
    }
}

impl Model for Scripted {
    fn name(&self) -> &str {
        "scripted"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        self.asked.lock().unwrap().push(request.clone());
        let reply = self.replies.lock().unwrap().pop_front();
        reply
            .map(Reply::text)
            .ok_or_else(|| ModelError::Unsupported {
                model: "scripted".to_owned(),
                why: "the script is over".to_owned(),
            })
    }
}

/// The stand-in, except that some of its actions place on the center.
pub struct Careless<F> {
    /// Whether the action that a request asks for is such a one.
    is_wrong: F,
    pub asked: Mutex<Vec<Request>>,
}

impl<F: Fn(&Request) -> bool + Send + Sync> Careless<F> {
    pub fn where_wrong(is_wrong: F) -> Careless<F> {
        Careless {
            is_wrong,
            asked: Mutex::default(),
        }
    }
}

impl<F: Fn(&Request) -> bool + Send + Sync> Model for Careless<F> {
    fn name(&self) -> &str {
        "careless"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        self.asked.lock().unwrap().push(request.clone());
        let reply = Geometric.ask(request, calls)?;
        let Some((pick, _)) = reply.text.split_once("Place Point = ") else {
            return Ok(reply);
        };
        if !(self.is_wrong)(request) {
            return Ok(reply);
        }
        let asked = words_of(request);
        let (_, center) = asked.rsplit_once("- Cloth center: ").unwrap();
        let center = center.lines().next().unwrap();
        Ok(Reply::text(format!("{pick}Place Point = {center}\n")))
    }
}

/// All text of a request, each part on its own lines.
pub fn words_of(request: &Request) -> String {
    let parts = request.messages.iter().flat_map(|message| &message.parts);
    let texts = parts.filter_map(|part| match part {
        Part::Text(text) => Some(text.as_str()),
        Part::Image(_) => None,
    });
    texts.collect::<Vec<_>>().join("\n")
}

/// Sends a process what Ctrl-C sends. The program `kill` is no part of a bare Debian.
#[cfg(unix)]
pub fn interrupt(process: u32) {
    use nix::sys::signal::{Signal, kill};
    kill(nix::unistd::Pid::from_raw(process as i32), Signal::SIGINT).unwrap();
}
