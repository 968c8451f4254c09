//! Asks the person beside the arm, on the terminal, how a rollout ended.
//!
//! In: a report, and lines from stdin; an interrupt does not count as an answer. Out: a [`Judgement`]. Questions go to
//! stderr, so that stdout stays data; end of input means no answer.

use crate::io::Io;
use crate::verbs::runtime::robot::hold_key;
use crate::verbs::runtime::robot::terminal::{self, choose, yes_or_no};
use fab_agent::judgement::{Cause, Judgement, Operator};
use fab_agent::record::Report;
use std::path::Path;

pub struct TerminalOperator<'io>(pub &'io Io);

impl Operator for TerminalOperator<'_> {
    fn judge(&self, report: &Report, folder: &Path) -> Option<Judgement> {
        let io = self.0;
        io.progress("");
        // A person who held a key while the arm moved may still hold it; from here on answers are lines.
        hold_key::restore();
        let (outcome, steps) = (report.outcome.name(), report.steps);
        let why = report.stopped.iter().map(|why| format!(" ({why})"));
        let (why, folder) = (why.collect::<String>(), folder.display());
        io.talk(&format!(
            "the rollout has ended: {outcome} after {steps} actions{why}, in `{folder}`"
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
    let reached = choose(lines, say, "Was the task reached? y or n:", yes_or_no)?;
    let mut why = None;
    if !reached {
        let question = "Why not? hardware (the arm, its grasp, the camera), detection (corners, the cloth) or reasoning (what the model chose); h, d or r:";
        why = Some(choose(lines, say, question, |answer| {
            let mut all = Cause::ALL.into_iter();
            all.find(|cause| !answer.is_empty() && cause.name().starts_with(answer))
        })?);
    }
    say("In a few words, or nothing:");
    let words = lines().map(|line| line.trim().to_owned());
    Some(Judgement {
        reached,
        why,
        words: words.filter(|words| !words.is_empty()),
    })
}

#[cfg(test)]
mod tests;
