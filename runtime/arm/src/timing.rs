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
use crate::kinematics::chain::{Chain, MAX_JOINTS};
use crate::port::Waypoint;
use crate::settings::Settings;
use nalgebra::SVector;
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

/// One value for each joint, 0 for those that the arm lacks, then one for the tool's place along its way.
type Row = SVector<f64, { MAX_JOINTS + 1 }>;

/// Places, speeds and accelerations.
type State = [Row; 3];

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
        if !path_rad.iter().flatten().all(|angle| angle.is_finite()) {
            return Err("a joint's angle on the way is no number".to_owned());
        }
        let steps_m = way_m / (path_rad.len().max(2) - 1) as f64;
        let places_m = (0..).map(|index| f64::from(index) * steps_m);
        let rows = path_rad.iter().zip(places_m);
        let rows: Vec<Row> = rows.map(|(joints, at_m)| row(joints, 0.0, at_m)).collect();
        let turned_rad = rows
            .iter()
            .map(|row| (row - rows[0]).remove_row(MAX_JOINTS));
        if turned_rad.map(|it| it.amax()).fold(0.0, f64::max) < NO_TURN_RAD {
            let still = path_rad.last().into_iter();
            return Ok(still
                .map(|joints_rad| Waypoint::at_rest(joints_rad.clone(), 0.0))
                .collect());
        }
        let caps = self.caps(speed_m_s);
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
        let stretch = stretch(&states, profile.duration_s() / steps, &caps);
        let takes_s = profile.duration_s() * stretch;
        if takes_s > MAX_S {
            return Err(too_long(takes_s));
        }
        let joints = |row: Row| row.as_slice()[..self.speeds_rad_s.len()].to_vec();
        let waypoint = |(index, [places, speeds, accelerations]): (usize, State)| Waypoint {
            joints_rad: joints(places),
            speeds_rad_s: joints(speeds / stretch),
            accelerations_rad_s2: joints(accelerations / stretch.powi(2)),
            at_s: takes_s * index as f64 / steps,
        };
        Ok(states.into_iter().enumerate().map(waypoint).collect())
    }

    /// Returns the limits of speed, acceleration and jerk; the tool has one of speed alone.
    fn caps(&self, speed_m_s: f64) -> [Row; 3] {
        [
            row(&self.speeds_rad_s, f64::INFINITY, speed_m_s),
            row(&[], self.acceleration_rad_s2, f64::INFINITY),
            row(&[], self.jerk_rad_s3, f64::INFINITY),
        ]
    }
}

/// Returns a row of one value for each joint, another for those that the arm lacks, and one for the tool.
fn row(joints: &[f64], lacking: f64, tool: f64) -> Row {
    let mut row = Row::repeat(lacking);
    for (value, joint) in row.iter_mut().zip(joints) {
        *value = *joint;
    }
    row[MAX_JOINTS] = tool;
    row
}

/// Returns the least time that the limits allow a difference of this order, seconds; or by how much a derivative exceeds
/// them.
fn least(difference: &Row, caps: &Row, order: usize) -> f64 {
    let share = difference.abs().component_div(caps).max();
    share.powf(1.0 / order as f64)
}

/// Returns when each row would be passed if every step took the least time that its limits allow, seconds.
fn knots(rows: &[Row], caps: &[Row; 3]) -> Vec<f64> {
    let mut steps_s = vec![0.0f64; rows.len()];
    let mut differences = rows.to_vec();
    for (order, caps) in (1..).zip(caps) {
        differences = between(&differences);
        for (first, difference) in differences.iter().enumerate() {
            let least_s = least(difference, caps, order);
            for step_s in &mut steps_s[first..=first + order] {
                *step_s = step_s.max(least_s);
            }
        }
    }
    // A mean of values that are each the most in their neighbourhood is no less than the value itself, and the speed
    // along the path has no corners.
    let most = |near: &[f64]| near.iter().copied().fold(0.0, f64::max);
    let mean = |near: &[f64]| near.iter().sum::<f64>() / near.len() as f64;
    let smooth = over_near(&steps_s, 2, most);
    let smooth = over_near(&over_near(&smooth, 1, mean), 1, mean);
    let mut at_s = 0.0;
    let mut knots = vec![0.0];
    for pair in smooth.windows(2) {
        at_s += (pair[0] + pair[1]) / 2.0;
        knots.push(at_s);
    }
    knots
}

