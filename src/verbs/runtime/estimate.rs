//! `--estimate`: what a run or a suite would ask and cost, without sending anything.

use crate::io::Io;
use crate::verbs::runtime::setting::catalogue;
use crate::verbs::runtime::setting::models::Answering;
use fab_agent::rollout::FirstQuestion;
use fab_program::Program;
use fab_providers::estimate::{ANSWER_TOKENS, Estimate, Plan, Question};

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
    /// For each question, the rollouts that are likely to ask it anew.
    pub fresh: &'a [u64],
}

/// Computes the likely and the highest calls and cost; questions to an embedded model are not calls.
pub fn estimate(asking: &Asking<'_>, io: &Io) -> Estimate {
    let program = asking.program;
    let questions = asking.questions.iter().zip(asking.fresh);
    let sent = questions.filter_map(|(FirstQuestion { stage, request }, fresh)| {
        let remote = asking.answering.remote(request.role)?;
        let [candidates, revisions] = rehearsed(program, stage);
        Some(Question {
            stage,
            profile: remote.profile(),
            request,
            lengths: remote.lengths(request),
            fresh: *fresh,
            candidates,
            revisions,
        })
    });
    let questions: Vec<Question<'_>> = sent.collect();
    let plan = Plan {
        questions: &questions,
        horizon: asking.horizon,
        actions_per_step: program.actions_per_step(),
        attempts: program.verify.attempts,
        shows_correction: program.verify.with_picture,
        rollouts: asking.rollouts,
        today: catalogue::today(io),
    };
    plan.estimate()
}

/// Returns the candidates and the revisions that a rehearsal adds to the questions of a stage.
fn rehearsed(program: &Program, stage: &str) -> [u32; 2] {
    let mut stages = program.stages.iter();
    let stage = stages.find(|it| it.name == stage);
    let rehearsal = stage.and_then(|stage| Some((stage, program.rehearsal_of(stage)?)));
    rehearsal.map_or([0, 0], |(stage, rehearsal)| {
        let candidates = rehearsal.choose.map_or(0, |_| stage.candidates() - 1);
        [candidates, rehearsal.revisions]
    })
}

/// Prints an estimate, and what it assumes.
pub fn say(estimate: &Estimate, json: bool, io: &Io) {
    let asks = estimate.at_most.calls > 0;
    io.either(json, estimate, || {
        if asks {
            estimate.to_string()
        } else {
            "no calls would be sent: the model is embedded or a replay".to_owned()
        }
    });
    if !json && asks {
        io.talk(&format!(
            "an estimate from the first step; nothing was sent. Likely: every first answer is accepted, has {ANSWER_TOKENS} \
             tokens, and hides no reasoning. At most: every correction and retry, the longest answers, and three times the \
             estimated text tokens"
        ));
    }
}
