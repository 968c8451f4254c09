//! Finds out what a model's interface takes: parameters, a schema, several pictures; and whether the model reasons.
//!
//! In: a model that can be asked under other assumptions than its known facts. Out: the facts that its answers and
//! refusals show, and in words what they leave open. A refusal counts only if the same question is taken without the
//! part in doubt.

use super::{MAX_TOKENS, reading};
use crate::catalogue::{Accepted, Facts, MaxTokensField, Wire, tokens};
use crate::remote::settings::Parameter;
use fab_base::wording::shown;
use fab_model::calls::{Calls, Fault, Usage, Usd};
use fab_model::{Message, Model, ModelError, ModelRole, Part, Png, Reply, Request, Speaker};
use fab_picture::png;
use fab_program::reply::{Aside, standing};
use image::{Rgb, RgbImage};
use serde::Serialize;
use serde_json::{Value, json};
use std::sync::Arc;

/// The most questions that [`abilities`] asks.
pub const MOST_QUESTIONS: u64 = 9;
/// A sampling value that the shipped tasks state, and that some models refuse.
const TEMPERATURE: f64 = 0.2;
/// As common as it is refused by models that fix their sampling.
const TOP_P: f64 = 0.9;
/// Sides of the two pictures of one colour, pixels.
const SIDE_PX: u32 = 112;
/// The longest answer that a remark repeats, characters.
const MAX_ANSWER: usize = 60;
/// Tokens beyond those of the text that are not yet taken for hidden thoughts: marks of the chat format.
const MARKS: u64 = 20;

/// A model that can be asked under assumed facts.
pub trait Subject {
    /// Returns the facts that are known of it.
    fn known(&self) -> &Facts;

    /// Returns the form of its messages.
    fn wire(&self) -> Wire;

    /// Returns the model as if these facts were known.
    fn under(&self, facts: &Facts) -> Result<Arc<dyn Model>, ModelError>;
}

/// What answers and refusals show.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Abilities {
    /// The facts that were found; others are `None`.
    pub facts: Facts,
    /// Whether it thinks before it answers; `None`: its answers do not tell.
    pub reasons: Option<bool>,
    /// What was seen besides, or left open, in words.
    pub notes: Vec<String>,
    /// Usage of all answers, as reported.
    pub usage: Usage,
    /// Their cost; `None` if a part is unknown.
    pub cost: Option<Usd>,
}

/// What became of a question.
enum Outcome {
    Answered(String),
    /// The interface refused it, with these words.
    Refused(String),
    /// It failed in another way, which says nothing about the part in doubt: the fault, and its words.
    Failed(Fault, String),
}

struct Prober<'a> {
    subject: &'a dyn Subject,
    calls: &'a mut dyn Calls,
    found: Abilities,
}

/// Asks up to [`MOST_QUESTIONS`] short questions.
///
/// Fails if a call is not sent, or fails in a way that further questions would not survive.
pub fn abilities(subject: &dyn Subject, calls: &mut dyn Calls) -> Result<Abilities, ModelError> {
    let mut prober = Prober {
        subject,
        calls,
        found: Abilities {
            cost: Some(Usd::ZERO),
            ..Abilities::default()
        },
    };
    if prober.token_limit()? {
        prober.sampling("temperature", TEMPERATURE)?;
        prober.sampling("top_p", TOP_P)?;
        prober.schema()?;
        prober.pictures()?;
    }
    Ok(prober.found)
}

