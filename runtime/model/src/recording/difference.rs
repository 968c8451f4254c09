//! Reports which part of a request differs from the recording.

use super::Exchange;
use crate::Request;
use serde_json::Value;

/// The longest text quoted, characters.
const MAX_QUOTED: usize = 80;

/// The fields of a request beside its place and its messages, in the order in which differences are told.
const SETTINGS: [&str; 7] = [
    "start",
    "repetition",
    "candidate",
    "temperature",
    "top_p",
    "max_tokens",
    "reasoning",
];

/// Names the recorded exchange most similar to a request, and what differs.
///
/// - `exchanges`: at least one.
pub(super) fn nearest(exchanges: &[Exchange], request: &Request) -> String {
    let asked = serde_json::to_value(request).expect("a request holds strings and finite numbers");
    // The last of equal ones wins, and reversed that is the first.
    let in_reverse = exchanges.iter().rev();
    let best = in_reverse.max_by_key(|exchange| likeness(&exchange.request, &asked));
    let Some(exchange) = best else {
        return "it is empty".to_owned();
    };
    let step = &exchange.request["step"];
    let is_other = |name: &str| exchange.request[name] != asked[name];
    if is_other("role") && is_other("messages") {
        return format!(
            "it holds no question to a model of {} that is like it",
            asked["role"]
        );
    }
    let parts = differences(&exchange.request, &asked);
    format!(
        "the recorded question that is most like it is one of action {step}, and differs in {}",
        parts.join("; ")
    )
}

/// How much two requests have in common, most important criterion first.
type Likeness = (bool, bool, usize, usize);

fn likeness(recorded: &Value, asked: &Value) -> Likeness {
    let is_same = |name: &str| recorded[name] == asked[name];
    let (there, here) = (list(&recorded["messages"]), list(&asked["messages"]));
    let alike = there.iter().zip(here).take_while(|(a, b)| a == b).count();
    let settings = SETTINGS.iter().filter(|name| is_same(name)).count();
    (
        is_same("role"),
        is_same("step"),
        alike + usize::from(there.len() == here.len()),
        settings,
    )
}

/// Lists the differences by their path in the request; both are JSON of a [`Request`].
pub(super) fn differences(recorded: &Value, asked: &Value) -> Vec<String> {
    let mut found = Vec::new();
    for name in ["role", "step"].iter().chain(&SETTINGS) {
        if recorded[name] != asked[name] {
            found.push(format!(
                "`{name}` (recorded {}, now {})",
                recorded[name], asked[name]
            ));
        }
    }
    let (there, here) = (list(&recorded["messages"]), list(&asked["messages"]));
    if there.len() != here.len() {
        found.push(format!(
            "the number of messages (recorded {}, now {})",
            there.len(),
            here.len()
        ));
    }
    for (number, (then, now)) in there.iter().zip(here).enumerate() {
        found.extend(message(number + 1, then, now));
    }
    found
}

fn message(number: usize, then: &Value, now: &Value) -> Option<String> {
    if then == now {
        return None;
    }
    let who = now["speaker"].as_str().unwrap_or("?");
    let place = format!("message {number} ({who})");
    if then["speaker"] != now["speaker"] {
        return Some(format!("who speaks in {place}"));
    }
    let (there, here) = (list(&then["parts"]), list(&now["parts"]));
    let first = there.iter().zip(here).position(|(then, now)| then != now);
    let Some(index) = first else {
        return Some(format!(
            "{place}, which had {} parts and has {}",
            there.len(),
            here.len()
        ));
    };
    let part = format!("{place}, part {}", index + 1);
    let (then, now) = (&there[index], &here[index]);
    Some(match (then["text"].as_str(), now["text"].as_str()) {
        (Some(then), Some(now)) => format!("{part}, {}", line(then, now)),
        (None, None) => format!(
            "{part}, the picture (recorded {}, now {})",
            short(&then["image"]),
            short(&now["image"])
        ),
        _ => format!("{part}, which is a text in one and a picture in the other"),
    })
}

/// Returns the items of a list; none of anything else.
fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Names the first line in which two texts differ.
fn line(then: &str, now: &str) -> String {
    let (mut there, mut here) = (then.lines(), now.lines());
    for number in 1.. {
        match (there.next(), here.next()) {
            (None, None) => break,
            (then, now) if then == now => {}
            (then, now) => {
                let quoted = |line: Option<&str>| line.map_or("no such line".to_owned(), quoted);
                return format!(
                    "line {number} (recorded {}, now {})",
                    quoted(then),
                    quoted(now)
                );
            }
        }
    }
    "the end of its last line".to_owned()
}

fn quoted(line: &str) -> String {
    let short: String = line.chars().take(MAX_QUOTED).collect();
    match short.len() < line.len() {
        true => format!("`{short}…`"),
        false => format!("`{short}`"),
    }
}

fn short(hash: &Value) -> String {
    hash.as_str().unwrap_or("?").chars().take(12).collect()
}
