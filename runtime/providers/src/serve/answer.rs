//! An answer before it has a format: what it says, where it ends, and its token counts.

use super::format::Format;
use crate::catalogue::{ImageTokens, tokens};
use fab_model::calls::Usage;
use fab_model::{Reply, Request};

/// How the tokens of a picture are estimated, since a stand-in has none: as for the GPT-6 models.
const PICTURE: ImageTokens = ImageTokens::Patches {
    side_px: 32,
    percent: 120,
};
/// The letters of a piece of a streamed answer: about four tokens.
const PIECE_LETTERS: usize = 16;
/// The most letters of an answer that a refusal quotes.
const QUOTED_LETTERS: usize = 400;

/// An answer.
pub(super) struct Answer {
    /// The same for equal questions, so that they have byte-identical answers.
    key: String,
    pub model: String,
    pub content: Content,
    /// Whether the limit of tokens cut it.
    pub is_cut: bool,
    pub usage: Usage,
}

/// What an answer says.
pub(super) enum Content {
    /// What the model wrote, in the wanted form.
    Text(String),
    /// Why it is not in that form.
    Refusal(String),
}

impl Content {
    pub(super) fn words(&self) -> &str {
        let (Content::Text(words) | Content::Refusal(words)) = self;
        words
    }
}

impl Answer {
    /// Puts a reply into its form, and cuts it at the most tokens that were asked for.
    pub(super) fn new(model: &str, request: &Request, reply: Reply, format: &Format) -> Answer {
        let quoted: String = reply.text.chars().take(QUOTED_LETTERS).collect();
        let mut content = match format.fit(reply.text) {
            Ok(text) => Content::Text(text),
            Err(why) => Content::Refusal(format!(
                "the answer of `{model}` does not follow the schema: {why}. It begins: {quoted}"
            )),
        };
        let mut usage = reply.usage.unwrap_or_else(|| Usage {
            input_tokens: tokens::of_messages(&request.messages, Some(&PICTURE))
                .map_or(0, |tokens| tokens.at_most),
            output_tokens: tokens::of_text(content.words()),
            ..Usage::default()
        });
        let most = request.max_tokens.map_or(u64::MAX, u64::from);
        let is_cut = usage.output_tokens > most;
        if is_cut {
            let (Content::Text(words) | Content::Refusal(words)) = &mut content;
            // The share of the answer for which the tokens suffice, whoever counted them.
            let letters =
                words.chars().count() as u128 * u128::from(most) / u128::from(usage.output_tokens);
            let end = words.char_indices().nth(letters as usize);
            words.truncate(end.map_or(words.len(), |(end, _)| end));
            usage.output_tokens = most;
        }
        Answer {
            key: request.key()[..24].to_owned(),
            model: model.to_owned(),
            content,
            is_cut,
            usage,
        }
    }

    /// Returns its id, or that of a part.
    pub(super) fn id(&self, prefix: &str) -> String {
        format!("{prefix}{}", self.key)
    }
}

/// Cuts a text into the pieces in which it is streamed.
pub(super) fn pieces(text: String) -> impl Iterator<Item = String> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let left = &text[at..];
        let end = left.char_indices().nth(PIECE_LETTERS);
        let piece = &left[..end.map_or(left.len(), |(end, _)| end)];
        at += piece.len();
        (!piece.is_empty()).then(|| piece.to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use fab_model::{Message, ModelRole, Speaker};

    #[test]
    fn tokens_that_the_model_reports_decide_where_an_answer_is_cut() {
        let messages = vec![Message::text(Speaker::User, "fold")];
        let mut request = Request::new(ModelRole::Text, messages);
        request.max_tokens = Some(20);
        let of = |output_tokens: u64| {
            let mut reply = Reply::text("ä".repeat(100));
            reply.usage = Some(Usage {
                input_tokens: 7,
                cached_input_tokens: 3,
                output_tokens,
                reasoning_tokens: None,
            });
            Answer::new("model", &request, reply, &Format::default())
        };
        for (reported, letters, is_cut) in [(20, 100, false), (40, 50, true), (u64::MAX, 0, true)] {
            let answer = of(reported);
            let found = answer.content.words().chars().count();
            assert_eq!((found, answer.is_cut), (letters, is_cut), "{reported}");
            assert_eq!(answer.usage.output_tokens, 20);
            assert_eq!(answer.usage.input_tokens, 7);
        }
    }
}
