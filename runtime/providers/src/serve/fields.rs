//! Takes the fields of a request one by one, so that unknown ones can be reported.
//!
//! In: a JSON object. Out: typed values, or a refusal that names the field. `null` counts as absent.

use super::refusal::Refusal;
use fab_program::{Reasoning, ReasoningLevel};
use serde_json::{Map, Value};

/// The fields not taken yet.
pub(super) struct Fields {
    /// The prefix of their names in messages, such as `messages[2].`.
    path: String,
    left: Map<String, Value>,
}

impl Fields {
    pub(super) fn new(path: impl Into<String>, left: Map<String, Value>) -> Fields {
        Fields {
            path: path.into(),
            left,
        }
    }

    /// Makes the fields of a value, which must be an object.
    pub(super) fn of(path: impl Into<String>, value: Value) -> Result<Fields, Refusal> {
        let path = path.into();
        match value {
            Value::Object(left) => Ok(Fields::new(format!("{path}."), left)),
            _ => Err(Refusal::of(
                path.as_str(),
                format!("`{path}` is not an object"),
            )),
        }
    }

    pub(super) fn path(&self, name: &str) -> String {
        format!("{}{name}", self.path)
    }

    pub(super) fn take(&mut self, name: &str) -> Option<Value> {
        self.left.remove(name).filter(|value| !value.is_null())
    }

    pub(super) fn required(&mut self, name: &str) -> Result<Value, Refusal> {
        self.take(name).ok_or_else(|| {
            let path = self.path(name);
            Refusal::of(path.as_str(), format!("`{path}` is missing"))
        })
    }

    pub(super) fn text(&mut self, name: &str) -> Result<String, Refusal> {
        match self.required(name)? {
            Value::String(text) => Ok(text),
            _ => Err(self.wrong(name, "is not a string")),
        }
    }

    /// Takes a number from `least` to `most`.
    pub(super) fn number(
        &mut self,
        name: &str,
        least: f64,
        most: f64,
    ) -> Result<Option<f64>, Refusal> {
        let Some(value) = self.take(name) else {
            return Ok(None);
        };
        let number = value
            .as_f64()
            .filter(|number| (least..=most).contains(number));
        number
            .map(Some)
            .ok_or_else(|| self.wrong(name, &format!("is not a number from {least} to {most}")))
    }

    /// Takes a level of reasoning.
    pub(super) fn level(&mut self, name: &str) -> Result<Option<Reasoning>, Refusal> {
        let Some(value) = self.take(name) else {
            return Ok(None);
        };
        let level = value.as_str().and_then(ReasoningLevel::from_word);
        let level = level.ok_or_else(|| self.wrong(name, "is not none, low, medium or high"))?;
        Ok(Some(Reasoning::Level(level)))
    }

    /// Takes an integer from `least` up.
    pub(super) fn whole(&mut self, name: &str, least: u32) -> Result<Option<u32>, Refusal> {
        let Some(value) = self.take(name) else {
            return Ok(None);
        };
        let number = value.as_u64().and_then(|number| u32::try_from(number).ok());
        let number = number.filter(|number| *number >= least);
        let rule = format!("is not a whole number from {least} to {}", u32::MAX);
        number.map(Some).ok_or_else(|| self.wrong(name, &rule))
    }

    /// Takes a switch; it is off if it is absent.
    pub(super) fn switch(&mut self, name: &str) -> Result<bool, Refusal> {
        match self.take(name) {
            None => Ok(false),
            Some(Value::Bool(is_on)) => Ok(is_on),
            Some(_) => Err(self.wrong(name, "is neither true nor false")),
        }
    }

    /// Takes the options of a stream, without those that both formats have.
    pub(super) fn stream_options(&mut self, is_streamed: bool) -> Result<Option<Fields>, Refusal> {
        let Some(options) = self.take("stream_options") else {
            return Ok(None);
        };
        if !is_streamed {
            return Err(self.wrong("stream_options", "is for `\"stream\": true` alone"));
        }
        let mut options = Fields::of(self.path("stream_options"), options)?;
        options.only("include_obfuscation", Value::Bool(false))?;
        Ok(Some(options))
    }

    /// Refuses a field unless it has the value without effect.
    pub(super) fn only(&mut self, name: &str, allowed: Value) -> Result<(), Refusal> {
        match self.take(name) {
            Some(value) if value != allowed && !is_same_number(&value, &allowed) => {
                let path = self.path(name);
                let message =
                    format!("`{path}` cannot be honoured here; leave it out, or say {allowed}");
                Err(Refusal::unsupported(&path, message))
            }
            _ => Ok(()),
        }
    }

    /// Refuses a list that has an entry other than the ones without effect.
    pub(super) fn only_of(&mut self, name: &str, allowed: &[&str]) -> Result<(), Refusal> {
        let entries = match self.take(name) {
            None => return Ok(()),
            Some(Value::Array(entries)) => entries,
            Some(_) => return Err(self.wrong(name, "is no list")),
        };
        let is_allowed = |entry: &Value| entry.as_str().is_some_and(|it| allowed.contains(&it));
        match entries.iter().find(|entry| !is_allowed(entry)) {
            None => Ok(()),
            Some(entry) => {
                let path = self.path(name);
                let entry: String = entry.to_string().chars().take(80).collect();
                let message =
                    format!("`{path}` with {entry} cannot be honoured here; leave it out");
                Err(Refusal::unsupported(&path, message))
            }
        }
    }

    /// Ignores fields without effect on the answer, and refuses all others left.
    pub(super) fn finish(mut self, harmless: &[&str]) -> Result<(), Refusal> {
        for name in harmless {
            self.left.remove(*name);
        }
        match self.left.iter().find(|(_, value)| !value.is_null()) {
            None => Ok(()),
            Some((name, _)) => {
                let path = self.path(&name.chars().take(80).collect::<String>());
                let message =
                    format!("`{path}` is not known here, and is not ignored either: leave it out");
                Err(Refusal::unsupported(&path, message))
            }
        }
    }

    pub(super) fn wrong(&self, name: &str, rule: &str) -> Refusal {
        let path = self.path(name);
        Refusal::of(path.as_str(), format!("`{path}` {rule}"))
    }
}

fn is_same_number(value: &Value, allowed: &Value) -> bool {
    value
        .as_f64()
        .zip(allowed.as_f64())
        .is_some_and(|(one, other)| one == other)
}
