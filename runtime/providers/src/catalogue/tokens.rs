//! Estimates the number of tokens of a question.
//!
//! In: texts, and sizes of pictures. Out: estimates, always labelled as such: the provider's own count is what is
//! billed. Only the picture formulas come from vendors; the one for text is a rule of thumb.

use fab_model::{Message, Part, Png};
use fab_picture::png;
pub use fab_program::tokens::of_text;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Add;

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

impl Add for Tokens {
    type Output = Tokens;

    fn add(self, other: Tokens) -> Tokens {
        Tokens {
            at_least: self.at_least.saturating_add(other.at_least),
            at_most: self.at_most.saturating_add(other.at_most),
        }
    }
}

impl fmt::Display for Tokens {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.at_least)?;
        match self.at_least == self.at_most {
            true => Ok(()),
            false => write!(f, "-{}", self.at_most),
        }
    }
}

/// How the tokens of a picture are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ImageTokens {
    /// The number of squares that cover the picture, each `percent` of a token, rounded up in total.
    Patches(Patches),
    /// The number of squares that cover the picture after its short side is scaled, each `each` tokens, plus `base`.
    Tiles(Tiles),
    /// Independent of the size.
    Flat(Flat),
}

/// Squares that cover a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Patches {
    /// Side of a square, pixels.
    pub side_px: u32,
    /// Tokens per hundred squares.
    #[serde(default = "hundred")]
    pub percent: u32,
}

/// Squares that cover a scaled picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tiles {
    /// Side of a square, pixels.
    pub side_px: u32,
    /// Scaled length of the picture's short side, pixels.
    pub short_side_px: u32,
    /// Tokens per picture.
    pub base: u32,
    /// Tokens per square.
    pub each: u32,
}

/// A number of tokens independent of the size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flat {
    /// The lowest observed number.
    pub at_least: u32,
    /// The highest.
    pub at_most: u32,
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
            ImageTokens::Patches(Patches { side_px, percent }) => {
                let patches = squares(width, height, side_px);
                Tokens::exactly(patches.saturating_mul(percent.into()).div_ceil(100))
            }
            ImageTokens::Tiles(Tiles {
                side_px,
                short_side_px,
                base,
                each,
            }) => {
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
            ImageTokens::Flat(Flat { at_least, at_most }) => Tokens {
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
pub fn of_messages(messages: &[Message], formula: Option<&ImageTokens>) -> Option<Tokens> {
    let parts = messages.iter().flat_map(|message| &message.parts);
    parts
        .map(|part| match part {
            Part::Text(text) => Some(Tokens::exactly(of_text(text))),
            Part::Image(png) => of_picture(png, formula),
        })
        .try_fold(Tokens::default(), |sum, tokens| Some(sum + tokens?))
}

/// Estimates the likely tokens of a text: words in pieces of seven letters, numbers in pieces of three digits, and each
/// sign. Lists of points come out two to three times longer than by their letters alone.
pub fn likely_of_text(text: &str) -> u64 {
    let (mut tokens, mut run) = (0_u64, 0_u64);
    let mut last = None;
    for c in text.chars() {
        let kind = match c {
            c if c.is_whitespace() => None,
            c if c.is_numeric() => Some(3),
            c if c.is_alphabetic() => Some(7),
            _ => Some(1),
        };
        let Some(piece) = kind else {
            last = None;
            continue;
        };
        run = if last == kind { run + 1 } else { 1 };
        if (run - 1).is_multiple_of(piece) {
            tokens += 1;
        }
        last = kind;
    }
    tokens
}

/// Estimates the likely tokens of messages; `None` if they have pictures with unknown tokens.
pub fn likely_of_messages(messages: &[Message], formula: Option<&ImageTokens>) -> Option<f64> {
    let parts = messages.iter().flat_map(|message| &message.parts);
    parts
        .map(|part| match part {
            Part::Text(text) => Some(likely_of_text(text) as f64),
            Part::Image(png) => {
                let tokens = of_picture(png, formula)?;
                Some((tokens.at_least as f64 + tokens.at_most as f64) / 2.0)
            }
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fab_model::Speaker;

    const GPT_6: ImageTokens = ImageTokens::Patches(Patches {
        side_px: 32,
        percent: 120,
    });
    const CLAUDE: ImageTokens = ImageTokens::Patches(Patches {
        side_px: 28,
        percent: 100,
    });
    const GPT_4O: ImageTokens = ImageTokens::Tiles(Tiles {
        side_px: 512,
        short_side_px: 768,
        base: 85,
        each: 170,
    });

    #[test]
    fn pictures_have_the_tokens_that_the_vendors_formulas_give() {
        // The first two figures come from the vendor's own page.
        assert_eq!(GPT_6.of(224, 224), Tokens::exactly(59));
        assert_eq!(GPT_6.of(720, 720), Tokens::exactly(635));
        assert_eq!(CLAUDE.of(224, 224), Tokens::exactly(64));
        assert_eq!(CLAUDE.of(720, 720), Tokens::exactly(676));
        let flat = ImageTokens::Flat(Flat {
            at_least: 1065,
            at_most: 1101,
        });
        for side in [1, 224, 4096] {
            let tokens = flat.of(side, side);
            assert_eq!((tokens.at_least, tokens.at_most), (1065, 1101));
        }
    }

    #[test]
    fn tiles_are_counted_after_the_short_side_fits() {
        // 720 pixels are two tiles a side, enlarged or not; 224 are one, or two when enlarged.
        assert_eq!(GPT_4O.of(720, 720), Tokens::exactly(85 + 4 * 170));
        let small = GPT_4O.of(224, 224);
        assert_eq!((small.at_least, small.at_most), (85 + 170, 85 + 4 * 170));
        // 1536 by 3072 becomes 768 by 1536: 2 by 3 tiles.
        assert_eq!(GPT_4O.of(1536, 3072), Tokens::exactly(85 + 6 * 170));
    }

    #[test]
    fn no_size_and_no_formula_makes_a_count_overflow() {
        for formula in [GPT_6, CLAUDE, GPT_4O] {
            for (width, height) in [(0, 0), (0, u32::MAX), (1, u32::MAX), (u32::MAX, u32::MAX)] {
                let tokens = formula.of(width, height);
                assert!(
                    tokens.at_least <= tokens.at_most,
                    "{formula:?} {width} {height}"
                );
            }
        }
    }

    #[test]
    fn likely_tokens_count_words_digits_and_signs() {
        for (text, expected) in [
            ("", 0),
            ("fold", 1),
            ("counter-clockwise", 4),
            ("(123, 45)", 5),
            ("1234567", 3),
            ("  a \n b", 2),
        ] {
            assert_eq!(likely_of_text(text), expected, "{text}");
        }
    }

    #[test]
    fn a_picture_without_a_formula_or_a_size_makes_the_sum_unknown() {
        let blank = png::encode(&image::RgbImage::new(224, 224));
        let shown = |bytes: Vec<u8>| {
            let mut message = Message::text(Speaker::User, "fold");
            message.parts.push(Part::Image(Png::new(bytes)));
            [message]
        };
        assert_eq!(
            of_messages(&shown(blank.clone()), Some(&GPT_6)),
            Some(Tokens::exactly(60))
        );
        assert_eq!(of_messages(&shown(blank), None), None);
        assert_eq!(of_messages(&shown(vec![7; 99]), Some(&GPT_6)), None);
        assert_eq!(
            of_messages(&[Message::text(Speaker::User, "fold")], None),
            Some(Tokens::exactly(1))
        );
    }
}
