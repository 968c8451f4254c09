//! The one check that every motion passes, and the type of a motion that passed it.
//!
//! In: the settings' limits, the table's surface, the arm's shapes, and motions: planned ones, those that are about to
//! be sent, corrections, and trajectories point by point. Out: [`Checked`], or why a motion is not allowed. The tool
//! stays in its box. No part of hand and links goes below the table, into a keep-out zone, or into another part.
//!
//! Where the arm's node finds the joint angles itself, the path of the links is the one that this crate's kinematics
//! would take; the measured angles are checked while it moves. Without measured angles only the hand is checked.

use super::driver::ArmState;
use super::kinematics::chain::Chain;
use super::kinematics::reach::Reach;
use super::kinematics::shape::PlacedCapsule;
use super::kinematics::tool_down::tool_down;
use super::port::Waypoint;
use super::route::{Act, Route, Segment, SegmentName};
use super::settings::{KeepOut, Settings, Workspace};
use super::timing::JointLimits;
use crate::calibration::Calibration;
use nalgebra::{Isometry3, Point3, Vector3};
use std::collections::BTreeMap;

/// The longest motion at once, metres; a longer one is a mistake in a place.
const MAX_WAY_M: f64 = 0.9;

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

/// How far the joint angles that an arm reports may be from those of its tool's pose, radians.
const ASIDE_RAD: f64 = 0.05;

/// Something that passed the checks of a [`Guard`]. Motions of the tool are made of nothing else, and only this module
/// makes one.
#[derive(Debug, PartialEq)]
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
    /// What the joints do, from rest to rest, at most [`STEP_M`] apart: a single point if nothing moves, none if the
    /// arm does not report its angles.
    pub waypoints: Vec<Waypoint>,
    /// The highest speed of the tool that the joints allow, m/s; infinite if no joint turns or their angles are unknown. How
    /// long they take to speed up does not count.
    pub joints_allow_m_s: f64,
}

