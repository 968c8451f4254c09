//! A world that is a user's program, in any language: another simulator, or their own robot.
//!
//! In: one line of JSON per question. Out: one line per answer, files by their paths. `docs/worlds.md` documents both.
//! Every answer is checked here before anybody uses it.

use crate::protocol::{
    Arrangement, CameraView, ClothState, Hello, LIMITS_S, Nothing, PROTOCOL, Positions, Question,
    ReachAnswer,
};
use crate::start::Start;
use crate::{Executed, Motion, World, WorldError, WorldPoint, simulated, unknown_manner};
use fab_base::child::{Child, ChildError, CommandLine};
use fab_base::interrupt::Interrupt;
use fab_base::wording::{counted, quoted};
use fab_base::{files, npy};
use fab_picture::observation::Observation;
use fab_picture::{DepthImage, dropouts, png};
use fab_program as program;
use fab_program::{Cloth, ClothStart, MANNERS, Picker, manner_field};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::cell::RefCell;
use std::path::Path;
use std::time::Duration;
use tempfile::TempDir;

/// The file in the run folder that receives the program's stderr.
pub const STDERR_FILE: &str = "world.stderr.txt";

/// The longest time limit that a program may state, seconds.
const MAX_LIMIT_S: u64 = 3600;

/// How long a program may take to stop after an interrupt.
const HALT_LIMIT: Duration = Duration::from_secs(5);

/// The largest array accepted, bytes.
const MAX_ARRAY_BYTES: u64 = 256 << 20;

/// A world run by a program.
pub struct ExternalWorld {
    child: RefCell<Child>,
    about: Hello,
    /// Files exchanged with the program; removed at the end.
    folder: TempDir,
    camera: program::Camera,
    picker: Picker,
    material: Option<program::Material>,
    interrupt: Interrupt,
    is_laid: bool,
    /// How many starts were written.
    n_starts: RefCell<u32>,
    particles: Option<Vec<[f32; 3]>>,
    /// The error of a question whose caller cannot fail; the next caller that can reports it.
    failed: RefCell<Option<String>>,
}

enum Answered<T> {
    Given(T),
    Refused(String),
}

impl ExternalWorld {
    /// Returns what the program says about itself.
    pub fn hello(&self) -> &Hello {
        &self.about
    }

    /// Starts a program and asks for its description.
    ///
    /// - `run`: the run folder, where its stderr is kept.
    pub fn start(
        command: &CommandLine,
        camera: &program::Camera,
        picker: Picker,
        run: Option<&Path>,
        interrupt: &Interrupt,
    ) -> Result<ExternalWorld, WorldError> {
        let failed = |why: String| WorldError::Program { why };
        let folder = tempfile::Builder::new().prefix("fabc-world-").tempdir();
        let folder = folder.map_err(|error| failed(error.to_string()))?;
        if folder.path().to_str().is_none() {
            return Err(failed(format!(
                "the folder for files, `{}`, is not UTF-8, so no line can name it: set TMPDIR to another one",
                folder.path().display()
            )));
        }
        let stderr = run.map(|run| run.join(STDERR_FILE));
        let mut child = Child::start(command, stderr.as_deref()).map_err(of_child)?;
        let hello = Question::Hello {
            protocol: PROTOCOL,
            folder: folder.path().to_owned(),
        };
        let limit = Duration::from_secs(limit_s("hello"));
        let about: Value = child.ask(&hello, limit, interrupt).map_err(of_child)?;
        if let Some(refused) = about.get("refused").and_then(Value::as_str) {
            return Err(failed(format!("`{command}` refuses `hello`: {refused}")));
        }
        let about = Hello::deserialize(&about)
            .map_err(|error| failed(format!("`{command}` answers `hello` wrongly: {error}")))?;
        if let Some(fault) = fault(&about) {
            return Err(failed(format!("`{command}` {fault}")));
        }
        Ok(ExternalWorld {
            child: RefCell::new(child),
            about,
            folder,
            camera: camera.clone(),
            picker,
            material: None,
            interrupt: interrupt.clone(),
            is_laid: false,
            n_starts: RefCell::new(0),
            particles: None,
            failed: RefCell::default(),
        })
    }

