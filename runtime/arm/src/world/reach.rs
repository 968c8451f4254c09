//! The reach of an arm, and a world that refuses points outside it without an arm.
//!
//! In: an arm's settings, and points in the world frame. Out: why nothing can be picked or placed there, worded for a
//! model. The world answers questions before a rollout: it asks nobody, and nothing real moves in it.

use super::base_from_world;
use super::parts::guard;
use crate::calibration::Calibration;
use crate::driver::ArmState;
use crate::guard::{Guard, Surface};
use crate::kinematics::reach::Reach;
use crate::kinematics::tool_down::tool_down;
use crate::plan::Plan;
use crate::route::{self, SegmentName};
use crate::settings::{DriverKind, Settings};
use fab_program::Manner;
use fab_world::{Grip, Motion, World, WorldPoint, Wrapper};
use nalgebra::Point3;

/// The reach of an arm with its hand pointing down.
pub(super) struct ArmReach {
    reach: Reach,
    guard: Guard,
}

impl ArmReach {
    /// Computes the reach of an arm whose motions are guarded.
    pub(super) fn new(settings: &Settings, guard: Guard) -> ArmReach {
        let turn_rad = settings.motion.hand_turn_deg.to_radians();
        ArmReach {
            reach: Reach::tool_down(guard.chain(), turn_rad),
            guard,
        }
    }

    /// Returns the reach in the base frame.
    pub(super) fn reach(&self) -> &Reach {
        &self.reach
    }

    /// Returns the guard of the arm's motions.
    pub(super) fn guard(&self) -> &Guard {
        &self.guard
    }

    /// Returns why a point in the world frame is out of reach, as [`World::out_of_reach`] does.
    pub(super) fn out_of_reach(&self, settings: &Settings, point: &WorldPoint) -> Option<String> {
        let surface = self.guard.surface();
        let at = base_point(settings, surface, point);
        let motion = &settings.motion;
        let top_m = (route::travel_height_m(settings, surface, &at) - at.z).max(0.0);
        let heights = [motion.pre_pick_m, motion.lift_m, motion.retreat_m, top_m];
        let margin_m = settings.tolerance.position_m;
        // Near the rim, an arm that is off by its tolerance finds no path to the point.
        let radius_m = at.x.hypot(at.y).max(f64::MIN_POSITIVE);
        let mut joints_rad = Vec::new();
        for by_m in [margin_m, -margin_m, 0.0] {
            let share = 1.0 + by_m / radius_m;
            let near = Point3::new(at.x * share, at.y * share, at.z);
            match self.reach.check(&near, &heights) {
                Ok(found_rad) => joints_rad = found_rad,
                Err(why) => return Some(format!("it lies {why}")),
            }
        }
        let turn_rad = motion.hand_turn_deg.to_radians();
        let over = |above_m: f64| Point3::new(at.x, at.y, at.z + above_m);
        let low = over(motion.grasp_m.min(motion.release_m));
        if let Err(why) = self.guard.goal(&low) {
            return Some(why);
        }
        let high = over(top_m);
        if let Err(why) = self.guard.goal(&high) {
            return Some(format!("at the height of travel (`motion.travel_m`) {why}"));
        }
        // The way down is the same as the way up.
        let from = ArmState {
            at_s: 0.0,
            tool: tool_down(&low, turn_rad),
            joints_rad,
            fingers: Vec::new(),
        };
        let up = tool_down(&high, turn_rad);
        self.guard.motion(&from, &up, motion.speed_m_s).err()
    }

    /// Returns why the arm cannot follow a motion's manner, as [`World::refuses`] does.
    ///
    /// The way is planned from where the arm rests.
    pub(super) fn refuses(&self, settings: &Settings, asked: &Motion) -> Option<String> {
        let mut grips = asked.grips.iter();
        grips.find_map(|grip| self.refuses_grip(settings, grip))
    }

