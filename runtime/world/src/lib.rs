//! Worlds that execute actions, behind one trait; starts, twins and expert results made with them, and measures of what
//! became of the cloth.
//!
//! In: a [`Start`] and [`Motion`]s in metres. Out: [`Observation`]s and what really happened. A world knows nothing
//! about prompts, models or checks.

pub mod conformance;
pub mod corner_fold;
pub mod crumple;
pub mod expert;
pub mod external;
pub mod metrics;
pub mod protocol;
pub mod serve;
pub mod simulated;
pub mod smallest_fold;
pub mod start;
pub mod twin;
pub mod vary;

#[cfg(test)]
#[path = "../../../tests/recorded_data.rs"]
mod recorded;
mod wrapper;

use crate::start::Start;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_base::wording::counted;
use fab_picture::observation::Observation;
use fab_program::{Manner, Material};
use nalgebra::Point3;
use serde::{Deserialize, Serialize};
use vary::AxisValues;

pub use external::ExternalWorld;
pub use simulated::{Look, SimulatedWorld, film, material};
pub use wrapper::Wrapper;

/// A point in the world frame: right-handed, z up, origin at the table's centre, metres.
pub type WorldPoint = Point3<f64>;

/// A cloth on a table under a camera, and something that picks and places.
///
/// Every implementation keeps the promises of [`conformance`].
pub trait World {
    /// Returns the world's name as reports print it, e.g. `sim`.
    fn name(&self) -> &str;

    /// Returns the hash of every parameter that changes results.
    fn parameters(&self) -> String;

    /// Returns a digest of the code behind the results: it changes whenever equal actions might have another result.
    fn code(&self) -> String;

    /// Returns the values in which the world differs from the task's own; none for most worlds.
    fn variation(&self) -> AxisValues {
        AxisValues::default()
    }

    /// Returns whether the world is repeatable: a reset restores the same cloth, and equal actions then give equal
    /// results.
    ///
    /// Only in such a world can an interrupted rollout be resumed.
    fn repeats(&self) -> bool {
        true
    }

    /// Returns whether nothing but a simulated cloth moves.
    ///
    /// Where something real may move, an action that cannot be trusted is not executed. A program is believed to move
    /// something real.
    fn is_simulated(&self) -> bool {
        false
    }

    /// Returns how many grippers move at the same time.
    fn grippers(&self) -> usize {
        1
    }

    /// Lays the cloth as `start` says and sets the clock to zero.
    fn reset(&mut self, start: &Start) -> Result<(), WorldError>;

    /// Takes a picture. Two pictures without an action between them are equal.
    fn observe(&mut self) -> Result<Observation, WorldError>;

    /// Executes a motion; one with another number of grips than [`World::grippers`] fails.
    ///
    /// Returns what was really done, which may differ from what was asked. Ends early when `interrupt` is raised: with
    /// [`WorldError::Interrupted`] if there is nothing more to report, otherwise with [`WorldError::Halted`].
    fn act(&mut self, motion: &Motion, interrupt: &Interrupt) -> Result<Executed, WorldError>;

    /// Crumples a start at random and returns where the cloth then lies, centred on the table and at rest.
    ///
    /// The seed decides everything random: equal starts and seeds give equal results. The world itself does not change,
    /// so a crumpled cloth begins a rollout like any other start: through [`World::reset`], with its digest in the
    /// journal. Fails with [`WorldError::CannotCrumple`] if the world has no way to do it, and ends early with
    /// [`WorldError::Interrupted`] when `interrupt` is raised.
    fn crumple(&self, start: &Start, seed: u64, interrupt: &Interrupt)
    -> Result<Start, WorldError>;

    /// Returns the position of every particle, or `None` if the world cannot know.
    ///
    /// Shape `[dimy * dimx]`, index `iy * dimx + ix`, world frame, metres.
    fn particles(&self) -> Option<Vec<[f32; 3]>>;

