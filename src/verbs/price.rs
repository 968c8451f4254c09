//! A model's price of a question, as `render --why` shows it.

#[cfg(feature = "runtime")]
use {
    crate::io::Io, crate::verbs::runtime::setting::catalogue, fab_model::calls::Usage,
    fab_providers::catalogue::Profile, std::sync::Arc,
};

/// Returns the fewest and the most tokens that a PNG file has.
type PictureTokens = Box<dyn Fn(&[u8]) -> Option<(u64, u64)>>;

/// What a model counts and costs; each is `None` where it is not known.
pub struct Price {
    /// The model, as `PROVIDER:NAME`.
    pub model: String,
    /// Today's price of so many input tokens, billionths of a US dollar.
    pub nano_usd: Box<dyn Fn(u64) -> Option<u64>>,
    /// The tokens of a picture.
    pub picture_tokens: PictureTokens,
}

#[cfg(feature = "runtime")]
impl Price {
    /// Returns today's price of a model.
    pub fn of(profile: Profile, io: &Io) -> Price {
        let profile = Arc::new(profile);
        let price = profile.price_on(catalogue::today(io));
        let nano_usd = move |input_tokens| {
            let usage = Usage {
                input_tokens,
                ..Usage::default()
            };
            Some(price.as_ref()?.cost(usage).nano())
        };
        Price {
            model: profile.title(),
            nano_usd: Box::new(nano_usd),
            picture_tokens: Box::new(move |png| {
                let [width, height] = fab_picture::png::size(png)?;
                let tokens = profile.facts.image_tokens.as_ref()?.of(width, height);
                Some((tokens.at_least, tokens.at_most))
            }),
        }
    }
}
