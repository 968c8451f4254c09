//! Dates in facts about models.
//!
//! In: `2026-11-20`, or `2024-12` if only the month is known. Out: an order, and distances in days. The caller supplies
//! today's date.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;
use std::time::{Duration, UNIX_EPOCH};

/// The length of `2026-11-20`, bytes.
const DAY_LENGTH: usize = 10;

/// The length of `2026-11`, bytes.
const MONTH_LENGTH: usize = 7;

const DAY_SECS: u64 = 24 * 60 * 60;

/// A day, or a month without a known day, which counts from its first day.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Date {
    /// Since 1970-01-01; of a month without a known day, its first.
    days: u64,
    has_day: bool,
}

/// A text that is not a date.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a date; write one such as `2026-11-20`, or `2026-11` if the day is unknown")]
pub struct NoDate(String);

impl Date {
    /// Returns the date this many days after 1970-01-01, e.g. of a system clock in UTC.
    ///
    /// Days after the year 9999 are clamped to its last day.
    pub fn from_unix_days(days: u64) -> Date {
        Date {
            days: days.min(2_932_896),
            has_day: true,
        }
    }

    /// Returns how many days later `other` is; negative if it is earlier.
    pub fn days_until(self, other: Date) -> i64 {
        other.days as i64 - self.days as i64
    }
}

impl FromStr for Date {
    type Err = NoDate;

    fn from_str(text: &str) -> Result<Date, NoDate> {
        let has_day = text.len() == DAY_LENGTH;
        let read = || {
            let start = match text.len() {
                DAY_LENGTH => format!("{text}T00:00:00Z"),
                MONTH_LENGTH => format!("{text}-01T00:00:00Z"),
                _ => return None,
            };
            let start = humantime::parse_rfc3339(&start).ok()?;
            let since = start.duration_since(UNIX_EPOCH).ok()?;
            let days = since.as_secs() / DAY_SECS;
            Some(Date { days, has_day })
        };
        // A long text is not repeated in full.
        read().ok_or_else(|| NoDate(text.chars().take(40).collect()))
    }
}

impl fmt::Display for Date {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let start = UNIX_EPOCH + Duration::from_secs(self.days * DAY_SECS);
        let start = humantime::format_rfc3339_seconds(start).to_string();
        let length = if self.has_day {
            DAY_LENGTH
        } else {
            MONTH_LENGTH
        };
        f.write_str(&start[..length])
    }
}

impl Serialize for Date {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Date {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Date, D::Error> {
        String::deserialize(deserializer)?
            .parse()
            .map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn date(text: &str) -> Date {
        text.parse().expect("a date")
    }

    #[test]
    fn dates_are_written_as_they_are_read() {
        for text in [
            "2026-11-20",
            "2024-12",
            "2024-02-29",
            "1970-01-01",
            "9999-12-31",
        ] {
            assert_eq!(date(text).to_string(), text);
        }
    }

    #[test]
    fn what_is_no_day_of_the_calendar_is_refused() {
        for text in [
            "",
            "2026",
            "2026-13",
            "2026-00-10",
            "2026-02-29",
            "2026-04-31",
            "26-11-20",
            "2026-1-2",
            "2026-11-20-1",
            "+026-11-20",
            "1969-12-31",
            "２０２６-11-20",
        ] {
            assert!(text.parse::<Date>().is_err(), "{text}");
        }
    }

    #[test]
    fn days_of_a_clock_are_days_of_the_calendar() {
        for (days, expected) in [
            (0, "1970-01-01"),
            (59, "1970-03-01"),
            (11_016, "2000-02-29"),
            (20_777, "2026-11-20"),
            (u64::MAX, "9999-12-31"),
        ] {
            assert_eq!(Date::from_unix_days(days), date(expected), "{days}");
        }
        for days in (0..60_000).step_by(17) {
            let distance = date("1970-01-01").days_until(Date::from_unix_days(days));
            assert_eq!(distance, days as i64);
        }
    }

    #[test]
    fn a_month_counts_from_its_first_day() {
        assert_eq!(date("2024-11-30").days_until(date("2024-12")), 1);
        assert_eq!(date("2027-01-14").days_until(date("2026-12-11")), -34);
    }
}
