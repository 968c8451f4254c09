//! Fills templates: the one place where a template becomes text.
//!
//! In: a program and [`Facts`], which become strings first. Out: the exact messages for a model. The templates use a
//! subset of Jinja that minijinja and Python's jinja2 render to the same bytes. A missing value is an error, nothing
//! is escaped, and rendering is bounded.

mod jinja;
mod placeholders;
mod text;

pub use jinja::{Jinja, escaped, placeholder};
pub use placeholders::constant;
pub use text::{FABC, Origin, Place, PromptText, Stretch};

use crate::data::actions::ActionField;
use crate::data::files::FileRef;
use crate::data::placeholders::Placeholder;
use crate::data::program::Program;
use crate::data::stage::{Picture, Read, Stage, Template};
use crate::data::verify::Check;
use crate::eval::{Eval, Notes};
use crate::facts::Facts;
use crate::pointing::{Notation, Pointing, PointingError};
use crate::scene::Missing;
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Value;
use minijinja::{AutoEscape, Environment, UndefinedBehavior};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The most steps that minijinja may take for one template.
const FUEL: u64 = 1_000_000;

/// The longest text that a template may become, bytes.
const MAX_BYTES: usize = 1 << 20;

/// Separates two texts of a message.
pub const SEPARATOR: &str = "\n\n";

/// Where the values of a text come from.
#[derive(Clone, Copy)]
pub enum Values<'a> {
    /// From the facts.
    Known(Facts<'a>),
    /// From the facts; missing values appear as in [`Values::Typed`].
    Partly(Facts<'a>),
    /// Without facts: each value appears as a description in angle brackets.
    ///
    /// Conditional texts are shown, because some scene would show them.
    Typed,
}

impl Values<'_> {
    /// Returns the same for a model with this pointing; placeholders of [`Values::Typed`] stay unchanged.
    pub fn with_pointing(self, pointing: Pointing) -> Self {
        match self {
            Values::Known(facts) => Values::Known(Facts { pointing, ..facts }),
            Values::Partly(facts) => Values::Partly(Facts { pointing, ..facts }),
            Values::Typed => Values::Typed,
        }
    }

    /// Returns how the points of the scene are written.
    pub fn notation(&self, program: &Program) -> Notation {
        match self {
            Values::Known(facts) | Values::Partly(facts) => facts.notation(program),
            Values::Typed => Notation::pixels(),
        }
    }

    /// Returns the frame in which they are written.
    pub fn pointing(&self, program: &Program) -> Pointing {
        match self {
            Values::Known(facts) | Values::Partly(facts) => facts.pointing,
            Values::Typed => Pointing::of_camera(&program.camera),
        }
    }
}

/// Who speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PromptSpeaker {
    /// The instructions for the whole conversation.
    System,
    /// The question.
    User,
    /// The answer of an example.
    Assistant,
}

/// One message for a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PromptMessage {
    /// Who speaks.
    pub speaker: PromptSpeaker,
    /// The text, and where it comes from.
    pub content: PromptText,
    /// The pictures that follow it, in order.
    pub pictures: Vec<PromptPicture>,
}

/// A picture of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PromptPicture {
    /// A picture that the runtime draws.
    Drawn(Picture),
    /// One of the author's pictures.
    File(FileRef),
}

/// Renders the messages of a stage: the system message, if it has one, its examples, and the question.
///
/// Two remarks may be appended to the question. If some candidate points are unreachable and its texts do not say so,
/// it lists them. If it shows points without saying how they are written, it says that, unless they are pixels of the
/// camera's picture, for which the task's own words are written. Fails if a value is missing, if the stage cannot be
/// asked in this frame, or if the program was edited by hand.
pub fn messages(
    program: &Program,
    stage: &Stage,
    values: Values<'_>,
) -> Result<Vec<PromptMessage>, RenderError> {
    let pointing = values.pointing(program);
    pointing.check(program, stage)?;
    let mut messages = Vec::with_capacity(2 + 2 * stage.examples.len());
    let mut say = |speaker, content, pictures| {
        messages.push(PromptMessage {
            speaker,
            content,
            pictures,
        });
    };
    if !stage.system.is_empty() {
        let content = joined(program, &stage.system, values)?;
        say(PromptSpeaker::System, content, Vec::new());
    }
    for (example, number) in stage.examples.iter().zip(1..) {
        let name = format!("example {number}");
        let texts = example
            .say
            .iter()
            .map(|words| PromptText::literal(words, &name));
        let images = example.images.iter().cloned().map(PromptPicture::File);
        let asked = PromptText::joined(texts, SEPARATOR);
        say(PromptSpeaker::User, asked, images.collect());
        let answered = PromptText::literal(&example.reply, &name);
        say(PromptSpeaker::Assistant, answered, Vec::new());
    }
    let pictures = stage.show.iter().copied().map(PromptPicture::Drawn);
    let mut content = joined(program, &stage.say, values)?;
    if let Some(remark) = reach_remark(program, stage, values) {
        content.push(SEPARATOR, PromptText::by_fabc(remark));
    }
    if leaves_frame_open(program, stage, &pointing) {
        content.push(SEPARATOR, PromptText::by_fabc(pointing.sentence()));
    }
    say(PromptSpeaker::User, content, pictures.collect());
    Ok(messages)
}

