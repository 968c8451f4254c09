//! The one check that every motion passes, and the type of a motion that passed it.
//!
//! In: the settings' limits, the table's surface, the arm's shapes, and motions: planned ones, those that are about to
//! be sent, corrections, and trajectories point by point. Out: [`Checked`], or why a motion is not allowed. The tool
//! stays in its box. No part of hand and links goes below the table, into a keep-out zone, or into another part.
//!
//! Where the arm's node finds the joint angles itself, the path of the links is the one that this crate's kinematics
//! would take; the measured angles are checked while it moves.

use super::driver::{ArmState, Deviation};
use super::kinematics::chain::Chain;
use super::kinematics::shape::Capsule;
use super::kinematics::tool_down::tool_down;
use super::port::Waypoint;
use super::settings::Settings;
use super::timing::JointLimits;
use crate::calibration::Calibration;
use nalgebra::{Isometry3, Point3, Vector3};

/// The longest step between two checked points of a path, metres.
pub const STEP_M: f64 = 0.01;

/// Largest tilt of the hand from straight down, and largest rotation in one motion, radians. Every goal points down.
const MAX_TILT_RAD: f64 = 0.2;

/// Resolution of a measured position, metres.
const READING_M: f64 = 0.001;

/// Slack of comparisons, metres: the inverse kinematics ends this near to its target.
const EXACT_M: f64 = 1e-5;

/// How far apart parts of the arm must be along a path, metres: between two points of it they come nearer.
const APART_M: f64 = STEP_M / 2.0;

/// How far a tool's pose may be from that of the joint angles, metres and radians: they are read one after the other.
const ASIDE_M: f64 = 0.02;
const ASIDE_RAD: f64 = 0.05;

/// How far an arm may be from where a motion begins, metres, and radians of a joint and of the tool: its readings differ by less
/// while it rests.
const BEGIN_M: f64 = 0.002;
const BEGIN_RAD: f64 = 0.002;
const BEGIN_TOOL_RAD: f64 = 0.02;

/// Something that passed the checks of a [`Guard`]. Motions of the tool are made of nothing else, and only this module
/// makes one.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked<T>(T);

impl<T> Checked<T> {
    /// Returns what was checked.
    pub fn get(&self) -> &T {
        &self.0
    }
}

impl Checked<Vec<Waypoint>> {
    /// A trajectory that holds the joints where they were measured.
    ///
    /// - `at_s`: the times of its points, seconds.
    pub(crate) fn hold(state: &ArmState, at_s: &[f64]) -> Checked<Vec<Waypoint>> {
        let hold = |at_s: &f64| Waypoint::at_rest(state.joints_rad.clone(), *at_s);
        Checked(at_s.iter().map(hold).collect())
    }
}

/// A straight motion of the tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Where the tool was when it was checked, `base_from_tool`: it holds from there alone.
    pub from: Isometry3<f64>,
    /// Where it ends, `base_from_tool`.
    pub to: Isometry3<f64>,
    /// Speed of the tool, m/s.
    pub speed_m_s: f64,
    /// What the joints do, from rest to rest, at most [`STEP_M`] apart: a single point if nothing moves.
    pub waypoints: Vec<Waypoint>,
}

impl Motion {
    /// Returns how long it takes, seconds.
    pub fn takes_s(&self) -> f64 {
        self.waypoints.last().map_or(0.0, |last| last.at_s)
    }

    /// Returns whether the arm is where the motion begins, so that it can be sent as it was checked.
    pub fn begins_at(&self, state: &ArmState) -> bool {
        let moved = Deviation::between(&self.from, &state.tool);
        let first = self.waypoints.first();
        let begins_rad = first.map_or(&[][..], |first| &first.joints_rad);
        let mut joints = begins_rad.iter().zip(&state.joints_rad);
        moved.position_m <= BEGIN_M
            && moved.angle_rad <= BEGIN_TOOL_RAD
            && begins_rad.len() == state.joints_rad.len()
            && joints.all(|(begins, is)| (begins - is).abs() < BEGIN_RAD)
    }
}

