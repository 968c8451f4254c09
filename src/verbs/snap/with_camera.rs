//! What the simulator's camera adds to a task: scenes, pictures, and the full text of each stage.
//!
//! Simulation is lazy: if scenes and pictures are pinned, no cloth is laid.

use super::scene::{Moment, PinnedAction, PinnedScene};
use crate::exit::Failure;
use crate::io::Io;
use crate::sources;
use crate::sources::TaskArguments;
use crate::verbs::render::page::DisplayMessage;
use crate::verbs::render::shown_without_drawing;
use crate::verbs::runtime::setting;
use crate::verbs::runtime::setting::FrameArguments;
use crate::verbs::runtime::setting::StartArguments;
use crate::verbs::runtime::step_scene::{StepScene, scene_at_step};
use fab_agent::examples::Examples;
use fab_agent::policy;
use fab_agent::subgoals::SubgoalSet;
use fab_base::interrupt::Interrupt;
use fab_picture::png;
use fab_program::render::Values;
use fab_program::scene::SceneView;
use fab_program::{ClothStart, KeypointShape, Picture, Program, Stage, Subgoals};
use fab_world::World;
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::Path;

/// Replaces declared programs whose cloth comes from a file of another grid by fitting ones, as a run does.
pub fn fitted(file: &str, programs: Vec<Program>, io: &Io) -> Result<Vec<Program>, Failure> {
    let fit = |program: Program| {
        if !matches!(program.cloth.start, ClothStart::File { .. }) {
            return Ok(program);
        }
        let world = setting::world(&program).map_err(Failure::environment)?;
        let folder = sources::folder_of(file);
        let interrupt = Interrupt::default();
        let start = setting::start(
            &program,
            &folder,
            &AS_DECLARED,
            world.as_ref(),
            &interrupt,
            io,
        )?;
        let task = TaskArguments {
            file: file.to_owned(),
            task: Some(program.task.clone()),
            variant: program.variant.clone(),
        };
        setting::fitted(&task, &program, &start, io)
    };
    programs.into_iter().map(fit).collect()
}

/// The start that the task declares.
const AS_DECLARED: StartArguments = StartArguments {
    start: None,
    frame: FrameArguments {
        dims: None,
        up: None,
    },
};

/// A camera over the cloth of one program.
pub struct Camera<'p> {
    program: &'p Program,
    /// Holds the program's file.
    pub folder: &'p Path,
    /// The stream for talk.
    pub io: &'p Io,
    world: Option<Box<dyn World>>,
    seen: BTreeMap<Moment, StepScene>,
    examples: OnceCell<Examples>,
}

impl<'p> Camera<'p> {
    /// Makes a camera for a program; `folder` holds its file.
    pub fn of(program: &'p Program, folder: &'p Path, io: &'p Io) -> Camera<'p> {
        Camera {
            program,
            folder,
            io,
            world: None,
            seen: BTreeMap::new(),
            examples: OnceCell::new(),
        }
    }

    /// Brings the cloth to a moment and takes a picture.
    pub fn scene(&mut self, moment: &Moment, seen_of: String) -> Result<PinnedScene, Failure> {
        let program = self.program;
        let seen = self.seen(moment)?;
        let shape = |shape| {
            let keypoints = program.keypoints.iter();
            keypoints.filter(move |keypoint| keypoint.extractor.shape() == shape)
        };
        let points = shape(KeypointShape::Points).chain(shape(KeypointShape::Point));
        let points = points.filter_map(|keypoint| {
            let points = seen.scene.points(&keypoint.name)?;
            Some((keypoint.name.clone(), points))
        });
        let areas = shape(KeypointShape::Mask).filter_map(|keypoint| {
            let area = seen.scene.area_px(&keypoint.name)?;
            Some((keypoint.name.clone(), area))
        });
        let last = seen.last.as_ref().map(|last| PinnedAction {
            fields: last.proposal.fields.iter().cloned().collect(),
            pick: last.pick,
            place: last.place,
        });
        Ok(PinnedScene {
            seen_of,
            start: moment.start,
            step: moment.step,
            last,
            points: points.collect(),
            areas: areas.collect(),
        })
    }

    /// Returns the messages of a stage, by the function that a rollout uses.
    pub fn messages(
        &self,
        stage: &Stage,
        values: Values<'_>,
        step: u32,
    ) -> Result<Option<Vec<DisplayMessage>>, Failure> {
        let examples = match self.examples.get() {
            Some(examples) => examples,
            None => {
                let examples = Examples::load(self.program, self.folder);
                let examples = examples.map_err(Failure::environment)?;
                self.examples.get_or_init(|| examples)
            }
        };
        let spoken = policy::opening(self.program, stage, values, examples, step);
        let spoken = spoken.map_err(Failure::environment)?;
        Ok(Some(shown_without_drawing(&spoken, step)))
    }

    /// Draws a picture as it is sent to a model that works in the camera's pixels.
    pub fn picture(
        &mut self,
        moment: &Moment,
        picture: &Picture,
    ) -> Result<Option<Vec<u8>>, Failure> {
        let program = self.program;
        let drawn = match picture {
            Picture::Subgoal { which, arrow } => {
                let (folder, number) = (self.folder, moment.step as usize - 1);
                let interrupt = Interrupt::default();
                let shown = (*which, *arrow);
                let world = self.world()?;
                SubgoalSet::picture(program, folder, number, shown, world, &interrupt)
                    .map_err(Failure::environment)?
            }
            Picture::Scene { .. } => {
                let StepScene {
                    scene,
                    observation,
                    last,
                } = self.seen(moment)?;
                let drawn = scene.annotated(program, &observation.rgb, last.as_ref());
                Some(drawn.map_err(Failure::environment)?)
            }
        };
        Ok(drawn.map(|drawn| png::encode(&drawn)))
    }

    fn seen(&mut self, moment: &Moment) -> Result<&StepScene, Failure> {
        if !self.seen.contains_key(moment) {
            let start = StartArguments {
                start: moment.start.map(|seed| seed.to_string()),
                ..AS_DECLARED
            };
            let interrupt = Interrupt::default();
            let (program, folder, io) = (self.program, self.folder, self.io);
            let world = self.world()?;
            // Demonstrated folds need no pictures.
            let subgoals = match program.subgoals {
                Some(Subgoals::Images { .. }) if moment.step > 1 => {
                    SubgoalSet::obtain(program, folder, world, &interrupt)
                        .map_err(Failure::environment)?
                }
                _ => SubgoalSet::none(),
            };
            let start = setting::start(program, folder, &start, world, &interrupt, io)?;
            let seen = scene_at_step(
                program,
                &start,
                moment.step,
                &subgoals,
                world,
                &interrupt,
                io,
            )?;
            self.seen.insert(moment.clone(), seen);
        }
        Ok(&self.seen[moment])
    }

    fn world(&mut self) -> Result<&mut dyn World, Failure> {
        if self.world.is_none() {
            let world = setting::world(self.program).map_err(Failure::environment)?;
            self.world = Some(world);
        }
        let world = self.world.as_mut().expect("it was made above");
        Ok(world.as_mut())
    }
}