impl Motion {
    /// Returns how long it takes, seconds; without joint angles, no less than the speed of the tool allows.
    pub fn takes_s(&self) -> f64 {
        let way_m = (self.to.translation.vector - self.from.translation.vector).norm();
        let timed = self.waypoints.last().map(|last| last.at_s);
        timed.unwrap_or(way_m / self.speed_m_s)
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

/// A segment of a route.
#[derive(Debug)]
pub struct SegmentEnd {
    /// The segment.
    pub segment: Segment,
    /// The arm's state at its end, with the time when it is there; `None` if the segment is not allowed.
    pub state: Option<ArmState>,
    /// [`Motion::joints_allow_m_s`].
    pub joints_allow_m_s: f64,
}

/// A route, as far as it is allowed.
#[derive(Debug)]
pub struct Walk {
    /// Its segments; a refused one is the last.
    pub ends: Vec<SegmentEnd>,
    /// Likewise those after a missed grasp.
    pub home: Vec<SegmentEnd>,
    /// The route, or why its last segment is not allowed.
    pub route: Result<Checked<Route>, String>,
}

impl Walk {
    /// Returns the arm's state after the grasp.
    pub fn grasped(&self) -> Option<&ArmState> {
        let mut ends = self.ends.iter();
        let grasp = ends.find(|end| end.segment.name == SegmentName::Grasp);
        grasp.and_then(|grasp| grasp.state.as_ref())
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
        let at = |x, y| calibration.table_height_m([x, y]);
        let level_m = at(0.0, 0.0);
        Surface::tilted([level_m, at(1.0, 0.0) - level_m, at(0.0, 1.0) - level_m])
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
    chain: Chain,
    joint_limits: JointLimits,
    workspace: Workspace,
    surface: Surface,
    /// Height of the table's middle, metres: the height at which the box is stated.
    middle_m: f64,
    /// Distance that goals keep from box and zones, metres: the position tolerance of the arm.
    margin_m: f64,
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
        let chain = settings.chain().clone();
        let margin_m = settings.tolerance.position_m;
        let down = tool_down(
            &Point3::origin(),
            settings.motion.hand_turn_deg.to_radians(),
        );
        let hand = hand_at(&chain, &down);
        let ends = hand
            .iter()
            .flat_map(|shape| shape.ends.map(|end| (shape.radius_m, end)));
        let normal = surface.normal();
        let below_m = ends
            .clone()
            .map(|(radius_m, end)| radius_m - end.coords.dot(&normal));
        let touch_m = below_m.fold(0.0, f64::max);
        let aside_m = ends.map(|(_, end)| end.x.hypot(end.y)).fold(0.0, f64::max);
        let mut guard = Guard {
            joint_limits: JointLimits::of(settings, &chain),
            workspace: settings.workspace.clone(),
            surface,
            middle_m: settings.table.center_m[2],
            margin_m,
            touch_m,
            // A hand that is tilted by its tolerance is lower on one side.
            slack_m: margin_m
                + READING_M
                + aside_m * settings.tolerance.angle_deg.to_radians().sin(),
            apart: Vec::new(),
            touching: Vec::new(),
            chain,
        };
        guard.pair_shapes(settings);
        guard
    }

    /// Finds the pairs of shapes that must not touch: those of links that do not hang from each other, and do not touch
    /// while the arm rests. A capsule around a mesh is too wide to tell: it would forbid an arm to fold its elbow.
    fn pair_shapes(&mut self, settings: &Settings) {
        let turn_rad = settings.motion.hand_turn_deg.to_radians();
        let rest = Reach::tool_down(&self.chain, turn_rad);
        // An arm that cannot be at rest moves nowhere, and is refused by that.
        let rest_rad = rest.check(&settings.workspace.rest_m.into(), &[]);
        let placed = rest_rad.map(|rest_rad| self.chain.placed_shapes(&rest_rad));
        let Ok(Ok(placed)) = placed else { return };
        // The hand is fixed to the last joint's link.
        let link = |shape: &PlacedCapsule| shape.link.min(self.chain.joints().len() - 1);
        for (second, other) in placed.iter().enumerate() {
            for (first, shape) in placed[..second].iter().enumerate() {
                let is_around_mesh = |at: usize| self.chain.shapes()[at].is_around_mesh;
                if link(shape).abs_diff(link(other)) <= 1
                    || is_around_mesh(first)
                    || is_around_mesh(second)
                {
                    continue;
                }
                if shape.gap_m(other) > APART_M {
                    self.apart.push([first, second]);
                    continue;
                }
                let parts = [shape, other].map(|shape| self.part(shape));
                if !self.touching.contains(&parts) {
                    self.touching.push(parts);
                }
            }
        }
    }

    /// Guards the arm of the settings over a level table, as if no calibration had measured a tilt.
    pub fn level(settings: &Settings) -> Guard {
        Guard::new(settings, Surface::level(settings))
    }

    /// Returns the arm.
    pub fn chain(&self) -> &Chain {
        &self.chain
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
        self.workspace.max_speed_m_s
    }

    /// Checks a straight motion of the tool from where the arm is; the error says why it is not allowed.
    ///
    /// - `from`: the arm's state; without joint angles only the hand is checked along the way.
    /// - `to`: `base_from_tool`.
    pub fn motion(
        &self,
        from: &ArmState,
        to: &Isometry3<f64>,
        speed_m_s: f64,
    ) -> Result<Checked<Motion>, String> {
        self.ends(&from.tool, to, speed_m_s)?;
        let mut path = Path::default();
        let mut waypoints = Vec::new();
        let mut joints_allow_m_s = f64::INFINITY;
        let way_m = (to.translation.vector - from.tool.translation.vector).norm();
        if from.joints_rad.is_empty() {
            let steps = (way_m / STEP_M).ceil().max(1.0) as usize;
            for step in 0..=steps {
                let pose = between(&from.tool, to, step as f64 / steps as f64);
                self.clear(&hand_at(&self.chain, &pose), &mut path)?;
            }
        } else {
            let points = self
                .chain
                .straight(&from.tool, to, &from.joints_rad, STEP_M);
            let mut points = points.map_err(|why| format!("the arm cannot follow: {why}"))?;
            joints_allow_m_s = self.joint_limits.allow_m_s(&points, way_m);
            begin_at(&mut points, &from.joints_rad);
            waypoints = self.joint_limits.time(&points, way_m, speed_m_s)?;
            for point in &waypoints {
                let tool = self.posture(&point.joints_rad, &mut path)?;
                self.inside(&Point3::from(tool.translation.vector), 0.0)
                    .map_err(|why| format!("the tool would be {why}"))?;
            }
        }
        path.end()?;
        Ok(Checked(Motion {
            from: from.tool,
            to: *to,
            speed_m_s,
            waypoints,
            joints_allow_m_s,
        }))
    }

    /// Checks a route, and the way home after a missed grasp; fails with the first segment that is not allowed.
    ///
    /// - `from`: the arm's state before it, with joint angles.
    pub fn route(&self, from: &ArmState, route: Route) -> Walk {
        let (ends, walked) = self.walk(from, &route.segments);
        let mut walk = Walk {
            ends,
            home: Vec::new(),
            route: Err(String::new()),
        };
        let walked = walked.and_then(|()| {
            let Some(grasped) = walk.grasped() else {
                return Ok(());
            };
            let (home, walked) = self.walk(grasped, &route.after_missed_grasp);
            walk.home = home;
            walked
        });
        walk.route = walked.map(|()| Checked(route));
        walk
    }

    /// Checks segments up to the first that is not allowed.
    fn walk(&self, from: &ArmState, segments: &[Segment]) -> (Vec<SegmentEnd>, Result<(), String>) {
        let mut ends = Vec::with_capacity(segments.len());
        let mut at = from.clone();
        for &segment in segments {
            let mut end = SegmentEnd {
                segment,
                state: None,
                joints_allow_m_s: f64::INFINITY,
            };
            if let Act::Move(to) = segment.act {
                match self.motion(&at, &to, segment.speed_m_s) {
                    Ok(Checked(mut motion)) => {
                        at.at_s += motion.takes_s();
                        let last = motion.waypoints.pop();
                        at.joints_rad = last.map(|last| last.joints_rad).unwrap_or_default();
                        at.tool = to;
                        end.joints_allow_m_s = motion.joints_allow_m_s;
                    }
                    Err(why) => {
                        ends.push(end);
                        return (ends, Err(why));
                    }
                }
            }
            end.state = Some(at.clone());
            ends.push(end);
        }
        (ends, Ok(()))
    }

    /// Checks a goal of the tool, wherever the tool is now; the error says why it is not allowed.
    pub fn goal(&self, point: &Point3<f64>) -> Result<(), String> {
        self.inside(point, self.margin_m)
            .map_err(|why| format!("the tool would be {why}"))
    }

    /// Checks the state of an arm that moves; the error says which limit it violates.
    pub fn measured(&self, state: &ArmState) -> Result<(), String> {
        let at = Point3::from(state.tool.translation.vector);
        self.inside(&at, 0.0)
            .map_err(|why| format!("the tool is {why}"))?;
        let shapes = match self.chain.placed_shapes(&state.joints_rad) {
            Ok(shapes) => shapes,
            Err(_) => hand_at(&self.chain, &state.tool),
        };
        if let Some((gap_m, [one, other])) = self.nearest_pair(&shapes)
            && gap_m <= 0.0
        {
            return Err(format!(
                "{} touches {}, with the tool at {}",
                self.part(one),
                self.part(other),
                place(&at)
            ));
        }
        for shape in &shapes {
            let below_m = -self.above_table_m(shape);
            if below_m > self.slack_m {
                return Err(format!(
                    "{} is {:.0} mm below the table",
                    self.part(shape),
                    below_m * 1000.0
                ));
            }
            let zones = self.workspace.keep_out.iter();
            if let Some(zone) = zones.into_iter().find(|zone| zone.gap_m(shape) <= 0.0) {
                return Err(format!(
                    "{}, with the tool at {}, is within `{}`, which is kept out",
                    self.part(shape),
                    place(&at),
                    zone.name
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
        let most_m_s = self.workspace.max_speed_m_s;
        if !(speed_m_s > 0.0 && speed_m_s <= most_m_s) {
            return Err(format!(
                "a speed of `{speed_m_s}` m/s is not above 0 and at most `{most_m_s}` m/s"
            ));
        }
        let way_m = (ends[1] - ends[0]).norm();
        if way_m > MAX_WAY_M {
            return Err(format!(
                "a way of {way_m:.3} m is longer than `{MAX_WAY_M}` m, the longest that is allowed at once"
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
        let tilt_m = self.surface.height_m(point.x, point.y) - self.middle_m;
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let tilt_m = if axis == 2 { tilt_m } else { 0.0 };
            let (least, most) = (
                self.workspace.min_m[axis] + tilt_m,
                self.workspace.max_m[axis],
            );
            let slack_m = if axis == 2 && margin_m > 0.0 {
                EXACT_M
            } else {
                0.0
            };
            // NaN must count as outside.
            let (low, high) = (least + margin_m - slack_m, most - margin_m);
            if !(point[axis] >= low && point[axis] <= high) {
                let margin = if margin_m > 0.0 {
                    format!(" with a margin of {:.0} mm", margin_m * 1000.0)
                } else {
                    String::new()
                };
                return Err(format!(
                    "at {}, outside of the workspace, whose {name} goes from {least:.3} to {most:.3} m{margin}",
                    place(point)
                ));
            }
        }
        Ok(())
    }

    /// Checks joint angles as the next point of a path, and returns where the tool is.
    fn posture(&self, joints_rad: &[f64], path: &mut Path) -> Result<Isometry3<f64>, String> {
        self.clear(&self.chain.placed_shapes(joints_rad)?, path)?;
        self.chain.base_from_tool(joints_rad)
    }

    /// Checks that shapes are above the table, outside of every zone, and apart from each other.
    fn clear(&self, shapes: &[PlacedCapsule], path: &mut Path) -> Result<(), String> {
        let table = nearest(shapes, |shape| self.above_table_m(shape));
        if let Some((gap_m, shape)) = table {
            path.next(0, gap_m, -EXACT_M, -self.slack_m, || {
                let below_mm = -gap_m * 1000.0;
                format!(
                    "{} would be {below_mm:.0} mm below the table",
                    self.part(shape)
                )
            })?;
        }
        if let Some((gap_m, [one, other])) = self.nearest_pair(shapes) {
            path.next(1, gap_m, APART_M, 0.0, || {
                format!(
                    "{} would come within {:.0} mm of {}",
                    self.part(one),
                    gap_m.max(0.0) * 1000.0,
                    self.part(other)
                )
            })?;
        }
        for (index, zone) in self.workspace.keep_out.iter().enumerate() {
            // Between two points of a path a shape comes nearer by at most half a step.
            let least_m = self.margin_m + STEP_M / 2.0;
            let Some((gap_m, shape)) = nearest(shapes, |shape| zone.gap_m(shape)) else {
                continue;
            };
            path.next(index + 2, gap_m, least_m, 0.0, || {
                let mm = |metres: f64| metres.max(0.0) * 1000.0;
                format!(
                    "{} would come within {:.0} mm of `{}`, which is kept out by {:.0} mm",
                    self.part(shape),
                    mm(gap_m),
                    zone.name,
                    mm(least_m)
                )
            })?;
        }
        Ok(())
    }

    /// Returns the two parts of the arm that are nearest to each other, and their distance, metres; `None` for the hand's
    /// shapes alone.
    fn nearest_pair<'s>(
        &self,
        shapes: &'s [PlacedCapsule],
    ) -> Option<(f64, [&'s PlacedCapsule; 2])> {
        let is_whole = shapes.len() == self.chain.shapes().len();
        let pairs = self.apart.iter().filter(|_| is_whole).map(|pair| {
            let pair = pair.map(|index| &shapes[index]);
            (pair[0].gap_m(pair[1]), pair)
        });
        pairs.min_by(|one, other| one.0.total_cmp(&other.0))
    }

    /// Returns the height of a shape above the table, metres.
    ///
    /// The settings state the table by the tool's place when the fingertips touch it, so the hand's shapes end where
    /// that is. Links are held to the tool's place itself, which is higher.
    fn above_table_m(&self, shape: &PlacedCapsule) -> f64 {
        // The table's plane, which has no edge, would pass through the foot.
        if shape.link == 0 && self.chain.is_upright() {
            return f64::INFINITY;
        }
        let ends = shape.ends.map(|end| self.surface.distance_m(&end));
        let touch_m = if shape.link == self.chain.joints().len() {
            self.touch_m
        } else {
            0.0
        };
        ends[0].min(ends[1]) - shape.radius_m + touch_m
    }

    /// Names the part of the arm that a shape contains.
    fn part(&self, shape: &PlacedCapsule) -> String {
        if shape.link == self.chain.joints().len() {
            "the hand".to_owned()
        } else {
            format!("the arm behind joint {}", shape.link + 1)
        }
    }
}

impl KeepOut {
    /// Returns the distance of a shape, metres; 0 or less if they overlap.
    fn gap_m(&self, shape: &PlacedCapsule) -> f64 {
        shape.gap_to_box_m(&self.min_m, &self.max_m)
    }
}

/// Returns the shape that is nearest to an obstacle, and its distance, metres.
fn nearest(
    shapes: &[PlacedCapsule],
    gap_m: impl Fn(&PlacedCapsule) -> f64,
) -> Option<(f64, &PlacedCapsule)> {
    let all = shapes.iter().map(|shape| (gap_m(shape), shape));
    all.min_by(|one, other| one.0.total_cmp(&other.0))
}

/// The obstacles of a path so far: the last gap to each that it has not been clear of yet, and what is wrong; nothing for
/// those that it has been clear of. An arm that begins too near to one may go away from it, and must end clear of it.
#[derive(Default)]
struct Path(BTreeMap<usize, Option<(f64, String)>>);

impl Path {
    /// Notes the next gap to an obstacle.
    ///
    /// - `least_m`: the gap at which the path is clear of it; `worst_m`: the gap with which it may begin.
    fn next(
        &mut self,
        obstacle: usize,
        gap_m: f64,
        least_m: f64,
        worst_m: f64,
        why: impl Fn() -> String,
    ) -> Result<(), String> {
        // NaN must count as too near.
        if gap_m >= least_m {
            self.0.insert(obstacle, None);
            return Ok(());
        }
        let goes_away = match self.0.get(&obstacle) {
            None => true,
            Some(before) => before
                .as_ref()
                .is_some_and(|(before_m, _)| gap_m >= before_m - EXACT_M),
        };
        let may_leave = gap_m >= worst_m && goes_away;
        if !may_leave {
            return Err(why());
        }
        self.0.insert(obstacle, Some((gap_m, why())));
        Ok(())
    }

    /// Fails if the path ends too near to an obstacle.
    fn end(self) -> Result<(), String> {
        match self.0.into_values().flatten().next() {
            Some((_, why)) => Err(why),
            None => Ok(()),
        }
    }
}

/// Lets a path begin where the joints are. The tool's pose and the joint angles are read one after the other and with a
/// millimetre of error, so its first point may be beside them; that fades out along the path.
fn begin_at(points: &mut [Vec<f64>], joints_rad: &[f64]) {
    let Some(first) = points.first().cloned() else {
        return;
    };
    let aside: Vec<f64> = joints_rad
        .iter()
        .zip(&first)
        .map(|(at, first)| at - first)
        .collect();
    if aside.iter().any(|aside| aside.abs() > ASIDE_RAD) {
        return;
    }
    let steps = (points.len() - 1).max(1) as f64;
    for (step, point) in points.iter_mut().enumerate() {
        let left = 1.0 - step as f64 / steps;
        for (angle, aside) in point.iter_mut().zip(&aside) {
            *angle += left * aside;
        }
    }
}

/// Returns the hand's shapes with the tool at a pose.
fn hand_at(chain: &Chain, tool: &Isometry3<f64>) -> Vec<PlacedCapsule> {
    let hand = chain
        .shapes()
        .iter()
        .filter(|shape| shape.link == chain.joints().len());
    hand.map(|shape| PlacedCapsule {
        link: shape.link,
        ends: [&shape.from, &shape.to].map(|end| tool * end),
        radius_m: shape.radius_m,
    })
    .collect()
}

/// Interpolates between two poses, at a fraction from 0 to 1; the rotation is at most [`MAX_TILT_RAD`].
fn between(from: &Isometry3<f64>, to: &Isometry3<f64>, part: f64) -> Isometry3<f64> {
    from.try_lerp_slerp(to, part, 1e-9).unwrap_or(*to)
}

fn place(point: &Point3<f64>) -> String {
    format!("({:.3}, {:.3}, {:.3})", point.x, point.y, point.z)
}
