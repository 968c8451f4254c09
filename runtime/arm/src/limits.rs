//! The one place that says where an arm may be and how fast: around any arm.
//!
//! In: motions. Out: the same motions, or a refusal before anything moves; and a stop where the arm leaves its limits on
//! the way. The limits are about the tool, not about elbow and cables: a person looks after those.

use super::driver::{Arm, ArmError, ArmState, Between, Halt, Off, Opening, Watch};
use super::settings::{KeepOut, Workspace};
use nalgebra::{Isometry3, Point3, Vector3};
use std::collections::VecDeque;

/// How much faster than allowed a measured speed may be before the arm is stopped: positions are measured to 1 mm.
const SPEED_SLACK: f64 = 1.5;

/// How far the tool may move while only the fingers should, metres: as near as the arm's node itself holds a place.
const FINGERS_STAY_M: f64 = 0.010;

/// Over how long speed is measured, seconds.
const SPEED_OVER_S: f64 = 0.4;

/// The most that a hand may be tilted from straight down, and turned in one motion, radians: it is sent straight down alone.
const MAX_TILT_RAD: f64 = 0.2;

/// An arm that stays within limits.
pub struct Limited<A: Arm> {
    arm: A,
    workspace: Workspace,
    /// How far from the limits a goal stays, metres: as far as the arm may miss it.
    margin_m: f64,
}

impl<A: Arm> Limited<A> {
    /// Puts limits around an arm whose tool comes to within `margin_m` of where it is sent.
    pub fn new(arm: A, workspace: Workspace, margin_m: f64) -> Limited<A> {
        Limited {
            arm,
            workspace,
            margin_m,
        }
    }

    /// Returns the arm within.
    pub fn arm(&mut self) -> &mut A {
        &mut self.arm
    }

    /// Says why a motion is not allowed, or that it is.
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

/// Says why a straight motion of the tool is not allowed, or that it is.
///
/// - `margin_m`: how far from the limits its goal stays.
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
    // Nothing says how fast a hand turns, and every motion here keeps it as it is.
    let turn_rad = from.rotation.angle_to(&to.rotation);
    let keeps = turn_rad <= MAX_TILT_RAD;
    if !keeps {
        return Err(format!(
            "the hand would be turned by {:.0} degrees, and at most {:.0} are allowed; bring it by hand to where it points straight down, turned as `motion.hand_turn_deg` says",
            turn_rad.to_degrees(),
            MAX_TILT_RAD.to_degrees()
        ));
    }
    let tilt_rad = (to.rotation * Vector3::z()).angle(&-Vector3::z());
    // Written so that what is no number is too much.
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

/// Says why the tool must not be sent to a point, wherever it is now, or that it may.
pub fn check_goal(workspace: &Workspace, margin_m: f64, point: &Point3<f64>) -> Result<(), String> {
    inside(workspace, point, margin_m).map_err(|why| format!("the tool would be {why}"))
}

/// Says on which side a point is outside of the box, drawn in by a margin.
fn inside(workspace: &Workspace, point: &Point3<f64>, margin_m: f64) -> Result<(), String> {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let (least, most) = (
            workspace.min_m[axis] + margin_m,
            workspace.max_m[axis] - margin_m,
        );
        // Written so that what is no number is outside.
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

/// Tells whether a straight way touches a zone, grown by a margin (slab method).
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

/// Tells whether a way begins beside a zone, within its margin, and leads out of the margin without coming nearer.
fn leaves(zone: &KeepOut, margin_m: f64, [from, to]: &[Point3<f64>; 2]) -> bool {
    let nearest = Point3::from(Vector3::from_fn(|axis, _| {
        from[axis].clamp(zone.min_m[axis], zone.max_m[axis])
    }));
    let away = from - nearest;
    // The distance to a box is convex along a line: where it does not fall at first, it never does.
    away.norm() > 0.0 && away.dot(&(to - from)) >= 0.0 && !crosses(zone, margin_m, to, to)
}

fn place(point: &Point3<f64>) -> String {
    format!("({:.3}, {:.3}, {:.3})", point.x, point.y, point.z)
}

/// Looks at an arm while it moves.
struct Lookout<'l> {
    workspace: &'l Workspace,
    /// When and where the tool was lately.
    lately: VecDeque<(f64, Isometry3<f64>)>,
}

impl Lookout<'_> {
    fn look(&mut self, state: &ArmState) -> Result<(), Halt> {
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
            .lately
            .back()
            .is_none_or(|(at_s, _)| state.at_s > *at_s)
        {
            self.lately.push_back((state.at_s, state.tool));
        }
        while self.lately.len() > 2
            && self
                .lately
                .get(1)
                .is_some_and(|(at_s, _)| state.at_s - at_s >= SPEED_OVER_S)
        {
            self.lately.pop_front();
        }
        let Some((first_s, first)) = self.lately.front() else {
            return Ok(());
        };
        let (took_s, way_m) = (
            state.at_s - first_s,
            Off::between(first, &state.tool).position_m,
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
        let from = self.arm.state()?;
        self.check(&from.tool, to, speed_m_s)?;
        let mut lookout = Lookout {
            workspace: &self.workspace,
            lately: VecDeque::new(),
        };
        self.arm.move_tool(to, speed_m_s, &mut |state| {
            lookout.look(state)?;
            watch(state)
        })
    }

    fn move_fingers(
        &mut self,
        opening: Opening,
        watch: &mut Watch<'_>,
    ) -> Result<Between, ArmError> {
        let mut lookout = Lookout {
            workspace: &self.workspace,
            lately: VecDeque::new(),
        };
        let begun_at = self.arm.state()?.tool;
        self.arm.move_fingers(opening, &mut |state| {
            lookout.look(state)?;
            let carried_m = Off::between(&begun_at, &state.tool).position_m;
            // Written so that what is no number stops it too.
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
