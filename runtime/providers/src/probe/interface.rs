//! Finds out what a model's interface refuses: a name of the token limit, values of sampling, a schema.
//!
//! In: a model that can be asked under other assumptions than its known facts. Out: the facts that its answers and
//! refusals show, and in words what they leave open. A setting counts as refused if a short question with it is refused:
//! the first question, without it, was taken.

use super::{MAX_TOKENS, Under};
use crate::catalogue::{Accepted, Facts, MaxTokensField, Profile, Wire};
use fab_base::wording::shown;
use fab_model::calls::{Calls, Fault};
use fab_model::{Message, ModelError, ModelRole, Request, Speaker};
use fab_program::reply::standing;
use serde_json::{Value, json};

/// The most questions about the interface: two each for the limit, `temperature` and `top_p`, and one for the schema.
pub(super) const MOST_QUESTIONS: u64 = 7;
/// A sampling value that the shipped tasks state, and that some models refuse.
const TEMPERATURE: f64 = 0.2;
/// As common as it is refused by models that fix their sampling.
const TOP_P: f64 = 0.9;
/// The longest answer that a note repeats, characters.
const MAX_ANSWER: usize = 60;

/// What became of a question.
enum Outcome {
    Answered(String),
    /// The interface refused it.
    Refused(String),
    /// It failed in a way that says nothing about the setting in doubt.
    Open(String),
}

pub(super) struct Prober<'a> {
    pub profile: &'a Profile,
    pub under: &'a Under<'a>,
    pub calls: &'a mut dyn Calls,
    /// The facts that were found; others are `None`.
    pub found: Facts,
    /// What was seen besides, or left open, in words.
    pub notes: Vec<String>,
}

impl Prober<'_> {
    /// Asks up to [`MOST_QUESTIONS`] short questions.
    ///
    /// Fails if the first one gets no answer, or another one fails in a way that further ones would not survive.
    pub fn run(&mut self) -> Result<(), ModelError> {
        self.token_limit()?;
        let temperature = |request: &mut Request, value| request.temperature = Some(value);
        self.found.temperature = self.sampling("temperature", TEMPERATURE, temperature)?;
        let top_p = |request: &mut Request, value| request.top_p = Some(value);
        self.found.top_p = self.sampling("top_p", TOP_P, top_p)?;
        self.schema()
    }

    /// Returns the known facts, with those found so far and with sampling unrestricted.
    pub fn assumed(&self) -> Facts {
        let known = &self.profile.facts;
        Facts {
            vision: None,
            temperature: None,
            top_p: None,
            max_tokens_field: self.found.max_tokens_field.or(known.max_tokens_field),
            ..known.clone()
        }
    }

    fn token_limit(&mut self) -> Result<(), ModelError> {
        let known = self.profile.facts.max_tokens_field;
        let fields: &[Option<MaxTokensField>] = match (self.profile.provider.wire, known) {
            (Wire::OpenaiChat, None) => &[
                Some(MaxTokensField::MaxTokens),
                Some(MaxTokensField::MaxCompletionTokens),
            ],
            _ => &[known],
        };
        let mut last = String::new();
        for field in fields {
            self.found.max_tokens_field = *field;
            match self.ask(&question("Answer with the word yes."))? {
                Outcome::Answered(_) => return Ok(()),
                Outcome::Refused(why) => last = why,
                Outcome::Open(why) => {
                    last = why;
                    break;
                }
            }
        }
        Err(ModelError::Failed {
            model: self.profile.title(),
            fault: Fault::BadRequest,
            why: last,
        })
    }

    /// Tries a value of a sampling parameter, and 1 if it is refused; returns `None` if it is taken.
    fn sampling(
        &mut self,
        name: &str,
        value: f64,
        state: fn(&mut Request, f64),
    ) -> Result<Option<Accepted>, ModelError> {
        for (tried, finding) in [(value, None), (1.0, Some(Accepted::Only(vec![1.0])))] {
            let mut request = question("Answer with the word yes.");
            state(&mut request, tried);
            match self.ask(&request)? {
                Outcome::Answered(_) => return Ok(finding),
                Outcome::Refused(_) => {}
                Outcome::Open(why) => {
                    let note = format!("whether it takes {name} {tried} is open: {why}");
                    self.notes.push(note);
                    return Ok(None);
                }
            }
        }
        Ok(Some(Accepted::Refused))
    }

    /// Asks in words for what the schema forbids. It has the keywords of a task's schema, because llama.cpp's server answers
    /// without any grammar, and says nothing, if it cannot parse the one that it made of the schema.
    fn schema(&mut self) -> Result<(), ModelError> {
        let words = "Name a tree. Answer with one word and nothing else.";
        let properties = json!({
            "reason": { "type": "string", "maxLength": 80 },
            "at": { "type": "string", "pattern": "^\\((0|-?[1-9][0-9]{0,5}), (0|-?[1-9][0-9]{0,5})\\)$" },
            "colour": { "type": "string", "enum": ["green", "brown"] },
        });
        let mut request = question(words);
        request.schema = Some(json!({
            "type": "object",
            "properties": properties,
            "required": ["reason", "at", "colour"],
            "additionalProperties": false,
        }));
        let (follows, note) = match self.ask(&request)? {
            Outcome::Open(why) => (None, format!("whether it follows a schema is open: {why}")),
            Outcome::Refused(_) => (Some(false), "the server refuses a schema".to_owned()),
            Outcome::Answered(text) => {
                let answer = standing(&text).text;
                let answer: Value = serde_json::from_str(answer.trim()).unwrap_or_default();
                if ["green", "brown"].iter().any(|it| answer["colour"] == **it) {
                    self.found.structured_output = Some(true);
                    return Ok(());
                }
                let answer = shown(text.trim(), MAX_ANSWER);
                let note = format!(
                    "the server takes a schema and ignores it: to `{words}` it answers `{answer}`, which the schema forbids"
                );
                (Some(false), note)
            }
        };
        self.found.structured_output = follows;
        self.notes.push(note);
        Ok(())
    }

    fn ask(&mut self, request: &Request) -> Result<Outcome, ModelError> {
        let facts = Facts {
            structured_output: Some(true),
            ..self.assumed()
        };
        match (self.under)(&facts)?.ask(request, self.calls) {
            Ok(reply) => Ok(Outcome::Answered(reply.text)),
            Err(ModelError::Failed {
                fault: Fault::BadRequest,
                why,
                ..
            }) => Ok(Outcome::Refused(why)),
            // The model declined this question, or thought too long about it.
            Err(ModelError::Failed { fault, why, .. })
                if [Fault::Truncated, Fault::Refused, Fault::ContentFiltered].contains(&fault) =>
            {
                Ok(Outcome::Open(why))
            }
            Err(error) => Err(error),
        }
    }
}

fn question(words: &str) -> Request {
    let message = Message::text(Speaker::User, words);
    let mut request = Request::new(ModelRole::Vision, vec![message]);
    request.max_tokens = Some(MAX_TOKENS);
    request
}