/// Returns the differences of neighbours.
fn between(rows: &[Row]) -> Vec<Row> {
    rows.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// Returns a function of each value and its neighbours, so many on either side.
fn over_near(values: &[f64], beside: usize, function: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let near = |at: usize| at.saturating_sub(beside)..(at + beside + 1).min(values.len());
    let all = 0..values.len();
    all.map(|at| function(&values[near(at)])).collect()
}

/// A natural cubic spline through rows of values.
struct Spline {
    knots: Vec<f64>,
    rows: Vec<Row>,
    /// Second derivatives at the knots.
    bends: Vec<Row>,
}

impl Spline {
    /// - `knots`: increasing, one for each row, two at least.
    fn through(knots: Vec<f64>, rows: Vec<Row>) -> Spline {
        let inner = 1..rows.len() - 1;
        let mut bends = vec![Row::zeros(); rows.len()];
        // Eliminate from the first inner knot to the last, then solve backwards.
        let mut factors = vec![0.0; rows.len()];
        for at in inner.clone() {
            let [before, after] = [knots[at] - knots[at - 1], knots[at + 1] - knots[at]];
            let pivot = 2.0 * (before + after) - before * factors[at - 1];
            factors[at] = after / pivot;
            let bend = (rows[at + 1] - rows[at]) / after - (rows[at] - rows[at - 1]) / before;
            bends[at] = (bend * 6.0 - bends[at - 1] * before) / pivot;
        }
        for at in inner.rev() {
            let next = bends[at + 1];
            bends[at] -= next * factors[at];
        }
        Spline { knots, rows, bends }
    }

    /// Returns its last knot; the first is 0.
    fn length(&self) -> f64 {
        self.knots.last().copied().unwrap_or_default()
    }

    /// Returns the state at a place that is passed with a speed and an acceleration.
    fn state(&self, [place, speed, acceleration]: [f64; 3]) -> State {
        let next = self.knots.partition_point(|knot| *knot <= place);
        let next = next.clamp(1, self.knots.len() - 1);
        let width = self.knots[next] - self.knots[next - 1];
        let after = (place - self.knots[next - 1]) / width;
        let before = 1.0 - after;
        let [here, there] = [self.rows[next - 1], self.rows[next]];
        let [bend, next_bend] = [self.bends[next - 1], self.bends[next]];
        let third = |share: f64| (share.powi(3) - share) * width.powi(2) / 6.0;
        let slope = |share: f64| (3.0 * share.powi(2) - 1.0) * width / 6.0;
        let values =
            here * before + there * after + bend * third(before) + next_bend * third(after);
        let slopes = (there - here) / width - bend * slope(before) + next_bend * slope(after);
        let bends = bend * before + next_bend * after;
        let accelerations = bends * speed.powi(2) + slopes * acceleration;
        [values, slopes * speed, accelerations]
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
    fn over(path: &Spline, [_, accelerations, jerks]: &[Row; 3]) -> Result<Profile, String> {
        let mut rates = MAX_RATES;
        for knot in &path.knots {
            let [_, slopes, _] = path.state([*knot, 1.0, 0.0]);
            for (rate, limits) in rates.iter_mut().zip([accelerations, jerks]) {
                *rate = rate.min(1.0 / least(&slopes, limits, 1));
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
fn stretch(states: &[State], step_s: f64, caps: &[Row; 3]) -> f64 {
    let at_rest = |state: Option<&State>| state.map(|state| [state[0]; 3]).into_iter().flatten();
    let places = at_rest(states.first()).chain(states.iter().map(|state| state[0]));
    let mut rows: Vec<Row> = places.chain(at_rest(states.last())).collect();
    let mut stretch = 1.0f64;
    for (order, caps) in (1..).zip(caps) {
        rows = between(&rows).iter().map(|row| row / step_s).collect();
        let stated = states.iter().filter_map(|state| state.get(order));
        let exceeded = stated.chain(&rows).map(|row| least(row, caps, order));
        stretch = exceeded.fold(stretch, f64::max);
    }
    stretch
}
