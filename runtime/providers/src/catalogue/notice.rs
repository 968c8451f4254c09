//! Notices about a model for its user.
//!
//! In: a [`Profile`] and the date. Out: notices as data; the command prints them.

use super::date::Date;
use super::{FactsSource, Profile, names};
use serde::Serialize;
use std::fmt;

/// A shutdown is announced this many days in advance.
const SOON_DAYS: i64 = 90;

/// Something that a user should know about a model.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "notice", rename_all = "snake_case")]
pub enum Notice {
    /// It no longer answers.
    Retired {
        /// Since when.
        on: Date,
        /// What its vendor recommends in its place.
        #[serde(skip_serializing_if = "Option::is_none")]
        instead: Option<String>,
    },
    /// It will soon stop answering.
    RetiresSoon {
        /// From when.
        on: Date,
        /// In how many days.
        days: i64,
        /// What its vendor recommends in its place.
        #[serde(skip_serializing_if = "Option::is_none")]
        instead: Option<String>,
    },
    /// The vendor may put another model behind its id.
    Undated,
    /// Its price will change.
    PriceChanges {
        /// From when.
        on: Date,
    },
    /// Its price is unknown.
    PriceUnknown,
    /// How it states positions in a picture is unknown.
    CoordinatesUnknown,
    /// No entry matches the id.
    Unlisted {
        /// A similar known id.
        near: Option<String>,
    },
    /// Its entry has only the vendor's name, which matched the id.
    ByName {
        /// The name.
        name: String,
    },
}

impl Notice {
    /// Returns whether a run with the model is likely to fail or to mislead; other notices are merely informative.
    pub fn is_warning(&self) -> bool {
        !matches!(
            self,
            Notice::Undated | Notice::ByName { .. } | Notice::PriceChanges { .. }
        )
    }
}

impl Profile {
    /// Returns the notices about the model on a date, most important first.
    pub fn notices(&self, today: Date) -> Vec<Notice> {
        let mut notices = Vec::new();
        if let Some(on) = self.facts.shutdown {
            let instead = self.facts.replaced_by.clone();
            match today.days_until(on) {
                ..=0 => notices.push(Notice::Retired { on, instead }),
                days @ ..=SOON_DAYS => notices.push(Notice::RetiresSoon { on, days, instead }),
                _ => {}
            }
        }
        match &self.listed {
            FactsSource::Not { near } => notices.push(Notice::Unlisted { near: near.clone() }),
            FactsSource::ByName(name) => notices.push(Notice::ByName { name: name.clone() }),
            FactsSource::ById | FactsSource::ByFamily => {}
        }
        if self.price_on(today).is_none() {
            notices.push(Notice::PriceUnknown);
        }
        if self.facts.coordinates.is_none() {
            notices.push(Notice::CoordinatesUnknown);
        }
        let prices = self
            .facts
            .price
            .iter()
            .flatten()
            .filter(|_| !self.is_free());
        let next = prices
            .filter_map(|price| price.from)
            .find(|from| today.days_until(*from) > 0);
        notices.extend(next.map(|on| Notice::PriceChanges { on }));
        if self.is_moving() {
            notices.push(Notice::Undated);
        }
        notices
    }

    /// Returns whether the vendor may put another model behind the id: if no entry says so, when it holds no date.
    pub fn is_moving(&self) -> bool {
        let own = self.provider.runs_on == Some(super::RunsOn::Own);
        self.facts
            .moving
            .unwrap_or(!own && !names::is_dated(&self.id))
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let recommended = |instead: &Option<String>| {
            instead.as_ref().map_or(String::new(), |id| {
                format!("; its vendor recommends `{id}`")
            })
        };
        match self {
            Notice::Retired { on, instead } => {
                write!(f, "it has been shut down since {on}{}", recommended(instead))
            }
            Notice::RetiresSoon { on, days, instead } => {
                let when = match days {
                    1 => "tomorrow".to_owned(),
                    days => format!("in {days} days"),
                };
                write!(f, "it will be shut down on {on}, {when}{}", recommended(instead))
            }
            Notice::Undated => f.write_str(
                "its id has no date: the vendor may replace the model behind it, and results may change",
            ),
            Notice::PriceChanges { on } => write!(f, "its price changes on {on}"),
            Notice::PriceUnknown => f.write_str("its price is not known"),
            Notice::CoordinatesUnknown => f.write_str(
                "it is not known how it states positions in a picture: `fabc probe` finds out",
            ),
            Notice::Unlisted { near: Some(near) } => {
                write!(f, "no entry fits its id; did you mean `{near}`?")
            }
            Notice::Unlisted { near: None } => f.write_str("no entry fits its id"),
            Notice::ByName { name } => write!(f, "its id was taken for that of {name}, whose id is not known"),
        }
    }
}
