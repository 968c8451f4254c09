//! Inverse kinematics: joint angles that move the tool to a pose.
//!
//! In: a tool pose in the base frame, and angles to stay near. Out: angles within the limits, otherwise how close the
//! attempt came and which joint blocked it. Damped least squares runs from those angles, or from each of a fixed list of
//! starts, with the damping of Sugihara ("Solvability-Unconcerned Inverse Kinematics by the Levenberg-Marquardt Method", 2011): it grows
//! with the remaining error, so no step has to be undone. Equal input gives equal angles. Collisions are not checked.

use super::chain::{Angles, Chain, Jacobian, Joint, MAX_JOINTS, METRES_PER_RAD, nearest_turn};
use super::starts;
use nalgebra::{Isometry3, Matrix6, SVector, Translation3, Vector3, Vector6};

/// How far the tool may be from the requested pose, metres.
pub const POSITION_TOLERANCE_M: f64 = 1e-4;

/// How far it may be rotated from the requested pose, radians: 0.01 degrees.
pub const ANGLE_TOLERANCE_RAD: f64 = 0.01 * std::f64::consts::PI / 180.0;

/// The error at which an attempt ends, far below the tolerance: the steps converge quadratically, so this costs only
/// one more.
const FINE: f64 = 1e-9;

/// The most steps of an attempt. Of successful attempts, 99 in 100 take fewer than 25.
const MAX_STEPS: usize = 40;

/// The largest turn of a joint in a step, radians; the linear model is not valid farther away.
const MAX_TURN_RAD: f64 = 0.6;

/// Remaining damping as the error vanishes; keeps the equations solvable in a singular posture.
const LEAST_DAMPING: f64 = 1e-9;

/// Why a pose that holds NaN or infinity is refused.
pub(super) const NO_POSE: &str = "the requested pose holds a number that is not finite";

/// Where an attempt ended.
pub(super) struct Attempt {
    pub(super) angles: Angles,
    distance_m: f64,
    angle_rad: f64,
}

/// A change of the joint angles, radians.
type Step = SVector<f64, MAX_JOINTS>;

impl Attempt {
    pub(super) fn reached(&self) -> bool {
        self.distance_m <= POSITION_TOLERANCE_M && self.angle_rad <= ANGLE_TOLERANCE_RAD
    }
}

impl Chain {
    /// Returns whether a pose is farther from the shoulder than the stretched arm reaches, with all links in one line.
    fn is_beyond(&self, base_from_tool: &Isometry3<f64>) -> bool {
        let links = self.links_at(&Angles::default());
        let links = &links[..self.joints().len()];
        let away_m = |from: &Isometry3<f64>, to: &Isometry3<f64>| {
            (to.translation.vector - from.translation.vector).norm()
        };
        // The point of the first joint's axis that is nearest to the second joint.
        let axis = links[0].rotation * Vector3::z();
        let up_m = (links[1].translation.vector - links[0].translation.vector).dot(&axis);
        let shoulder = Translation3::from(axis * up_m) * links[0];
        let links_m = links[1..].windows(2).map(|pair| away_m(&pair[0], &pair[1]));
        let stretched_m = away_m(&shoulder, &links[1]) + links_m.sum::<f64>();
        let wrist = base_from_tool * self.last_from_tool.inverse();
        away_m(&shoulder, &wrist) > stretched_m + POSITION_TOLERANCE_M
    }

    /// Returns joint angles for a pose close to the tool's pose at the given angles, in one attempt.
    pub(super) fn next(
        &self,
        base_from_tool: &Isometry3<f64>,
        near: &Angles,
    ) -> Result<Angles, String> {
        self.judged(near, &self.approach(base_from_tool, near))
    }

    /// Returns the angles of an attempt that reached its pose, on the turns nearest to others.
    fn judged(&self, near: &Angles, best: &Attempt) -> Result<Angles, String> {
        if best.reached() {
            return Ok(self.turns_nearest(&best.angles, near));
        }
        let is_at_limit = |(joint, angle): (&Joint, &f64)| {
            joint
                .limits_rad
                .is_some_and(|limits| limits.contains(angle))
        };
        let at_limit = self.joints().iter().zip(&best.angles).position(is_at_limit);
        let at_limit = at_limit.map_or_else(String::new, |index| {
            format!(": joint `{}` is at its limit", index + 1)
        });
        Err(format!(
            "the arm came to `{:.1}` mm and `{:.2}` degrees of the pose{at_limit}",
            best.distance_m * 1e3,
            best.angle_rad.to_degrees()
        ))
    }

