//! The ROS 2 connection: a joint trajectory controller, joint states, a gripper, a camera's topics.
//!
//! In: the `[ros2]` section of the settings. Out: a [`Ros2Port`] and a camera, which make no decisions. Each is a DDS
//! participant with threads of its own, so its methods are ordinary blocking calls. Neither a build nor a run needs an
//! installation of ROS. It joins no ROS graph: `ros2 node list` does not show it, `ros2 topic info` does.
//!
//! Quality of service: joint states and pictures are requested best effort and volatile, which matches writers that
//! offer that or more. Services and the goals' states are reliable, as every ROS 2 action server offers them.

mod messages;

mod connect;
mod goals;
mod port;
mod readings;

mod action;
mod camera;
mod link;
mod service;

#[cfg(test)]
#[path = "tests/distribution.rs"]
mod distribution;

pub use camera::subscribe;
pub use connect::connect;
pub use port::Ros2Port;

/// Why an arm or a camera is unreachable.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Ros2Error {
    /// DDS could not be started, or refused a topic.
    #[error("{what}: {why}")]
    Refused {
        /// What was tried.
        what: String,
        /// What went wrong.
        why: String,
    },
    /// Something required is missing.
    #[error("{0}")]
    Missing(String),
    /// A setting is unusable.
    #[error("{0}")]
    Setting(String),
}
