//! Demonstrations of a task by the scripted expert, as in-context examples of a stage.
//!
//! In: a file that [`make`] wrote. Out: questions with their answers, by step. The file holds observations and choices,
//! not prompts: if a component changes, the examples change with it.

mod make;
mod words;

pub use make::{DemoRequest, make};

use crate::error::RunError;
use crate::task_files;
use fab_base::files;
use fab_program::Proposal;
use fab_program::facts::Facts;
use fab_program::pointing::Pointing;
use fab_program::render::{self, Origin, Place, PromptText, RenderError, Values};
use fab_program::reply;
use fab_program::scene::SceneView;
use fab_program::space;
use fab_program::{
    self as program, Cloth, ClothStart, PARTICLES_A_SIDE, PixelPoint, Program, Value,
};
use fab_world::metrics;
use fab_world::start::Start;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Version of the file's lines.
pub const DEMOS_FORMAT: u32 = 1;

/// The longest file accepted, bytes.
const MAX_BYTES: u64 = 16 << 20;

/// Two starts are the same if their particles are closer than this on average, metres.
const SAME_START_M: f64 = 0.002;

/// The first line of a demonstrations file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// The value of [`DEMOS_FORMAT`] when it was written.
    pub format: u32,
    /// The task that is demonstrated.
    pub task: String,
    /// The stage that shows them.
    pub stage: String,
    /// Hash of the simulator's parameters.
    pub params: String,
    /// The seed that drew the starts.
    pub seed: u64,
}

/// A further line: one demonstration, from its start to its last step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Demo {
    /// Particles from left to right, and from back to front.
    pub dims: [u32; 2],
    /// How far the flat cloth is turned, degrees, counter-clockwise as seen from above.
    pub turned_deg: f64,
    /// What was seen and done, step by step.
    pub steps: Vec<DemoStep>,
}

/// One step of a demonstration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DemoStep {
    /// The points that the camera showed, by keypoint.
    pub points: BTreeMap<String, Vec<PixelPoint>>,
    /// The texts that earlier stages would have produced, by name.
    pub texts: BTreeMap<String, String>,
    /// The chosen value of each field of the action.
    pub chosen: BTreeMap<String, Value>,
    /// Why, in a sentence.
    pub reason: String,
}

/// The demonstrations of one stage, ready to be shown.
#[derive(Clone, Debug)]
pub struct Demonstrations {
    stage: String,
    /// The file as the task names it.
    file: String,
    starts: Vec<Start>,
    /// The demonstrations, each with its line number.
    demos: Vec<(u32, Demo)>,
}

impl Demonstrations {
    /// Reads the file that a program names, and checks every question and answer against the program's own wording.
    ///
    /// Fails if the file cannot be read, has another format or stage, lacks something that a question shows, or holds
    /// an answer that the program's own reader would reject.
    pub fn load(
        program: &Program,
        demos: &program::Demos,
        folder: &Path,
    ) -> Result<Demonstrations, RunError> {
        let path = task_files::resolve(folder, &demos.file).map_err(|why| {
            RunError::Failed(format!(
                "{why}; `fabc demos FILE --variant NAME` makes the demonstrations"
            ))
        })?;
        let file = path.display();
        let unreadable = |why: String| {
            RunError::Failed(format!("cannot read the demonstrations `{file}`: {why}"))
        };
        let wrong = |line: usize, why: String| {
            RunError::Failed(format!("line {line} of the demonstrations `{file}`: {why}"))
        };
        let text = files::read_text(&path, MAX_BYTES).map_err(unreadable)?;
        let lines = text.lines().zip(1..);
        let mut lines = lines.filter(|(line, _)| !line.trim().is_empty());
        let first = lines.next().map(|(line, _)| serde_json::from_str(line));
        let header: Header = first
            .ok_or_else(|| unreadable("it is empty".to_owned()))?
            .map_err(|error| wrong(1, error.to_string()))?;
        let Header { format, stage, .. } = &header;
        if (*format, stage) != (DEMOS_FORMAT, &demos.stage) {
            let why = format!(
                "it has format {format} and is for the stage `{stage}`; right would be format {DEMOS_FORMAT} and `{}`: make \
                 it again by `fabc demos`",
                demos.stage
            );
            return Err(wrong(1, why));
        }
        let mut demonstrations = Demonstrations {
            stage: demos.stage.clone(),
            file: demos.file.path.clone(),
            starts: Vec::new(),
            demos: Vec::new(),
        };
        for (line, number) in lines {
            let demo = serde_json::from_str(line).map_err(|error| error.to_string());
            demo.and_then(|demo| demonstrations.add(program, demo, number as u32))
                .map_err(|why| wrong(number, why))?;
        }
        Ok(demonstrations)
    }

