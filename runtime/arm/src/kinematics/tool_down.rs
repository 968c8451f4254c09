//! All postures in which the hand points straight down, at a given distance and height.
//!
//! In: a chain; the tool's distance from the first joint's axis, and its height. Out: joint angles within the limits.
//! The list is complete but for one family, so an empty list means out of reach. With the hand down, the last joint's
//! axis is vertical: that joint only turns the hand. The fifth joint is scanned in steps. Its angle fixes the direction
//! of the forearm, and with that the position of the elbow. The elbow can be there if its distance from the shoulder
//! equals the length of the upper arm: a root in one unknown.
//!
//! One family is omitted: at the two angles of the fifth joint at which forearm and hand are parallel, both may be
//! vertical with any angle of the fourth. It adds only positions less than 0.16 m from the axis, from which most paths
//! lead nowhere.
//!
//! This relies on what all supported arms share: the first axis is the base's vertical, the second and the third are
//! horizontal and parallel, and the fourth lies in the plane in which those two move the arm. A test checks each model.

use super::chain::{Angles, Chain, about_z, nearest_turn};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector2, Vector3};
use std::f64::consts::{PI, TAU};

/// Number of steps of the scan of the fifth joint. Two roots within a step of 2 degrees are missed; that happens where
/// they meet, at the edge of the reachable range, and moves the edge by less than 0.1 mm.
const STEPS: usize = 180;

/// Below this length the horizontal part of the fourth axis has no direction.
const LEVEL: f64 = 1e-9;

/// Bisections of a step that contains a root; leaves 2 degrees / 2^24.
const HALVINGS: usize = 24;

/// Returns the pose of a hand that points straight down.
///
/// - `point`: position of its tool, base frame, metres.
/// - `turn_rad`: its rotation about the base's vertical; at 0 the tool's x axis lies along the base's.
pub fn tool_down(point: &Point3<f64>, turn_rad: f64) -> Isometry3<f64> {
    let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    Isometry3::from_parts(Translation3::from(point.coords), about_z(turn_rad) * down)
}

/// An arm whose hand points down.
#[derive(Clone, Debug)]
pub(super) struct ToolDown {
    chain: Chain,
    plane: Plane,
    steps: [Vec<Side>; 2],
}

/// The plane in which the second and the third joint move the arm, with the first at zero. Its axes are `u`,
/// horizontal, and the vertical; angles in it grow from the vertical towards `u`, and with the second joint.
#[derive(Clone, Debug)]
struct Plane {
    u: Vector3<f64>,
    normal: Vector3<f64>,
    /// Position of the shoulder, along `u` and up, metres.
    shoulder: Vector2<f64>,
    /// Distance of the forearm's axis from the first axis, along `normal`, metres.
    beside_m: f64,
    upper: Link,
    fore: Link,
    /// Angle of the forearm's direction relative to the fourth axis.
    fore_from_axis_rad: f64,
    /// 1 if the third axis points the same way as the second, otherwise -1; likewise the first axis and the base's
    /// vertical.
    third: f64,
    first: f64,
}

#[derive(Clone, Debug)]
struct Link {
    length_m: f64,
    /// Its direction in the plane with all joints at zero, radians.
    at_zero_rad: f64,
}

/// The arm's geometry at an angle of the fifth joint, with the plane rotated so that the fourth axis lies in it.
#[derive(Clone, Copy, Debug)]
struct Side {
    fifth_rad: f64,
    /// The horizontal direction along `u`, with the hand unrotated.
    heading: Vector2<f64>,
    /// The rotation about the vertical that this takes.
    turned_rad: f64,
    /// Position of the elbow from the tool, along `u` and up, metres.
    elbow: Vector2<f64>,
    /// Position of the tool along the normal, metres.
    tool_beside_m: f64,
    /// The forearm's direction in the plane.
    fore_rad: f64,
}

