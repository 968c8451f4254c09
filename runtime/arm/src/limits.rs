//! Safety limits on where an arm may be and how fast it may move. They wrap any arm.
//!
//! In: motions. Out: the same motions, or a refusal before anything moves; and a stop if the arm violates its limits
//! during a motion. The limits apply to the tool only: a person has to watch elbow and cables.

use super::driver::{Arm, ArmError, ArmState, Deviation, Halt, HandContents, Opening, Watch};
use super::settings::{KeepOut, Tolerance, Workspace};
use nalgebra::{Isometry3, Point3, Vector3};
use std::collections::VecDeque;

/// Factor by which the measured speed may exceed the limit before the arm is stopped: positions have 1 mm resolution.
const SPEED_SLACK: f64 = 1.5;

/// How far the tool may move during a finger motion, metres: the accuracy with which the arm's node holds a pose.
const FINGERS_STAY_M: f64 = 0.010;

/// Time over which speed is measured, seconds.
const SPEED_OVER_S: f64 = 0.4;

/// Largest tilt of the hand from straight down, and largest rotation in one motion, radians. Every goal here points
/// down.
const MAX_TILT_RAD: f64 = 0.2;

/// An arm whose motions are checked against limits.
pub struct Limited<A: Arm> {
    arm: A,
    workspace: Workspace,
    /// Distance that goals keep from the limits, metres: the position tolerance of the arm.
    margin_m: f64,
    /// How often a motion that ended short of its goal is sent again.
    corrections: u32,
}

impl<A: Arm> Limited<A> {
    /// Wraps an arm whose tool reaches its goals to within the tolerance.
    pub fn new(arm: A, workspace: Workspace, tolerance: &Tolerance) -> Limited<A> {
        Limited {
            arm,
            workspace,
            margin_m: tolerance.position_m,
            corrections: tolerance.corrections,
        }
    }

    /// Returns the wrapped arm.
    pub fn arm(&mut self) -> &mut A {
        &mut self.arm
    }

    /// Checks a straight motion of the tool; the error says why it is not allowed.
    ///
    /// - `from`, `to`: `base_from_tool`.
    pub fn check(
        &self,
        from: &Isometry3<f64>,
        to: &Isometry3<f64>,
        speed_m_s: f64,
    ) -> Result<(), ArmError> {
        check(&self.workspace, self.margin_m, from, to, speed_m_s).map_err(ArmError::Refused)
    }
}

/// Checks a straight motion of the tool; the error says why it is not allowed.
///
/// - `margin_m`: distance that the goal keeps from the limits.
pub fn check(
    workspace: &Workspace,
    margin_m: f64,
    from: &Isometry3<f64>,
    to: &Isometry3<f64>,
    speed_m_s: f64,
) -> Result<(), String> {
    let ends = [from, to].map(|pose| Point3::from(pose.translation.vector));
    if !ends
        .iter()
        .flat_map(|end| end.iter())
        .all(|value| value.is_finite())
    {
        return Err("a motion's end is no place".to_owned());
    }
    if !(speed_m_s > 0.0 && speed_m_s <= workspace.max_speed_m_s) {
        return Err(format!(
            "a speed of `{speed_m_s}` m/s is not above 0 and at most `{}` m/s",
            workspace.max_speed_m_s
        ));
    }
    let way_m = (ends[1] - ends[0]).norm();
    if way_m > workspace.max_step_m {
        return Err(format!(
            "a way of {way_m:.3} m is longer than `{}` m, the longest that is allowed at once",
            workspace.max_step_m
        ));
    }
    // Rotation speed is not limited, and every motion here keeps the rotation.
    let turn_rad = from.rotation.angle_to(&to.rotation);
    let keeps = turn_rad <= MAX_TILT_RAD;
    if !keeps {
        return Err(format!(
            "the hand would turn by {:.0} degrees; the limit is {:.0}; move it by hand until it points straight down \
             with the rotation `motion.hand_turn_deg`",
            turn_rad.to_degrees(),
            MAX_TILT_RAD.to_degrees()
        ));
    }
    let tilt_rad = (to.rotation * Vector3::z()).angle(&-Vector3::z());
    // NaN must fail this check.
    let is_upright = tilt_rad <= MAX_TILT_RAD;
    if !is_upright || !to.rotation.coords.iter().all(|value| value.is_finite()) {
        return Err(format!(
            "the hand would be tilted by {:.0} degrees, and at most {:.0} are allowed",
            tilt_rad.to_degrees(),
            MAX_TILT_RAD.to_degrees()
        ));
    }
    inside(workspace, &ends[0], 0.0)
        .map_err(|why| format!("the tool is {why}; bring it back by hand"))?;
    check_goal(workspace, margin_m, &ends[1])?;
    for zone in &workspace.keep_out {
        if crosses(zone, margin_m, &ends[0], &ends[1]) && !leaves(zone, margin_m, &ends) {
            return Err(format!(
                "the way from {} to {} leads through `{}`, which is kept out",
                place(&ends[0]),
                place(&ends[1]),
                zone.name
            ));
        }
    }
    Ok(())
}

/// Checks a goal of the tool, wherever the tool is now; the error says why it is not allowed.
pub fn check_goal(workspace: &Workspace, margin_m: f64, point: &Point3<f64>) -> Result<(), String> {
    inside(workspace, point, margin_m).map_err(|why| format!("the tool would be {why}"))
}

