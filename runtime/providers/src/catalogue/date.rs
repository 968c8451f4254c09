//! Dates in facts about models.
//!
//! In: `2026-11-20`, or `2024-12` if only the month is known. Out: an order, and distances in days. The caller supplies
//! today's date.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// A day, or a month without a known day, which counts from its first day.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Date {
    year: u16,
    month: u8,
    day: Option<u8>,
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
        let mut left = days.min(2_932_896);
        let mut year = 1970;
        while left >= days_of_year(year) {
            left -= days_of_year(year);
            year += 1;
        }
        let mut month = 1;
        while left >= u64::from(days_of_month(year, month)) {
            left -= u64::from(days_of_month(year, month));
            month += 1;
        }
        Date {
            year,
            month,
            day: u8::try_from(left + 1).ok(),
        }
    }

    /// Returns how many days later `other` is; negative if it is earlier.
    pub fn days_until(self, other: Date) -> i64 {
        other.days() - self.days()
    }

    /// Returns the days since the year 0, by the Gregorian calendar.
    fn days(self) -> i64 {
        let years = i64::from(self.year);
        let before = years - 1;
        let leap_days = before.div_euclid(4) - before.div_euclid(100) + before.div_euclid(400);
        let months: i64 = (1..self.month)
            .map(|month| i64::from(days_of_month(self.year, month)))
            .sum();
        years * 365 + leap_days + months + i64::from(self.day.unwrap_or(1))
    }
}

fn is_leap(year: u16) -> bool {
    year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
}

fn days_of_year(year: u16) -> u64 {
    if is_leap(year) { 366 } else { 365 }
}

fn days_of_month(year: u16, month: u8) -> u8 {
    match month {
        4 | 6 | 9 | 11 => 30,
        2 if is_leap(year) => 29,
        2 => 28,
        _ => 31,
    }
}

impl FromStr for Date {
    type Err = NoDate;

    fn from_str(text: &str) -> Result<Date, NoDate> {
        let number = |part: &str, length: usize| {
            let is_plain = part.len() == length && part.bytes().all(|byte| byte.is_ascii_digit());
            is_plain.then(|| part.parse::<u16>().ok()).flatten()
        };
        let mut parts = text.split('-');
        let read = || {
            let year = number(parts.next()?, 4)?;
            let month = u8::try_from(number(parts.next()?, 2)?).ok()?;
            let day = match parts.next() {
                Some(part) => Some(u8::try_from(number(part, 2)?).ok()?),
                None => None,
            };
            let is_real = (1970..=9999).contains(&year)
                && (1..=12).contains(&month)
                && day.is_none_or(|day| (1..=days_of_month(year, month)).contains(&day))
                && parts.next().is_none();
            is_real.then_some(Date { year, month, day })
        };
        let mut read = read;
        // A long text is not repeated in full.
        read().ok_or_else(|| NoDate(text.chars().take(40).collect()))
    }
}

impl fmt::Display for Date {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}-{:02}", self.year, self.month)?;
        self.day.map_or(Ok(()), |day| write!(f, "-{day:02}"))
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