    /// Says what every cloth is made of; fails if the program knows no materials.
    pub fn with_material(
        self,
        material: Option<&program::Material>,
    ) -> Result<ExternalWorld, WorldError> {
        if let Some(material) = material.filter(|_| !self.about.materials) {
            return Err(self.wrong(format!(
                "its `hello` does not say `\"materials\": true`, and the task's cloth is made of `{}`",
                material.name
            )));
        }
        Ok(ExternalWorld {
            material: material.map(program::Material::without_sources),
            ..self
        })
    }

    /// Asks a question. If it is interrupted, the program is interrupted too, and its last line counts.
    fn ask<T: DeserializeOwned>(
        &self,
        question: &Question,
        interrupt: &Interrupt,
    ) -> Result<Answered<T>, WorldError> {
        let name = question.name();
        if let Some(why) = self.failed.borrow_mut().take() {
            return Err(WorldError::Program { why });
        }
        let own = self.about.limits_s.get(name).copied();
        let limit = Duration::from_secs(own.unwrap_or_else(|| limit_s(name)));
        let mut child = self.child.borrow_mut();
        child.send(question).map_err(of_child)?;
        let line = match child.receive(limit, interrupt) {
            Err(ChildError::Interrupted) => {
                child.tell(&Question::Interrupt);
                // Whatever the answer is now, the rollout was interrupted.
                let last = child.receive(HALT_LIMIT, &Interrupt::default());
                last.map_err(|_| WorldError::Interrupted)?
            }
            received => received.map_err(of_child)?,
        };
        let answer: Value = child.read(&line).map_err(of_child)?;
        let words = |key: &str| answer.get(key).and_then(Value::as_str).map(str::to_owned);
        if let Some(refused) = words("refused") {
            return Ok(Answered::Refused(refused));
        }
        if let Some(told) = words("halted") {
            return Err(WorldError::Halted { told });
        }
        if answer.get("interrupted") == Some(&Value::Bool(true)) {
            return Err(WorldError::Interrupted);
        }
        match T::deserialize(&answer) {
            Ok(answer) => Ok(Answered::Given(answer)),
            Err(error) => Err(of_child(child.no_answer(&line, error))),
        }
    }

    /// Asks a question that the program must not refuse.
    fn get<T: DeserializeOwned>(
        &self,
        question: &Question,
        interrupt: &Interrupt,
    ) -> Result<T, WorldError> {
        match self.ask(question, interrupt)? {
            Answered::Given(answer) => Ok(answer),
            Answered::Refused(why) => {
                Err(self.wrong(format!("it refuses `{}`: {why}", question.name())))
            }
        }
    }

    fn wrong(&self, why: impl std::fmt::Display) -> WorldError {
        WorldError::Program {
            why: format!("`{}`: {why}", self.about.name),
        }
    }

    /// Writes the files of a start for the program.
    fn written(&self, start: &Start) -> Result<ClothState, WorldError> {
        let refused = |why: String| WorldError::Start {
            start: start.name.clone(),
            why,
        };
        simulated::check_whole(start)?;
        let grid = start.grid;
        let count = grid.dimx as usize * grid.dimy as usize;
        if start.positions.len() != count {
            let found = start.positions.len();
            return Err(refused(format!(
                "it has {found} particles, and its grid has {count}"
            )));
        }
        if !are_finite(&start.positions) {
            return Err(refused("a position is not finite".to_owned()));
        }
        let flat = Start::flat(&Cloth {
            dimx: grid.dimx,
            dimy: grid.dimy,
            spacing_m: grid.spacing_m,
            start: ClothStart::Flat,
            material: self.material.clone(),
        });
        let lie = if flat.positions == start.positions {
            Arrangement::Flat
        } else {
            Arrangement::Positions
        };
        let mut number = self.n_starts.borrow_mut();
        *number += 1;
        let path = self.folder.path().join(format!("start-{number}.npy"));
        files::write_whole(&path, &npy::encode(&start.positions))
            .map_err(|error| self.wrong(error))?;
        Ok(ClothState {
            name: start.name.clone(),
            lie,
            grid,
            positions: path,
            material: self.material.clone(),
        })
    }

    /// Reads `count` particle positions; any other number is an error.
    fn positions(&self, file: &Path, count: usize) -> Result<Vec<[f32; 3]>, WorldError> {
        let wrong = |why: String| self.wrong(format!("its positions `{}`: {why}", file.display()));
        let bytes = files::read(file, MAX_ARRAY_BYTES).map_err(wrong)?;
        let shape =
            "they are not a .npy file of little-endian float32 numbers of shape [particles, 3]";
        let positions = npy::decode(&bytes).ok_or_else(|| wrong(shape.to_owned()))?;
        if positions.len() != count {
            let found = positions.len();
            return Err(wrong(format!(
                "they are {found}, and the start has {count} particles"
            )));
        }
        if are_finite(&positions) {
            Ok(positions)
        } else {
            Err(wrong("one is not finite".to_owned()))
        }
    }

