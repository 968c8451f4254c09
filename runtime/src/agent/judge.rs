//! What an answer means: a text, an action with its verdict, or nothing that can be read.

use super::Finding;
use compiler::facts::Facts;
use compiler::program::{Program, Read, Stage};
use compiler::render::RenderError;
use compiler::reply::{self, Malformed, Reading};
use compiler::verify::{self, Strictness};

/// Reads an answer and, where it proposes an action, lets the verifier judge it.
pub(super) fn judge(
    program: &Program,
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
        Read::Action => match reply::read_action_in(program, &facts.notation(program), text) {
            Ok(Reading { value, repairs }) => {
                let verdict = verify::verdict(program, facts, &value, Strictness::Full)?;
                Ok(Finding::Action {
                    fields: value.fields,
                    repairs,
                    verdict,
                })
            }
            Err(error) => Ok(malformed(error)),
        },
    }
}