impl Prober<'_> {
    /// Finds the name of the token limit; returns whether the interface takes questions at all.
    fn token_limit(&mut self) -> Result<bool, ModelError> {
        let known = self.subject.known().max_tokens_field;
        let omitted = self.subject.under(self.subject.known())?.omits();
        let fields: &[Option<MaxTokensField>] = match (self.subject.wire(), known) {
            (Wire::OpenaiChat, None) if !omitted.contains(&Parameter::MaxTokens.name()) => &[
                Some(MaxTokensField::MaxTokens),
                Some(MaxTokensField::MaxCompletionTokens),
            ],
            (_, Some(field)) => &[Some(field)],
            (_, None) => &[None],
        };
        let mut last = String::new();
        for field in fields {
            self.found.facts.max_tokens_field = *field;
            match self.ask(&say_yes(), |_| {})? {
                Outcome::Refused(why) => last = why,
                Outcome::Answered(_) => return Ok(true),
                // Further questions would fare alike, and may be billed.
                Outcome::Failed(fault @ (Fault::ServerFailed | Fault::InvalidReply), why) => {
                    let model = self.subject.under(self.subject.known())?;
                    return Err(ModelError::Failed {
                        model: model.name().to_owned(),
                        fault,
                        why,
                    });
                }
                Outcome::Failed(_, why) => {
                    self.note(format!("a first question failed: {why}"));
                    return Ok(true);
                }
            }
        }
        self.found.facts.max_tokens_field = None;
        self.note(format!(
            "it takes no question with a limit on its answer: {last}"
        ));
        Ok(false)
    }

    fn sampling(&mut self, name: &str, value: f64) -> Result<(), ModelError> {
        let stated = |value: f64| {
            let mut request = say_yes();
            match name {
                "top_p" => request.top_p = Some(value),
                _ => request.temperature = Some(value),
            }
            request
        };
        let accepted = match self.ask(&stated(value), |_| {})? {
            Outcome::Answered(_) => {
                self.note(format!("it takes {name} {value}"));
                return Ok(());
            }
            Outcome::Failed(_, why) => {
                self.note(format!("whether it takes {name} is open: {why}"));
                return Ok(());
            }
            Outcome::Refused(_) => match self.ask(&stated(1.0), |_| {})? {
                Outcome::Answered(_) => Accepted::Only(vec![1.0]),
                Outcome::Refused(_) => Accepted::Refused,
                Outcome::Failed(_, why) => {
                    self.note(format!(
                        "it refuses {name} {value}; whether it takes 1 is open: {why}"
                    ));
                    return Ok(());
                }
            },
        };
        match name {
            "top_p" => self.found.facts.top_p = Some(accepted),
            _ => self.found.facts.temperature = Some(accepted),
        }
        Ok(())
    }

    /// Asks in words for what the schema forbids. It has the keywords of a task's schema, because llama.cpp's server answers
    /// without any grammar, and says nothing, if it cannot parse the one that it made of the schema.
    fn schema(&mut self) -> Result<(), ModelError> {
        let words = "Name a tree. Answer with one word and nothing else.";
        let mut request = asked(vec![Part::Text(words.to_owned())]);
        let properties = json!({
            "reason": { "type": "string", "maxLength": 80 },
            "at": { "type": "string", "pattern": "^\\((0|-?[1-9][0-9]{0,5}), (0|-?[1-9][0-9]{0,5})\\)$" },
            "colour": { "type": "string", "enum": ["green", "brown"] },
        });
        request.schema = Some(json!({
            "type": "object",
            "properties": properties,
            "required": ["reason", "at", "colour"],
            "additionalProperties": false,
        }));
        let follows = match self.ask(&request, |facts| facts.structured_output = Some(true))? {
            Outcome::Answered(text) => {
                let answer = standing(&text).text;
                let answer: Value = serde_json::from_str(answer.trim()).unwrap_or_default();
                let follows = ["green", "brown"].iter().any(|it| answer["colour"] == **it);
                if !follows {
                    self.note(format!(
                        "the server takes a schema and ignores it: to `{words}` it answers `{}`, which the schema forbids",
                        shown(text.trim(), MAX_ANSWER)
                    ));
                }
                follows
            }
            Outcome::Refused(_) => {
                self.note("the server refuses a schema".to_owned());
                false
            }
            Outcome::Failed(_, why) => {
                self.note(format!("whether it follows a schema is open: {why}"));
                return Ok(());
            }
        };
        self.found.facts.structured_output = Some(follows);
        Ok(())
    }

    fn pictures(&mut self) -> Result<(), ModelError> {
        let (red, blue) = (plain([220, 30, 30]), plain([30, 60, 220]));
        let words = "There are two pictures, each of one colour. Say which colour, red or blue, the first and the \
                     second have, in two lines:\nfirst: COLOUR\nsecond: COLOUR";
        let text = || Part::Text(words.to_owned());
        match self.ask(&asked(vec![text(), red.clone(), blue]), |facts| {
            facts.vision = None
        })? {
            Outcome::Answered(text) => match reading::colours(&text) {
                Some(["red", "blue"]) => {
                    self.found.facts.vision = Some(true);
                    self.found.facts.several_pictures = Some(true);
                }
                _ => self
                    .note("it did not name the colours of two pictures in one message".to_owned()),
            },
            Outcome::Failed(_, why) => {
                self.note(format!(
                    "whether it takes two pictures in one message is open: {why}"
                ));
            }
            Outcome::Refused(_) => {
                match self.ask(&asked(vec![text(), red]), |facts| facts.vision = None)? {
                    Outcome::Answered(_) => self.found.facts.several_pictures = Some(false),
                    Outcome::Refused(_) => self.found.facts.vision = Some(false),
                    Outcome::Failed(_, why) => {
                        self.note(format!("whether it takes pictures is open: {why}"));
                    }
                }
            }
        }
        Ok(())
    }

    /// Asks under the known facts and those found, with the parameters in doubt unrestricted.
    fn ask(
        &mut self,
        request: &Request,
        assume: impl Fn(&mut Facts),
    ) -> Result<Outcome, ModelError> {
        let mut facts = Facts {
            temperature: None,
            top_p: None,
            several_pictures: None,
            max_tokens_field: self.found.facts.max_tokens_field,
            ..self.subject.known().clone()
        };
        assume(&mut facts);
        let model = self.subject.under(&facts)?;
        match model.ask(request, self.calls) {
            Ok(reply) => {
                self.count(&reply);
                Ok(Outcome::Answered(reply.text))
            }
            Err(ModelError::Failed { fault, why, .. }) => match fault {
                Fault::BadRequest => Ok(Outcome::Refused(why)),
                Fault::Truncated
                | Fault::InvalidReply
                | Fault::Refused
                | Fault::ContentFiltered
                | Fault::ServerFailed => Ok(Outcome::Failed(fault, why)),
                _ => Err(ModelError::Failed {
                    model: model.name().to_owned(),
                    fault,
                    why,
                }),
            },
            Err(error) => Err(error),
        }
    }

    fn count(&mut self, reply: &Reply) {
        self.found.usage = self.found.usage + reply.usage.unwrap_or_default();
        self.found.cost = self
            .found
            .cost
            .zip(reply.cost)
            .map(|(sum, more)| sum + more);
        self.found.reasons = reasons(reply).max(self.found.reasons);
    }

    fn note(&mut self, note: String) {
        self.found.notes.push(note);
    }
}

/// Returns whether an answer came with thoughts: in its text, or hidden among the reported tokens.
pub(super) fn reasons(reply: &Reply) -> Option<bool> {
    let answer = standing(&reply.text);
    if answer.is_cut_off
        || answer
            .asides
            .iter()
            .any(|(_, kind)| *kind == Aside::Thought)
    {
        return Some(true);
    }
    let visible = tokens::of_text(&reply.text).saturating_mul(crate::catalogue::SAFETY);
    let reported = reply.usage?.output_tokens;
    Some(reported > visible.saturating_add(MARKS))
}

fn asked(parts: Vec<Part>) -> Request {
    let message = Message {
        speaker: Speaker::User,
        parts,
    };
    let mut request = Request::new(ModelRole::Vision, vec![message]);
    request.max_tokens = Some(MAX_TOKENS);
    request
}

fn say_yes() -> Request {
    asked(vec![Part::Text("Answer with the word yes.".to_owned())])
}

/// Draws a picture of one colour.
fn plain(colour: [u8; 3]) -> Part {
    let picture = RgbImage::from_pixel(SIDE_PX, SIDE_PX, Rgb(colour));
    Part::Image(Png::new(png::encode(&picture)))
}
