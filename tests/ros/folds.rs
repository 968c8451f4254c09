//! The arm of kinova-ros folds a cloth, by each of its drivers.

use super::nodes::Driver;
use super::whole::folds_a_double_triangle;

#[test]
#[ignore = "needs ROS"]
fn peer_ros_an_arm_with_a_calibrated_camera_folds_a_double_triangle() {
    folds_a_double_triangle(Driver::Kinova, 1);
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_an_arm_moved_by_trajectories_folds_a_double_triangle() {
    folds_a_double_triangle(Driver::Trajectory, 2);
}
