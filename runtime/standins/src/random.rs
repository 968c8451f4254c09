//! `random`: a stand-in that ignores the prompt and draws each field of an action from the offered choices.
//!
//! In: a [`Request`]. Out: an answer in JSON, with each offered value equally likely. The request's content, including
//! its step and repetition, and the seed determine the draw: equal requests get equal answers. Questions for words get
//! words without content. `fab_agent::policy::Random` draws in the same way, without a prompt.

use super::choices::{self, Field};
use fab_base::chance::Chance;
use fab_model::calls::Calls;
use fab_model::{Model, ModelError, ModelKind, Reply, Request};
use fab_picture::png;
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
        let fields = choices::fields(request);
        if fields.is_empty() {
            return Ok(Reply::text(idle_words(request)));
        }
        let mut values = Vec::with_capacity(fields.len());
        for field in fields {
            let value =
                draw(&field, request, &mut chance).ok_or_else(|| ModelError::Unsupported {
                    model: self.name.clone(),
                    why: format!("the schema offers nothing for `{}`", field.name),
                })?;
            values.push((field.name, value));
        }
        Ok(Reply::text(choices::answer(request, values)))
    }
}

/// Draws a value; if any pixel may be named, a pixel of the last picture.
fn draw(field: &Field, request: &Request, chance: &mut Chance) -> Option<String> {
    if !field.values.is_empty() {
        return Some(field.values[chance.below(field.values.len())].clone());
    }
    let images = request.messages.iter().flat_map(|message| &message.parts);
    let mut last = images.filter_map(|part| match part {
        fab_model::Part::Image(png) => Some(png),
        fab_model::Part::Text(_) => None,
    });
    let picture = png::decode(last.next_back()?.bytes(), Path::new("the last picture")).ok()?;
    let (width, height) = picture.dimensions();
    let [u, v] = [width, height].map(|side| chance.below(side as usize));
    Some(format!("({u}, {v})"))
}

/// Fills every line that the question asks for, such as `- Instructions: …`, with words without content.
fn idle_words(request: &Request) -> String {
    let asked = choices::last_asked(request);
    let labels = asked.lines().filter_map(|line| {
        let (label, _) = line.trim().strip_prefix("- ")?.split_once(": ")?;
        let is_word = label.chars().all(|c| c.is_alphabetic() || c == ' ');
        is_word.then(|| format!("{label}: Pick any point and place it on any other."))
    });
    let lines: Vec<String> = labels.collect();
    if lines.is_empty() {
        return "I look at nothing and have nothing to say.".to_owned();
    }
    lines.join("\n")
}
