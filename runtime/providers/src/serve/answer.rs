//! Common parts of both answer formats: token counts, and an id.

use crate::catalogue::{ImageTokens, Patches, tokens};
use fab_model::calls::Usage;
use fab_model::{Reply, Request};

/// How the tokens of a picture are estimated, since a stand-in has none: as for the GPT-6 models.
const PICTURE: ImageTokens = ImageTokens::Patches(Patches {
    side_px: 32,
    percent: 120,
});

/// Returns the usage of an answer: as reported by the model, else an estimate.
pub(super) fn usage(request: &Request, reply: &Reply) -> Usage {
    reply.usage.unwrap_or_else(|| Usage {
        input_tokens: tokens::of_messages(&request.messages, Some(&PICTURE))
            .map_or(0, |tokens| tokens.at_most),
        output_tokens: tokens::of_text(&reply.text),
        ..Usage::default()
    })
}

/// Derives an answer's id from its question, so that equal questions have byte-identical answers.
pub(super) fn id(prefix: &str, request: &Request) -> String {
    format!("{prefix}{}", &request.key()[..24])
}
