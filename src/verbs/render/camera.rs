//! Renders prompts of a scene from the world's camera, with the pictures that a model gets.

use super::page::{DisplayMessage, DisplayPart, ShownStage};
use super::{RenderArguments, Rendered, corrections_of, title, wanted};
use crate::exit::Failure;
use crate::io::Io;
use crate::sources;
use crate::sources::TaskArguments;
use crate::verbs::price::Price;
use crate::verbs::runtime::run::say_pictures;
use crate::verbs::runtime::setting;
use crate::verbs::runtime::setting::StartArguments;
use crate::verbs::runtime::setting::catalogue::FactsArguments;
use crate::verbs::runtime::setting::models::TargetModel;
use crate::verbs::runtime::step_scene::{StepScene, scene_at_step};
use clap::Args;
use fab_agent::examples::Examples;
use fab_agent::pictures::Pictures;
use fab_agent::policy;
use fab_agent::policy::{Finding, MessagePart, Rehearsed, StepView, UndrawnMessage};
use fab_agent::subgoals::SubgoalSet;
use fab_base::interrupt::Interrupt;
use fab_model::{Message, Part, Speaker};
use fab_program::facts::Facts;
use fab_program::render::Values;
use fab_program::reply::Stated;
use fab_program::scene::SceneView;
use fab_program::verify::Verdict;
use fab_program::{ClothStart, Program, Stage};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Where the cloth lies, who is shown the messages, and what was answered.
#[derive(Args)]
pub struct CameraArguments {
    #[command(flatten)]
    pub start: StartArguments,
    #[command(flatten)]
    pub shown: TargetModelArguments,
    /// What a model answered, in the order of the questions; shows what follows, such as the message of a refusal.
    #[arg(
        long = "reply",
        value_name = "TEXT",
        conflicts_with = "scene",
        allow_hyphen_values = true
    )]
    pub replies: Vec<String>,
}

impl CameraArguments {
    /// Returns the files that it names.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        let start = self.start.start.iter().map(PathBuf::from);
        start.chain(self.shown.facts.models.iter().cloned())
    }
}

/// To which model messages are shown as it would be sent them.
#[derive(Args)]
pub struct TargetModelArguments {
    /// Show what this `PROVIDER:NAME` would be sent, with points as it writes them; default: in the task's pixels.
    #[arg(long, value_name = "MODEL")]
    pub model: Option<String>,
    /// Show what a model that chooses numbered points would be sent.
    #[arg(long)]
    pub marks: bool,
    #[command(flatten)]
    pub facts: FactsArguments,
}

/// Returns the task for the cloth of a start file, if the start is one; otherwise the task unchanged.
pub fn fitted_to_start(
    task: &TaskArguments,
    declared: &Program,
    start: &StartArguments,
    interrupt: &Interrupt,
    io: &Io,
) -> Result<Program, Failure> {
    let is_seed = |text: &String| text.bytes().all(|byte| byte.is_ascii_digit());
    let is_file = match &start.start {
        Some(text) => !is_seed(text),
        None => matches!(declared.cloth.start, ClothStart::File { .. }),
    };
    if !is_file {
        return Ok(declared.clone());
    }
    let world = setting::world(declared).map_err(Failure::environment)?;
    let folder = sources::folder_of(&task.file);
    let start = setting::start(declared, &folder, start, world.as_ref(), interrupt, io)?;
    setting::fitted(task, declared, &start, io)
}

/// Renders stages as a rollout would ask them: brings the cloth to the step, takes a picture, and goes through the
/// stages with the rollout's own functions.
///
/// - `declared`: the task as written, whose subgoals are shown.
pub fn rendered(
    declared: &Program,
    arguments: &RenderArguments,
    io: &Io,
) -> Result<Rendered, Failure> {
    let CameraArguments {
        start,
        shown: target,
        replies,
    } = &arguments.camera;
    // Ctrl-C ends the whole program, unless `--watch` listens to it.
    let interrupt = if arguments.watch {
        io.interrupt()?
    } else {
        Interrupt::default()
    };
    let program = match arguments.scene {
        Some(_) => declared.clone(),
        None => fitted_to_start(&arguments.task, declared, start, &interrupt, io)?,
    };
    let (stages, listed) = wanted(&program, arguments)?;
    let target = TargetModel::of(target, io)?;
    let seen = Seen::at(&program, declared, arguments, &interrupt, io)?;
    let scene: &dyn SceneView = match &listed {
        Some(listed) => listed,
        None => &seen.scene.scene,
    };
    let texts = BTreeMap::new();
    let values = Values::Partly(Facts {
        scene,
        texts: &texts,
        step: arguments.step,
        last: seen.scene.last.as_ref(),
        proposal: None,
        pointing: target.lowering.pointing(seen.pictures.size()),
    });
    let rehearsed = match &listed {
        Some(_) => seen.conversations(&program, &stages, values, arguments.step, &target)?,
        None => seen.rehearsed(&program, &stages, replies, arguments.step, &target)?,
    };
    let shown = rehearsed
        .into_iter()
        .zip(&stages)
        .map(|(rehearsed, stage)| {
            let corrections = corrections_of(&program, stage, values);
            let conversation = &rehearsed.conversation;
            let messages = conversation.spoken.iter().zip(&conversation.messages);
            Ok(ShownStage {
                corrections: corrections.map_err(Failure::environment)?,
                n_asked_first: rehearsed.n_asked_first,
                messages: messages
                    .map(|(spoken, sent)| displayed(spoken, Some(sent), arguments.step))
                    .collect(),
                findings: rehearsed.findings.iter().map(in_words).collect(),
                results: rehearsed
                    .findings
                    .iter()
                    .map(|it| serde_json::json!(it))
                    .collect(),
                name: rehearsed.stage,
            })
        });
    Ok(Rendered {
        shown: shown.collect::<Result<_, Failure>>()?,
        price: target.profile.map(|profile| Price::of(profile, io)),
        program,
    })
}