    /// Returns in how many places an edge of the cloth's mesh goes through the cloth, as none of a real cloth does; `None` if
    /// the world cannot know, or does not tell.
    fn crossings(&self) -> Option<usize> {
        None
    }

    /// Returns what the camera sees of the flat cloth, whole and alone on the table, or `None` if no such picture was
    /// taken.
    ///
    /// Coverage is measured against this picture if the world does not know its particles, so it belongs to the world's
    /// parameters. It has the size of the other pictures; its depth may lack readings.
    fn flat_cloth(&self) -> Option<Observation> {
        None
    }

    /// Returns why nothing can be picked or placed at a point, or `None` if it is in reach.
    ///
    /// The reason completes a sentence for the model, such as `it lies 0.81 m from the arm's base, and the arm reaches
    /// 0.70 m`. It depends on the point and the world's parameters alone.
    fn out_of_reach(&self, _point: &WorldPoint) -> Option<String> {
        None
    }

    /// Returns why a motion cannot be executed in its [`Manner`], or `None` if it can.
    ///
    /// The reason is a sentence for the model without a full stop, such as `` `lift` of 300 mm is beyond the arm ``. It
    /// depends on the motion and the world's parameters alone. A world that says nothing here acts on no manner at all.
    fn refuses(&self, motion: &Motion) -> Option<String> {
        unknown_manner(self.name(), motion, &[])
    }
}

/// Returns why a world cannot follow a motion's manner, given the fields that it acts on; `None` if it acts on all that are
/// stated.
pub fn unknown_manner(world: &str, motion: &Motion, acts_on: &[String]) -> Option<String> {
    let grips = motion.grips.iter();
    let mut unknown = grips.flat_map(|grip| grip.manner.stated().map(|(name, _)| name));
    let name = unknown.find(|name| !acts_on.iter().any(|known| known == name))?;
    Some(format!("the world `{world}` does not act on `{name}`"))
}

/// What a world reports about itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct About {
    /// Its [`World::name`].
    pub name: String,
    /// Its [`World::parameters`].
    pub parameters: String,
    /// Its [`World::code`].
    pub code: String,
}

impl About {
    /// Collects the answers of a world.
    pub fn of(world: &dyn World) -> About {
        About {
            name: world.name().to_owned(),
            parameters: world.parameters(),
            code: world.code(),
        }
    }

    /// Returns what the world reports about itself with a cloth of a material.
    pub fn with_material(&self, material: Option<&Material>) -> About {
        About {
            parameters: parameters_with(self.parameters.clone(), material),
            ..self.clone()
        }
    }
}

/// Returns why a motion cannot be executed, as [`World::refuses`] does.
pub type Refuses<'a> = dyn Fn(&Motion) -> Option<String> + 'a;

/// Refuses no motion: for questions outside any world.
pub fn nothing(_: &Motion) -> Option<String> {
    None
}

/// Returns the hash of a world's settings with the material of its cloth, if a task states one.
pub fn parameters_with(parameters: String, material: Option<&Material>) -> String {
    let Some(material) = material else {
        return parameters;
    };
    let text = serde_json::to_string(&material.without_sources())
        .expect("a material has string keys and finite numbers");
    Cache::key([parameters.as_str(), &text])[..16].to_owned()
}

/// Returns why nothing can be done at a point, as [`World::out_of_reach`] does.
pub type Reach<'a> = dyn Fn(&WorldPoint) -> Option<String> + 'a;

/// Treats every point as in reach: for questions outside any world.
pub fn everywhere(_: &WorldPoint) -> Option<String> {
    None
}

/// What one gripper does: it picks at one point, carries the cloth to another and releases it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grip {
    /// Where the cloth is picked.
    pub pick: WorldPoint,
    /// Where it is released.
    pub place: WorldPoint,
    /// How the gripper goes about it, where the task or the answer says so.
    #[serde(default, skip_serializing_if = "Manner::is_default")]
    pub manner: Manner,
}