    /// Asks where the particles are now.
    fn look_at_particles(&mut self, count: usize) -> Result<(), WorldError> {
        if self.about.particles {
            let answer: Positions = self.get(&Question::Particles, &self.interrupt)?;
            self.particles = Some(self.positions(&answer.positions, count)?);
        }
        Ok(())
    }
}

impl World for ExternalWorld {
    fn name(&self) -> &str {
        &self.about.name
    }

    fn parameters(&self) -> String {
        crate::parameters_with(self.about.parameters.clone(), self.material.as_ref())
    }

    fn code(&self) -> String {
        self.about.code.clone()
    }

    fn repeats(&self) -> bool {
        self.about.repeats
    }

    fn grippers(&self) -> usize {
        self.about.grippers as usize
    }

    fn reset(&mut self, start: &Start) -> Result<(), WorldError> {
        let question = Question::Reset {
            camera: self.camera.clone(),
            picker: self.picker,
            start: self.written(start)?,
        };
        if let Answered::Refused(why) = self.ask::<Nothing>(&question, &self.interrupt)? {
            let start = start.name.clone();
            return Err(WorldError::Start { start, why });
        }
        self.is_laid = true;
        self.look_at_particles(start.positions.len())
    }

    fn observe(&mut self) -> Result<Observation, WorldError> {
        if !self.is_laid {
            return Err(WorldError::NotReset);
        }
        let seen: CameraView = self.get(&Question::Observe, &self.interrupt)?;
        let side = self.camera.image_px;
        let rgb = png::load(&seen.rgb).map_err(|error| self.wrong(error))?;
        if rgb.dimensions() != (side, side) {
            let (width, height) = rgb.dimensions();
            return Err(self.wrong(format!(
                "its picture has {width} x {height} px, and the task's camera takes {side} x {side} px"
            )));
        }
        let wrong =
            |why: String| self.wrong(format!("its depth `{}`: {why}", seen.depth.display()));
        let bytes = files::read(&seen.depth, MAX_ARRAY_BYTES).map_err(wrong)?;
        let (shape, depths) = npy::decode_floats(&bytes).map_err(wrong)?;
        if shape != [u64::from(side); 2] {
            return Err(wrong(format!(
                "its shape is {shape:?}, and the picture's is [{side}, {side}]"
            )));
        }
        if !depths
            .iter()
            .all(|depth| (0.0..f64::INFINITY).contains(depth))
        {
            let why = "a depth is negative or not finite; 0 means no reading";
            return Err(wrong(why.to_owned()));
        }
        let depths = depths.into_iter().map(|depth| depth as f32).collect();
        let depth_m = DepthImage::from_raw(side, side, depths).expect("as many depths as pixels");
        let (depth_m, note) = dropouts::closed(&depth_m);
        if !seen.time_s.is_finite() {
            return Err(self.wrong(format!("its `time_s` is {}", seen.time_s)));
        }
        Ok(Observation {
            rgb,
            depth_m,
            camera: seen
                .camera
                .camera([side; 2])
                .map_err(|why| self.wrong(why))?,
            time_s: seen.time_s,
            notes: note.into_iter().collect(),
        })
    }

    fn act(&mut self, motion: &Motion, interrupt: &Interrupt) -> Result<Executed, WorldError> {
        if !self.is_laid {
            return Err(WorldError::NotReset);
        }
        let fits = motion.grips.len() == self.grippers();
        let unequal = (!fits).then(|| motion.unequal(self.name(), self.grippers()));
        if let Some(why) = unequal.or_else(|| self.refuses(motion)) {
            return Err(WorldError::Motion { why });
        }
        let question = Question::Act {
            grips: motion.grips.clone(),
        };
        let mut done: Executed = match self.ask(&question, interrupt)? {
            Answered::Given(done) => done,
            Answered::Refused(why) => return Err(WorldError::Motion { why }),
        };
        if done.grips.len() != motion.grips.len() {
            return Err(self.wrong(format!(
                "it says what {} did, and was asked for {}",
                counted(done.grips.len(), "grip"),
                motion.grips.len()
            )));
        }
        let points = done.grips.iter().flat_map(|done| {
            let ends = [done.grip.pick, done.grip.place].into_iter();
            ends.chain(done.released_at)
        });
        let mut numbers = points.flat_map(|point| [point.x, point.y, point.z]);
        if !(numbers.all(f64::is_finite) && (0.0..f64::INFINITY).contains(&done.duration_s)) {
            return Err(
                self.wrong("what it did has a number that is not finite, or a negative duration")
            );
        }
        // A world acts in the manner that it was asked for, or refuses it.
        for (done, asked) in done.grips.iter_mut().zip(&motion.grips) {
            done.grip.manner = asked.manner;
        }
        let count = self.particles.as_ref().map_or(0, Vec::len);
        self.look_at_particles(count)?;
        Ok(done)
    }