/// What the camera sees at a step, and the pictures of it.
struct Seen {
    scene: StepScene,
    pictures: Pictures,
}

impl Seen {
    /// Lays the cloth, executes the demonstrated folds before the step, and takes a picture.
    fn at(
        program: &Program,
        declared: &Program,
        arguments: &RenderArguments,
        interrupt: &Interrupt,
        io: &Io,
    ) -> Result<Seen, Failure> {
        let mut world = setting::world(program).map_err(Failure::environment)?;
        let world = world.as_mut();
        let folder = sources::folder_of(&arguments.task.file);
        let subgoals = SubgoalSet::obtain(declared, &folder, world, interrupt)
            .map_err(Failure::environment)?;
        let examples = Examples::load(program, &folder).map_err(Failure::environment)?;
        say_pictures(&subgoals, &examples, &arguments.task.file, io);
        let start = &arguments.camera.start;
        let start = setting::start(program, &folder, start, world, interrupt, io)?;
        let step = arguments.step;
        let scene = scene_at_step(program, &start, step, &subgoals, world, interrupt, io)?;
        let shown = subgoals.step(step as usize - 1);
        let shown = shown.map_err(Failure::environment)?;
        let pictures = Pictures::of(
            program,
            &scene.scene,
            &scene.observation,
            scene.last.as_ref(),
            shown,
            examples,
        );
        let pictures = pictures.map_err(Failure::environment)?;
        Ok(Seen { scene, pictures })
    }

    /// Goes through the stages with the given answers.
    fn rehearsed(
        &self,
        program: &Program,
        stages: &[&Stage],
        replies: &[String],
        step: u32,
        target: &TargetModel,
    ) -> Result<Vec<Rehearsed>, Failure> {
        let StepScene {
            scene,
            observation,
            last,
        } = &self.scene;
        let view = StepView::without_rollout(
            program,
            scene,
            observation,
            step,
            last.as_ref(),
            &self.pictures,
        );
        let lowering = |_| target.lowering;
        let rehearsed = policy::rehearse(view, stages, &lowering, replies.to_vec());
        let (rehearsed, left) = rehearsed.map_err(Failure::environment)?;
        match left.len() {
            0 => Ok(rehearsed),
            beyond => Err(Failure::usage(format!(
                "the last {beyond} of the answers given by `--reply` belong to no question: no more are asked"
            ))),
        }
    }

    /// Returns the first question of each stage, with the points of a file.
    fn conversations(
        &self,
        program: &Program,
        stages: &[&Stage],
        values: Values<'_>,
        step: u32,
        target: &TargetModel,
    ) -> Result<Vec<Rehearsed>, Failure> {
        let stages = stages.iter().map(|stage| {
            let pictures = &self.pictures;
            let lowering = &target.lowering;
            let conversation =
                policy::conversation(program, stage, values, pictures, step, lowering);
            let conversation = conversation.map_err(Failure::environment)?;
            Ok(Rehearsed {
                stage: stage.name.clone(),
                n_asked_first: conversation.messages.len(),
                conversation,
                findings: Vec::new(),
            })
        });
        stages.collect()
    }
}

/// Describes the finding about an answer.
fn in_words(finding: &Finding) -> String {
    let (words, stated) = match finding {
        Finding::Text {
            name,
            value,
            stated,
            ..
        } => (format!("`{name}` is \"{value}\""), stated),
        Finding::Action {
            verdict, stated, ..
        } => match verdict {
            Verdict::Accept => ("accepted".to_owned(), stated),
            Verdict::Reject { check, .. } => (format!("refused by `{check}`"), stated),
        },
        Finding::Malformed { field, stated, .. } => (format!("`{field}` cannot be read"), stated),
        Finding::Failed { why, .. } => return why.clone(),
    };
    let sources: String = stated.iter().map(source).collect();
    format!("{words}{sources}")
}

/// Names the characters of an answer that were read as a field, and each repair.
fn source(stated: &Stated) -> String {
    let text = stated.text.split_whitespace().collect::<Vec<_>>().join(" ");
    let repairs = stated.repairs.iter().map(|repair| format!("; {repair}"));
    format!(
        "\n  `{}` from `{text}` at byte {}{}",
        stated.field,
        stated.at,
        repairs.collect::<String>()
    )
}

/// Returns messages for display without their pictures.
pub fn shown_without_drawing(spoken: &[UndrawnMessage], step: u32) -> Vec<DisplayMessage> {
    let messages = spoken.iter();
    messages.map(|it| displayed(it, None, step)).collect()
}

/// Combines a message with the request that is sent, if it was drawn.
fn displayed(spoken: &UndrawnMessage, sent: Option<&Message>, step: u32) -> DisplayMessage {
    let png = |number: usize| match sent?.parts.get(number)? {
        Part::Image(png) => Some(png.bytes().to_vec()),
        Part::Text(_) => None,
    };
    let part = |(number, part): (usize, &MessagePart)| {
        let title = match part {
            MessagePart::Text(said) => return DisplayPart::Text(said.clone()),
            MessagePart::Picture(picture) => title(picture, step),
            MessagePart::RefusedAction => "the refused action".to_owned(),
            MessagePart::Prediction => "what would come of the answer".to_owned(),
        };
        let png = png(number);
        DisplayPart::Picture { title, png }
    };
    DisplayMessage {
        role: match spoken.speaker {
            Speaker::System => "system",
            Speaker::User => "user",
            Speaker::Assistant => "assistant",
        },
        parts: spoken.parts.iter().enumerate().map(part).collect(),
    }
}
