//! Asks the person beside the arm, on the terminal, how a rollout ended.
//!
//! In: a report, and lines from stdin; an interrupt does not count as an answer. Out: a [`Judgement`]. Questions go to
//! stderr, so that stdout stays data; end of input means no answer.

use crate::io::Io;
use crate::verbs::runtime::robot::terminal;
use fab_agent::judgement::{Cause, Judgement};
use fab_agent::operator::Operator;
use fab_agent::record::Report;
use std::path::Path;

/// How often a question is repeated after an unknown answer.
const TRIES: u32 = 10;

/// Asks on the terminal.
pub struct TerminalOperator<'io>(pub &'io Io);

impl Operator for TerminalOperator<'_> {
    fn judge(&self, report: &Report, folder: &Path) -> Option<Judgement> {
        let io = self.0;
        io.progress("");
        // A person who held a key while the arm moved may still hold it; from here on answers are lines.
        terminal::restore();
        io.talk(&format!(
            "{} has ended: {} after {} actions{}, in `{}`",
            report.task,
            report.outcome.name(),
            report.steps,
            report
                .stopped
                .as_ref()
                .map_or(String::new(), |why| format!(" ({why})")),
            folder.display()
        ));
        let judgement = asked(&mut || terminal::typed_line(io), &mut |text| io.talk(text));
        if judgement.is_none() {
            io.talk("note: nobody answered; the rollout is kept without a judgement");
        }
        judgement
    }
}

/// Asks the questions; `None` if the input ends or every attempt is an unknown answer.
fn asked(
    lines: &mut dyn FnMut() -> Option<String>,
    say: &mut dyn FnMut(&str),
) -> Option<Judgement> {
    let reached = choice(
        lines,
        say,
        "Was the task reached? y or n:",
        |answer| match answer {
            "y" | "yes" => Some(true),
            "n" | "no" => Some(false),
            _ => None,
        },
    )?;
    let why = match reached {
        true => None,
        false => {
            let question = "Why not? hardware (the arm, its grasp, the camera), detection (corners, the cloth) or reasoning (what the model chose); h, d or r:";
            let cause = choice(lines, say, question, |answer| {
                let mut all = Cause::ALL.into_iter();
                all.find(|cause| !answer.is_empty() && cause.name().starts_with(answer))
            })?;
            Some(cause)
        }
    };
    say("In a few words, or nothing:");
    let words = line(lines).filter(|words| !words.is_empty());
    Some(Judgement {
        reached,
        why,
        words,
    })
}

fn choice<T>(
    lines: &mut dyn FnMut() -> Option<String>,
    say: &mut dyn FnMut(&str),
    question: &str,
    meant: impl Fn(&str) -> Option<T>,
) -> Option<T> {
    for _ in 0..TRIES {
        say(question);
        if let Some(found) = meant(&line(lines)?.to_lowercase()) {
            return Some(found);
        }
    }
    None
}

/// Returns the typed line, trimmed; `None` at end of input.
fn line(lines: &mut dyn FnMut() -> Option<String>) -> Option<String> {
    lines().map(|line| line.trim().to_owned())
}

#[cfg(test)]
mod tests;
