//! Renders prompts of a scene from the world's camera, with the pictures that a model gets.

use super::page::{DisplayMessage, DisplayPart, ShownStage};
use super::scene_file::SceneFile;
use super::title;
use super::why::Rates;
use crate::exit::Failure;
use crate::io::Io;
use crate::sources;
use crate::verbs::render::RenderArguments;
use crate::verbs::runtime::run::say_pictures;
use crate::verbs::runtime::setting;
use crate::verbs::runtime::setting::StartArguments;
use crate::verbs::runtime::setting::catalogue;
use crate::verbs::runtime::setting::catalogue::FactsArguments;
use crate::verbs::runtime::setting::models::TargetModel;
use crate::verbs::runtime::step_scene::{StepScene, scene_at_step};
use clap::Args;
use fab_agent::examples::Examples;
use fab_agent::pictures::Pictures;
use fab_agent::policy;
use fab_agent::policy::{Conversation, Finding, MessagePart, Rehearsed, StepView, UndrawnMessage};
use fab_agent::subgoals::SubgoalSet;
use fab_base::interrupt::Interrupt;
use fab_model::calls::Usage;
use fab_model::{Message, Part, Speaker};
use fab_picture::png;
use fab_program::facts::Facts;
use fab_program::render::Values;
use fab_program::reply::Stated;
use fab_program::scene::SceneView;
use fab_program::verify::Verdict;
use fab_program::{ClothStart, Program, Stage};
use fab_providers::catalogue::{Date, Profile};
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

/// Returns the task for the cloth of the named start file, if there is one; otherwise the task unchanged.
pub fn fitted(
    declared: &Program,
    arguments: &RenderArguments,
    io: &Io,
) -> Result<Program, Failure> {
    let is_seed = |text: &String| text.bytes().all(|byte| byte.is_ascii_digit());
    let is_file = match &arguments.camera.start.start {
        Some(text) => !is_seed(text),
        None => matches!(declared.cloth.start, ClothStart::File { .. }),
    };
    if !is_file || arguments.scene.is_some() {
        return Ok(declared.clone());
    }
    let world = setting::world(declared).map_err(Failure::environment)?;
    let folder = sources::folder_of(&arguments.task.file);
    let interrupt = interrupt(arguments, io)?;
    let start = setting::start(
        declared,
        &folder,
        &arguments.camera.start,
        world.as_ref(),
        &interrupt,
        io,
    )?;
    setting::fitted(&arguments.task, declared, &start, io)
}

/// Returns what ends a simulation early. Ctrl-C ends the whole program, unless `--watch` listens to it.
fn interrupt(arguments: &RenderArguments, io: &Io) -> Result<Interrupt, Failure> {
    match arguments.watch {
        true => io.interrupt(),
        false => Ok(Interrupt::default()),
    }
}

/// A scene and everything that can be displayed of it.
pub struct DisplayedScene {
    seen: StepScene,
    pictures: Pictures,
    step: u32,
    target_model: TargetModel,
    rates: Option<RatesOn>,
}

impl DisplayedScene {
    /// Lays the cloth, executes the demonstrated folds before the step, and takes a picture.
    ///
    /// - `program`: the task for the cloth that lies there.
    /// - `declared`: the task as written; its subgoals are shown.
    pub fn at(
        program: &Program,
        declared: &Program,
        arguments: &RenderArguments,
        io: &Io,
    ) -> Result<DisplayedScene, Failure> {
        if arguments.scene.is_some() && arguments.camera.start.start.is_some() {
            let both = "`--scene` and `--start` exclude each other: `--scene` gives the points, with `--start` the \
                camera finds them";
            return Err(Failure::usage(both));
        }
        let target_model = TargetModel::of(&arguments.camera.shown, io)?;
        let interrupt = interrupt(arguments, io)?;
        let mut world = setting::world(program).map_err(Failure::environment)?;
        let folder = sources::folder_of(&arguments.task.file);
        let subgoals = SubgoalSet::obtain(declared, &folder, world.as_mut(), &interrupt)
            .map_err(Failure::environment)?;
        let examples = Examples::load(program, &folder).map_err(Failure::environment)?;
        say_pictures(&subgoals, &examples, &arguments.task.file, io);
        let start = setting::start(
            program,
            &folder,
            &arguments.camera.start,
            world.as_ref(),
            &interrupt,
            io,
        )?;
        let step = arguments.step;
        let seen = scene_at_step(
            program,
            &start,
            step,
            &subgoals,
            world.as_mut(),
            &interrupt,
            io,
        )?;
        let StepScene {
            scene,
            observation,
            last,
        } = &seen;
        let shown = subgoals.step(step as usize - 1);
        let shown = shown.map_err(Failure::environment)?;
        let pictures = Pictures::of(program, scene, observation, last.as_ref(), shown, examples)
            .map_err(Failure::environment)?;
        Ok(DisplayedScene {
            seen,
            pictures,
            step,
            rates: target_model.profile.clone().map(|profile| RatesOn {
                profile,
                day: catalogue::today(io),
            }),
            target_model,
        })
    }

    /// Returns the rates of the model to which the messages are shown, if one is named.
    pub fn rates(&self) -> Option<&dyn Rates> {
        self.rates.as_ref().map(|rates| rates as &dyn Rates)
    }

