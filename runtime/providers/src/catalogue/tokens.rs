//! Estimates the number of tokens of a question.
//!
//! In: texts, and sizes of pictures. Out: estimates, always labelled as such: the provider's own count is what is
//! billed. Only the picture formulas come from vendors; the one for text is a rule of thumb.

use fab_model::{Message, Part, Png};
use fab_picture::png;
pub use fab_program::tokens::of_text;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A range of token counts; `exactly` makes one with equal bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Tokens {
    /// The lower bound.
    pub at_least: u64,
    /// The upper bound.
    pub at_most: u64,
}

impl Tokens {
    /// Makes an exact number.
    pub fn exactly(tokens: u64) -> Tokens {
        Tokens {
            at_least: tokens,
            at_most: tokens,
        }
    }
}

impl fmt::Display for Tokens {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.at_least == self.at_most {
            write!(f, "{}", self.at_most)
        } else {
            write!(f, "{}-{}", self.at_least, self.at_most)
        }
    }
}

/// How the tokens of a picture are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ImageTokens {
    /// The number of squares that cover the picture, each `percent` of a token, rounded up in total.
    Patches {
        /// Side of a square, pixels.
        side_px: u32,
        /// Tokens per hundred squares.
        #[serde(default = "hundred")]
        percent: u32,
    },
    /// The number of squares that cover the picture after its short side is scaled, each `each` tokens, plus `base`.
    Tiles {
        /// Side of a square, pixels.
        side_px: u32,
        /// Scaled length of the picture's short side, pixels.
        short_side_px: u32,
        /// Tokens per picture.
        base: u32,
        /// Tokens per square.
        each: u32,
    },
    /// Independent of the size: the lowest and the highest observed number.
    Flat {
        /// The lowest.
        at_least: u32,
        /// The highest.
        at_most: u32,
    },
}

fn hundred() -> u32 {
    100
}

impl ImageTokens {
    /// Returns the tokens of a picture; sides in pixels.
    ///
    /// It is not documented whether small pictures are enlarged to fit tiles, so the bounds cover both.
    pub fn of(&self, width: u32, height: u32) -> Tokens {
        let squares = |width: u64, height: u64, side: u32| {
            let side = u64::from(side.max(1));
            width.div_ceil(side).saturating_mul(height.div_ceil(side))
        };
        let (width, height) = (u64::from(width), u64::from(height));
        match *self {
            ImageTokens::Patches { side_px, percent } => {
                let patches = squares(width, height, side_px);
                Tokens::exactly(patches.saturating_mul(percent.into()).div_ceil(100))
            }
            ImageTokens::Tiles {
                side_px,
                short_side_px,
                base,
                each,
            } => {
                let short = width.min(height).max(1);
                let fit = |side: u64| (side * u64::from(short_side_px)).div_ceil(short);
                let count = |width, height| {
                    squares(width, height, side_px)
                        .saturating_mul(each.into())
                        .saturating_add(base.into())
                };
                let fitted = count(fit(width), fit(height));
                let as_it_is = count(width, height);
                Tokens {
                    at_least: fitted.min(as_it_is),
                    at_most: if short < u64::from(short_side_px) {
                        fitted.max(as_it_is)
                    } else {
                        fitted
                    },
                }
            }
            ImageTokens::Flat { at_least, at_most } => Tokens {
                at_least: at_least.into(),
                at_most: at_most.into(),
            },
        }
    }
}

/// Estimates the tokens of a picture; `None` if they are unknown.
pub(crate) fn of_picture(png: &Png, formula: Option<&ImageTokens>) -> Option<Tokens> {
    let [width, height] = png::size(png.bytes())?;
    Some(formula?.of(width, height))
}

/// Estimates the tokens of a conversation; `None` if it has pictures with unknown tokens.
///
/// - `of_text`: counts the tokens of a text.
pub fn of_messages(
    messages: &[Message],
    formula: Option<&ImageTokens>,
    of_text: fn(&str) -> u64,
) -> Option<Tokens> {
    let mut parts = messages.iter().flat_map(|message| &message.parts);
    parts.try_fold(Tokens::default(), |sum, part| {
        let tokens = match part {
            Part::Text(text) => Tokens::exactly(of_text(text)),
            Part::Image(png) => of_picture(png, formula)?,
        };
        Some(Tokens {
            at_least: sum.at_least.saturating_add(tokens.at_least),
            at_most: sum.at_most.saturating_add(tokens.at_most),
        })
    })
}

/// Estimates the likely tokens of a text: words in pieces of seven letters, numbers in pieces of three digits, and each
/// sign. Lists of points come out two to three times longer than by their letters alone.
pub fn likely_of_text(text: &str) -> u64 {
    let piece = |c: char| match c {
        c if c.is_whitespace() => usize::MAX,
        c if c.is_numeric() => 3,
        c if c.is_alphabetic() => 7,
        _ => 1,
    };
    let letters: Vec<usize> = text.chars().map(piece).collect();
    let runs = letters.chunk_by(|one, other| one == other);
    let runs = runs.filter(|run| run[0] != usize::MAX);
    runs.map(|run| run.len().div_ceil(run[0]) as u64).sum()
}