/// Returns whether a stage shows or asks for points that are not pixels of the camera's picture, and none of its
/// texts says how they are written. [`messages`] then says it.
pub fn leaves_frame_open(program: &Program, stage: &Stage, pointing: &Pointing) -> bool {
    if pointing.is_native() {
        return false;
    }
    let templates = templates_of(program, stage);
    // A conditional part may be missing from the prompt.
    let says_so = templates
        .iter()
        .filter(|template| template.when.is_none())
        .flat_map(|template| &template.variables)
        .any(|variable| variable.value == Placeholder::PointForm);
    let asks =
        matches!(stage.read, Read::Action) && program.actions.iter().any(ActionField::is_point);
    !says_so && (asks || shows_points(program, &templates))
}

/// Returns the remark of [`messages`] about unreachable candidate points, if a stage shows or asks for points and
/// none of its rendered texts names the unreachable ones.
fn reach_remark(program: &Program, stage: &Stage, values: Values<'_>) -> Option<String> {
    let (Values::Known(facts) | Values::Partly(facts)) = values else {
        return None;
    };
    if facts.scene.unreachable().is_empty() {
        return None;
    }
    let eval = Eval { program, facts };
    let is_said = |template: &&&Template| match &template.when {
        Some(when) => eval.holds(when, &mut Notes::new()).unwrap_or(false),
        None => true,
    };
    let templates = templates_of(program, stage);
    let said = templates.iter().filter(is_said);
    let says_so = said
        .flat_map(|template| &template.variables)
        .any(|variable| variable.value == Placeholder::Unreachable);
    let concerns = matches!(stage.read, Read::Action) || shows_points(program, &templates);
    let points = placeholders::unreachable(facts.scene, &facts.notation(program));
    (concerns && !says_so).then(|| {
        format!("Some points cannot be reached, and nothing can be done there. They are not among those listed: {points}.")
    })
}

fn templates_of<'p>(program: &'p Program, stage: &Stage) -> Vec<&'p Template> {
    let names = stage.system.iter().chain(&stage.say);
    names.filter_map(|name| program.template(name)).collect()
}

fn shows_points(program: &Program, templates: &[&Template]) -> bool {
    let mut shown = templates.iter().flat_map(|template| &template.variables);
    shown.any(|variable| placeholders::has_points(program, &variable.value))
}

/// What a prompt says about pictures of the scene if points are numbered.
pub const NUMBERED_POINTS: &str =
    "The numbers in the picture of the scene are those of the listed points.";

/// What a correction says about its picture, if the task corrects `with picture`.
///
/// The runtime draws the marks. The words are here, with every other text that reaches a model.
pub const REFUSED_ACTION: &str = "The picture shows the refused action: a green ring around the pick point, a green arrow along the move, and a purple ring around the place point.";

/// Renders the message to the model for each check that could fail, and then for a step whose result is rejected.
///
/// - Returns the check's `NAME`, or `result`, and the text. With [`Values::Partly`], placeholders stand for the
///   rejected action, because there is none yet.
pub fn corrections(
    program: &Program,
    values: Values<'_>,
) -> Result<Vec<(String, PromptText)>, RenderError> {
    let checks = program.verify.checks.iter();
    let checks = checks.map(|check| (check.name.as_str(), check.message.as_str()));
    let result = program.verify.result.iter();
    let result = result.map(|check| ("result", check.message.as_str()));
    let mut told = Vec::new();
    for (name, message) in checks.chain(result) {
        let text = text(program, message, values)?;
        told.extend(text.map(|text| (name.to_owned(), text)));
    }
    Ok(told)
}

