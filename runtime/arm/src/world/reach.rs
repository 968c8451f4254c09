//! The reach of an arm, and a world that refuses points outside it without an arm.
//!
//! In: an arm's settings, and points in the world frame. Out: why nothing can be picked or placed there, worded for a
//! model. The world answers questions before a rollout: it asks nobody, and nothing real moves in it.

use super::base_from_world;
use super::parts::guard;
use crate::calibration::Calibration;
use crate::driver::ArmState;
use crate::guard::{Guard, Surface};
use crate::kinematics::reach::{Reach, Turn};
use crate::kinematics::tool_down::tool_down;
use crate::route;
use crate::settings::Settings;
use fab_world::{World, WorldPoint, Wrapper};
use nalgebra::Point3;

/// The reach of an arm with its hand pointing down.
pub(super) struct ArmReach {
    reach: Reach,
    guard: Guard,
}

impl ArmReach {
    /// Computes the reach of an arm whose motions are guarded.
    pub(super) fn new(settings: &Settings, guard: Guard) -> ArmReach {
        let turn = Turn::Fixed(settings.motion.hand_turn_deg.to_radians());
        ArmReach {
            reach: Reach::tool_down(guard.chain(), turn),
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
                let route = route::Route::new(&settings, &surface, &rest, &pick, &pick);
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
        assert_eq!(at(0.19), None);
        // By its kinematics alone, the arm would reach both.
        for radius_m in [0.7072, 0.187] {
            let base = Point3::new(radius_m * angle_rad.cos(), radius_m * angle_rad.sin(), 0.02);
            assert!(
                reach.reach.check(&base, &[0.05, 0.10]).is_ok(),
                "{radius_m}"
            );
        }
    }
}