    fn refuses_grip(&self, settings: &Settings, asked: &Grip) -> Option<String> {
        let manner = &asked.manner;
        if manner.is_default() {
            return None;
        }
        if manner.press_m.is_some_and(|press_m| press_m > 0.0) {
            return Some(
                "`press` is not possible: the arm feels no force, so it presses no crease"
                    .to_owned(),
            );
        }
        if let Some(speed_m_s) = manner.speed_m_s
            && let Some(why) = self.speed_refused(settings, speed_m_s)
        {
            return Some(format!("`speed` of {speed_m_s} m/s is not possible: {why}"));
        }
        let points = [&asked.pick, &asked.place];
        let points = points.map(|point| base_point(settings, self.guard.surface(), point));
        let turn_rad = settings.motion.hand_turn_deg.to_radians();
        let rest = ArmState {
            at_s: 0.0,
            tool: tool_down(&settings.workspace.rest_m.into(), turn_rad),
            joints_rad: Vec::new(),
            fingers: Vec::new(),
        };
        let plan = |manner: &Manner| {
            let (plan, route) = Plan::make(settings, &self.guard, &rest, points, manner);
            (plan.refused.filter(|_| route.is_none()), plan.segments)
        };
        let (refused, segments) = plan(manner);
        if let Some(why) = refused {
            // What is impossible in the arm's own manner too is not refused here.
            if plan(&Manner::default()).0.is_some() {
                return None;
            }
            let heights = [
                ("lift", manner.lift_m),
                ("release_height", manner.release_height_m),
            ];
            let stated = heights.into_iter().filter_map(|(name, height_m)| {
                let height_m = height_m?;
                let alone = Manner::default().with(name, height_m);
                let why = plan(&alone).0?;
                Some(format!(
                    "`{name}` of {:.0} mm is not possible: {why}",
                    height_m * 1000.0
                ))
            });
            return stated.into_iter().next().or(Some(why));
        }
        let speed_m_s = manner.speed_m_s?;
        let mut at = rest.clone();
        for segment in &segments {
            let to = tool_down(&segment.to_m.into(), turn_rad);
            let carries = matches!(
                segment.name,
                SegmentName::Lift | SegmentName::Over | SegmentName::DownToPlace
            );
            let most_m_s = self.guard.joints_allow_m_s(&at, &to);
            if carries && speed_m_s > most_m_s {
                return Some(format!(
                    "`speed` of {speed_m_s} m/s is not possible: on this way the arm's joints allow at most {most_m_s:.3} m/s"
                ));
            }
            at.tool = to;
            at.joints_rad = segment
                .joints_deg
                .iter()
                .map(|deg| deg.to_radians())
                .collect();
        }
        None
    }

    /// Returns why no way can have this speed.
    fn speed_refused(&self, settings: &Settings, speed_m_s: f64) -> Option<String> {
        let usual_m_s = settings.motion.speed_m_s;
        if settings.driver == DriverKind::Kinova && speed_m_s != usual_m_s {
            return Some(format!(
                "the arm takes poses and moves at a speed of its own, `motion.speed_m_s` of {usual_m_s} m/s"
            ));
        }
        let most_m_s = self.guard.max_speed_m_s();
        (speed_m_s > most_m_s).then(|| {
            format!("the tool moves at most at `workspace.max_speed_m_s` of {most_m_s} m/s")
        })
    }
}

/// Returns a world point in the base frame, raised to the table if it lies below.
pub(super) fn base_point(
    settings: &Settings,
    surface: &Surface,
    point: &WorldPoint,
) -> Point3<f64> {
    let mut at = base_from_world(settings) * point;
    at.z = at.z.max(surface.height_m(at.x, at.y));
    at
}

/// A world in which points out of an arm's reach are refused.
pub struct WithinReach {
    world: Box<dyn World>,
    settings: Settings,
    reach: ArmReach,
}

impl WithinReach {
    /// Adds an arm's reach to a world that has none.
    pub fn new(
        world: Box<dyn World>,
        settings: Settings,
        calibration: &Calibration,
    ) -> WithinReach {
        let guard = guard(&settings, calibration);
        WithinReach {
            world,
            reach: ArmReach::new(&settings, guard),
            settings,
        }
    }
}

impl Wrapper for WithinReach {
    fn inner(&self) -> &dyn World {
        self.world.as_ref()
    }

    fn inner_mut(&mut self) -> &mut dyn World {
        self.world.as_mut()
    }

    fn out_of_reach(&self, point: &WorldPoint) -> Option<String> {
        self.reach.out_of_reach(&self.settings, point)
    }

