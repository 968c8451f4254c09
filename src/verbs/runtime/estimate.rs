//! `--estimate`: what a run or a suite would ask and cost, without sending anything.

use crate::io::Io;
use crate::report::Report;
use crate::verbs::runtime::setting::catalogue;
use crate::verbs::runtime::setting::models::Answering;
use fab_agent::habits::{Recorded, Setting};
use fab_agent::rollout::FirstQuestion;
use fab_program::{Program, Read};
use fab_providers::estimate::{Correction, Estimate, Fresh, Plan, Question, Rehearsed, Typical};
use std::path::Path;

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
    /// For each question, the rollouts that ask it anew.
    pub fresh: &'a [Fresh],
    /// Earlier rollouts, which say what is likely.
    pub recorded: &'a Recorded,
}

/// The folder in which runs are kept if none is named.
const RUNS: &str = "runs";

/// Reads earlier runs, of the named folder or else of the usual one.
pub fn recorded(out: Option<&Path>) -> Recorded {
    Recorded::below(out.unwrap_or(Path::new(RUNS)))
}

/// Computes bounds and likely values of calls and cost; questions to an embedded model are not calls.
pub fn estimate(asking: &Asking<'_>, io: &Io) -> Estimate {
    let program = asking.program;
    let models = asking.answering.models();
    let setting = Setting {
        task: program.task.clone(),
        variant: program.variant.clone(),
        models: [
            models.vision.name().to_owned(),
            models.text.name().to_owned(),
        ],
    };
    let typical = |stage: &str| match asking.recorded.stage(&setting, stage) {
        Some(habit) => Typical {
            calls_per_step: habit.calls_per_step,
            steps_share: habit.steps_share,
            input_tokens: Some(habit.input_tokens),
            output_tokens: habit.output_tokens,
            recorded_calls: habit.calls,
        },
        None => {
            let declared = program.stages.iter().find(|it| it.name == stage);
            let answer_tokens = match declared.map(|it| &it.read) {
                Some(Read::Text { .. }) => Typical::TEXT_TOKENS,
                Some(Read::Action) | None => Typical::ACTION_TOKENS,
            };
            Typical::shipped(answer_tokens, program.actions_per_step())
        }
    };
    let sent = asking.questions.iter().zip(asking.fresh).filter_map(
        |(FirstQuestion { stage, request }, fresh)| {
            let lengths = asking.answering.lengths(request);
            Some(Question {
                stage,
                profile: asking.answering.profile(request.role)?,
                messages: &request.messages,
                schema: request.schema.as_ref(),
                max_tokens: lengths.visible,
                hidden_tokens: lengths.hidden,
                rehearsed: rehearsed(program, stage),
                typical: typical(stage),
                fresh: *fresh,
            })
        },
    );
    let questions: Vec<Question<'_>> = sent.collect();
    let plan = Plan {
        questions: &questions,
        horizon: asking.horizon,
        actions_per_step: program.actions_per_step(),
        attempts: program.verify.attempts,
        correction: if program.verify.with_picture {
            Correction::Picture
        } else {
            Correction::Words
        },
        rollouts: asking.rollouts,
        today: catalogue::today(io),
    };
    plan.estimate()
}

/// Returns what a rehearsal adds to the questions of a stage.
fn rehearsed(program: &Program, stage: &str) -> Rehearsed {
    let mut stages = program.stages.iter();
    let stage = stages.find(|it| it.name == stage);
    let rehearsal = stage.and_then(|stage| Some((stage, program.rehearsal_of(stage)?)));
    let Some((stage, rehearsal)) = rehearsal else {
        return Rehearsed::default();
    };
    Rehearsed {
        candidates: rehearsal.choose.map_or(0, |_| stage.candidates() - 1),
        revisions: rehearsal.revisions,
    }
}

/// Prints an estimate, and what it rests on.
pub fn say(estimate: &Estimate, json: bool, io: &Io) {
    io.result(json, estimate);
    let calls = { estimate.stages.iter() }.map(|stage| stage.typical.recorded_calls);
    let likely = match calls.sum::<u64>() {
        0 => "assumes answers of typical length that are accepted at once".to_owned(),
        calls => format!(
            "is the average of {calls} recorded calls, and assumes typical answers for stages without"
        ),
    };
    if !json && !estimate.stages.is_empty() {
        io.talk(&format!(
            "an estimate from the first step; nothing was sent. The lower bound assumes that every first answer is \
             accepted; the upper bound assumes every correction and retry, and three times the estimated text tokens; the \
             likely value {likely}"
        ));
    }
}

impl Report for Estimate {
    fn text(&self) -> String {
        if self.stages.is_empty() {
            "no calls would be sent: the model is embedded or a recording".to_owned()
        } else {
            self.to_string()
        }
    }
}
