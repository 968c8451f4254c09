//! The texts that reach a model, and the questions that they make up.

use crate::data::files::FileRef;
use crate::data::placeholders::Placeholder;
use crate::data::values::Condition;
use crate::words::words;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// One piece of text in the portable Jinja subset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Template {
    /// The component's name; `STAGE.say` or `STAGE.system` for a stage's own text (`STAGE.say.2` for a second one);
    /// `check.NAME` for the message of a check.
    pub name: String,
    /// When it is part of the prompt; `None` means always.
    pub when: Option<Condition>,
    /// Jinja source; every variable in it is a string.
    pub text: String,
    /// The variables in it, by name.
    pub variables: Vec<Variable>,
    /// The file that declares it, as in [`crate::data::files::SourceStamp::name`].
    pub declared_in: String,
    /// The line of its first character there, from 1.
    pub line: u32,
}

/// A variable of a template.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    /// Its name in templates; one name means one value in the whole program.
    pub name: String,
    /// The value that it shows.
    pub value: Placeholder,
}

/// One question to a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Its name in the task.
    pub name: String,
    /// Which model is asked.
    pub model: ModelRole,
    /// Sampling temperature, if the task states one.
    pub temperature: Option<f64>,
    /// Nucleus sampling, 0 to 1, if the task states it.
    pub top_p: Option<f64>,
    /// The longest answer, tokens, if the task states one.
    pub max_tokens: Option<u32>,
    /// How much the model thinks before it answers, if the task states it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reasoning: Option<Reasoning>,
    /// How many answers are asked for where a rehearsal chooses among them, if the task states it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub candidates: Option<u32>,
    /// Templates of the system message, joined by a blank line; if empty, there is no system message.
    pub system: Vec<String>,
    /// Questions and answers that come before this question.
    pub examples: Vec<Example>,
    /// Templates of the user message, joined by a blank line.
    pub say: Vec<String>,
    /// Pictures that follow the user message's text, in order.
    pub show: Vec<Picture>,
    /// What is taken from the answer.
    pub read: Read,
}

impl Stage {
    /// Returns how many answers are asked for where a rehearsal chooses among them.
    pub fn candidates(&self) -> u32 {
        self.candidates.unwrap_or(1)
    }
}

/// A question with its answer, shown to a model as if it had been asked before.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Example {
    /// The question's texts, joined by a blank line.
    pub say: Vec<LiteralText>,
    /// Pictures that follow it.
    pub images: Vec<FileRef>,
    /// The answer; the stage's own reader can read it.
    pub reply: LiteralText,
}

/// A text of a source file that is used unchanged.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LiteralText {
    /// The text.
    pub text: String,
    /// The file that contains it, as in [`crate::data::files::SourceStamp::name`].
    pub declared_in: String,
    /// The line of its first character there, from 1.
    pub line: u32,
}

/// How much a model thinks before it answers: hidden tokens, apart from the answer's own.
///
/// In JSON and TOML a word or a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected `none`, `low`, `medium`, `high` or a number of tokens"
)]
pub enum Reasoning {
    /// As much as the model takes this word to mean.
    Level(ReasoningLevel),
    /// At most so many tokens.
    Tokens(u32),
}

/// How much a model thinks, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReasoningLevel {
    /// Not at all.
    None,
    /// Little.
    Low,
    /// More.
    Medium,
    /// Much.
    High,
}

words!(ReasoningLevel {
    "none" => None, "not at all";
    "low" => Low, "little";
    "medium" => Medium, "more";
    "high" => High, "much";
});

impl Reasoning {
    /// The largest number of tokens that can be stated.
    pub const MOST_TOKENS: u32 = 100_000;
    /// The word after a number of tokens.
    pub const UNIT: &'static str = "tokens";

    /// Returns the hidden tokens that are allowed beside the answer's.
    ///
    /// No vendor says how many a word may take; these are powers of four above the smallest budget of Anthropic's
    /// client (1,024). A question whose thinking needs more is asked once more, with twice as many.
    pub fn allowed_tokens(self) -> u32 {
        match self {
            Reasoning::Level(ReasoningLevel::None) => 0,
            Reasoning::Level(ReasoningLevel::Low) => 1024,
            Reasoning::Level(ReasoningLevel::Medium) => 4096,
            Reasoning::Level(ReasoningLevel::High) => 16_384,
            Reasoning::Tokens(tokens) => tokens,
        }
    }
}

impl fmt::Display for Reasoning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Reasoning::Level(level) => f.write_str(level.word()),
            Reasoning::Tokens(tokens) => write!(f, "{tokens} {}", Reasoning::UNIT),
        }
    }
}

impl FromStr for Reasoning {
    type Err = String;

    /// Reads a word, or a number with or without `tokens`.
    fn from_str(text: &str) -> Result<Reasoning, String> {
        let text = text.trim();
        if let Some(level) = ReasoningLevel::from_word(text) {
            return Ok(Reasoning::Level(level));
        }
        let number = text.strip_suffix(Reasoning::UNIT).unwrap_or(text);
        let tokens = number.trim_end().parse().ok();
        let tokens = tokens.filter(|tokens| (1..=Reasoning::MOST_TOKENS).contains(tokens));
        tokens.map(Reasoning::Tokens).ok_or_else(|| {
            format!(
                "write `none`, `low`, `medium`, `high`, or a number of tokens from 1 to {}",
                Reasoning::MOST_TOKENS
            )
        })
    }
}

/// The kind of model that a stage asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelRole {
    /// One that sees pictures.
    Vision,
    /// One that reads text.
    Text,
}

/// A picture shown to a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "picture", rename_all = "snake_case")]
pub enum Picture {
    /// A subgoal.
    Subgoal {
        /// Which one.
        which: SubgoalStep,
        /// Whether the step's arrow is drawn on it.
        arrow: Arrow,
    },
    /// What the camera sees now.
    Scene {
        /// Whether the task's layers are drawn on it.
        layers: Layers,
    },
}

/// Which of the two pictures around a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SubgoalStep {
    /// The cloth before the step.
    Now,
    /// The cloth after the step.
    Next,
}

/// Whether an arrow from pick to place is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arrow {
    /// A ring at the pick, a line, and a tip at the place (protocol, section 6).
    Drawn,
    /// The bare picture.
    Absent,
}

/// Whether the task's annotation layers are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Layers {
    /// All of them, in order.
    Drawn,
    /// The bare picture.
    Absent,
}

/// What is taken from an answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum Read {
    /// The text between two literals, as a variable of later stages.
    Text {
        /// The variable.
        name: String,
        /// The literal before it, e.g. `Instructions:`.
        before: String,
        /// The literal after it; if empty, the text ends with the line.
        after: String,
    },
    /// All fields of the action.
    Action,
}
