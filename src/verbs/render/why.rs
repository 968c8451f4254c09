//! `--why`: shows the source file and line of each prompt line, and the tokens of each component.
//!
//! In: a stage for display. Out: the page with line numbers, a table of estimated tokens, and the same as JSON. Picture
//! tokens and prices are known only if a model is named.

use super::page::{DisplayPart, Line, ShownStage};
use fab_program::render::Origin;
use fab_program::tokens;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// A provider's token counts and prices for a model, where known.
pub trait Rates {
    /// Returns the model's name.
    fn model(&self) -> String;

    /// Returns the fewest and the most tokens that a picture may have.
    fn picture_tokens(&self, png: &[u8]) -> Option<(u64, u64)>;

    /// Returns the price of `tokens` input tokens, billionths of a US dollar.
    fn cost_nano_usd(&self, tokens: u64) -> Option<u64>;
}

/// The size of one component of a stage.
struct Weight {
    said_by: String,
    /// The file that declares it, in the user's spelling.
    file: Option<String>,
    at_least: u64,
    at_most: u64,
}

/// Returns the page with line numbers, and a table of the tokens of each component.
///
/// - `folder`: the folder of the task's file; prefixed to file names.
pub fn text(stage: &ShownStage, folder: &Path, rates: Option<&dyn Rates>) -> String {
    let mut text = format!("=== stage {}\n", stage.name);
    let mut before: Option<(String, Option<String>)> = None;
    for line in stage.lines() {
        let head = line.origin.as_ref().map(|origin| {
            let file = origin
                .place
                .as_ref()
                .map(|place| named(folder, &place.file));
            (origin.source.clone(), file)
        });
        if head.is_some() && head != before {
            text.push_str(&format!("      {}\n", heading(&head)));
        }
        if head.is_some() || !line.text.is_empty() {
            before = head;
        }
        text.push_str(&numbered(&line));
    }
    text.push('\n');
    text.push_str(&table(stage, folder, rates));
    text
}

fn heading(head: &Option<(String, Option<String>)>) -> String {
    match head {
        Some((said_by, Some(file))) => format!("[{said_by}, {file}]"),
        Some((said_by, None)) => format!("[{said_by}]"),
        None => String::new(),
    }
}

/// Writes a numbered line, and marks below it which words are values.
fn numbered(line: &Line) -> String {
    let place = line.origin.as_ref().and_then(|it| it.place.as_ref());
    let number = place.map_or(String::new(), |place| place.line.to_string());
    if line.origin.is_none() && !line.text.is_empty() {
        return format!("{}\n", line.text);
    }
    let mut text = format!("{number:>5} | {}", line.text);
    text.truncate(text.trim_end().len());
    text.push('\n');
    let mut marks = String::new();
    let mut names = Vec::new();
    for (from, to, variable) in &line.values {
        let column = marks.chars().count();
        marks.push_str(&" ".repeat(from.saturating_sub(column)));
        marks.push_str(&"^".repeat(to - from));
        names.push(variable.as_str());
    }
    if !names.is_empty() {
        text.push_str(&format!("      | {marks} {}\n", names.join(", ")));
    }
    text
}

fn named(folder: &Path, file: &str) -> String {
    folder.join(file).display().to_string()
}

/// Returns the tokens of each component and picture of the question, in order of appearance.
fn weights(stage: &ShownStage, folder: &Path, rates: Option<&dyn Rates>) -> Vec<Weight> {
    let mut letters: Vec<(String, Option<String>, String)> = Vec::new();
    let mut weights = Vec::new();
    for said in stage.texts() {
        for stretch in &said.stretches {
            let said_by = group(&stretch.origin);
            let file = stretch.origin.place.as_ref();
            let file = file.map(|place| named(folder, &place.file));
            let words = &said.text[stretch.bytes.clone()];
            match letters.iter_mut().find(|(known, ..)| *known == said_by) {
                Some((.., all)) => all.push_str(words),
                None => letters.push((said_by, file, words.to_owned())),
            }
        }
    }
    for (said_by, file, words) in letters {
        let tokens = tokens::of_text(&words);
        weights.push(Weight {
            said_by,
            file,
            at_least: tokens,
            at_most: tokens,
        });
    }
    for part in stage.first_question() {
        if let (
            DisplayPart::Picture {
                title,
                png: Some(png),
            },
            Some(rates),
        ) = (part, rates)
            && let Some((at_least, at_most)) = rates.picture_tokens(png)
        {
            weights.push(Weight {
                said_by: format!("picture: {title}"),
                file: None,
                at_least,
                at_most,
            });
        }
    }
    weights
}

