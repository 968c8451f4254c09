//! Models that answer prompts, behind one trait; how a model gets points and pictures, calls with caps and ledger,
//! replays of earlier runs.
//!
//! In: a self-contained [`Request`]: a model gets nothing else, neither the task's name nor the simulator's state. Out:
//! a [`Reply`]. Reading the answer is the job of `fab_program::reply`, judging it of `fab_program::verify`, asking
//! again of `fab_agent::policy`.

pub mod calls;
pub mod lowering;
pub mod replay;

use crate::calls::{CallRefused, Calls, Fault, Usage, Usd};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

pub use fab_program::render::PromptSpeaker as Speaker;
pub use fab_program::{ModelRole, Reasoning};
pub use lowering::Lowering;

/// Answers one request at a time.
///
/// Stand-ins and the models of providers pass the conformance suite in `tests/suite/model_conformance.rs`.
pub trait Model: Send + Sync {
    /// Returns the name that reports and journals print, e.g. `geometric`.
    fn name(&self) -> &str;

    /// Returns what stands behind the name.
    fn nature(&self) -> ModelKind;

    /// Returns whether equal questions may get different answers at another [`Request::repetition`].
    ///
    /// A suite repeats the rollouts of such a model, and runs those of others once.
    fn varies(&self) -> bool {
        true
    }

    /// Returns whether it holds one answer for all starts of a suite, and so cannot draw one for each.
    fn shares_answers(&self) -> bool {
        false
    }

    /// Returns how the model gets points of a picture, and in which size it gets pictures.
    ///
    /// A model that forwards questions to another one returns that model's lowering.
    fn lowering(&self) -> Lowering {
        Lowering::PIXELS
    }

    /// Returns the settings that are omitted although a stage states them.
    fn omits(&self) -> Vec<&'static str> {
        Vec::new()
    }

    /// Answers a request.
    ///
    /// Reports every network call to `calls`. Fails if there is no answer; an unhelpful answer is a normal [`Reply`].
    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError>;
}

/// What a run records about a model: models with different descriptions are different models.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Description {
    /// Its name.
    pub name: String,
    /// What stands behind it.
    pub nature: ModelKind,
    /// How it gets points of pictures.
    pub lowering: Lowering,
    /// The parameters omitted from its requests.
    pub omits: Vec<String>,
}

impl Description {
    /// Describes a model.
    pub fn of(model: &dyn Model) -> Description {
        Description {
            name: model.name().to_owned(),
            nature: model.nature(),
            lowering: model.lowering(),
            omits: model.omits().into_iter().map(str::to_owned).collect(),
        }
    }
}

/// Which model answers which role.
#[derive(Clone, Copy)]
pub struct Models<'a> {
    /// Answers stages that show pictures.
    pub vision: &'a dyn Model,
    /// Answers text-only stages.
    pub text: &'a dyn Model,
}

impl<'a> Models<'a> {
    /// Returns the model for a role.
    pub fn of(&self, role: ModelRole) -> &'a dyn Model {
        match role {
            ModelRole::Vision => self.vision,
            ModelRole::Text => self.text,
        }
    }

    /// Returns the name for reports; both names if the roles differ.
    pub fn name(&self) -> String {
        let [vision, text] = [self.vision, self.text].map(Model::name);
        if vision == text {
            return vision.to_owned();
        }
        format!("{vision}, {text}")
    }

    /// Returns what stands behind them: a stand-in if either is one.
    pub fn nature(&self) -> ModelKind {
        if self.vision.nature() == ModelKind::StandIn {
            return ModelKind::StandIn;
        }
        self.text.nature()
    }

    /// Returns whether equal questions may get different answers at another repetition.
    pub fn varies(&self) -> bool {
        self.vision.varies() || self.text.varies()
    }
}

/// What stands behind a model's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelKind {
    /// A built-in program in place of a model; results say so.
    StandIn,
    /// A vision-language model.
    Model,
}