    fn refuses(&self, motion: &Motion) -> Option<String> {
        let why = self.reach.refuses(&self.settings, motion);
        why.or_else(|| self.world.refuses(motion))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::world::load;
    use std::path::Path;

    /// Cloth on the low side of a tilted table is grasped where it lies, not at the height of the table's middle.
    #[test]
    fn grasp_heights_follow_a_tilted_table() {
        let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tasks/real/simulated.toml");
        let (settings, ..) = load(&robot).unwrap();
        let slope = 3f64.to_radians().tan();
        let [x, y, z] = settings.table.center_m;
        let world_from_base = base_from_world(&settings).inverse();
        for way_rad in (0..10).map(f64::from) {
            let [along_x, along_y] = [slope * way_rad.cos(), slope * way_rad.sin()];
            let surface = Surface::tilted([z - along_x * x - along_y * y, along_x, along_y]);
            for (at_x, at_y) in [(0.3, -0.2), (0.3, 0.2), (0.6, -0.2), (0.6, 0.2), (x, y)] {
                let cloth = Point3::new(at_x, at_y, surface.height_m(at_x, at_y));
                let pick = base_point(&settings, &surface, &(world_from_base * cloth));
                assert!((pick - cloth).norm() < 1e-9, "{pick} {cloth}");
                // What a camera sees below the table lies on it.
                let below = cloth - nalgebra::Vector3::z() * 0.03;
                let pick = base_point(&settings, &surface, &(world_from_base * below));
                assert!((pick - cloth).norm() < 1e-9, "{pick} {cloth}");
                let rest = tool_down(&settings.workspace.rest_m.into(), 0.0);
                let route =
                    route::Route::new(&settings, &surface, &rest, &pick, &pick, &Manner::default());
                let is_down = |it: &&route::Segment| it.name == route::SegmentName::Down;
                let down = route.segments.iter().find(is_down).unwrap();
                let route::Act::Move(to) = down.act else {
                    panic!("{down:?}")
                };
                assert!((to.translation.z - cloth.z).abs() < 1e-9);
            }
        }
    }

    /// A point at the rim can be reached in one posture only: an arm that is off by a millimetre does not get there.
    #[test]
    fn points_at_the_rim_are_left_out_by_what_an_arm_may_be_off() {
        let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tasks/real/simulated.toml");
        let (settings, _, calibration) = load(&robot).unwrap();
        let guard = guard(&settings, &calibration);
        let reach = ArmReach::new(&settings, guard);
        let world_from_base = base_from_world(&settings).inverse();
        let angle_rad = 0.215_f64;
        let at = |radius_m: f64| {
            let (sin, cos) = angle_rad.sin_cos();
            let base = Point3::new(radius_m * cos, radius_m * sin, 0.02);
            reach.out_of_reach(&settings, &(world_from_base * base))
        };
        assert_eq!(at(0.70), None);
        let why = at(0.7072).unwrap();
        assert!(why.contains("it lies 0.71 m from the arm's base"), "{why}");
        assert!(at(0.187).is_some(), "the same holds near the base");
        let why = at(0.19).unwrap();
        assert!(
            why.contains("the arm behind joint 2 would come within"),
            "{why}"
        );
        let nearest = (19..30).find(|cm| at(f64::from(*cm) / 100.0).is_none());
        assert_eq!(nearest, Some(21), "no part of the arm touches another");
        // By its kinematics alone, the arm would reach both.
        for radius_m in [0.7072, 0.187] {
            let base = Point3::new(radius_m * angle_rad.cos(), radius_m * angle_rad.sin(), 0.02);
            assert!(
                reach.reach.check(&base, &[0.05, 0.10]).is_ok(),
                "{radius_m}"
            );
        }
    }

    #[test]
    fn manners_beyond_the_arm_are_refused_by_name_and_with_the_bound() {
        let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tasks/real/simulated.toml");
        let (mut settings, _, calibration) = load(&robot).unwrap();
        let reach = ArmReach::new(&settings, guard(&settings, &calibration));
        let points = [
            WorldPoint::new(-0.05, 0.0, 0.0),
            WorldPoint::new(0.1, 0.05, 0.0),
        ];
        let motion =
            |manner: Manner| Motion::from(Grip::new(points[0], points[1]).with_manner(manner));
        let said = |settings: &Settings, name: &str, value: f64| {
            reach.refuses(settings, &motion(Manner::default().with(name, value)))
        };
        for (name, value) in [
            ("lift", 0.0),
            ("lift", 0.1),
            ("release_height", 0.0),
            ("release_height", 0.1),
            ("press", 0.0),
            ("speed", settings.motion.speed_m_s),
            ("speed", 0.03),
        ] {
            assert_eq!(said(&settings, name, value), None, "{name} {value}");
        }
        let top_m = settings.workspace.max_m[2];
        let usual_m_s = settings.motion.speed_m_s;
        for (name, value, expected) in [
            (
                "lift",
                0.9,
                "`lift` of 900 mm is not possible: the tool would be at".to_owned(),
            ),
            ("lift", 0.9, format!("to {top_m:.3} m")),
            (
                "release_height",
                0.9,
                "`release_height` of 900 mm is not possible".to_owned(),
            ),
            (
                "press",
                0.1,
                "`press` is not possible: the arm feels no force".to_owned(),
            ),
        ] {
            let why = said(&settings, name, value).unwrap();
            assert!(why.contains(&expected), "{why}");
        }
        // An arm that takes poses alone has one speed.
        settings.driver = DriverKind::Kinova;
        assert_eq!(said(&settings, "speed", usual_m_s), None);
        let why = said(&settings, "speed", 0.03).unwrap();
        let expected = format!("a speed of its own, `motion.speed_m_s` of {usual_m_s} m/s");
        assert!(why.contains(&expected), "{why}");
        // An arm that follows trajectories takes a speed, within its limits.
        settings.driver = DriverKind::Trajectory;
        assert_eq!(said(&settings, "speed", 0.03), None);
        let most_m_s = settings.workspace.max_speed_m_s;
        let why = said(&settings, "speed", most_m_s + 0.1).unwrap();
        let expected = format!("`workspace.max_speed_m_s` of {most_m_s} m/s");
        assert!(why.contains(&expected), "{why}");
        settings.workspace.max_speed_m_s = 5.0;
        let reach = ArmReach::new(&settings, guard(&settings, &calibration));
        let fast = motion(Manner::default().with("speed", 4.0));
        let why = reach.refuses(&settings, &fast).unwrap();
        assert!(why.contains("the arm's joints allow at most"), "{why}");
    }
}
