//! Checks that ROS computes the same checksums of message definitions as the generator of Rust types.

use super::nodes;

#[test]
#[ignore = "needs ROS"]
fn peer_ros_has_the_same_sum_for_every_message_and_service() {
    let ours = fab_arm_ros::definitions();
    assert!(ours.len() > 30, "{ours:?}");
    let names: Vec<&str> = ours.iter().map(|(name, _)| *name).collect();
    let folder = tempfile::tempdir().unwrap();
    let theirs = nodes::generate(folder.path(), &names);
    let wrong: Vec<String> = ours
        .iter()
        .map(|(name, sum)| format!("{name} {sum}"))
        .filter(|line| !theirs.lines().any(|other| other == line))
        .collect();
    assert!(
        wrong.is_empty(),
        "of ours {wrong:#?} differ; ROS has:\n{theirs}"
    );
}