/// Everything that is sent for one answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Request {
    /// Which kind of model is asked.
    pub role: ModelRole,
    /// The conversation so far, oldest first.
    pub messages: Vec<Message>,
    /// Sampling temperature, if the task states one.
    pub temperature: Option<f64>,
    /// Nucleus sampling, if the task states it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub top_p: Option<f64>,
    /// The longest answer, tokens, if the task states a limit; hidden reasoning comes on top.
    pub max_tokens: Option<u32>,
    /// How much the model thinks before it answers, if that is stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reasoning: Option<Reasoning>,
    /// Distinguishes equal questions that need independent answers.
    pub repetition: u32,
    /// The start of a suite that the question is for; without it, equal questions at all starts are the same one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<u64>,
    /// The rollout's action that the question is for, from 1; makes a later, otherwise equal question distinct.
    pub step: u32,
    /// Which of several answers to one question this is for, from 0; the first is the question without candidates.
    #[serde(skip_serializing_if = "is_first")]
    pub candidate: u32,
    /// The JSON Schema of the answer, with the scene's values, if the stage reads the action.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub schema: Option<serde_json::Value>,
}

impl Request {
    /// Makes a first-step, single-repetition question without settings or schema.
    pub fn new(role: ModelRole, messages: Vec<Message>) -> Request {
        Request {
            role,
            messages,
            temperature: None,
            top_p: None,
            max_tokens: None,
            reasoning: None,
            repetition: 0,
            start: None,
            step: 1,
            candidate: 0,
            schema: None,
        }
    }

    /// Returns the request's identity: SHA-256 over its JSON, in which an image is replaced by its hash.
    pub fn key(&self) -> String {
        let bytes = serde_json::to_vec(self).expect("a request holds strings and finite numbers");
        fab_base::digest::of(bytes)
    }
}

fn is_first(candidate: &u32) -> bool {
    *candidate == 0
}

/// One turn of the conversation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Message {
    /// Who speaks.
    pub speaker: Speaker,
    /// Text and pictures, in order.
    pub parts: Vec<Part>,
}

impl Message {
    /// Makes a turn of text alone.
    pub fn text(speaker: Speaker, text: impl Into<String>) -> Self {
        Message {
            speaker,
            parts: vec![Part::Text(text.into())],
        }
    }
}

/// A piece of a turn.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Words.
    Text(String),
    /// A picture.
    Image(Png),
}

/// An encoded picture; journals replace it by the hash of its bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct Png {
    bytes: Arc<[u8]>,
    sha256: String,
}

impl Png {
    /// Wraps the bytes of a PNG file.
    pub fn new(bytes: Vec<u8>) -> Self {
        let sha256 = fab_base::digest::of(&bytes);
        Png {
            bytes: bytes.into(),
            sha256,
        }
    }

    /// Returns the bytes of the PNG file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns the SHA-256 of the bytes, hex.
    pub fn sha256(&self) -> &str {
        &self.sha256
    }
}

impl Serialize for Png {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.sha256)
    }
}

/// An answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reply {
    /// What the model wrote.
    pub text: String,
    /// The usage reported by the provider.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub usage: Option<Usage>,
    /// Its cost, billionths of a US dollar, if the price is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost: Option<Usd>,
}

impl Reply {
    /// Makes an answer without usage: one that was not bought.
    pub fn text(text: impl Into<String>) -> Reply {
        Reply {
            text: text.into(),
            usage: None,
            cost: None,
        }
    }
}

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The request cannot be answered by this model.
    #[error("model `{model}` cannot answer this request: {why}")]
    Unsupported {
        /// The model's name.
        model: String,
        /// What is missing or wrong.
        why: String,
    },
    /// Calls were made, and the last one failed with this fault.
    #[error("model `{model}` gave no answer ({fault}): {why}")]
    Failed {
        /// The model's name.
        model: String,
        /// What went wrong last.
        fault: Fault,
        /// The failure in words, with the number of attempts; without any API key.
        why: String,
    },
    /// A call was not sent, or the user interrupted it.
    #[error(transparent)]
    NotSent(#[from] CallRefused),
}
