//! A camera over ROS: unchanged pictures, taken after they were requested.

use super::nodes::{PATIENCE_S, Ros};
use fab_arm::rgbd::{Intrinsics, RgbdSource};
use fab_arm::settings::RosSettings;
use fab_arm_ros::subscribe;

#[test]
#[ignore = "needs ROS"]
fn peer_ros_pictures_arrive_bit_for_bit() {
    let ros = Ros::with_arm();
    let mut camera = subscribe(&ros.settings(), PATIENCE_S).unwrap();
    for _ in 0..3 {
        let shot = camera.shoot().unwrap();
        assert_eq!(shot.rgb.dimensions(), (64, 48));
        assert_eq!(shot.depth_m.dimensions(), (64, 48));
        for (column, row, pixel) in shot.rgb.enumerate_pixels() {
            assert_eq!(pixel.0, [column as u8, row as u8, (column ^ row) as u8]);
            let depth = if row == 0 {
                0.0
            } else {
                (500 + column) as f32 / 1000.0
            };
            assert_eq!(
                shot.depth_m.get_pixel(column, row).0,
                [depth],
                "{column} {row}"
            );
        }
        let expected = Intrinsics {
            size_px: [64, 48],
            focal_px: [80.0, 81.0],
            middle_px: [32.25, 24.5],
            distortion: vec![0.1, -0.02, 0.001, 0.002, 0.0],
        };
        assert_eq!(shot.intrinsics, Some(expected));
    }
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_a_camera_that_says_nothing_is_named() {
    let mut ros = Ros::with_arm();
    let aside = RosSettings {
        depth: Some("/camera/depth".to_owned()),
        ..ros.settings()
    };
    let mut camera = subscribe(&ros.settings(), PATIENCE_S).unwrap();
    camera.shoot().unwrap();
    let why = subscribe(&aside, 2.0).unwrap().shoot().unwrap_err();
    assert_eq!(
        why,
        "nothing came on `/camera/depth` within 2 s: is the camera's driver started?"
    );
    ros.kill_node();
    let mut camera = subscribe(&ros.settings(), 1.0).unwrap();
    let error = camera.shoot().unwrap_err();
    assert_eq!(
        error,
        "nothing came on `/camera/color/image_raw` within 1 s: is \
         the camera's driver started?"
    );
    let none = RosSettings {
        color: None,
        ..ros.settings()
    };
    let refused = subscribe(&none, 1.0).err().unwrap().to_string();
    assert_eq!(
        refused,
        "`[ros]` does not name the topics `color`, `depth` and `info`"
    );
}
