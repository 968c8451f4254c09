//! `random`: a stand-in that ignores the prompt and draws each field of an action from the offered choices.
//!
//! In: a [`Request`]. Out: an answer in JSON, with each offered value equally likely. The request's content, including
//! its step and repetition, and the seed determine the draw: equal requests get equal answers. Questions for words get
//! words without content. `fab_agent::policy::Random` draws in the same way, without a prompt.

use crate::geometric::pictures;
use fab_base::chance::Chance;
use fab_model::calls::Calls;
use fab_model::{Model, ModelError, ModelKind, Reply, Request};
use fab_picture::png;
use serde_json::{Map, Value};
use std::path::Path;

/// The stand-in.
#[derive(Clone, Debug)]
pub struct Random {
    name: String,
    seed: u64,
}

impl Random {
    /// Makes the stand-in for a seed.
    pub fn seeded(seed: u64) -> Random {
        Random {
            name: format!("random answers, seed {seed}"),
            seed,
        }
    }
}

impl Model for Random {
    fn name(&self) -> &str {
        &self.name
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let mut chance = Chance::of(&format!("random {} {}", self.seed, request.key()));
        let schema = request.schema.as_ref();
        let properties = schema.and_then(|schema| schema["properties"].as_object());
        let mut answer = Map::new();
        for (name, property) in properties.into_iter().flatten() {
            let value = if property["enum"].is_null() && property["pattern"].is_null() {
                Some("I look at nothing, so any choice will do.".to_owned())
            } else {
                draw(property, request, &mut chance)
            };
            let value = value.ok_or_else(|| ModelError::Unsupported {
                model: self.name.clone(),
                why: format!("the schema offers nothing for `{name}`"),
            })?;
            answer.insert(name.clone(), value.into());
        }
        Ok(Reply::text(Value::Object(answer).to_string()))
    }
}

/// Draws a value of a field; if any pixel may be named, a pixel of the last picture.
fn draw(property: &Value, request: &Request, chance: &mut Chance) -> Option<String> {
    let values = property["enum"].as_array().into_iter().flatten();
    let values: Vec<&str> = values.filter_map(Value::as_str).collect();
    if !values.is_empty() {
        return Some(values[chance.below(values.len())].to_owned());
    }
    let last = request.messages.iter().flat_map(pictures).last()?;
    let picture = png::opened(last, Path::new("the last picture")).ok()?;
    let (width, height) = picture.dimensions();
    let [u, v] = [width, height].map(|side| chance.below(side as usize));
    Some(format!("({u}, {v})"))
}
