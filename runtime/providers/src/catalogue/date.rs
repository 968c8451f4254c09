//! Days of the calendar, from which prices count and on which facts were gathered.
//!
//! In: `2026-11-20`. Out: an order. The caller supplies today's date.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::time::{Duration, UNIX_EPOCH};

const DAY_SECS: u64 = 24 * 60 * 60;
/// 9999-12-31, in days since 1970-01-01: the last day that is written with four digits for its year.
const LAST_DAY: u64 = 2_932_896;

/// A day.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Date {
    /// Since 1970-01-01.
    days: u64,
}

impl Date {
    /// Returns the date this many days after 1970-01-01, e.g. of a system clock in UTC; at most the year 9999.
    pub fn from_unix_days(days: u64) -> Date {
        Date {
            days: days.min(LAST_DAY),
        }
    }
}

impl TryFrom<String> for Date {
    type Error = String;

    /// Reads a date such as `2026-11-20`; fails with the reason.
    fn try_from(text: String) -> Result<Date, String> {
        let start = humantime::parse_rfc3339(&format!("{text}T00:00:00Z"));
        let since = start.ok().and_then(|it| it.duration_since(UNIX_EPOCH).ok());
        let days = since.map(|since| since.as_secs() / DAY_SECS);
        days.map(|days| Date { days })
            .ok_or_else(|| format!("`{text}` is not a date; write one such as `2026-11-20`"))
    }
}

impl fmt::Display for Date {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let start = UNIX_EPOCH + Duration::from_secs(self.days * DAY_SECS);
        let start = humantime::format_rfc3339_seconds(start).to_string();
        f.write_str(&start[.."2026-11-20".len()])
    }
}

impl From<Date> for String {
    fn from(date: Date) -> String {
        date.to_string()
    }
}
