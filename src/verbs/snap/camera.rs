//! What the camera adds to a task: scenes, pictures, and the full text of each stage.
//!
//! Simulation is lazy: if scenes and pictures are pinned, no cloth is laid. The authoring tool has no camera; it renders
//! texts for scenes that are pinned, and cannot draw.

use super::scene::{Moment, PinnedScene};
use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::render::page::DisplayMessage;
use fab_program::render::Values;
use fab_program::{Picture, Program, Stage};
use std::path::Path;

#[cfg(feature = "runtime")]
use {
    super::scene::PinnedAction,
    crate::sources::TaskArguments,
    crate::verbs::render::camera::{fitted_to_start, shown_without_drawing},
    crate::verbs::runtime::setting::{self, FrameArguments, StartArguments},
    crate::verbs::runtime::step_scene::{StepScene, scene_at_step},
    fab_agent::examples::Examples,
    fab_agent::policy,
    fab_agent::subgoals::SubgoalSet,
    fab_base::interrupt::Interrupt,
    fab_picture::png,
    fab_program::scene::SceneView,
    fab_program::{KeypointShape, Subgoals},
    fab_world::World,
    std::cell::OnceCell,
    std::collections::BTreeMap,
};

/// A camera over the cloth of one program.
pub struct Camera<'p> {
    program: &'p Program,
    /// Holds the program's file.
    #[cfg(feature = "runtime")]
    folder: &'p Path,
    io: &'p Io,
    #[cfg(feature = "runtime")]
    world: Option<Box<dyn World>>,
    #[cfg(feature = "runtime")]
    seen: BTreeMap<Moment, StepScene>,
    #[cfg(feature = "runtime")]
    examples: OnceCell<Examples>,
}

/// Replaces programs whose cloth comes from a file of another grid by fitting ones, as a run does.
#[cfg(feature = "runtime")]
pub fn fitted(file: &str, programs: Vec<Program>, io: &Io) -> Result<Vec<Program>, Failure> {
    let fit = |program: Program| {
        let task = TaskArguments {
            file: file.to_owned(),
            task: Some(program.task.clone()),
            variant: program.variant.clone(),
        };
        fitted_to_start(&task, &program, &AS_DECLARED, &Interrupt::default(), io)
    };
    programs.into_iter().map(fit).collect()
}

/// The start that the task declares.
#[cfg(feature = "runtime")]
const AS_DECLARED: StartArguments = StartArguments {
    start: None,
    frame: FrameArguments {
        dims: None,
        up: None,
    },
};

#[cfg(feature = "runtime")]
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
        let mut points = BTreeMap::new();
        let mut areas = BTreeMap::new();
        for keypoint in &program.keypoints {
            let name = &keypoint.name;
            match keypoint.extractor.shape() {
                KeypointShape::Point | KeypointShape::Points => {
                    points.extend(seen.scene.points(name).map(|it| (name.clone(), it)));
                }
                KeypointShape::Mask => {
                    areas.extend(seen.scene.area_px(name).map(|it| (name.clone(), it)));
                }
                _ => {}
            }
        }
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
            points,
            areas,
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

/// Returns the programs unchanged: the authoring tool lays no cloth.
#[cfg(not(feature = "runtime"))]
pub fn fitted(_file: &str, programs: Vec<Program>, _io: &Io) -> Result<Vec<Program>, Failure> {
    Ok(programs)
}

#[cfg(not(feature = "runtime"))]
impl<'p> Camera<'p> {
    /// Makes what takes the place of a camera.
    pub fn of(program: &'p Program, _folder: &'p Path, io: &'p Io) -> Camera<'p> {
        Camera { program, io }
    }

    /// Fails: there is no camera.
    pub fn scene(&mut self, moment: &Moment, _seen_of: String) -> Result<PinnedScene, Failure> {
        Err(Failure::environment(format!(
            "the scene `{}` of `{}` is not pinned, or is of another cloth, camera or keypoints; this build of fabc has no camera to see it anew",
            moment.name,
            self.program.title()
        )))
    }

    /// Returns the messages of a stage; `None` if they include demonstrations, which this build cannot read.
    pub fn messages(
        &self,
        stage: &Stage,
        values: Values<'_>,
        step: u32,
    ) -> Result<Option<Vec<DisplayMessage>>, Failure> {
        let program = self.program;
        if program.demos.iter().any(|demos| demos.stage == stage.name) {
            self.io.talk(&format!(
                "note: `{}` is shown demonstrations in stage {}, which this build of fabc cannot read; its snapshots are not checked",
                program.title(),
                stage.name
            ));
            return Ok(None);
        }
        let messages = crate::verbs::render::page::messages(program, stage, values, step);
        messages.map(Some).map_err(Failure::environment)
    }

    /// Returns `None`: this build cannot draw.
    pub fn picture(&mut self, _: &Moment, _: &Picture) -> Result<Option<Vec<u8>>, Failure> {
        self.io.talk(&format!(
            "note: a picture of `{}` may have changed, and this build of fabc cannot draw",
            self.program.title()
        ));
        Ok(None)
    }
}
