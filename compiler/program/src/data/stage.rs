//! The texts that reach a model, and the questions that they make up.

use crate::data::files::FileRef;
use crate::data::placeholders::Placeholder;
use crate::data::values::Condition;
use serde::{Deserialize, Serialize};

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
