//! Prompts on a scene that the world's camera sees, with the pictures that a model gets.

use super::{Listed, Shown, ShownPart, title};
use crate::cli::RenderArguments;
use crate::exit::Failure;
use crate::setting::models;
use crate::{setting, sources};
use compiler::facts::{Done, Facts, SceneView};
use compiler::program::{ClothStart, PixelPoint, Program, Stage, Subgoals, Value};
use compiler::render::{PromptPicture, Values};
use compiler::reply::Proposal;
use runtime::agent::{self, PromptError};
use runtime::examples::Examples;
use runtime::expert;
use runtime::interrupt::Interrupt;
use runtime::model::{Lowering, Message, Part, Speaker};
use runtime::pictures::Pictures;
use runtime::scene::Scene;
use runtime::start::Start;
use runtime::subgoals::SubgoalSet;
use runtime::world::World;
use std::collections::BTreeMap;

/// Returns the task for the cloth of the start file that is named, where one is; else the task as it is.
pub fn fitted(declared: &Program, arguments: &RenderArguments) -> Result<Program, Failure> {
    let is_seed = |text: &String| text.bytes().all(|byte| byte.is_ascii_digit());
    let is_file = match &arguments.start.start {
        Some(text) => !is_seed(text),
        None => matches!(declared.cloth.start, ClothStart::File { .. }),
    };
    if !is_file || arguments.scene.is_some() {
        return Ok(declared.clone());
    }
    let world = setting::world(declared).map_err(Failure::environment)?;
    let folder = sources::folder_of(&arguments.task.file);
    let interrupt = Interrupt::default();
    let start = setting::start(
        declared,
        &folder,
        &arguments.start,
        world.as_ref(),
        &interrupt,
    )?;
    setting::fitted(&arguments.task, declared, &start)
}

/// A scene and what can be shown of it.
pub struct View {
    scene: Scene,
    pictures: Pictures,
    last: Option<Done>,
    step: u32,
    lowering: Lowering,
}

impl View {
    /// Lays the cloth, executes the demonstrated folds before the step, and looks.
    ///
    /// - `program`: the task for the cloth that lies there; `declared`: the same as it is written, whose subgoals
    ///   are shown.
    pub fn at(
        program: &Program,
        declared: &Program,
        arguments: &RenderArguments,
    ) -> Result<View, Failure> {
        if arguments.scene.is_some() && arguments.start.start.is_some() {
            let both = "`--scene` gives the points and `--start` lets the camera find them; give one of them";
            return Err(Failure::usage(both));
        }
        let lowering = models::lowering(&arguments.shown)?;
        let interrupt = Interrupt::default();
        let mut world = setting::world(program).map_err(Failure::environment)?;
        let folder = sources::folder_of(&arguments.task.file);
        let subgoals = SubgoalSet::obtain(declared, &folder, world.as_mut(), &interrupt)
            .map_err(Failure::environment)?;
        let examples = Examples::load(program, &folder).map_err(Failure::environment)?;
        let start = setting::start(
            program,
            &folder,
            &arguments.start,
            world.as_ref(),
            &interrupt,
        )?;
        let step = arguments.step;
        let seen = look(program, &start, step, world.as_mut(), &interrupt)?;
        let annotated = seen
            .scene
            .annotated(program, &seen.rgb, seen.last.as_ref())
            .map_err(Failure::environment)?;
        Ok(View {
            pictures: Pictures {
                subgoals: subgoals
                    .step(step as usize - 1)
                    .map_err(Failure::environment)?,
                scene: seen.rgb,
                annotated,
                examples,
            },
            scene: seen.scene,
            last: seen.last,
            step,
            lowering,
        })
    }

    /// Renders one stage as the chosen model is sent it, by the function that a rollout uses.
    pub fn messages(
        &self,
        program: &Program,
        stage: &Stage,
        listed: Option<&Listed>,
    ) -> Result<Vec<Shown>, PromptError> {
        let lowering = &self.lowering;
        let texts = BTreeMap::new();
        let scene: &dyn SceneView = match listed {
            Some(listed) => listed,
            None => &self.scene,
        };
        let values = Values::Partly(Facts {
            scene,
            texts: &texts,
            step: self.step,
            last: self.last.as_ref(),
            proposal: None,
            pointing: lowering.pointing(self.pictures.size()),
        });
        let step = self.step;
        let messages = agent::conversation(program, stage, values, &self.pictures, step, lowering)?;
        let files = stage.examples.iter().flat_map(|example| &example.images);
        let files = files.cloned().map(PromptPicture::File);
        let drawn = stage.show.iter().copied().map(PromptPicture::Drawn);
        let mut titles = files.chain(drawn).map(|picture| title(&picture, step));
        Ok(messages
            .into_iter()
            .map(|message| shown(message, &mut titles))
            .collect())
    }
}

/// What the camera sees at a step, and the action before it.
struct Seen {
    scene: Scene,
    rgb: image::RgbImage,
    last: Option<Done>,
}

fn look(
    program: &Program,
    start: &Start,
    step: u32,
    world: &mut dyn World,
    interrupt: &Interrupt,
) -> Result<Seen, Failure> {
    let mut seen: Option<Seen> = None;
    world.reset(start).map_err(Failure::environment)?;
    for earlier in 0..step {
        let mut last = None;
        if earlier > 0 {
            let Some(Subgoals::Demonstrate { folds }) = &program.subgoals else {
                return Err(Failure::usage(
                    "the task demonstrates no folds, so that only step 1 can be shown; give `--scene FILE.json`",
                ));
            };
            let fold = &folds[(earlier as usize - 1).min(folds.len() - 1)];
            let motion = expert::motion(fold, start, world).map_err(Failure::environment)?;
            let camera = world.observe().map_err(Failure::environment)?.camera;
            let pixel = |point| {
                let [column, row]: [f64; 2] = camera.pixel_from_world(point)?;
                Some(PixelPoint::new(column.floor() as i32, row.floor() as i32))
            };
            last = pixel(motion.pick)
                .zip(pixel(motion.place))
                .map(|(pick, place)| done(pick, place));
            world
                .act(&motion, interrupt)
                .map_err(Failure::environment)?;
        }
        let observation = world.observe().map_err(Failure::environment)?;
        let first = seen.as_ref().map(|seen| &seen.scene);
        let scene = Scene::of(program, &observation, first).map_err(Failure::environment)?;
        seen = Some(Seen {
            scene,
            rgb: observation.rgb,
            last,
        });
    }
    seen.ok_or_else(|| Failure::usage("steps are counted from 1"))
}

/// Makes the action that a demonstrated fold stands for.
fn done(pick: PixelPoint, place: PixelPoint) -> Done {
    let field = |name: &str, point| (name.to_owned(), Value::Point(point));
    Done {
        proposal: Proposal {
            fields: vec![field("pick", pick), field("place", place)],
        },
        pick,
        place,
    }
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