impl Checked<Motion> {
    /// Returns what the joints do as a goal for a controller of joint trajectories.
    pub fn trajectory(&self) -> Checked<Vec<Waypoint>> {
        Checked(self.0.waypoints.clone())
    }

    /// Returns its end as a goal for a node that finds the joint angles itself.
    pub fn pose(&self) -> Checked<Isometry3<f64>> {
        Checked(self.0.to)
    }
}

/// The tool's height when the closed fingertips touch the table, at each place: a plane in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// `z = height[0] + height[1] x + height[2] y`, metres.
    height: [f64; 3],
}

impl Surface {
    /// The plane that was touched for a calibration.
    pub fn of(calibration: &Calibration) -> Surface {
        Surface::tilted(calibration.fit.height)
    }

    /// A level plane through the settings' table.
    pub fn level(settings: &Settings) -> Surface {
        Surface::tilted([settings.table.center_m[2], 0.0, 0.0])
    }

    /// A plane `z = height[0] + height[1] x + height[2] y`, metres, base frame.
    pub fn tilted(height: [f64; 3]) -> Surface {
        Surface { height }
    }

    /// Returns its height at a place, metres, base frame.
    pub fn height_m(&self, x: f64, y: f64) -> f64 {
        self.height[0] + self.height[1] * x + self.height[2] * y
    }

    /// Returns its normal, which points up.
    fn normal(&self) -> Vector3<f64> {
        Vector3::new(-self.height[1], -self.height[2], 1.0).normalize()
    }

    /// Returns the distance of a point above it, metres; negative below.
    fn distance_m(&self, point: &Point3<f64>) -> f64 {
        (point.z - self.height_m(point.x, point.y)) * self.normal().z
    }
}

/// Checks motions of one arm over one table.
#[derive(Clone, Debug)]
pub struct Guard {
    settings: Settings,
    surface: Surface,
    /// How far below the tool's place the straight hand reaches, along the table's normal, metres.
    touch_m: f64,
    /// How far below the table a measured hand may seem to be, metres.
    slack_m: f64,
    /// Pairs of shapes that must not touch, as indices.
    apart: Vec<[usize; 2]>,
    /// Pairs of parts that touch in the rest pose, as their shapes are wider than they are, and that are left out.
    touching: Vec<[String; 2]>,
}

impl Guard {
    /// Guards the arm of the settings over a table.
    pub fn new(settings: &Settings, surface: Surface) -> Guard {
        let turn_rad = settings.motion.hand_turn_deg.to_radians();
        let down = tool_down(&Point3::origin(), turn_rad);
        let (shapes, hand) = (settings.chain().shapes(), settings.chain().joints().len());
        let hand = shapes.iter().filter(|shape| shape.link == hand);
        let ends = hand.flat_map(|it| it.ends.map(|end| (it.radius_m, down * end)));
        let normal = surface.normal();
        let below_m = ends
            .clone()
            .map(|(radius_m, end)| radius_m - end.coords.dot(&normal));
        let aside_m = ends.map(|(_, end)| end.x.hypot(end.y)).fold(0.0, f64::max);
        let tolerance = &settings.tolerance;
        let mut guard = Guard {
            settings: settings.clone(),
            surface,
            touch_m: below_m.fold(0.0, f64::max),
            // A hand that is tilted by its tolerance is lower on one side.
            slack_m: tolerance.position_m
                + READING_M
                + aside_m * tolerance.angle_deg.to_radians().sin(),
            apart: Vec::new(),
            touching: Vec::new(),
        };
        guard.pair_shapes();
        guard
    }

