//! What both forms of an answer say alike: how many tokens there were, and a name for the answer.

use crate::catalogue::{ImageTokens, Patches, tokens};
use fab_model::calls::Usage;
use fab_model::{Reply, Request};

/// How the tokens of a picture are estimated, since a stand-in has none: as the GPT-6 models count them.
const PICTURE: ImageTokens = ImageTokens::Patches(Patches {
    side_px: 32,
    percent: 120,
});

/// Returns what an answer used: what the model reports, else an estimate.
pub(super) fn usage(request: &Request, reply: &Reply) -> Usage {
    reply.usage.unwrap_or_else(|| Usage {
        input_tokens: tokens::of_messages(&request.messages, Some(&PICTURE))
            .map_or(0, |tokens| tokens.at_most),
        cached_input_tokens: 0,
        output_tokens: tokens::of_text(&reply.text),
    })
}

/// Names an answer by its question, so that equal questions have equal answers to the last byte.
pub(super) fn id(prefix: &str, request: &Request) -> String {
    format!("{prefix}{}", &request.key()[..24])
}
