//! The ROS 1 connection: the node of kinova-ros, a joint trajectory controller, a camera's topics.
//!
//! In: the `[ros]` section of the settings. Out: a [`RosPort`] and a camera, which make no decisions. Each has
//! its own ROS node and threads, so its methods are ordinary blocking calls. Message definitions are in `msgs/`;
//! neither a build nor a run needs a ROS installation. Only this folder names roslibrust.
//!
//! Other machines find this one under `ROS_HOSTNAME`, else `ROS_IP`, else the machine's own name. The library reads
//! these variables itself, so a `host` in the settings is only compared with the result.

mod connect;
mod port;
mod servers;
mod topics;

mod action;
mod ledger;

mod camera;

mod link;

pub use camera::subscribe;
pub use connect::connect;
pub use port::RosPort;

/// The Rust types of the messages in `msgs/`, one module per package.
#[allow(missing_docs, dead_code, unused_imports, clippy::all)]
mod messages {
    include!(concat!(env!("OUT_DIR"), "/messages.rs"));
}

/// Why a master, a node or a camera is unreachable.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RosError {
    /// Nobody answers at the master's address.
    #[error("no master at {address}: is roscore running? ({why})")]
    Master {
        /// The address, e.g. `http://localhost:11311`.
        address: String,
        /// The result of the attempt.
        why: String,
    },
    /// Other nodes would look for this program under a different name than the settings state.
    #[error(
        "other nodes find this program as `{found}`, and the settings say `{expected}`: set ROS_HOSTNAME={expected} before the start"
    )]
    Host {
        /// The name in the settings.
        expected: String,
        /// The name in use.
        found: String,
    },
    /// Something required is missing.
    #[error("{0}")]
    Missing(String),
    /// A setting is missing or unusable.
    #[error("{0}")]
    Setting(String),
    /// The master refused a registration.
    #[error("{what}: {why}")]
    Refused {
        /// What was tried.
        what: String,
        /// What went wrong.
        why: String,
    },
}

/// Packages of ROS 2 that the generator adds to every set of definitions.
const OF_ROS_2: [&str; 2] = ["builtin_interfaces/", "service_msgs/"];

/// Returns the name and MD5 sum of every message and service used here, in the order of names.
///
/// Nodes communicate only if both have the same sum for a topic or service.
pub fn definitions() -> Vec<(&'static str, &'static str)> {
    let messages = messages::MESSAGE_REGISTRY.descriptors().iter();
    let services = messages::SERVICE_REGISTRY.descriptors().iter();
    messages
        .map(|message| (message.ros_type_name, message.md5sum))
        .chain(services.map(|service| (service.ros_service_name, service.md5sum)))
        .filter(|(name, _)| !OF_ROS_2.iter().any(|package| name.starts_with(package)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::RosPort;

    /// A watchdog stops the arm from its own thread.
    #[test]
    fn ports_and_cameras_are_send() {
        fn assert_send<T: Send>() {}
        assert_send::<RosPort>();
        assert_send::<fab_arm::rgbd::topics::TopicCamera<crate::link::Link>>();
    }

    /// Sums taken from other programs, so that an error in a definition is not compared with itself.
    #[test]
    fn definitions_have_the_sums_that_others_publish() {
        let ours = super::definitions();
        for sum in [
            (
                "control_msgs/FollowJointTrajectoryActionGoal",
                "cff5c1d533bf2f82dd0138d57f4304bb",
            ),
            (
                "control_msgs/FollowJointTrajectoryActionResult",
                "c4fb3b000dc9da4fd99699380efcc5d9",
            ),
            ("kinova_msgs/Stop", "585dc4164508d473dff8f8b67a05d2ad"),
            ("sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743"),
            ("sensor_msgs/CameraInfo", "c9a58c1b0b154e0e6da7578cb991d214"),
            ("std_msgs/Header", "2176decaecbce78abc3b96ef049fabed"),
        ] {
            assert!(ours.contains(&sum), "{sum:?} of {ours:?}");
        }
    }
}