    /// Attempts a pose from one start after the other, the arm's home first; nothing for a pose that is too far away.
    pub(super) fn search(&self, base_from_tool: Isometry3<f64>) -> impl Iterator<Item = Attempt> {
        let is_near = !self.is_beyond(&base_from_tool);
        let starts = starts::towards(self, base_from_tool).take_while(move |_| is_near);
        starts.map(move |start| self.approach(&base_from_tool, &start))
    }

    /// Steps from `start` towards a pose until it is reached or the step limit is.
    fn approach(&self, base_from_tool: &Isometry3<f64>, start: &Angles) -> Attempt {
        let mut angles = self.within_limits(start);
        for _ in 0..MAX_STEPS {
            let (tool, jacobian) = self.motion_at(&angles);
            let error = error(base_from_tool, &tool);
            if error.norm() < FINE {
                break;
            }
            let step = self.step(&angles, &jacobian, &error);
            let largest = step.amax();
            let scale = if largest > MAX_TURN_RAD {
                MAX_TURN_RAD / largest
            } else {
                1.0
            };
            for (angle, change) in angles.iter_mut().zip(step.iter()) {
                *angle += scale * change;
            }
            angles = self.within_limits(&angles);
            if largest < FINE {
                break;
            }
        }
        let error = error(base_from_tool, &self.tool_at(&angles));
        Attempt {
            angles,
            distance_m: error.fixed_rows::<3>(0).norm() * METRES_PER_RAD,
            angle_rad: error.fixed_rows::<3>(3).norm(),
        }
    }

    /// Solves for a damped step; leaves out joints that would be pushed past a limit they are at.
    fn step(&self, angles: &Angles, jacobian: &Jacobian, error: &Vector6<f64>) -> Step {
        let mut weighted = *jacobian;
        weighted
            .fixed_rows_mut::<3>(0)
            .scale_mut(1.0 / METRES_PER_RAD);
        let mut step = damped(&weighted, error);
        let mut is_clamped = false;
        for (index, joint) in self.joints().iter().enumerate() {
            let Some([least, most]) = joint.limits_rad else {
                continue;
            };
            if (angles[index] <= least && step[index] < 0.0)
                || (angles[index] >= most && step[index] > 0.0)
            {
                weighted.column_mut(index).fill(0.0);
                is_clamped = true;
            }
        }
        if is_clamped {
            step = damped(&weighted, error);
        }
        step
    }

    /// Returns the angles clamped to the joint limits; extra full turns are removed first.
    fn within_limits(&self, angles: &Angles) -> Angles {
        let mut within = *angles;
        for (angle, joint) in within.iter_mut().zip(self.joints()) {
            if let Some([least, most]) = joint.limits_rad
                && !(least..=most).contains(angle)
            {
                let middle = (least + most) / 2.0;
                *angle = nearest_turn(*angle, middle).clamp(least, most);
            }
        }
        within
    }

    /// Returns the same posture with each joint on the turn closest to `near` that its limits allow.
    pub(super) fn turns_nearest(&self, angles: &Angles, near: &Angles) -> Angles {
        let mut nearest = *angles;
        for ((angle, near), joint) in nearest.iter_mut().zip(near).zip(self.joints()) {
            let turned = nearest_turn(*angle, *near);
            let is_allowed = |[least, most]: [f64; 2]| (least..=most).contains(&turned);
            if joint.limits_rad.is_none_or(is_allowed) {
                *angle = turned;
            }
        }
        nearest
    }
}

/// Returns whether a pose consists of finite numbers.
pub(crate) fn is_pose(pose: &Isometry3<f64>) -> bool {
    let numbers = pose
        .translation
        .vector
        .iter()
        .chain(pose.rotation.coords.iter());
    numbers.copied().all(f64::is_finite)
}

/// Returns the remaining error between the tool and the pose: metres divided by the length weighted like a radian, then
/// radians.
fn error(base_from_tool: &Isometry3<f64>, tool: &Isometry3<f64>) -> Vector6<f64> {
    let moved = (base_from_tool.translation.vector - tool.translation.vector) / METRES_PER_RAD;
    let turned = (base_from_tool.rotation * tool.rotation.inverse()).scaled_axis();
    Vector6::new(moved.x, moved.y, moved.z, turned.x, turned.y, turned.z)
}

/// Returns the shortest damped step, `Jᵀ (J Jᵀ + λ)⁻¹ e`. The six equations stay six with a seventh joint.
fn damped(jacobian: &Jacobian, error: &Vector6<f64>) -> Step {
    let damping = 0.5 * error.norm_squared() + LEAST_DAMPING;
    let normal = jacobian * jacobian.transpose() + Matrix6::identity() * damping;
    // A sum of squares plus a positive diagonal is positive definite.
    let solved = normal.cholesky().map(|factors| factors.solve(error));
    solved.map_or_else(Step::zeros, |solved| jacobian.tr_mul(&solved))
}
