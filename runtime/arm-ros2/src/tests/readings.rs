//! Tests of `readings.rs`.

#![allow(clippy::unwrap_used)]

use super::*;
use proptest::prelude::*;

fn chain() -> Chain {
    Chain::of_model("j2n6s200").unwrap()
}

fn names() -> Names {
    Names {
        joints: (1..=6).map(|joint| format!("joint_{joint}")).collect(),
        fingers: vec!["finger".to_owned()],
        n_fingers: 2,
    }
}

fn message(names: &[&str], position: &[f64]) -> JointState {
    let mut message = JointState {
        name: names.iter().map(|name| (*name).to_owned()).collect(),
        position: position.to_vec(),
        ..JointState::default()
    };
    message.header.stamp.sec = 7;
    message.header.stamp.nanosec = 500_000_000;
    message
}

const ALL: [&str; 7] = [
    "finger", "joint_6", "joint_5", "joint_4", "joint_3", "joint_2", "joint_1",
];

#[test]
fn joints_are_found_by_name_whatever_their_order() {
    let said = message(&ALL, &[0.5, 1.3, 1.4, 4.2, 1.0, 2.9, 4.8]);
    let read = read(&said, &names(), &chain()).unwrap();
    let (joints_rad, tool) = read.arm.unwrap();
    assert_eq!(joints_rad, [4.8, 2.9, 1.0, 4.2, 1.4, 1.3]);
    assert_eq!(tool, chain().base_from_tool(&joints_rad).unwrap());
    assert_eq!(read.fingers, Some(vec![0.5, 0.5]));
    assert_eq!(read.stamp_s, 7.5);
}

#[test]
fn a_message_of_other_joints_is_passed_over_and_half_an_arm_is_not() {
    let other = read(&message(&["lift"], &[1.0]), &names(), &chain()).unwrap();
    assert_eq!((other.arm, other.fingers), (None, None));
    let hand = read(&message(&["finger"], &[1.0]), &names(), &chain()).unwrap();
    assert_eq!((hand.arm, hand.fingers), (None, Some(vec![1.0, 1.0])));
    let mut unstamped = message(&ALL, &[0.0; 7]);
    unstamped.header.stamp.sec = 0;
    unstamped.header.stamp.nanosec = 0;
    for (said, expected) in [
        (
            message(&ALL[1..6], &[0.0; 5]),
            "gives no position of the joint `joint_1`",
        ),
        (
            message(&ALL, &[0.0; 6]),
            "gives no position of the joint `joint_1`",
        ),
        (
            message(&ALL, &[f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
            "gives no position of the joint `finger`",
        ),
        (
            unstamped,
            "has no stamp, so that nothing tells how old it is",
        ),
    ] {
        let found = read(&said, &names(), &chain()).unwrap_err();
        assert_eq!(found, expected);
    }
}

proptest! {
    /// Readings are always finite, whatever a message holds.
    #[test]
    fn readings_are_finite(values in prop::collection::vec(any::<f64>(), 0..9), secs: i32) {
        let mut said = message(&ALL, &values);
        said.header.stamp.sec = secs;
        if let Ok(read) = read(&said, &names(), &chain()) {
            if let Some((joints_rad, tool)) = read.arm {
                prop_assert!(joints_rad.iter().all(|angle| angle.is_finite()));
                prop_assert!(tool.to_homogeneous().iter().all(|value| value.is_finite()));
            }
            prop_assert!(read.fingers.iter().flatten().all(|position| position.is_finite()));
            prop_assert!(read.stamp_s.is_finite());
        }
    }
}