    fn add(&mut self, program: &Program, demo: Demo, line: u32) -> Result<(), String> {
        self.starts.push(start_of(program, &demo)?);
        let pointing = Pointing::of_camera(&program.camera);
        for (step, number) in demo.steps.iter().zip(1..) {
            question_and_answer(program, &self.stage, step, number, pointing)?;
        }
        self.demos.push((line, demo));
        Ok(())
    }

    /// Writes the demonstrations of a stage in a step, which counts from 1, in a model's point convention: each a question
    /// and its answer.
    ///
    /// Fails if a question cannot be written in that convention, or an answer would not be read back as chosen.
    pub fn answered_examples(
        &self,
        program: &Program,
        stage: &str,
        step: u32,
        pointing: Pointing,
    ) -> Result<Vec<[PromptText; 2]>, RunError> {
        let shown = self.demos.iter().filter(|_| stage == self.stage);
        let index = step.saturating_sub(1) as usize;
        shown
            .filter_map(|(line, demo)| Some((line, demo.steps.get(index)?)))
            .zip(1..)
            .map(|((line, demo), number)| {
                let (question, answer) = question_and_answer(program, stage, demo, step, pointing)?;
                let origin = Origin {
                    source: format!("demonstration {number}"),
                    value: None,
                    place: Some(Place {
                        file: self.file.clone(),
                        line: *line,
                    }),
                };
                Ok([question, answer].map(|text| PromptText::of(text, origin.clone())))
            })
            .collect::<Result<_, _>>()
            .map_err(|why: String| {
                RunError::Failed(format!(
                    "the demonstrations cannot be written for this model: {why}"
                ))
            })
    }

    /// Returns how many actions are demonstrated, over all steps.
    pub fn data_size(&self) -> usize {
        self.demos.iter().map(|(_, demo)| demo.steps.len()).sum()
    }

    /// Returns the number, from 1, of the demonstration that begins at this start.
    pub fn demonstrates(&self, start: &Start) -> Option<usize> {
        let same = |known: &Start| {
            known.grid == start.grid
                && metrics::mean_particle_distance_m(&known.positions, &start.positions)
                    .is_some_and(|distance_m| distance_m < SAME_START_M)
        };
        Some(self.starts.iter().position(same)? + 1)
    }
}

/// Lays the cloth as in a demonstration.
fn start_of(program: &Program, demo: &Demo) -> Result<Start, String> {
    let [dimx, dimy] = demo.dims;
    let [fewest, most] = PARTICLES_A_SIDE;
    let range = fewest..=most;
    if !(range.contains(&dimx) && range.contains(&dimy) && demo.turned_deg.is_finite()) {
        return Err(format!(
            "a cloth of {dimx} by {dimy} particles, turned by {} degrees, cannot be laid",
            demo.turned_deg
        ));
    }
    let cloth = Cloth {
        dimx,
        dimy,
        spacing_m: program.cloth.spacing_m,
        start: ClothStart::Flat,
        material: None,
    };
    Ok(Start::turned_by(&cloth, demo.turned_deg.to_radians()))
}

/// Writes one step as a question and its answer.
fn question_and_answer(
    program: &Program,
    stage: &str,
    step: &DemoStep,
    number: u32,
    pointing: Pointing,
) -> Result<(String, String), String> {
    let Some(stage) = program.stages.iter().find(|known| known.name == stage) else {
        return Err(format!("the task has no stage `{stage}`"));
    };
    let scene = DemoScene(&step.points);
    let facts = Facts {
        texts: &step.texts,
        ..Facts::of(&scene, number, pointing)
    };
    let notation = facts.notation(program);
    let mut messages = render::messages(program, stage, Values::Known(facts))
        .map_err(|error: RenderError| format!("the question cannot be written: {error}"))?;
    let question = messages.pop().map(|message| message.content.text);
    let mut lines = Vec::with_capacity(program.actions.len() + 1);
    let mut fields = Vec::with_capacity(program.actions.len());
    for field in &program.actions {
        let Some(value) = step.chosen.get(&field.name) else {
            return Err(format!("step {number} chooses no `{}`", field.name));
        };
        lines.push(space::statement(
            field,
            &notation.stated_value(field, value),
        ));
        fields.push((field.name.clone(), value.clone()));
    }
    let points: Vec<PixelPoint> = step.points.values().flatten().copied().collect();
    lines.push(notation.retold(&step.reason, &points));
    let answer = lines.join("\n");
    let proposal = Proposal { fields };
    match reply::read_action_in(program, &notation, &answer) {
        Ok(reading) if reading.value == proposal => Ok((question.unwrap_or_default(), answer)),
        Ok(_) => Err(format!("the answer of step {number} reads as another one")),
        Err(malformed) => Err(format!(
            "the answer of step {number} is not readable: {}",
            malformed.message
        )),
    }
}

/// The points of a demonstration as a scene.
struct DemoScene<'a>(&'a BTreeMap<String, Vec<PixelPoint>>);

impl SceneView for DemoScene<'_> {
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
        self.0.get(keypoint).cloned()
    }
}
