//! Times a path of the tool: when the arm passes each point of it.
//!
//! In: joint angles at even steps of a path, the tool's speed, and the limits of the joints. Out: waypoints that begin
//! and end at rest and exceed no limit of speed, acceleration or jerk; all of them lie on the path. Whether the path is
//! allowed is left to the guard.
//!
//! First, each step gets the least time that the limits allow it. The sum of these times is the path's parameter, and
//! the angles are a cubic spline over it. Then one jerk-limited profile (Ruckig: Berscheid and Kröger, "Jerk-limited
//! Real-time Trajectory Generation with Arbitrary Target States", 2021) runs from the parameter's start to its end, so
//! the tool never leaves the path. Last, differences of the waypoints are compared with the limits, and all times are
//! stretched by what is missing.

use crate::guard::STEP_M;
use crate::kinematics::chain::Chain;
use crate::port::Waypoint;
use crate::settings::Settings;
use rsruckig::prelude::{
    DataArrayOrVec, InputParameter, Ruckig, RuckigResult, ThrowErrorHandler, Trajectory,
};

/// The longest time between two waypoints before times are stretched, seconds: half of the time in which acceleration
/// builds up with the default limits.
const BETWEEN_S: f64 = 0.05;

/// The least number of steps of a trajectory, so that a short one keeps its form.
const MIN_STEPS: f64 = 20.0;

/// The longest motion, seconds: the longest way of 2 m at the lowest speed of 5 mm/s takes less.
const MAX_S: f64 = 600.0;

/// A path that turns no joint by more than this, radians, is no motion.
const NO_TURN_RAD: f64 = 1e-6;

/// The largest rates of the profile, 1/s and 1/s²: they keep the numbers finite if the joints hardly turn.
const MAX_RATES: [f64; 2] = [1e3, 1e6];

/// How fast the joints of an arm may turn.
#[derive(Clone, Debug, PartialEq)]
pub struct JointLimits {
    /// The highest speed of each, from the base to the hand, rad/s.
    pub speeds_rad_s: Vec<f64>,
    /// The largest acceleration of each, rad/s².
    pub acceleration_rad_s2: f64,
    /// The largest jerk of each, rad/s³.
    pub jerk_rad_s3: f64,
}

impl JointLimits {
    /// Returns the arm's own speeds, and the settings' acceleration and jerk.
    pub fn of(settings: &Settings, chain: &Chain) -> JointLimits {
        let speed_rad_s = |joint: &crate::kinematics::chain::Joint| joint.max_speed_rad_s;
        JointLimits {
            speeds_rad_s: chain.joints().iter().map(speed_rad_s).collect(),
            acceleration_rad_s2: settings.motion.acceleration_deg_s2.to_radians(),
            jerk_rad_s3: settings.motion.jerk_deg_s3.to_radians(),
        }
    }

    /// Returns the highest speed of the tool that the joints' own speeds allow along a path, m/s; infinite if no joint
    /// turns.
    ///
    /// - `path_rad`, `way_m`: as of [`JointLimits::time`].
    pub fn allow_m_s(&self, path_rad: &[Vec<f64>], way_m: f64) -> f64 {
        let step_m = way_m / (path_rad.len() - 1).max(1) as f64;
        let steps = path_rad.windows(2).flat_map(|pair| {
            let turns = pair[0].iter().zip(&pair[1]).map(|(a, b)| (b - a).abs());
            let limits = self.speeds_rad_s.iter().zip(turns);
            limits.map(|(limit, turn)| step_m * limit / turn)
        });
        // A joint that does not turn gives infinity, or no number on a way of no length.
        steps.fold(f64::INFINITY, f64::min)
    }

