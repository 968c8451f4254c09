//! Renders prompts of a scene from the world's camera, with the pictures that a model gets.

use super::page::{DisplayMessage, DisplayPart, ShownStage};
use super::{RenderArguments, Rendered, chosen_stages, title};
use crate::exit::Failure;
use crate::io::Io;
use crate::sources::{self, TaskArguments};
use crate::verbs::price::Price;
use crate::verbs::runtime::run::say_pictures;
use crate::verbs::runtime::setting::catalogue::FactsArguments;
use crate::verbs::runtime::setting::models::TargetModel;
use crate::verbs::runtime::setting::{self, StartArguments};
use crate::verbs::runtime::step_scene::{StepScene, scene_at_step};
use clap::Args;
use fab_agent::examples::Examples;
use fab_agent::pictures::Pictures;
use fab_agent::policy::{self, Finding, MessagePart, StageMessage, StepView};
use fab_agent::subgoals::SubgoalSet;
use fab_base::interrupt::Interrupt;
use fab_program::facts::Facts;
use fab_program::render::Values;
use fab_program::reply::{Malformed, Stated};
use fab_program::verify::Verdict;
use fab_program::{ClothStart, Program};
use std::path::{Path, PathBuf};

/// Where the cloth lies, who is shown the messages, and what was answered.
#[derive(Args)]
pub struct CameraArguments {
    #[command(flatten)]
    pub start: StartArguments,
    #[command(flatten)]
    pub shown: TargetModelArguments,
    /// What a model answered, in the order of the questions; shows what follows, such as the message of a refusal.
    #[arg(long = "reply", value_name = "TEXT", allow_hyphen_values = true)]
    pub replies: Vec<String>,
}

impl CameraArguments {
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
    let is_file = match &start.start {
        Some(text) => !text.bytes().all(|byte| byte.is_ascii_digit()),
        None => matches!(declared.cloth.start, ClothStart::File { .. }),
    };
    if !is_file {
        return Ok(declared.clone());
    }
    let world = setting::world(declared)?;
    let folder = sources::folder_of(&task.file);
    let start = setting::start(declared, &folder, start, world.as_ref(), interrupt, io)?;
    setting::fitted(task, declared, &start, io)
}

/// Renders stages by the rollout's own functions; subgoals are those of the task as `declared`.
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
    let listened = arguments.watch.then(|| io.interrupt()).transpose()?;
    let interrupt = listened.unwrap_or_default();
    let program = &fitted_to_start(&arguments.task, declared, start, &interrupt, io)?;
    let stages = chosen_stages(program, arguments.stage.as_deref())?;
    let target = TargetModel::of(target, io)?;
    let (folder, step) = (sources::folder_of(&arguments.task.file), arguments.step);
    let seen = Seen::at(program, declared, &folder, start, step, &interrupt, io)?;
    let Seen {
        scene: StepScene {
            scene,
            observation,
            last,
        },
        pictures,
        subgoals,
    } = &seen;
    say_pictures(subgoals, &arguments.task.file, io);
    let values = Values::Partly(Facts {
        last: last.as_ref(),
        ..Facts::of(scene, step, target.lowering.pointing(pictures.size()))
    });
    let view =
        StepView::without_rollout(program, scene, observation, step, last.as_ref(), pictures);
    let (rehearsed, left) = policy::rehearse(view, &stages, target.lowering, replies.clone())?;
    if !left.is_empty() {
        let n_left = left.len();
        return Err(Failure::usage(format!(
            "the last {n_left} of the answers given by `--reply` belong to no question: no more are asked"
        )));
    }
    let mut shown = Vec::with_capacity(rehearsed.len());
    for (rehearsed, stage) in rehearsed.into_iter().zip(stages) {
        let messages = rehearsed.conversation.iter();
        let messages = messages.map(|message| displayed(message, step));
        let findings = rehearsed.findings.iter();
        shown.push(ShownStage {
            n_asked_first: rehearsed.n_asked_first,
            findings: findings.clone().map(in_words).collect(),
            results: findings.map(|it| serde_json::json!(it)).collect(),
            ..ShownStage::of(program, stage, values, messages.collect())?
        });
    }
    Ok(Rendered {
        stages: shown,
        price: target.profile.map(|profile| Price::of(profile, io)),
    })
}

/// What the camera sees at a step, and the pictures that the step can show.
pub struct Seen {
    pub scene: StepScene,
    pub pictures: Pictures,
    subgoals: SubgoalSet,
}

impl Seen {
    /// Lays the cloth, executes the steps before this one, and takes a picture; subgoals are those of the task as `declared`.
    pub fn at(
        program: &Program,
        declared: &Program,
        folder: &Path,
        start: &StartArguments,
        step: u32,
        interrupt: &Interrupt,
        io: &Io,
    ) -> Result<Seen, Failure> {
        let mut world = setting::world(program)?;
        let world = world.as_mut();
        let subgoals = SubgoalSet::obtain(declared, folder, world, interrupt)?;
        let examples = Examples::load(program, folder)?;
        let start = setting::start(program, folder, start, world, interrupt, io)?;
        let seen = scene_at_step(program, &start, step, &subgoals, world, interrupt, io)?;
        let StepScene {
            scene,
            observation,
            last,
        } = &seen;
        let shown = subgoals.step(step as usize - 1)?;
        let pictures = Pictures::of(program, scene, observation, last.as_ref(), shown, examples)?;
        Ok(Seen {
            scene: seen,
            pictures,
            subgoals,
        })
    }
}

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
        Finding::Malformed(Malformed { field, stated, .. }) => {
            (format!("`{field}` cannot be read"), stated)
        }
        Finding::Failed { why, .. } => return why.clone(),
    };
    let sources: String = stated.iter().map(source).collect();
    format!("{words}{sources}")
}

/// Names the characters of an answer that were read as a field, and each repair.
fn source(stated: &Stated) -> String {
    let Stated { field, at, .. } = stated;
    let text = stated.text.split_whitespace().collect::<Vec<_>>().join(" ");
    let repairs = stated.repairs.iter().map(|repair| format!("; {repair}"));
    let repairs: String = repairs.collect();
    format!("\n  `{field}` from `{text}` at byte {at}{repairs}")
}

/// Returns a message for display, with the pictures that are drawn.
pub fn displayed(message: &StageMessage, step: u32) -> DisplayMessage {
    let part = |part: &MessagePart| {
        let (title, png) = match part {
            MessagePart::Text(said) => return DisplayPart::Text { said: said.clone() },
            MessagePart::Picture(picture, png) => (title(picture, step), png.as_ref()),
            MessagePart::Added(what, png) => ((*what).to_owned(), Some(png)),
        };
        let png = png.map(|png| png.bytes().to_vec());
        DisplayPart::Image { title, png }
    };
    DisplayMessage {
        role: format!("{:?}", message.speaker).to_lowercase(),
        parts: message.parts.iter().map(part).collect(),
    }
}
