//! `--why`: shows the source file and line of each prompt line, and the tokens of each component.
//!
//! In: a stage for display. Out: the page with line numbers, a table of estimated tokens, and both as data. Picture
//! tokens and prices are known only if a model is named.

use super::page::{DisplayPart, ShownStage};
use crate::verbs::price::Price;
use fab_base::table::{Align, aligned};
use fab_program::render::Origin;
use fab_program::tokens;
use serde::Serialize;
use serde_json::{Value, json};
use std::path::Path;

#[derive(Serialize)]
struct Weight {
    said_by: String,
    at_least: u64,
    at_most: u64,
    cost_nano_usd: Option<u64>,
}

#[derive(Serialize)]
struct Weights {
    components: Vec<Weight>,
    all: Weight,
    /// How many pictures have an unknown token count.
    pictures_not_counted: usize,
}

/// Returns the page with line numbers, and a table of the tokens of each component; `folder` goes before file names.
pub fn text(stage: &ShownStage, folder: &Path, price: Option<&Price>) -> String {
    let mut lines = vec![format!("=== stage {}", stage.name)];
    let mut before: Option<String> = None;
    for line in stage.lines() {
        let Some(Origin { source, place, .. }) = &line.origin else {
            if line.text.is_empty() {
                lines.push("      |".to_owned());
            } else {
                before = None;
                lines.push(line.text);
            }
            continue;
        };
        let place_of = place.as_ref();
        let file = place_of.map(|place| format!(", {}", named(folder, &place.file)));
        let head = Some(format!("      [{source}{}]", file.unwrap_or_default()));
        if head != before {
            lines.extend(head.clone());
            before = head;
        }
        let number = place_of.map_or(String::new(), |place| place.line.to_string());
        lines.push(format!("{number:>5} | {}", line.text).trim_end().to_owned());
    }
    lines.push(String::new());
    lines.extend(table(stage, price));
    lines.join("\n") + "\n"
}

fn named(folder: &Path, file: &str) -> String {
    folder.join(file).display().to_string()
}

/// Weighs each component and picture of the first question.
fn weighed(stage: &ShownStage, price: Option<&Price>) -> Weights {
    let weight = |said_by: String, (at_least, at_most)| Weight {
        said_by,
        at_least,
        at_most,
        cost_nano_usd: price.and_then(|price| (price.nano_usd)(at_most)),
    };
    let mut texts: Vec<(String, String)> = Vec::new();
    for said in stage.texts() {
        for stretch in &said.stretches {
            let said_by = group(&stretch.origin);
            let words = &said.text[stretch.bytes.clone()];
            match texts.iter_mut().find(|(known, _)| *known == said_by) {
                Some((_, all)) => all.push_str(words),
                None => texts.push((said_by, words.to_owned())),
            }
        }
    }
    let texts = texts.into_iter().map(|(said_by, words)| {
        let tokens = tokens::of_text(&words);
        weight(said_by, (tokens, tokens))
    });
    let mut components: Vec<Weight> = texts.collect();
    let mut pictures_not_counted = 0;
    for part in stage.first_question() {
        let DisplayPart::Image { title, png } = part else {
            continue;
        };
        let tokens = price.zip(png.as_ref());
        match tokens.and_then(|(price, png)| (price.picture_tokens)(png)) {
            Some(tokens) => components.push(weight(format!("picture: {title}"), tokens)),
            None => pictures_not_counted += 1,
        }
    }
    let sum = |of: fn(&Weight) -> u64| components.iter().map(of).sum();
    let all = (sum(|it| it.at_least), sum(|it| it.at_most));
    Weights {
        all: weight("in all".to_owned(), all),
        components,
        pictures_not_counted,
    }
}

/// Returns the name under which a stretch is counted: demonstrations share one.
fn group(origin: &Origin) -> String {
    match origin.source.split_once(' ') {
        Some(("demonstration", _)) => "demonstrations".to_owned(),
        Some(("example", _)) => "examples".to_owned(),
        _ => origin.source.clone(),
    }
}

fn table(stage: &ShownStage, price: Option<&Price>) -> Vec<String> {
    let weights = weighed(stage, price);
    let of = price.map(|price| format!(", and their cost for {}", price.model));
    let mut lines = vec![format!(
        "estimated tokens of the first question{}",
        of.unwrap_or_default()
    )];
    let rows = weights.components.iter().chain([&weights.all]);
    let rows: Vec<_> = rows
        .map(|weight| {
            let (least, most) = (weight.at_least, weight.at_most);
            let tokens = if least == most {
                least.to_string()
            } else {
                format!("{least}-{most}")
            };
            let cost = weight.cost_nano_usd.map(dollars).unwrap_or_default();
            [weight.said_by.clone(), format!("{tokens:>7}"), cost]
        })
        .collect();
    let rows = aligned(&[Align::Left, Align::Right], &rows).into_iter();
    lines.extend(rows.map(|row| format!("  {row}")));
    let uncounted = weights.pictures_not_counted;
    if uncounted > 0 {
        let why = match price {
            None => "; `--model PROVIDER:NAME` adds their tokens and the cost".to_owned(),
            Some(price) => format!(": how many tokens one has for {} is not known", price.model),
        };
        lines.push(format!("  {uncounted} pictures are not counted{why}"));
    }
    let unpriced = price.filter(|_| weights.all.cost_nano_usd.is_none());
    lines.extend(unpriced.map(|price| format!("  the price of {} is not known", price.model)));
    lines
}

/// Formats billionths of a dollar as a column, rounded up to a millionth.
fn dollars(nano: u64) -> String {
    let micro = nano.div_ceil(1000);
    format!("${}.{:06}", micro / 1_000_000, micro % 1_000_000)
}

/// Tells where the texts of a stage come from, and what they weigh.
pub fn of(stage: &ShownStage, folder: &Path, price: Option<&Price>) -> Value {
    let mut stretches = Vec::new();
    for (message, shown) in stage.messages.iter().enumerate() {
        for (part, shown) in shown.parts.iter().enumerate() {
            let DisplayPart::Text { said } = shown else {
                continue;
            };
            stretches.extend(said.stretches.iter().map(|stretch| {
                let place = stretch.origin.place.as_ref();
                json!({
                    "message": message,
                    "part": part,
                    "start": stretch.bytes.start,
                    "end": stretch.bytes.end,
                    "said_by": stretch.origin.source,
                    "value": stretch.origin.value,
                    "file": place.map(|place| named(folder, &place.file)),
                    "line": place.map(|place| place.line),
                })
            }));
        }
    }
    json!({ "stretches": stretches, "estimated_tokens": weighed(stage, price) })
}