    /// Times a path; the error says why that is not possible. A path without motion is a single waypoint.
    ///
    /// - `path_rad`: joint angles at even steps along the path, both ends included.
    /// - `way_m`: the length of the tool's way, metres.
    /// - `speed_m_s`: the highest speed of the tool.
    pub fn time(
        &self,
        path_rad: &[Vec<f64>],
        way_m: f64,
        speed_m_s: f64,
    ) -> Result<Vec<Waypoint>, String> {
        let [first, .., last] = path_rad else {
            let still = path_rad.iter().take(1);
            return Ok(still
                .map(|joints_rad| Waypoint::at_rest(joints_rad.clone(), 0.0))
                .collect());
        };
        if !path_rad.iter().flatten().all(|angle| angle.is_finite()) {
            return Err("a joint's angle on the way is no number".to_owned());
        }
        if turns_rad(first, path_rad) < NO_TURN_RAD {
            return Ok(vec![Waypoint::at_rest(last.clone(), 0.0)]);
        }
        let caps = self.caps(speed_m_s);
        let step_m = way_m / (path_rad.len() - 1) as f64;
        let rows: Vec<Vec<f64>> = path_rad
            .iter()
            .enumerate()
            .map(|(index, joints_rad)| {
                let mut row = joints_rad.clone();
                row.push(index as f64 * step_m);
                row
            })
            .collect();
        let path = Spline::through(knots(&rows, &caps), rows);
        let too_long = |takes_s: f64| {
            format!(
                "the motion would take {takes_s:.0} s, and at most {MAX_S} s are allowed: the limits of the joints, or \
                 `motion.speed_m_s`, leave it no more speed"
            )
        };
        if path.length() > MAX_S {
            return Err(too_long(path.length()));
        }
        let profile = Profile::over(&path, &caps)?;
        let between_s = BETWEEN_S.min(STEP_M / speed_m_s);
        let steps = (profile.duration_s() / between_s).ceil().max(MIN_STEPS);
        let states: Vec<State> = (0..=steps as usize)
            .map(|step| path.state(profile.at(profile.duration_s() * (step as f64 / steps))))
            .collect();
        let step_s = profile.duration_s() / steps;
        let stretch = stretch(&states, step_s, &caps);
        let takes_s = profile.duration_s() * stretch;
        if takes_s > MAX_S {
            return Err(too_long(takes_s));
        }
        let joints = self.speeds_rad_s.len();
        let waypoint = |(index, state): (usize, State)| {
            let [joints_rad, speeds, accelerations] = state.map(|mut row| {
                row.truncate(joints);
                row
            });
            Waypoint {
                joints_rad,
                speeds_rad_s: speeds.iter().map(|it| it / stretch).collect(),
                accelerations_rad_s2: accelerations
                    .iter()
                    .map(|it| it / stretch.powi(2))
                    .collect(),
                at_s: takes_s * index as f64 / steps,
            }
        };
        Ok(states.into_iter().enumerate().map(waypoint).collect())
    }

    /// Returns the limits of speed, acceleration and jerk: of each joint, then of the tool's place along the path,
    /// which has one of speed alone.
    fn caps(&self, speed_m_s: f64) -> [Vec<f64>; 3] {
        let all = |limit: f64, tool: f64| {
            let mut limits = vec![limit; self.speeds_rad_s.len()];
            limits.push(tool);
            limits
        };
        let mut speeds = self.speeds_rad_s.clone();
        speeds.push(speed_m_s);
        [
            speeds,
            all(self.acceleration_rad_s2, f64::INFINITY),
            all(self.jerk_rad_s3, f64::INFINITY),
        ]
    }
}

/// Returns the largest turn of a joint from where it begins, radians.
fn turns_rad(first: &[f64], path_rad: &[Vec<f64>]) -> f64 {
    let turns = path_rad.iter().flat_map(|joints_rad| {
        let pairs = joints_rad.iter().zip(first);
        pairs.map(|(angle, first)| (angle - first).abs())
    });
    turns.fold(0.0, f64::max)
}

/// Returns when each row would be passed if every step took the least time that its limits allow, seconds.
fn knots(rows: &[Vec<f64>], caps: &[Vec<f64>; 3]) -> Vec<f64> {
    let differences = [1, 2, 3].map(|order| differences(rows, order));
    let steps_s: Vec<f64> = (0..rows.len())
        .map(|row| {
            let mut step_s = 0.0f64;
            for ((differences, caps), order) in differences.iter().zip(caps).zip(1..) {
                // The differences that contain this row.
                let from = row.saturating_sub(order);
                let until = (row + 1).min(differences.len());
                for difference in &differences[from.min(until)..until] {
                    for (value, cap) in difference.iter().zip(caps) {
                        step_s = step_s.max((value.abs() / cap).powf(1.0 / f64::from(order as u8)));
                    }
                }
            }
            step_s
        })
        .collect();
    // A mean of values that are each the most in their neighbourhood is no less than the value itself, and the speed
    // along the path has no corners.
    let smooth = means(&means(&most(&steps_s)));
    let mut at_s = 0.0;
    let mut knots = vec![0.0];
    for pair in smooth.windows(2) {
        at_s += (pair[0] + pair[1]) / 2.0;
        knots.push(at_s);
    }
    knots
}