impl ToolDown {
    pub(super) fn new(chain: &Chain) -> ToolDown {
        let mut downwards = ToolDown {
            chain: chain.clone(),
            plane: Plane::of(chain),
            steps: Default::default(),
        };
        // Half a step in: at 0 the forearm may be vertical, which gives the first side no direction.
        let endless = [0.5, STEPS as f64 + 0.5].map(|step| step * TAU / STEPS as f64);
        let [least, most] = chain.joints()[4].limits_rad.unwrap_or(endless);
        downwards.steps = [1.0, -1.0].map(|sign| {
            let mut heading = downwards.axis(least).xy().normalize() * sign;
            let side = |step: usize| {
                let fifth_rad = least + (most - least) * step as f64 / STEPS as f64;
                let side = downwards.side(fifth_rad, &heading);
                heading = side.heading;
                side
            };
            (0..=STEPS).map(side).collect()
        });
        downwards
    }

    /// Returns all postures within the limits, with the first joint such that the tool lies along the base's x axis and
    /// the last at zero.
    ///
    /// - `distance_m`: distance of the tool from the first joint's axis.
    /// - `height_m`: height of the tool above the base.
    pub(super) fn postures(&self, distance_m: f64, height_m: f64) -> Vec<Angles> {
        let mut postures = Vec::new();
        for steps in &self.steps {
            for ahead in [1.0, -1.0] {
                let left_m =
                    |side: &Side| self.upper_arm_lacks_m(side, ahead * distance_m, height_m);
                for pair in steps.windows(2) {
                    let (Some(one), Some(other)) = (left_m(&pair[0]), left_m(&pair[1])) else {
                        continue;
                    };
                    if (one < 0.0) != (other < 0.0) {
                        let side = self.halve(&pair[0], &pair[1], left_m);
                        postures.extend(self.posture(&side, ahead * distance_m, height_m));
                    }
                }
            }
        }
        postures
    }

