//! What is refused of a goal before any message is made of it, whatever the connection.

use super::Waypoint;
use std::time::Duration;

/// The longest wait, so that no sum of times overflows.
const LONGEST_S: f64 = 86_400.0;

/// Refuses a trajectory that no message can carry, or no controller follows: of fewer than 2 points, of another number
/// of joints, with values that are no numbers, or with times that do not grow or do not fit 32 bits of seconds.
pub fn check_trajectory(points: &[Waypoint], n_joints: usize) -> Result<(), String> {
    if points.len() < 2 {
        return Err(format!(
            "it has {} points, and needs at least 2",
            points.len()
        ));
    }
    let mut before_s = -1.0;
    for (index, point) in points.iter().enumerate() {
        for values in [
            &point.joints_rad,
            &point.speeds_rad_s,
            &point.accelerations_rad_s2,
        ] {
            check_count(values.len(), n_joints, "joints")?;
            check_finite(values)?;
        }
        check_finite([&point.at_s])?;
        let is_later = if index == 0 {
            point.at_s >= 0.0
        } else {
            point.at_s > before_s
        };
        if !is_later || point.at_s > f64::from(i32::MAX) {
            return Err(format!(
                "point {index} is at `{}` s, not after the one before",
                point.at_s
            ));
        }
        before_s = point.at_s;
    }
    Ok(())
}

/// Refuses another number of values than the arm has.
pub fn check_count(found: usize, expected: usize, what: &str) -> Result<(), String> {
    if found == expected {
        return Ok(());
    }
    Err(format!(
        "it names {found} {what}, and the arm has {expected}"
    ))
}

/// Refuses infinite values and those that are no numbers.
pub fn check_finite<'a>(values: impl IntoIterator<Item = &'a f64>) -> Result<(), String> {
    match values.into_iter().find(|value| !value.is_finite()) {
        Some(value) => Err(format!("it holds `{value}`, which is not a number")),
        None => Ok(()),
    }
}

/// Converts seconds to a duration; accepts any number, and limits it to 0 to a day.
pub fn bounded_wait(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds.min(LONGEST_S)).unwrap_or_default()
}

impl Waypoint {
    /// Returns the time since the start as whole seconds and the nanoseconds that are left, below 1,000,000,000.
    pub fn time_from_start(&self) -> (i32, u32) {
        // Rounded as a whole, so that the nanoseconds never reach a full second.
        let nanoseconds = (self.at_s * 1e9).round() as i64;
        (
            (nanoseconds / 1_000_000_000) as i32,
            (nanoseconds % 1_000_000_000) as u32,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

    #[test]
    fn a_trajectory_that_no_message_can_carry_is_refused_in_words() {
        let at = |at_s, angle| Waypoint::at_rest(vec![angle, 0.0], at_s);
        let rows = [
            (vec![at(0.0, 1.0)], "it has 1 points, and needs at least 2"),
            (
                vec![at(0.0, f64::NAN), at(1.0, 2.0)],
                "it holds `NaN`, which is not a number",
            ),
            (
                vec![at(1.0, 1.0), at(1.0, 2.0)],
                "point 1 is at `1` s, not after the one before",
            ),
            (
                vec![at(0.0, 1.0), at(1e12, 2.0)],
                "point 1 is at `1000000000000` s, not after the one before",
            ),
            (
                vec![at(0.0, 1.0), Waypoint::at_rest(vec![0.0], 1.0)],
                "it names 1 joints, and the arm has 2",
            ),
        ];
        for (points, expected) in rows {
            let found = check_trajectory(&points, 2);
            assert_eq!(found, Err(expected.to_owned()));
        }
        assert_eq!(check_trajectory(&[at(0.0, 0.0), at(1.0, 1.0)], 2), Ok(()));
    }

    #[test]
    fn a_time_is_rounded_to_nanoseconds_as_a_whole() {
        let times = [0.0, 0.5, 1.9999999999];
        let sent = times.map(|at_s| Waypoint::at_rest(Vec::new(), at_s).time_from_start());
        assert_eq!(sent, [(0, 0), (0, 500_000_000), (2, 0)]);
    }

    #[test]
    fn no_number_of_seconds_is_too_much_for_a_clock() {
        for seconds in [f64::NAN, f64::INFINITY, -1.0, 1e300, 0.0, 5.0] {
            let _ = Instant::now() + bounded_wait(seconds);
        }
        assert_eq!(bounded_wait(1.5), Duration::from_millis(1500));
    }
}