/// Returns the differences of rows of an order; none if there are too few rows.
fn differences(rows: &[Vec<f64>], order: usize) -> Vec<Vec<f64>> {
    let mut differences = rows.to_vec();
    for _ in 0..order {
        let next = differences.windows(2).map(|pair| {
            let values = pair[1].iter().zip(&pair[0]);
            values.map(|(after, before)| after - before).collect()
        });
        differences = next.collect();
    }
    differences
}

/// Returns for each value the most within two places of it.
fn most(values: &[f64]) -> Vec<f64> {
    let near = |at: usize| &values[at.saturating_sub(2)..(at + 3).min(values.len())];
    let most = |at| near(at).iter().copied().fold(0.0, f64::max);
    (0..values.len()).map(most).collect()
}

/// Returns for each value the mean of it and its neighbours.
fn means(values: &[f64]) -> Vec<f64> {
    let near = |at: usize| &values[at.saturating_sub(1)..(at + 2).min(values.len())];
    let mean = |at| near(at).iter().sum::<f64>() / near(at).len() as f64;
    (0..values.len()).map(mean).collect()
}

/// Place, speed and acceleration of every joint and of the tool along its way.
type State = [Vec<f64>; 3];

/// A natural cubic spline through rows of values.
struct Spline {
    knots: Vec<f64>,
    rows: Vec<Vec<f64>>,
    /// Second derivatives at the knots.
    bends: Vec<Vec<f64>>,
}

impl Spline {
    /// - `knots`: increasing, one for each row, two at least.
    fn through(knots: Vec<f64>, rows: Vec<Vec<f64>>) -> Spline {
        let (count, width) = (rows.len(), rows[0].len());
        let mut bends = vec![vec![0.0; width]; count];
        // Eliminate from the first inner knot to the last, then solve backwards.
        let mut factors = vec![0.0; count];
        for at in 1..count - 1 {
            let [before, after] = [knots[at] - knots[at - 1], knots[at + 1] - knots[at]];
            let pivot = 2.0 * (before + after) - before * factors[at - 1];
            factors[at] = after / pivot;
            for column in 0..width {
                let [left, here, right] =
                    [-1, 0, 1].map(|by: isize| rows[at.saturating_add_signed(by)][column]);
                let bend = 6.0 * ((right - here) / after - (here - left) / before);
                bends[at][column] = (bend - before * bends[at - 1][column]) / pivot;
            }
        }
        for at in (1..count - 1).rev() {
            let next = bends[at + 1].clone();
            for (bend, next) in bends[at].iter_mut().zip(next) {
                *bend -= factors[at] * next;
            }
        }
        Spline { knots, rows, bends }
    }

    /// Returns its last knot; the first is 0.
    fn length(&self) -> f64 {
        self.knots.last().copied().unwrap_or_default()
    }

    /// Returns values, first and second derivatives at a place.
    fn at(&self, place: f64) -> State {
        let next = self.knots.partition_point(|knot| *knot <= place);
        let next = next.clamp(1, self.knots.len() - 1);
        let width = self.knots[next] - self.knots[next - 1];
        let after = (place - self.knots[next - 1]) / width;
        let before = 1.0 - after;
        let column = |column: usize| {
            let [here, there] = [next - 1, next].map(|at| self.rows[at][column]);
            let [bend, next_bend] = [next - 1, next].map(|at| self.bends[at][column]);
            let third = |share: f64| (share.powi(3) - share) * width.powi(2) / 6.0;
            let slope = |share: f64| (3.0 * share.powi(2) - 1.0) * width / 6.0;
            [
                before * here + after * there + third(before) * bend + third(after) * next_bend,
                (there - here) / width - slope(before) * bend + slope(after) * next_bend,
                before * bend + after * next_bend,
            ]
        };
        let columns: Vec<[f64; 3]> = (0..self.rows[0].len()).map(column).collect();
        [0, 1, 2].map(|order| columns.iter().map(|column| column[order]).collect())
    }