/// Returns the name under which a stretch is counted: demonstrations share one.
fn group(origin: &Origin) -> String {
    match origin.source.split_once(' ') {
        Some(("demonstration", _)) => "demonstrations".to_owned(),
        Some(("example", _)) => "examples".to_owned(),
        _ => origin.source.clone(),
    }
}

fn table(stage: &ShownStage, folder: &Path, rates: Option<&dyn Rates>) -> String {
    let weights = weights(stage, folder, rates);
    let widest = weights.iter().map(|weight| weight.said_by.chars().count());
    let widest = widest.max().unwrap_or(0).max("in all".len());
    let all = total(&weights);
    let rows = weights.iter().chain([&all]);
    let mut text = String::from("estimated tokens of the first question");
    if let Some(rates) = rates {
        text.push_str(&format!(", and their cost for {}", rates.model()));
    }
    text.push('\n');
    for weight in rows {
        let tokens = bounds(weight.at_least, weight.at_most);
        let cost = rates.and_then(|rates| rates.cost_nano_usd(weight.at_most));
        let cost = cost.map_or(String::new(), |nano| format!("  {}", dollars(nano)));
        let name = &weight.said_by;
        text.push_str(&format!("  {name:widest$}  {tokens:>7}{cost}\n"));
    }
    let n_pictures = not_counted(stage, rates);
    match rates {
        None if n_pictures > 0 => text.push_str(&format!(
            "  {n_pictures} pictures are not counted; `--model PROVIDER:NAME` adds their tokens and the cost\n"
        )),
        Some(rates) if n_pictures > 0 => text.push_str(&format!(
            "  {n_pictures} pictures are not counted: how many tokens one has for {} is not known\n",
            rates.model()
        )),
        _ => {}
    }
    if let Some(rates) = rates.filter(|rates| rates.cost_nano_usd(1).is_none()) {
        text.push_str(&format!("  the price of {} is not known\n", rates.model()));
    }
    text
}

/// Returns how many pictures of the first question have an unknown token count.
fn not_counted(stage: &ShownStage, rates: Option<&dyn Rates>) -> usize {
    let is_unknown = |part: &&DisplayPart| match (part, rates) {
        (DisplayPart::Text(_), _) => false,
        (DisplayPart::Picture { png: Some(png), .. }, Some(rates)) => {
            rates.picture_tokens(png).is_none()
        }
        (DisplayPart::Picture { .. }, _) => true,
    };
    stage.first_question().filter(is_unknown).count()
}

fn total(weights: &[Weight]) -> Weight {
    Weight {
        said_by: "in all".to_owned(),
        file: None,
        at_least: weights.iter().map(|weight| weight.at_least).sum(),
        at_most: weights.iter().map(|weight| weight.at_most).sum(),
    }
}

fn bounds(at_least: u64, at_most: u64) -> String {
    match at_least == at_most {
        true => at_least.to_string(),
        false => format!("{at_least}-{at_most}"),
    }
}

/// Formats billionths of a dollar, rounded to a millionth.
fn dollars(nano: u64) -> String {
    let micro = nano.div_ceil(1000);
    format!("${}.{:06}", micro / 1_000_000, micro % 1_000_000)
}

/// Returns the stretches and the weights of a stage.
pub fn as_json(stage: &ShownStage, folder: &Path, rates: Option<&dyn Rates>) -> Value {
    let mut stretches = Vec::new();
    for (number, message) in stage.messages.iter().enumerate() {
        for (part, shown) in message.parts.iter().enumerate() {
            let DisplayPart::Text(said) = shown else {
                continue;
            };
            for stretch in &said.stretches {
                let place = stretch.origin.place.as_ref();
                stretches.push(json!({
                    "message": number,
                    "part": part,
                    "start": stretch.bytes.start,
                    "end": stretch.bytes.end,
                    "said_by": stretch.origin.source,
                    "value": stretch.origin.value,
                    "file": place.map(|place| named(folder, &place.file)),
                    "line": place.map(|place| place.line),
                }));
            }
        }
    }
    let weights = weights(stage, folder, rates);
    let all = total(&weights);
    let weighed = |weight: &Weight| {
        json!({
            "said_by": weight.said_by,
            "file": weight.file,
            "at_least": weight.at_least,
            "at_most": weight.at_most,
            "cost_nano_usd": rates.and_then(|rates| rates.cost_nano_usd(weight.at_most)),
        })
    };
    let mut by_component = BTreeMap::new();
    by_component.insert("components", Value::from_iter(weights.iter().map(weighed)));
    by_component.insert("all", weighed(&all));
    by_component.insert("pictures_not_counted", json!(not_counted(stage, rates)));
    json!({ "stretches": stretches, "estimated_tokens": by_component })
}
