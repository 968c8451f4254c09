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
use crate::route;
use crate::settings::{DriverKind, Settings};
use fab_world::{Grip, Motion, World, WorldPoint, Wrapper};
use nalgebra::Point3;

/// The reach of an arm with its hand pointing down.
pub(super) struct ArmReach {
    /// The reach in the base frame.
    pub reach: Reach,
    /// The guard of the arm's motions.
    pub guard: Guard,
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

    /// Returns why a point in the world frame is out of reach, as [`World::out_of_reach`] does.
    pub(super) fn out_of_reach(&self, settings: &Settings, point: &WorldPoint) -> Option<String> {
        let surface = self.guard.surface();
        let at = base_point(settings, surface, point);
        let motion = &settings.motion;
        let top_m = (route::travel_height_m(settings, surface, &at) - at.z).max(0.0);
        let low_m = motion.grasp_m.min(motion.release_m);
        let heights = [motion.pre_pick_m, motion.lift_m, motion.retreat_m, top_m];
        let heights = heights.map(|above_m| (above_m - low_m).max(0.0));
        let margin_m = settings.tolerance.position_m;
        // Near the rim, an arm that is off by its tolerance finds no path to the point.
        let radius_m = at.x.hypot(at.y).max(f64::MIN_POSITIVE);
        let mut joints_rad = Vec::new();
        for by_m in [margin_m, -margin_m, 0.0] {
            let share = 1.0 + by_m / radius_m;
            let near = Point3::new(at.x * share, at.y * share, at.z + low_m);
            match self.reach.check(&near, &heights) {
                Ok(found_rad) => joints_rad = found_rad,
                Err(why) => return Some(format!("it lies {why}")),
            }
        }
        let turn_rad = motion.hand_turn_deg.to_radians();
        let over = |above_m: f64| Point3::new(at.x, at.y, at.z + above_m);
        let low = over(low_m);
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
        let (usual_m_s, most_m_s) = (settings.motion.speed_m_s, self.guard.max_speed_m_s());
        let why_slower = |speed_m_s: f64| {
            if settings.driver == DriverKind::Kinova && speed_m_s != usual_m_s {
                return Some(format!(
                    "the arm takes poses and moves at a speed of its own, `motion.speed_m_s` of {usual_m_s} m/s"
                ));
            }
            let is_too_fast = speed_m_s > most_m_s;
            is_too_fast.then(|| {
                format!("the tool moves at most at `workspace.max_speed_m_s` of {most_m_s} m/s")
            })
        };
        if let Some(speed_m_s) = manner.speed_m_s
            && let Some(why) = why_slower(speed_m_s)
        {
            return Some(format!("`speed` of {speed_m_s} m/s is not possible: {why}"));
        }
        let points = [&asked.pick, &asked.place];
        let points = points.map(|point| base_point(settings, self.guard.surface(), point));
        let rest = ArmState::hand_down(settings, &settings.workspace.rest_m.into());
        let why = match rest {
            Ok(rest) => {
                Plan::make(settings, &self.guard, &rest, points, manner)
                    .0
                    .refused?
            }
            Err(why) => format!("the arm cannot rest at `rest_m`: {why}"),
        };
        let stated_m = [
            ("lift", manner.lift_m),
            ("release_height", manner.release_height_m),
        ];
        let stated = stated_m.into_iter().filter_map(|(name, height_m)| {
            Some(format!("`{name}` of {:.0} mm", height_m? * 1000.0))
        });
        let stated: Vec<String> = stated.collect();
        (!stated.is_empty()).then(|| format!("{} is not possible: {why}", stated.join(" with ")))
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
mod tests;