impl Grip {
    /// Returns a grip in the world's own manner.
    pub fn new(pick: WorldPoint, place: WorldPoint) -> Grip {
        Grip {
            pick,
            place,
            manner: Manner::default(),
        }
    }

    /// Returns the same grip in a stated manner.
    pub fn with_manner(self, manner: Manner) -> Grip {
        Grip { manner, ..self }
    }
}

/// What the grippers of a world do at the same time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// One grip for each of the world's [`World::grippers`].
    pub grips: Vec<Grip>,
}

impl From<Grip> for Motion {
    fn from(grip: Grip) -> Motion {
        Motion { grips: vec![grip] }
    }
}

impl Motion {
    /// Returns the grip of a world that has one gripper; fails if the motion has another number of grips.
    pub fn only(&self, world: &str) -> Result<Grip, WorldError> {
        match self.grips[..] {
            [grip] => Ok(grip),
            _ => Err(WorldError::Motion {
                why: self.unequal(world, 1),
            }),
        }
    }

    /// Says that a motion does not fit the grippers of a world.
    fn unequal(&self, world: &str, grippers: usize) -> String {
        let grips = counted(self.grips.len(), "grip");
        let grippers = counted(grippers, "gripper");
        format!("the motion has {grips}, and the world `{world}` has {grippers}")
    }
}

/// What a world really did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Executed {
    /// What each gripper did.
    pub grips: Vec<ExecutedGrip>,
    /// Duration in the world, seconds.
    pub duration_s: f64,
}

impl Executed {
    /// Returns the motion as executed.
    pub fn motion(&self) -> Motion {
        Motion {
            grips: self.grips.iter().map(|done| done.grip).collect(),
        }
    }

    /// Returns whether a gripper held nothing.
    pub fn has_missed(&self) -> bool {
        self.grips.iter().any(|done| done.grasp == Grasp::Missed)
    }
}

/// What one gripper really did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExecutedGrip {
    /// The grip as executed; a world with limits may have clipped it.
    #[serde(flatten)]
    pub grip: Grip,
    /// What was held between pick and place.
    pub grasp: Grasp,
    /// Where the held particle was when it was let go of; `None` if none was held, or if the world does not know it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub released_at: Option<WorldPoint>,
}

/// What was held between pick and place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Grasp {
    /// The particle with this index.
    Particle(u32),
    /// Nothing: the cloth was out of reach of the gripper.
    Missed,
    /// Something: the closing fingers stopped before they met.
    Held,
    /// The gripper closed, and nothing tells whether it holds anything.
    Unverified,
}

/// Why a world failed.
#[derive(Debug, thiserror::Error)]
pub enum WorldError {
    /// The start cannot be laid.
    #[error("the start `{start}` cannot be laid on the table: {why}")]
    Start {
        /// The start's name.
        start: String,
        /// What is wrong with it.
        why: String,
    },
    /// The camera cannot be set up.
    #[error("the camera cannot be set up: {why}")]
    Camera {
        /// What is wrong with it.
        why: String,
    },
    /// The world was used before its first reset.
    #[error("no cloth has been laid yet")]
    NotReset,
    /// The world has no way to crumple a cloth.
    #[error("the world `{world}` cannot crumple a cloth; give it a start file")]
    CannotCrumple {
        /// The world's name.
        world: String,
    },
    /// The motion left the range that the world can represent.
    #[error("the motion failed: {why}")]
    Motion {
        /// What went wrong.
        why: String,
    },
    /// The user's program behind the world failed, or gave an impossible answer.
    #[error("{why}")]
    Program {
        /// What went wrong, with the program's name or command line.
        why: String,
    },
    /// A stop was requested.
    #[error("interrupted")]
    Interrupted,
    /// The motion was only planned; nothing is to move.
    #[error("planned, and not moved")]
    PlannedOnly,
    /// A stop was requested, or permission to go on was refused, in the middle of a motion.
    #[error("{told}")]
    Halted {
        /// In which part it stopped, and what is verified.
        told: String,
    },
}
