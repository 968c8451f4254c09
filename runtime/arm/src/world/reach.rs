//! The reach of an arm, and a world that refuses points outside it without an arm.
//!
//! In: an arm's settings, and points in the world frame. Out: why nothing can be picked or placed there, worded for a
//! model. The world answers questions before a rollout: it asks nobody, and nothing real moves in it.

use super::base_from_world;
use crate::kinematics::chain::Chain;
use crate::kinematics::reach::{Reach, Turn};
use crate::kinematics::tool_down::tool_down;
use crate::settings::Settings;
use crate::{limits, route};
use fab_world::{World, WorldError, WorldPoint, Wrapper};
use nalgebra::{Isometry3, Point3};

/// The reach of an arm with its hand pointing down.
pub(super) struct ArmReach(Reach);

impl ArmReach {
    /// Computes the reach of the arm in the settings.
    pub(super) fn of(settings: &Settings) -> Result<ArmReach, WorldError> {
        let chain = Chain::of_model(&settings.model).map_err(|why| WorldError::Motion {
            why: why.to_string(),
        })?;
        let turn = Turn::Fixed(settings.motion.hand_turn_deg.to_radians());
        Ok(ArmReach(Reach::tool_down(&chain, turn)))
    }

    /// Returns the reach in the base frame.
    pub(super) fn reach(&self) -> &Reach {
        &self.0
    }

    /// Returns why a point in the world frame is out of reach, as [`World::out_of_reach`] does.
    pub(super) fn out_of_reach(&self, settings: &Settings, point: &WorldPoint) -> Option<String> {
        let at = base_point(settings, point);
        let motion = &settings.motion;
        let top_m = route::travel_height_m(settings) - at.z;
        let heights = [
            motion.pre_pick_m,
            motion.lift_m,
            motion.retreat_m,
            top_m.max(0.0),
        ];
        let margin_m = settings.tolerance.position_m;
        // Near the rim, an arm that is off by its tolerance finds no path to the point.
        let radius_m = at.x.hypot(at.y).max(f64::MIN_POSITIVE);
        for by_m in [0.0, margin_m, -margin_m] {
            let share = 1.0 + by_m / radius_m;
            let near = Point3::new(at.x * share, at.y * share, at.z);
            if let Err(why) = self.0.check(&near, &heights) {
                return Some(format!("it lies {why}"));
            }
        }
        let pose = |above_m: f64| tool_down(&Point3::new(at.x, at.y, at.z + above_m), 0.0);
        let (low, high) = (
            pose(motion.grasp_m.min(motion.release_m)),
            pose(top_m.max(0.0)),
        );
        let check = |from, to| {
            limits::check(&settings.workspace, margin_m, from, to, motion.speed_m_s).err()
        };
        let goal = |pose: &Isometry3<f64>| {
            let at = Point3::from(pose.translation.vector);
            limits::check_goal(&settings.workspace, margin_m, &at).err()
        };
        goal(&low)
            .or_else(|| {
                let why = goal(&high)?;
                Some(format!("at the height of travel (`motion.travel_m`) {why}"))
            })
            .or_else(|| check(&high, &low))
            .or_else(|| check(&low, &high))
    }
}

/// Returns a world point in the base frame, raised to the table if it lies below.
pub(super) fn base_point(settings: &Settings, point: &WorldPoint) -> Point3<f64> {
    let mut at = base_from_world(settings) * point;
    at.z = at.z.max(settings.table.center_m[2]);
    at
}

/// A world in which points out of an arm's reach are refused.
pub struct WithinReach {
    world: Box<dyn World>,
    settings: Settings,
    reach: ArmReach,
}

impl WithinReach {
    /// Adds an arm's reach to a world that has none; fails for an unknown arm model.
    pub fn new(world: Box<dyn World>, settings: Settings) -> Result<WithinReach, WorldError> {
        Ok(WithinReach {
            world,
            reach: ArmReach::of(&settings)?,
            settings,
        })
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

    /// A point at the rim can be reached in one posture only: an arm that is off by a millimetre does not get there.
    #[test]
    fn points_at_the_rim_are_left_out_by_what_an_arm_may_be_off() {
        let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tasks/real/simulated.toml");
        let (settings, ..) = load(&robot).unwrap();
        let reach = ArmReach::of(&settings).unwrap();
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
            assert!(reach.0.check(&base, &[0.05, 0.10]).is_ok(), "{radius_m}");
        }
    }
}
