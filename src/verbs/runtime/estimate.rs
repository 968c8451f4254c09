//! `--estimate`: what a run or a suite would ask and cost, without sending anything.

use crate::io::Io;
use crate::verbs::runtime::setting::catalogue;
use crate::verbs::runtime::setting::models::Answering;
use fab_agent::rollout::FirstQuestion;
use fab_program::Program;
use fab_providers::estimate::{Correction, Estimate, Plan, Question};

/// Rollouts that ask the same questions.
pub struct Asking<'a> {
    /// The task.
    pub program: &'a Program,
    /// The first request of each stage.
    pub questions: &'a [FirstQuestion],
    /// The models that answer.
    pub answering: &'a Answering,
    /// The most steps of a rollout.
    pub horizon: u32,
    /// The number of rollouts.
    pub rollouts: u64,
}

/// Computes upper bounds for calls and cost; questions to an embedded model are not calls.
pub fn estimate(asking: &Asking<'_>, io: &Io) -> Estimate {
    let program = asking.program;
    let sent = asking
        .questions
        .iter()
        .filter_map(|FirstQuestion { stage, request }| {
            let lengths = asking.answering.lengths(request);
            Some(Question {
                stage,
                profile: asking.answering.profile(request.role)?,
                messages: &request.messages,
                schema: request.schema.as_ref(),
                max_tokens: lengths.visible,
                hidden_tokens: lengths.hidden,
            })
        });
    let questions: Vec<Question<'_>> = sent.collect();
    let plan = Plan {
        questions: &questions,
        horizon: asking.horizon,
        actions_per_step: program.actions_per_step(),
        attempts: program.verify.attempts,
        correction: match program.verify.with_picture {
            true => Correction::Picture,
            false => Correction::Words,
        },
        rollouts: asking.rollouts,
        today: catalogue::today(io),
    };
    plan.estimate()
}

/// Prints an estimate.
pub fn say(estimate: &Estimate, wants_json: bool, io: &Io) {
    if wants_json {
        io.json(
            &serde_json::to_value(estimate).expect("an estimate has string keys and whole numbers"),
        );
        return;
    }
    if estimate.stages.is_empty() {
        io.data("no calls would be sent: the model is embedded or a recording");
        return;
    }
    io.data(&estimate.to_string());
    io.talk(
        "an estimate from the first step; nothing was sent. The lower bound assumes that every first answer is \
         accepted; the upper bound assumes every correction and retry, and three times the estimated text tokens",
    );
}