/// Renders the message to the model when a check fails.
pub fn correction(
    program: &Program,
    check: &Check,
    facts: Facts<'_>,
) -> Result<String, RenderError> {
    let text = plain_text(program, &check.message, Values::Known(facts))?;
    Ok(text.unwrap_or_default())
}

/// Renders one template to plain text; `None` if its condition does not hold.
///
/// Fails if a value is missing or if the program was edited by hand.
pub fn plain_text(
    program: &Program,
    name: &str,
    values: Values<'_>,
) -> Result<Option<String>, RenderError> {
    Ok(text(program, name, values)?.map(|content| content.text))
}

/// Renders one template with the source of each stretch; `None` if its condition does not hold.
pub fn text(
    program: &Program,
    name: &str,
    values: Values<'_>,
) -> Result<Option<PromptText>, RenderError> {
    let Some(template) = program.template(name) else {
        return Err(RenderError::UnknownTemplate {
            template: name.to_owned(),
        });
    };
    if let (Some(when), Values::Known(facts) | Values::Partly(facts)) = (&template.when, values) {
        let eval = Eval { program, facts };
        match (eval.holds(when, &mut Notes::new()), values) {
            (Ok(true), _) => {}
            (Ok(false), _) => return Ok(None),
            (Err(_), Values::Partly(_)) => {}
            (Err(missing), _) => return Err(missing.into()),
        }
    }
    let texts = self::values(program, template, values)?;
    let context = texts
        .iter()
        .map(|(variable, text)| (variable.clone(), Value::from(text.as_str())))
        .collect();
    let text = fill(&template.text, &context).map_err(|why| RenderError::BadTemplate {
        template: name.to_owned(),
        why,
    })?;
    Ok(Some(text::laid_over(template, &texts, text)))
}

/// Writes the values that a template shows, by variable.
pub fn values(
    program: &Program,
    template: &Template,
    values: Values<'_>,
) -> Result<BTreeMap<String, String>, RenderError> {
    let mut texts = BTreeMap::new();
    for variable in &template.variables {
        let text = match values {
            Values::Known(facts) => placeholders::known(program, facts, &variable.value)?,
            Values::Partly(facts) => placeholders::known(program, facts, &variable.value)
                .unwrap_or_else(|_| placeholders::typed(program, &variable.name, &variable.value)),
            Values::Typed => placeholders::typed(program, &variable.name, &variable.value),
        };
        texts.insert(variable.name.clone(), text);
    }
    Ok(texts)
}

fn joined(
    program: &Program,
    names: &[String],
    values: Values<'_>,
) -> Result<PromptText, RenderError> {
    let mut texts = Vec::with_capacity(names.len());
    for name in names {
        texts.extend(text(program, name, values)?);
    }
    Ok(PromptText::joined(texts, SEPARATOR))
}

/// Fills Jinja source; fails with the reason in words.
pub fn fill(source: &str, context: &BTreeMap<String, Value>) -> Result<String, String> {
    let text = environment()
        .render_str(source, Value::from(context.clone()))
        .map_err(|error| error.to_string())?;
    if text.len() > MAX_BYTES {
        return Err(format!(
            "it becomes {} bytes long, at most {MAX_BYTES} are accepted",
            text.len()
        ));
    }
    Ok(text)
}

/// Returns a minijinja environment with the settings under which it agrees with Python's jinja2.
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

/// Why a template cannot be rendered.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RenderError {
    /// The program has no such template.
    #[error("the program has no template `{template}`")]
    UnknownTemplate {
        /// Its name.
        template: String,
    },
    /// A keypoint, a field or a text is missing.
    #[error("`{name}` is not known here")]
    MissingFact {
        /// Its name.
        name: String,
    },
    /// The template cannot be rendered; the compiler never emits such a template.
    #[error("the template `{template}` cannot be rendered: {why}")]
    BadTemplate {
        /// The template.
        template: String,
        /// The template engine's message.
        why: String,
    },
    /// The stage cannot be asked of a model with this pointing.
    #[error(transparent)]
    Pointing(#[from] PointingError),
}

impl From<Missing> for RenderError {
    fn from(missing: Missing) -> Self {
        RenderError::MissingFact { name: missing.name }
    }
}
