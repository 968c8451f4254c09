//! The arm of `fabc bench --world arm`.
//!
//! In: the command line and the suite. Out: whether the arm can run the suite, and its world for each rollout.

use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::runtime::bench::BenchArguments;
use crate::verbs::runtime::setting;
use crate::verbs::runtime::setting::arm::ArmMode;
use crate::verbs::runtime::setting::worlds::WorldChoice;
use fab_arm::settings::{DriverKind, Settings};
use fab_arm::world;
use fab_bench::on_arm::Cloths;
use fab_bench::suite::Suite;
use fab_world::About;

pub struct Arm {
    pub about: About,
    /// Who or what lays cloths on its table.
    pub cloths: Cloths,
    pub settings: Settings,
}

/// Checks first of all that the arm can run the suite; `None` if no arm is asked for.
pub fn check(arguments: &BenchArguments, suite: &Suite, io: &Io) -> Result<Option<Arm>, Failure> {
    if arguments.world != WorldChoice::Arm {
        return Ok(None);
    }
    if let Some(jobs) = arguments.jobs.filter(|jobs| *jobs != 1) {
        return Err(Failure::usage(format!(
            "`--jobs {jobs}` is for the simulator: an arm carries rollouts out one at a time"
        )));
    }
    let settings = Settings::load(arguments.arm.robot())?;
    let cloths = match settings.driver {
        DriverKind::Simulated => Cloths::Simulated,
        DriverKind::Kinova | DriverKind::Trajectory | DriverKind::Ros2 => Cloths::ByHand,
    };
    cloths.check(suite)?;
    let settings = setting::arm::check(&arguments.arm, ArmMode::Execute, io)?;
    Ok(Some(Arm {
        about: world::about(arguments.arm.robot()).map_err(Failure::environment)?,
        cloths,
        settings,
    }))
}