    /// Finds the pairs of shapes that must not touch: those of links that do not hang from each other, and do not touch
    /// while the arm rests. A capsule around a mesh is too wide to tell: it would forbid an arm to fold its elbow.
    fn pair_shapes(&mut self) {
        let (settings, chain) = (&self.settings, self.settings.chain());
        // An arm that cannot be at rest moves nowhere, and is refused by that.
        let rest = ArmState::hand_down(settings, &settings.workspace.rest_m.into());
        let placed = rest.and_then(|rest| chain.placed_shapes(&rest.joints_rad));
        let placed = placed.unwrap_or_default();
        // The hand is fixed to the last joint's link.
        let link = |shape: &Capsule| shape.link.min(chain.joints().len() - 1);
        let pairs = (0..placed.len()).flat_map(|other| (0..other).map(move |one| [one, other]));
        let is_told = |pair: &[usize; 2]| {
            let [one, other] = pair.map(|index| &placed[index]);
            let is_around_mesh = one.is_around_mesh || other.is_around_mesh;
            !is_around_mesh && link(one).abs_diff(link(other)) > 1
        };
        let are_apart = |[one, other]: &[usize; 2]| placed[*one].gap_m(&placed[*other]) > APART_M;
        let (apart, touching): (Vec<_>, Vec<_>) = pairs.filter(is_told).partition(are_apart);
        let touching = touching
            .iter()
            .map(|pair| pair.map(|index| self.part(&placed[index])));
        let mut touching: Vec<_> = touching.collect();
        touching.sort();
        touching.dedup();
        (self.apart, self.touching) = (apart, touching);
    }

    /// Guards the arm of the settings over a level table, as if no calibration had measured a tilt.
    pub fn level(settings: &Settings) -> Guard {
        Guard::new(settings, Surface::level(settings))
    }

    /// Returns the arm.
    pub fn chain(&self) -> &Chain {
        self.settings.chain()
    }

    /// Returns the table's surface.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Returns the pairs of parts that touch in the rest pose, so that they are not kept apart.
    pub fn touching(&self) -> &[[String; 2]] {
        &self.touching
    }

    /// Returns the highest speed of the tool, m/s.
    pub fn max_speed_m_s(&self) -> f64 {
        self.settings.workspace.max_speed_m_s
    }

    /// Checks a straight motion of the tool from where the arm is; the error says why it is not allowed.
    ///
    /// - `from`: the arm's state.
    /// - `to`: `base_from_tool`.
    pub fn motion(
        &self,
        from: &ArmState,
        to: &Isometry3<f64>,
        speed_m_s: f64,
    ) -> Result<Checked<Motion>, String> {
        self.ends(&from.tool, to, speed_m_s)?;
        let limits = JointLimits::of(&self.settings, self.chain());
        let begin = self.chain().base_from_tool(&from.joints_rad)?;
        let aside = Deviation::between(&begin, &from.tool);
        // NaN must be refused.
        let do_fit = aside.position_m <= ASIDE_M && aside.angle_rad <= ASIDE_RAD;
        if !do_fit {
            return Err(format!(
                "the arm reports joints that bring its tool {aside} away from where it reports the tool: the readings do not \
                 fit, or `model` names another arm"
            ));
        }
        let points = self.chain().straight(&from.joints_rad, to, STEP_M);
        let points = points.map_err(|why| format!("the arm cannot follow: {why}"))?;
        let way_m = (to.translation.vector - begin.translation.vector).norm();
        let waypoints = limits.time(&points, way_m, speed_m_s)?;
        let mut path = Vec::new();
        for point in &waypoints {
            let tool = self.chain().base_from_tool(&point.joints_rad)?;
            path.push(self.gaps(&self.chain().placed_shapes(&point.joints_rad)?));
            self.inside(&Point3::from(tool.translation.vector), 0.0)
                .map_err(|why| format!("the tool would be {why}"))?;
        }
        keeps_clear(&path)?;
        Ok(Checked(Motion {
            from: from.tool,
            to: *to,
            speed_m_s,
            waypoints,
        }))
    }

    /// Checks a goal of the tool, wherever the tool is now; the error says why it is not allowed.
    pub fn goal(&self, point: &Point3<f64>) -> Result<(), String> {
        self.inside(point, self.settings.tolerance.position_m)
            .map_err(|why| format!("the tool would be {why}"))
    }

    /// Checks the state of an arm that moves; the error says which limit it violates.
    pub fn measured(&self, state: &ArmState) -> Result<(), String> {
        let at = Point3::from(state.tool.translation.vector);
        self.inside(&at, 0.0)
            .map_err(|why| format!("the tool is {why}"))?;
        let shapes = self.chain().placed_shapes(&state.joints_rad)?;
        for gap in self.gaps(&shapes) {
            // NaN must stop the arm too.
            let is_kept = gap.gap_m >= gap.worst_m;
            if !is_kept {
                return Err(format!(
                    "{}, with the tool at {}",
                    gap.text("is"),
                    place(&at)
                ));
            }
        }
        Ok(())
    }

