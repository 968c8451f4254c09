//! What an answer means: a text, an action with its verdict, or nothing that can be read.

use super::reach::out_of_reach;
use super::{Finding, Situation};
use fab_program::Proposal;
use fab_program::facts::Facts;
use fab_program::render::RenderError;
use fab_program::reply::{self, Malformed, Reading};
use fab_program::verify::{self, Strictness, Verdict};
use fab_program::{Read, Stage};

/// Reads an answer and, where it proposes an action, lets the verifier judge it.
pub(super) fn judge(
    situation: Situation<'_>,
    stage: &Stage,
    facts: Facts<'_>,
    text: &str,
) -> Result<Finding, RenderError> {
    let malformed = |Malformed { field, message }| Finding::Malformed { field, message };
    match &stage.read {
        Read::Text {
            name,
            before,
            after,
        } => Ok(match reply::read_text(before, after, text) {
            Ok(Reading { value, repairs }) => Finding::Text {
                name: name.clone(),
                value,
                repairs,
            },
            Err(error) => malformed(error),
        }),
        Read::Action => {
            match reply::read_action_in(situation.program, &facts.notation(situation.program), text)
            {
                Ok(Reading { value, repairs }) => {
                    let verdict = verdict(situation, facts, &value, Strictness::Full)?;
                    Ok(Finding::Action {
                        fields: value.fields,
                        repairs,
                        verdict,
                    })
                }
                Err(error) => Ok(malformed(error)),
            }
        }
    }
}

/// Judges an action by the task's checks, and then by what the world can reach.
pub(super) fn verdict(
    situation: Situation<'_>,
    facts: Facts<'_>,
    proposal: &Proposal,
    strictness: Strictness,
) -> Result<Verdict, RenderError> {
    let program = situation.program;
    Ok(
        match verify::verdict(program, facts, proposal, strictness)? {
            Verdict::Accept => out_of_reach(situation, &facts.notation(program), proposal)
                .unwrap_or(Verdict::Accept),
            refused => refused,
        },
    )
}