    fn crumple(
        &self,
        start: &Start,
        seed: u64,
        interrupt: &Interrupt,
    ) -> Result<Start, WorldError> {
        if !self.about.crumples {
            return Err(WorldError::CannotCrumple {
                world: self.about.name.clone(),
            });
        }
        let question = Question::Crumple {
            seed,
            start: self.written(start)?,
        };
        let heap: Positions = self.get(&question, interrupt)?;
        let positions = self.positions(&heap.positions, start.positions.len())?;
        Ok(start.crumpled(seed, positions))
    }

    fn particles(&self) -> Option<Vec<[f32; 3]>> {
        self.particles.clone()
    }

    fn refuses(&self, motion: &Motion) -> Option<String> {
        unknown_manner(&self.about.name, motion, &self.about.acts_on)
    }

    /// If the program fails to answer, the next action reports it.
    fn out_of_reach(&self, point: &WorldPoint) -> Option<String> {
        if !self.about.reach || self.failed.borrow().is_some() {
            return None;
        }
        let question = Question::Reach {
            point: [point.x, point.y, point.z],
        };
        match self.get::<ReachAnswer>(&question, &self.interrupt) {
            Ok(ReachAnswer { why }) => why,
            Err(error) => {
                *self.failed.borrow_mut() = Some(error.to_string());
                None
            }
        }
    }
}

/// Says what is wrong with a world's description, if anything is.
fn fault(about: &Hello) -> Option<String> {
    if about.protocol != PROTOCOL {
        return Some(format!(
            "answers version {} of the lines, and this fabc asks in version {PROTOCOL}, in which `act` and its \
             answer have a list of `grips`; let it answer that, and add `\"protocol\": {PROTOCOL}` to its `hello`",
            about.protocol
        ));
    }
    if about.grippers == 0 {
        return Some("states `grippers` as 0; a world has at least 1".to_owned());
    }
    let stated = [
        ("name", &about.name),
        ("parameters", &about.parameters),
        ("code", &about.code),
    ];
    if let Some((key, _)) = { stated }.iter().find(|(_, value)| value.trim().is_empty()) {
        return Some(format!(
            "states an empty `{key}`, and results are stored under it"
        ));
    }
    let is_question = |name: &String| LIMITS_S.iter().any(|(known, _)| known == name);
    let is_limit = |limit_s: &u64| (1..=MAX_LIMIT_S).contains(limit_s);
    let mut limits = about.limits_s.iter();
    if let Some((question, limit_s)) = limits.find(|(name, it)| !is_question(name) || !is_limit(it))
    {
        return Some(format!(
            "states the limit `{question}` as {limit_s} s; the questions are {}, and a limit is from 1 to {MAX_LIMIT_S} s",
            quoted(LIMITS_S.map(|(known, _)| known))
        ));
    }
    let mut acts_on = about.acts_on.iter();
    let unknown = acts_on.find(|name| manner_field(name).is_none())?;
    let known = quoted(MANNERS.iter().map(|row| row.name));
    Some(format!("acts on `{unknown}`, and a manner has {known}"))
}

fn are_finite(positions: &[[f32; 3]]) -> bool {
    positions.iter().flatten().all(|number| number.is_finite())
}

fn limit_s(question: &str) -> u64 {
    let found = LIMITS_S.iter().find(|(known, _)| *known == question);
    found.map_or(60, |(_, limit_s)| *limit_s)
}

fn of_child(error: ChildError) -> WorldError {
    match error {
        ChildError::Interrupted => WorldError::Interrupted,
        error => WorldError::Program {
            why: error.to_string(),
        },
    }
}