    /// Checks the ends of a motion: numbers, speed, length, rotation, and the tool's box.
    fn ends(
        &self,
        from: &Isometry3<f64>,
        to: &Isometry3<f64>,
        speed_m_s: f64,
    ) -> Result<(), String> {
        let ends = [from, to].map(|pose| Point3::from(pose.translation.vector));
        let mut numbers = ends.iter().flat_map(|end| end.iter());
        if !numbers.all(|value| value.is_finite()) {
            return Err("a motion's end is no place".to_owned());
        }
        let most_m_s = self.settings.workspace.max_speed_m_s;
        if !(speed_m_s > 0.0 && speed_m_s <= most_m_s) {
            return Err(format!(
                "a speed of `{speed_m_s}` m/s is not above 0 and at most `{most_m_s}` m/s"
            ));
        }
        // Rotation speed is not limited, and every motion here keeps the rotation. NaN must fail these checks.
        let turn_rad = from.rotation.angle_to(&to.rotation);
        let keeps = turn_rad <= MAX_TILT_RAD;
        if !keeps {
            return Err(format!(
                "the hand would turn by {:.0} degrees; the limit is {:.0}; move it by hand until it points straight \
                 down with the rotation `motion.hand_turn_deg`",
                turn_rad.to_degrees(),
                MAX_TILT_RAD.to_degrees()
            ));
        }
        let tilt_rad = (to.rotation * Vector3::z()).angle(&-Vector3::z());
        let is_upright = tilt_rad <= MAX_TILT_RAD;
        if !is_upright || !to.rotation.coords.iter().all(|value| value.is_finite()) {
            return Err(format!(
                "the hand would be tilted by {:.0} degrees, and at most {:.0} are allowed",
                tilt_rad.to_degrees(),
                MAX_TILT_RAD.to_degrees()
            ));
        }
        self.inside(&ends[0], 0.0)
            .map_err(|why| format!("the tool is {why}; bring it back by hand"))?;
        self.goal(&ends[1])
    }

