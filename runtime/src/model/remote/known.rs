//! Settings from what is known of a model.
//!
//! In: a [`Profile`], where its provider is reached, and the day whose prices count. Out: [`Settings`]. A fact that
//! is not known restricts nothing.

use super::settings::{Accepts, MaxTokensField, Support};
use super::{BaseUrl, Pricing, Settings, Wire};
use crate::calls::{Usage, Usd};
use crate::model::Request;
use crate::model::catalogue::{self, Accepted, Date, Priced, Profile};
use crate::model::lowering::{Lowering, Points, Resize};
use compiler::pointing::{Order, Unit};
use std::num::NonZeroU32;
use std::sync::Arc;

impl Settings {
    /// Makes the settings of a model of which a profile is known.
    pub fn of(profile: &Profile, base_url: BaseUrl, today: Date) -> Settings {
        let wire = match profile.provider.wire {
            catalogue::Wire::OpenaiResponses => Wire::OpenaiResponses,
            catalogue::Wire::OpenaiChat => Wire::OpenaiChat,
            catalogue::Wire::Anthropic => Wire::Anthropic,
            catalogue::Wire::Gemini => Wire::Gemini,
        };
        let facts = &profile.facts;
        Settings {
            pictures: support(facts.vision),
            structured_output: support(facts.structured_output),
            lowering: lowering(profile),
            temperature: accepts(facts.temperature.as_ref()),
            top_p: accepts(facts.top_p.as_ref()),
            max_tokens_field: match facts.max_tokens_field {
                Some(catalogue::MaxTokensField::MaxCompletionTokens) => {
                    MaxTokensField::MaxCompletionTokens
                }
                Some(catalogue::MaxTokensField::MaxTokens) | None => MaxTokensField::MaxTokens,
            },
            pricing: Arc::new(profile.priced_on(today)),
            ..Settings::new(&profile.provider.name, &profile.id, wire, base_url)
        }
    }
}

impl Pricing for Priced {
    fn at_most(&self, request: &Request) -> Option<Usd> {
        Priced::at_most(self, request)
    }

    fn cost(&self, usage: Usage) -> Option<Usd> {
        Priced::cost(self, usage)
    }
}

/// Returns how points are written for a model; in pixels of the picture that is sent where its habit is not known.
pub fn lowering(profile: &Profile) -> Lowering {
    let facts = &profile.facts;
    let within = facts.largest_side_px.and_then(NonZeroU32::new);
    let resize = within.map_or(Resize::Never, |side_px| Resize::Within { side_px });
    let Some(habit) = facts.coordinates else {
        return Lowering {
            resize,
            ..Lowering::PIXELS
        };
    };
    let multiples = habit.multiples_of_px.and_then(NonZeroU32::new);
    Lowering {
        points: Points::Coordinates,
        unit: match habit.unit {
            catalogue::Unit::Pixels => Unit::Pixels,
            catalogue::Unit::Fraction => Unit::Fraction,
            catalogue::Unit::Percent => Unit::Percent,
            catalogue::Unit::PerMille => Unit::PerMille,
        },
        order: match habit.order {
            catalogue::Order::Xy => Order::Xy,
            catalogue::Order::Yx => Order::Yx,
        },
        resize: multiples.map_or(resize, |of_px| Resize::Multiples { of_px }),
    }
}

fn support(known: Option<bool>) -> Support {
    match known {
        None => Support::Unknown,
        Some(true) => Support::Yes,
        Some(false) => Support::No,
    }
}

fn accepts(known: Option<&Accepted>) -> Accepts {
    match known {
        None => Accepts::Unknown,
        Some(Accepted::Only(values)) => Accepts::Values(values.clone()),
        Some(Accepted::Range([least, most])) => Accepts::Range(*least, *most),
    }
}