    /// Bisects the interval between two neighbours for the angle at which `left` changes its sign.
    fn halve(&self, from: &Side, to: &Side, left: impl Fn(&Side) -> Option<f64>) -> Side {
        let (mut low, mut high) = (*from, *to);
        let below = left(&low).is_some_and(|left| left < 0.0);
        for _ in 0..HALVINGS {
            let middle = self.side((low.fifth_rad + high.fifth_rad) / 2.0, &low.heading);
            if left(&middle).is_some_and(|left| left < 0.0) == below {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Returns the geometry at an angle of the fifth joint, with the fourth axis on the side of the plane closest to
    /// `heading`. This keeps neighbouring angles' sides neighbours when that axis passes the vertical.
    fn side(&self, fifth_rad: f64, heading: &Vector2<f64>) -> Side {
        let fourth = self.fourth(fifth_rad);
        let axis = fourth.rotation * Vector3::z();
        let level = axis.xy();
        let heading = match level.try_normalize(LEVEL) {
            Some(direction) if direction.dot(heading) < 0.0 => -direction,
            Some(direction) => direction,
            None => *heading,
        };
        let turned_rad = azimuth(&self.plane.u.xy()) - azimuth(&heading);
        let plane = &self.plane;
        let wrist = about_z(turned_rad) * fourth.translation.vector;
        let fore_rad = level.dot(&heading).atan2(axis.z) + plane.fore_from_axis_rad;
        Side {
            fifth_rad,
            heading,
            turned_rad,
            elbow: Vector2::new(wrist.dot(&plane.u), wrist.z)
                - along(fore_rad) * plane.fore.length_m,
            tool_beside_m: plane.beside_m - wrist.dot(&plane.normal),
            fore_rad,
        }
    }

    /// Returns the elbow's squared distance from the shoulder minus the upper arm's squared length, square metres;
    /// `None` if the tool would be farther from the plane than its distance from the axis.
    fn upper_arm_lacks_m(&self, side: &Side, distance_m: f64, height_m: f64) -> Option<f64> {
        let elbow = self.elbow(side, distance_m, height_m)?;
        Some((elbow - self.plane.shoulder).norm_squared() - self.plane.upper.length_m.powi(2))
    }

    fn elbow(&self, side: &Side, distance_m: f64, height_m: f64) -> Option<Vector2<f64>> {
        Some(side.elbow + Vector2::new(ahead_m(side, distance_m)?, height_m))
    }

    fn posture(&self, side: &Side, distance_m: f64, height_m: f64) -> Option<Angles> {
        let plane = &self.plane;
        let upper = self.elbow(side, distance_m, height_m)? - plane.shoulder;
        let second = upper.x.atan2(upper.y) - plane.upper.at_zero_rad;
        let third = (side.fore_rad - plane.fore.at_zero_rad - second) * plane.third;
        let tool = plane.u * ahead_m(side, distance_m)? + plane.normal * side.tool_beside_m;
        let turn = -azimuth(&tool.xy());
        let mut angles = [
            turn * plane.first,
            second,
            third,
            0.0,
            side.fifth_rad,
            0.0,
            0.0,
        ];
        for (angle, joint) in angles.iter_mut().zip(self.chain.joints()) {
            if let Some([least, most]) = joint.limits_rad {
                *angle = nearest_turn(*angle, (least + most) / 2.0);
            }
        }
        if self.chain.joint_past_limit(&angles).is_some() {
            return None;
        }
        // The difference between the wrist's current and required rotation is a turn about the fourth axis.
        let links = self.chain.links_at(&angles);
        let (fourth, fifth) = (links[3].rotation, links[4].rotation);
        let needed = about_z(side.turned_rad + turn) * self.fifth().rotation;
        let missing = fourth.inverse() * needed * fifth.inverse() * fourth;
        angles[3] = 2.0 * missing.k.atan2(missing.w);
        Some(angles)
    }

    fn axis(&self, fifth_rad: f64) -> Vector3<f64> {
        self.fourth(fifth_rad).rotation * Vector3::z()
    }

    /// Returns the frame of the fourth joint in the same situation.
    fn fourth(&self, fifth_rad: f64) -> Isometry3<f64> {
        let fourth_from_fifth =
            self.chain.joints()[4].parent_from_joint_at_zero * about_z(fifth_rad);
        self.fifth() * fourth_from_fifth.inverse()
    }

    /// Returns the frame of the fifth joint relative to the tool, with the hand pointing down unrotated and the last
    /// joint at zero.
    fn fifth(&self) -> Isometry3<f64> {
        let sixth = tool_down(&Point3::origin(), 0.0) * self.chain.last_from_tool().inverse();
        sixth * self.chain.joints()[5].parent_from_joint_at_zero.inverse()
    }
}

impl Plane {
    fn of(chain: &Chain) -> Plane {
        let links = chain.links_at(&Angles::default());
        let axis = |index: usize| links[index].rotation * Vector3::z();
        let at = |index: usize| links[index].translation.vector;
        let normal = axis(1);
        let u = normal.cross(&Vector3::z());
        let flat = |vector: Vector3<f64>| Vector2::new(vector.dot(&u), vector.z);
        let link = |vector: Vector2<f64>| Link {
            length_m: vector.norm(),
            at_zero_rad: vector.x.atan2(vector.y),
        };
        let fore = link(flat(at(3) - at(2)));
        Plane {
            u,
            normal,
            shoulder: flat(at(1)),
            beside_m: at(3).dot(&normal),
            upper: link(flat(at(2) - at(1))),
            fore_from_axis_rad: fore.at_zero_rad - link(flat(axis(3))).at_zero_rad,
            fore,
            third: axis(2).dot(&normal).signum(),
            first: chain.first_turns(),
        }
    }
}

/// Returns how far ahead of the first axis the tool is, along `u`; behind it if the distance is negative.
fn ahead_m(side: &Side, distance_m: f64) -> Option<f64> {
    let square = distance_m.powi(2) - side.tool_beside_m.powi(2);
    (square >= 0.0).then(|| square.sqrt() * distance_m.signum())
}

fn along(angle_rad: f64) -> Vector2<f64> {
    Vector2::new(angle_rad.sin(), angle_rad.cos())
}

fn azimuth(vector: &Vector2<f64>) -> f64 {
    vector.y.atan2(vector.x)
}