    /// Returns the state at a place that is passed with a speed and an acceleration.
    fn state(&self, [place, speed, acceleration]: [f64; 3]) -> State {
        let [values, slopes, bends] = self.at(place);
        let speeds = slopes.iter().map(|slope| slope * speed).collect();
        let accelerations = slopes.iter().zip(&bends);
        let accelerations =
            accelerations.map(|(slope, bend)| bend * speed * speed + slope * acceleration);
        let accelerations = accelerations.collect();
        [values, speeds, accelerations]
    }
}

/// A motion along a path's parameter from rest to rest.
struct Profile {
    trajectory: Trajectory<1>,
    length: f64,
}

impl Profile {
    /// Plans the fastest motion along a path at rates of up to 1, with which the joints keep their limits where the
    /// path is straight.
    fn over(path: &Spline, [_, accelerations, jerks]: &[Vec<f64>; 3]) -> Result<Profile, String> {
        let mut rates = MAX_RATES;
        for knot in &path.knots {
            let [_, slopes, _] = path.at(*knot);
            for (slope, limits) in slopes.iter().zip(accelerations.iter().zip(jerks)) {
                rates[0] = rates[0].min(limits.0 / slope.abs());
                rates[1] = rates[1].min(limits.1 / slope.abs());
            }
        }
        let mut input = InputParameter::<1>::new(None);
        input.target_position[0] = path.length();
        input.max_velocity[0] = 1.0;
        input.max_acceleration[0] = rates[0];
        input.max_jerk[0] = rates[1];
        let mut trajectory = Trajectory::new(None);
        let mut planner = Ruckig::<1, ThrowErrorHandler>::new(None, BETWEEN_S);
        match planner.calculate(&input, &mut trajectory) {
            Ok(RuckigResult::Working | RuckigResult::Finished) => Ok(Profile {
                trajectory,
                length: path.length(),
            }),
            Ok(other) => Err(format!("the motion cannot be timed: {other:?}")),
            Err(error) => Err(format!("the motion cannot be timed: {error}")),
        }
    }

    fn duration_s(&self) -> f64 {
        self.trajectory.get_duration()
    }

    /// Returns place, speed and acceleration at a time; both ends are at rest.
    fn at(&self, at_s: f64) -> [f64; 3] {
        let [mut place, mut speed, mut acceleration] =
            [0; 3].map(|_| DataArrayOrVec::<f64, 1>::new(None, 0.0));
        self.trajectory.at_time(
            at_s,
            &mut Some(&mut place),
            &mut Some(&mut speed),
            &mut Some(&mut acceleration),
            &mut None,
            &mut None,
        );
        match at_s {
            at_s if at_s <= 0.0 => [0.0; 3],
            at_s if at_s >= self.duration_s() => [self.length, 0.0, 0.0],
            _ => [place[0].clamp(0.0, self.length), speed[0], acceleration[0]],
        }
    }
}

/// Returns by how much times must be stretched so that no limit is exceeded, 1 if none is.
///
/// Differences over steps are means over time, so the waypoints keep a limit if the path does. The arm rests before and
/// after.
fn stretch(states: &[State], step_s: f64, caps: &[Vec<f64>; 3]) -> f64 {
    let places = states.iter().map(|state| state[0].clone());
    let [Some(first), Some(last)] = [states.first(), states.last()].map(|it| it.map(|it| &it[0]))
    else {
        return 1.0;
    };
    let rest = |place: &Vec<f64>| vec![place.clone(); caps.len()];
    let places: Vec<Vec<f64>> = rest(first)
        .into_iter()
        .chain(places)
        .chain(rest(last))
        .collect();
    let mut stretch = 1.0f64;
    for (order, caps) in (1..).zip(caps) {
        let least = |value: f64, cap: f64| (value.abs() / cap).powf(1.0 / f64::from(order as u8));
        for difference in differences(&places, order) {
            for (value, cap) in difference.iter().zip(caps) {
                stretch = stretch.max(least(value / step_s.powi(order as i32), *cap));
            }
        }
        for state in states.iter().filter_map(|state| state.get(order)) {
            for (value, cap) in state.iter().zip(caps) {
                stretch = stretch.max(least(*value, *cap));
            }
        }
    }
    stretch
}