    /// Checks that a point is inside the box, shrunk by a margin; the error names the violated axis. The box's floor
    /// follows the table's tilt.
    fn inside(&self, point: &Point3<f64>, margin_m: f64) -> Result<(), String> {
        let tilt_m = self.surface.height_m(point.x, point.y) - self.settings.table.center_m[2];
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let workspace = &self.settings.workspace;
            let tilt_m = if axis == 2 { tilt_m } else { 0.0 };
            let (least, most) = (workspace.min_m[axis] + tilt_m, workspace.max_m[axis]);
            // NaN must count as outside.
            let (low, high) = (least + margin_m - EXACT_M, most - margin_m + EXACT_M);
            if !(point[axis] >= low && point[axis] <= high) {
                return Err(format!(
                    "at {}, outside of the workspace, whose {name} goes from {least:.3} to {most:.3} m with a margin of \
                     {:.0} mm",
                    place(point),
                    margin_m * 1000.0
                ));
            }
        }
        Ok(())
    }

    /// Returns the least gap between shapes and each obstacle: the table, other parts of the arm, and every zone.
    fn gaps(&self, shapes: &[Capsule]) -> Vec<Gap> {
        let mm = |metres: f64| metres.max(0.0) * 1000.0;
        let table = nearest(
            shapes
                .iter()
                .map(|shape| (self.above_table_m(shape), shape)),
        );
        let table = table.map(|(gap_m, shape)| Gap {
            gap_m,
            least_m: -EXACT_M,
            worst_m: -self.slack_m,
            part: self.part(shape),
            place: format!("{:.0} mm below the table", mm(-gap_m)),
        });
        let pairs = self.apart.iter().map(|pair| {
            let [one, other] = pair.map(|index| &shapes[index]);
            (one.gap_m(other), [one, other])
        });
        let pair = nearest(pairs).map(|(gap_m, [one, other])| Gap {
            gap_m,
            least_m: APART_M,
            worst_m: 0.0,
            part: self.part(one),
            place: format!("within {:.0} mm of {}", mm(gap_m), self.part(other)),
        });
        // Between two points of a path a shape comes nearer by at most half a step.
        let least_m = self.settings.tolerance.position_m + STEP_M / 2.0;
        let zones = self.settings.workspace.keep_out.iter().filter_map(|zone| {
            let gap_m = |shape: &Capsule| shape.gap_to_box_m(&zone.min_m, &zone.max_m);
            let (gap_m, shape) = nearest(shapes.iter().map(|shape| (gap_m(shape), shape)))?;
            let (name, at_mm, least_mm) = (&zone.name, mm(gap_m), mm(least_m));
            Some(Gap {
                gap_m,
                least_m,
                worst_m: 0.0,
                part: self.part(shape),
                place: format!(
                    "within {at_mm:.0} mm of `{name}`, which is kept out by {least_mm:.0} mm"
                ),
            })
        });
        table.into_iter().chain(pair).chain(zones).collect()
    }

    /// Returns the height of a shape above the table, metres.
    ///
    /// The settings state the table by the tool's place when the fingertips touch it, so the hand's shapes end where
    /// that is. Links are held to the tool's place itself, which is higher.
    fn above_table_m(&self, shape: &Capsule) -> f64 {
        // The table's plane, which has no edge, would pass through the foot.
        if shape.link == 0 && self.chain().is_upright() {
            return f64::INFINITY;
        }
        let ends = shape.ends.map(|end| self.surface.distance_m(&end));
        let touch_m = if shape.link == self.chain().joints().len() {
            self.touch_m
        } else {
            0.0
        };
        ends[0].min(ends[1]) - shape.radius_m + touch_m
    }

    /// Names the part of the arm that a shape contains.
    fn part(&self, shape: &Capsule) -> String {
        if shape.link == self.chain().joints().len() {
            "the hand".to_owned()
        } else {
            format!("the arm behind joint {}", shape.link + 1)
        }
    }
}

/// Returns what is nearest, with its distance.
fn nearest<T>(gaps: impl Iterator<Item = (f64, T)>) -> Option<(f64, T)> {
    gaps.min_by(|one, other| one.0.total_cmp(&other.0))
}

/// The distance of the nearest part of the arm from an obstacle.
struct Gap {
    gap_m: f64,
    /// The gap with which a path is clear of it, metres.
    least_m: f64,
    /// The gap with which a path may begin, and that is kept while the arm moves, metres.
    worst_m: f64,
    part: String,
    /// Where the part is.
    place: String,
}

impl Gap {
    fn is_clear(&self) -> bool {
        self.gap_m >= self.least_m
    }

    /// Says where the part is, or would be.
    fn text(&self, is: &str) -> String {
        format!("{} {is} {}", self.part, self.place)
    }
}

/// Checks that a path keeps clear of each obstacle; the error says of which it does not. An arm that begins too near to
/// one may go away from it, and must end clear of it.
///
/// - `path`: the gaps at each of its points, to the obstacles in one order.
fn keeps_clear(path: &[Vec<Gap>]) -> Result<(), String> {
    let n_obstacles = path.first().map_or(0, Vec::len);
    for obstacle in 0..n_obstacles {
        let mut before: Option<&Gap> = None;
        for gap in path.iter().map(|gaps| &gaps[obstacle]) {
            // NaN must count as too near.
            let may_leave = match before {
                None => gap.gap_m >= gap.worst_m,
                Some(before) => !before.is_clear() && gap.gap_m >= before.gap_m - EXACT_M,
            };
            if !gap.is_clear() && !may_leave {
                return Err(gap.text("would be"));
            }
            before = Some(gap);
        }
        if let Some(last) = before.filter(|last| !last.is_clear()) {
            return Err(last.text("would be"));
        }
    }
    Ok(())
}

fn place(point: &Point3<f64>) -> String {
    format!("({:.3}, {:.3}, {:.3})", point.x, point.y, point.z)
}
