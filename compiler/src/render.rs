//! Fills templates: the one place where a template becomes text.
//!
//! In: a program and [`Bindings`], whose values are all strings. Out: the exact messages for a model. The
//! templates keep to a subset of Jinja that minijinja and Python's jinja2 render byte for byte alike;
//! a missing value is an error, nothing is escaped, and rendering is bounded.

use crate::program::{Check, KeypointShape, Picture, PixelPoint, Program, Read, Stage};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Value;
use minijinja::{AutoEscape, Environment, UndefinedBehavior};
use std::collections::BTreeMap;
use std::fmt;

/// The most steps that minijinja may take for one template.
const FUEL: u64 = 1_000_000;

/// The longest text that a template may become, bytes.
const MAX_BYTES: usize = 1 << 20;

/// The values that templates may name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bindings {
    values: BTreeMap<String, String>,
}

impl Bindings {
    /// Makes an empty set.
    pub fn new() -> Bindings {
        Bindings::default()
    }

    /// Sets a name to a pixel, written `(x, y)`.
    pub fn point(&mut self, name: &str, point: PixelPoint) {
        self.text(name, &point.to_string());
    }

    /// Sets a name to a list of pixels, written `(x, y), (x, y)`.
    pub fn points(&mut self, name: &str, points: &[PixelPoint]) {
        self.text(name, &listed(points));
    }

    /// Sets a name to a text.
    pub fn text(&mut self, name: &str, text: &str) {
        self.values.insert(name.to_owned(), text.to_owned());
    }

    /// Returns what a name stands for.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.values.get(name).map(String::as_str)
    }
}

/// Writes pixels as prompts do: `(x, y), (x, y)`.
pub(crate) fn listed(points: &[PixelPoint]) -> String {
    points
        .iter()
        .map(PixelPoint::to_string)
        .collect::<Vec<_>>()
        .join(", ")
}

/// Gives every name of a program a value that says what would stand there.
pub fn placeholders(program: &Program) -> Bindings {
    let mut bindings = Bindings::new();
    let mut put = |name: &str, what: &str| bindings.text(name, &format!("<{name}: {what}>"));
    for keypoint in &program.keypoints {
        match keypoint.extractor.shape() {
            KeypointShape::Mask => {}
            KeypointShape::Points => put(&keypoint.name, "points (x, y), …"),
            KeypointShape::Point => put(&keypoint.name, "a point (x, y)"),
        }
    }
    for stage in &program.stages {
        if let Read::Text { name, .. } = &stage.read {
            put(name, &format!("the answer of stage {}", stage.name));
        }
    }
    for field in &program.actions {
        put(&field.name, "the proposed point (x, y)");
    }
    bindings
}

/// Who speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PromptSpeaker {
    /// The frame of the conversation.
    System,
    /// The question.
    User,
}

/// One message for a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PromptMessage {
    /// Who speaks.
    pub speaker: PromptSpeaker,
    /// The text.
    pub text: String,
    /// The pictures that follow it, in order.
    pub pictures: Vec<Picture>,
}

/// Renders the messages of a stage: the system message, if it has one, and the question.
///
/// Fails where a value is missing or the program was edited by hand.
pub fn messages(
    program: &Program,
    stage: &Stage,
    bindings: &Bindings,
) -> Result<Vec<PromptMessage>, RenderError> {
    let mut messages = Vec::with_capacity(2);
    if !stage.system.is_empty() {
        let text = joined(program, &stage.system, bindings)?;
        messages.push(PromptMessage {
            speaker: PromptSpeaker::System,
            text,
            pictures: Vec::new(),
        });
    }
    let text = joined(program, &stage.say, bindings)?;
    messages.push(PromptMessage {
        speaker: PromptSpeaker::User,
        text,
        pictures: stage.show.clone(),
    });
    Ok(messages)
}

/// Renders what a model is told when a check fails.
pub fn correction(
    program: &Program,
    check: &Check,
    bindings: &Bindings,
) -> Result<String, RenderError> {
    one(program, &check.message, bindings)
}

fn joined(program: &Program, names: &[String], bindings: &Bindings) -> Result<String, RenderError> {
    let texts: Result<Vec<String>, RenderError> = names
        .iter()
        .map(|name| one(program, name, bindings))
        .collect();
    Ok(texts?.join("\n\n"))
}

fn one(program: &Program, name: &str, bindings: &Bindings) -> Result<String, RenderError> {
    let Some(template) = program.template(name) else {
        return Err(RenderError::UnknownTemplate {
            template: name.to_owned(),
        });
    };
    if let Some(missing) = template
        .variables
        .iter()
        .find(|variable| bindings.get(variable).is_none())
    {
        return Err(RenderError::MissingValue {
            template: name.to_owned(),
            variable: missing.clone(),
        });
    }
    let wrong = |why: String| RenderError::BadTemplate {
        template: name.to_owned(),
        why,
    };
    let environment = environment();
    let context: BTreeMap<&str, Value> = bindings
        .values
        .iter()
        .map(|(name, value)| (name.as_str(), Value::from(value.as_str())))
        .collect();
    let text = environment
        .render_str(&template.text, Value::from(context))
        .map_err(|error| wrong(error.to_string()))?;
    if text.len() > MAX_BYTES {
        return Err(wrong(format!(
            "it becomes {} bytes long, at most {MAX_BYTES} are accepted",
            text.len()
        )));
    }
    Ok(text)
}

/// Returns minijinja with the settings under which it agrees with Python's jinja2.
fn environment() -> Environment<'static> {
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_auto_escape_callback(|_| AutoEscape::None);
    let syntax = SyntaxConfig::builder()
        .keep_trailing_newline(true)
        .trim_blocks(false)
        .lstrip_blocks(false)
        .build();
    environment.set_syntax(syntax.expect("the usual delimiters differ from each other"));
    environment.set_fuel(Some(FUEL));
    environment
}

/// Why a template does not become a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RenderError {
    /// The program has no such template.
    UnknownTemplate {
        /// Its name.
        template: String,
    },
    /// A value is missing.
    MissingValue {
        /// The template.
        template: String,
        /// The variable.
        variable: String,
    },
    /// A keypoint that a check needs was not found in the scene.
    MissingKeypoint {
        /// The keypoint.
        keypoint: String,
    },
    /// The template cannot be rendered; the compiler emits none such.
    BadTemplate {
        /// The template.
        template: String,
        /// What the template engine said.
        why: String,
    },
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RenderError::UnknownTemplate { template } => {
                write!(f, "the program has no template `{template}`")
            }
            RenderError::MissingValue { template, variable } => write!(
                f,
                "the template `{template}` needs a value for `{variable}`"
            ),
            RenderError::MissingKeypoint { keypoint } => {
                write!(f, "the scene has no keypoint `{keypoint}`")
            }
            RenderError::BadTemplate { template, why } => {
                write!(f, "the template `{template}` cannot be rendered: {why}")
            }
        }
    }
}

impl std::error::Error for RenderError {}