/// Checks that a point is inside the workspace, shrunk by a margin; the error names the violated axis.
fn inside(workspace: &Workspace, point: &Point3<f64>, margin_m: f64) -> Result<(), String> {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let (least, most) = (
            workspace.min_m[axis] + margin_m,
            workspace.max_m[axis] - margin_m,
        );
        // NaN must count as outside.
        if !(point[axis] >= least && point[axis] <= most) {
            let margin = match margin_m > 0.0 {
                true => format!(" with a margin of {:.0} mm", margin_m * 1000.0),
                false => String::new(),
            };
            return Err(format!(
                "at {}, outside of the workspace, whose {name} goes from {:.3} to {:.3} m{margin}",
                place(point),
                workspace.min_m[axis],
                workspace.max_m[axis]
            ));
        }
    }
    Ok(())
}

/// Returns whether a straight path touches a zone, grown by a margin (slab method).
fn crosses(zone: &KeepOut, margin_m: f64, from: &Point3<f64>, to: &Point3<f64>) -> bool {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        let (least, most) = (zone.min_m[axis] - margin_m, zone.max_m[axis] + margin_m);
        let way = to[axis] - from[axis];
        if way.abs() < 1e-12 {
            if from[axis] < least || from[axis] > most {
                return false;
            }
            continue;
        }
        let (a, b) = ((least - from[axis]) / way, (most - from[axis]) / way);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    enter <= leave
}

/// Returns whether a path starts beside a zone, within its margin, and leaves the margin without coming nearer.
fn leaves(zone: &KeepOut, margin_m: f64, [from, to]: &[Point3<f64>; 2]) -> bool {
    let nearest = Point3::from(Vector3::from_fn(|axis, _| {
        from[axis].clamp(zone.min_m[axis], zone.max_m[axis])
    }));
    let away = from - nearest;
    // The distance to a box is convex along a line: if it does not decrease at first, it never does.
    away.norm() > 0.0 && away.dot(&(to - from)) >= 0.0 && !crosses(zone, margin_m, to, to)
}

fn place(point: &Point3<f64>) -> String {
    format!("({:.3}, {:.3}, {:.3})", point.x, point.y, point.z)
}

/// Checks the arm against its limits while it moves.
struct LimitMonitor<'l> {
    workspace: &'l Workspace,
    /// Recent times and poses of the tool.
    recent: VecDeque<(f64, Isometry3<f64>)>,
}

impl LimitMonitor<'_> {
    fn check(&mut self, state: &ArmState) -> Result<(), Halt> {
        let out = |why: String| Halt::Stop(ArmError::OutOfLimits(why));
        let at = Point3::from(state.tool.translation.vector);
        inside(self.workspace, &at, 0.0).map_err(|why| out(format!("the tool is {why}")))?;
        for zone in &self.workspace.keep_out {
            if crosses(zone, 0.0, &at, &at) {
                return Err(out(format!(
                    "the tool is at {}, within `{}`, which is kept out",
                    place(&at),
                    zone.name
                )));
            }
        }
        if self
            .recent
            .back()
            .is_none_or(|(at_s, _)| state.at_s > *at_s)
        {
            self.recent.push_back((state.at_s, state.tool));
        }
        while self.recent.len() > 2
            && self
                .recent
                .get(1)
                .is_some_and(|(at_s, _)| state.at_s - at_s >= SPEED_OVER_S)
        {
            self.recent.pop_front();
        }
        let Some((first_s, first)) = self.recent.front() else {
            return Ok(());
        };
        let (took_s, way_m) = (
            state.at_s - first_s,
            Deviation::between(first, &state.tool).position_m,
        );
        if took_s >= SPEED_OVER_S && way_m / took_s > SPEED_SLACK * self.workspace.max_speed_m_s {
            return Err(out(format!(
                "the tool moves at {:.2} m/s, and `{}` m/s are allowed",
                way_m / took_s,
                self.workspace.max_speed_m_s
            )));
        }
        Ok(())
    }
}

impl<A: Arm> Arm for Limited<A> {
    fn name(&self) -> String {
        self.arm.name()
    }

    fn now_s(&self) -> f64 {
        self.arm.now_s()
    }

    fn wait(&mut self, seconds: f64) {
        self.arm.wait(seconds);
    }

    fn state(&mut self) -> Result<ArmState, ArmError> {
        self.arm.state()
    }

    fn move_tool(
        &mut self,
        to: &Isometry3<f64>,
        speed_m_s: f64,
        watch: &mut Watch<'_>,
    ) -> Result<ArmState, ArmError> {
        let mut corrections = 0;
        loop {
            let from = self.arm.state()?;
            self.check(&from.tool, to, speed_m_s)?;
            let mut monitor = LimitMonitor {
                workspace: &self.workspace,
                recent: VecDeque::new(),
            };
            let moved = self.arm.move_tool(to, speed_m_s, &mut |state| {
                monitor.check(state)?;
                watch(state)
            });
            match moved {
                Err(ArmError::Short { .. }) if corrections < self.corrections => corrections += 1,
                moved => return moved,
            }
        }
    }

    fn move_fingers(
        &mut self,
        opening: Opening,
        watch: &mut Watch<'_>,
    ) -> Result<HandContents, ArmError> {
        let mut monitor = LimitMonitor {
            workspace: &self.workspace,
            recent: VecDeque::new(),
        };
        let begun_at = self.arm.state()?.tool;
        self.arm.move_fingers(opening, &mut |state| {
            monitor.check(state)?;
            let carried_m = Deviation::between(&begun_at, &state.tool).position_m;
            // NaN must stop the arm too.
            let stays = carried_m <= FINGERS_STAY_M;
            if !stays {
                return Err(Halt::Stop(ArmError::OutOfLimits(format!(
                    "the tool moved by {:.0} mm while only the fingers should",
                    carried_m * 1000.0
                ))));
            }
            watch(state)
        })
    }

    fn stop(&mut self) -> Result<(), ArmError> {
        self.arm.stop()
    }

    fn enable(&mut self) -> Result<(), ArmError> {
        self.arm.enable()
    }
}
