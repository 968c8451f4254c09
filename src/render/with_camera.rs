//! Prompts on a scene that the world's camera sees, with the pictures that a model gets.

use super::{Shown, ShownPart};
use crate::cli::RenderArguments;
use crate::exit::Failure;
use crate::setting;
use compiler::program::{Arrow, Picture, Program, Stage, Subgoals, Which};
use compiler::render::{Bindings, RenderError};
use runtime::expert;
use runtime::interrupt::Interrupt;
use runtime::model::{Message, Part, Speaker};
use runtime::scene::Scene;
use runtime::subgoals::{StepPictures, SubgoalSet};
use runtime::world::World;
use runtime::{agent, start::Start};

/// A scene and the pictures around it.
pub struct View {
    scene: Option<Scene>,
    pictures: StepPictures,
    step: u32,
}

impl View {
    /// Lays the cloth, executes the demonstrated folds before the step, and looks.
    pub fn at(program: &Program, arguments: &RenderArguments) -> Result<View, Failure> {
        if arguments.scene.is_some() && arguments.start.start.is_some() {
            let both = "`--scene` gives the points and `--start` lets the camera find them; give one of them";
            return Err(Failure::usage(both));
        }
        let interrupt = Interrupt::default();
        let mut world = setting::world(program).map_err(Failure::environment)?;
        let folder = sources::folder_of(&arguments.file);
        let subgoals = SubgoalSet::obtain(program, &folder, world.as_mut(), &interrupt)
            .map_err(Failure::environment)?;
        let scene = match arguments.scene {
            Some(_) => None,
            None => {
                let start = setting::start(program, &arguments.start)?;
                Some(look(
                    program,
                    &start,
                    arguments.step,
                    world.as_mut(),
                    &interrupt,
                )?)
            }
        };
        Ok(View {
            scene,
            pictures: subgoals
                .step(arguments.step as usize - 1)
                .map_err(Failure::environment)?,
            step: arguments.step,
        })
    }

    /// Sets every point of the scene.
    pub fn bind(&self, bindings: &mut Bindings) {
        if let Some(scene) = &self.scene {
            scene.bind(bindings);
        }
    }

    /// Renders one stage by the function that a rollout uses.
    pub fn messages(
        &self,
        program: &Program,
        stage: &Stage,
        bindings: &Bindings,
    ) -> Result<Vec<Shown>, RenderError> {
        let messages = agent::conversation(program, stage, bindings, |picture| {
            self.pictures.png(picture)
        })?;
        let mut titles = stage.show.iter().map(|picture| self.title(*picture));
        Ok(messages
            .into_iter()
            .map(|message| shown(message, &mut titles))
            .collect())
    }

    fn title(&self, picture: Picture) -> String {
        let number = match picture.subgoal {
            Which::Now => self.step - 1,
            Which::Next => self.step,
        };
        match picture.arrow {
            Arrow::Drawn => format!("subgoal {number} with arrow"),
            Arrow::Absent => format!("subgoal {number}"),
        }
    }
}

fn look(
    program: &Program,
    start: &Start,
    step: u32,
    world: &mut dyn World,
    interrupt: &Interrupt,
) -> Result<Scene, Failure> {
    let mut scene = None;
    world.reset(start).map_err(Failure::environment)?;
    for earlier in 0..step {
        if earlier > 0 {
            let Subgoals::Demonstrate { folds } = &program.subgoals else {
                return Err(Failure::usage(
                    "the task brings its own pictures, so that only step 1 can be shown; give `--scene FILE.json`",
                ));
            };
            let fold = &folds[(earlier as usize - 1).min(folds.len() - 1)];
            let motion = expert::motion(fold, start, world).map_err(Failure::environment)?;
            world
                .act(&motion, interrupt)
                .map_err(Failure::environment)?;
        }
        let observation = world.observe().map_err(Failure::environment)?;
        scene =
            Some(Scene::of(program, &observation, scene.as_ref()).map_err(Failure::environment)?);
    }
    scene.ok_or_else(|| Failure::usage("steps are counted from 1"))
}

fn shown(message: Message, titles: &mut impl Iterator<Item = String>) -> Shown {
    let role = match message.speaker {
        Speaker::System => "system",
        Speaker::User => "user",
        Speaker::Assistant => "assistant",
    };
    let part = |part: Part| match part {
        Part::Text(text) => ShownPart::Text(text),
        Part::Image(png) => ShownPart::Picture {
            title: titles.next().unwrap_or_default(),
            png: Some(png.bytes().to_vec()),
        },
    };
    Shown {
        role,
        parts: message.parts.into_iter().map(part).collect(),
    }
}