    /// Goes through the stages with the same functions as a rollout.
    pub fn stages(
        &self,
        program: &Program,
        stages: &[&Stage],
        listed: Option<&SceneFile>,
        arguments: &RenderArguments,
    ) -> Result<Vec<ShownStage>, Failure> {
        let rehearsed = match listed {
            Some(listed) => self.listed(program, stages, listed)?,
            None => self.rehearsed(program, stages, arguments.camera.replies.clone())?,
        };
        let texts = BTreeMap::new();
        let scene: &dyn SceneView = match listed {
            Some(listed) => listed,
            None => &self.seen.scene,
        };
        let values = Values::Partly(self.facts(scene, &texts));
        let shown = rehearsed.into_iter().map(|rehearsed| {
            let name = rehearsed.stage.as_str();
            let stage = program.stages.iter().find(|stage| stage.name == name);
            let stage = stage.expect("a rehearsed stage is one of the program's");
            let corrections = super::corrections_of(program, stage, values);
            Ok(ShownStage {
                corrections: corrections.map_err(Failure::environment)?,
                n_asked_first: rehearsed.n_asked_first,
                messages: shown(&rehearsed.conversation, self.step),
                findings: rehearsed.findings.iter().map(in_words).collect(),
                results: rehearsed
                    .findings
                    .iter()
                    .map(|it| serde_json::json!(it))
                    .collect(),
                name: rehearsed.stage,
            })
        });
        shown.collect()
    }

    fn facts<'t>(
        &'t self,
        scene: &'t dyn SceneView,
        texts: &'t BTreeMap<String, String>,
    ) -> Facts<'t> {
        Facts {
            scene,
            texts,
            step: self.step,
            last: self.seen.last.as_ref(),
            proposal: None,
            pointing: self.target_model.lowering.pointing(self.pictures.size()),
        }
    }

    fn rehearsed(
        &self,
        program: &Program,
        stages: &[&Stage],
        answers: Vec<String>,
    ) -> Result<Vec<Rehearsed>, Failure> {
        let view = StepView::without_rollout(
            program,
            &self.seen.scene,
            &self.seen.observation,
            self.step,
            self.seen.last.as_ref(),
            &self.pictures,
        );
        let lowering = |_| self.target_model.lowering;
        let rehearsed = policy::rehearse(view, stages, &lowering, answers);
        let (rehearsed, left) = rehearsed.map_err(Failure::environment)?;
        match left.len() {
            0 => Ok(rehearsed),
            beyond => Err(Failure::usage(format!(
                "the last {beyond} of the answers given by `--reply` belong to no question: no more are asked"
            ))),
        }
    }

    fn listed(
        &self,
        program: &Program,
        stages: &[&Stage],
        listed: &SceneFile,
    ) -> Result<Vec<Rehearsed>, Failure> {
        let texts = BTreeMap::new();
        let values = Values::Partly(self.facts(listed, &texts));
        let lowering = &self.target_model.lowering;
        let stages = stages.iter().map(|stage| {
            let conversation =
                policy::conversation(program, stage, values, &self.pictures, self.step, lowering);
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
    match finding {
        Finding::Text {
            name,
            value,
            stated,
            ..
        } => format!("`{name}` is \"{value}\"{}", sources(stated)),
        Finding::Action {
            verdict: Verdict::Accept,
            stated,
            ..
        } => format!("accepted{}", sources(stated)),
        Finding::Action {
            verdict: Verdict::Reject { check, .. },
            stated,
            ..
        } => format!("refused by `{check}`{}", sources(stated)),
        Finding::Malformed { field, stated, .. } => {
            format!("`{field}` cannot be read{}", sources(stated))
        }
        Finding::Failed { why, .. } => why.clone(),
    }
}

/// Lists the characters of an answer that were read, and each repair.
fn sources(stated: &[Stated]) -> String {
    let source = |it: &Stated| {
        let text = it.text.split_whitespace().collect::<Vec<_>>().join(" ");
        let repairs: String = it
            .repairs
            .iter()
            .map(|repair| format!("; {repair}"))
            .collect();
        format!(
            "\n  `{}` from `{text}` at byte {}{repairs}",
            it.field, it.at
        )
    };
    stated.iter().map(source).collect()
}

/// Returns messages for display without their pictures.
pub fn shown_without_drawing(spoken: &[UndrawnMessage], step: u32) -> Vec<DisplayMessage> {
    spoken
        .iter()
        .map(|spoken| one(spoken, None, step))
        .collect()
}

/// Combines a conversation's messages with the request that is sent.
fn shown(conversation: &Conversation, step: u32) -> Vec<DisplayMessage> {
    let both = conversation.spoken.iter().zip(&conversation.messages);
    both.map(|(spoken, message)| one(spoken, Some(message), step))
        .collect()
}

fn one(spoken: &UndrawnMessage, sent: Option<&Message>, step: u32) -> DisplayMessage {
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

/// A model's prices on a given day.
struct RatesOn {
    profile: Profile,
    day: Date,
}

impl Rates for RatesOn {
    fn model(&self) -> String {
        self.profile.title()
    }

    fn picture_tokens(&self, png: &[u8]) -> Option<(u64, u64)> {
        let [width, height] = png::size(png)?;
        let tokens = self.profile.facts.image_tokens.as_ref()?.of(width, height);
        Some((tokens.at_least, tokens.at_most))
    }

    fn cost_nano_usd(&self, tokens: u64) -> Option<u64> {
        let usage = Usage {
            input_tokens: tokens,
            ..Usage::default()
        };
        let price = self.profile.price_on(self.day)?;
        Some(price.cost(usage).nano())
    }
}
