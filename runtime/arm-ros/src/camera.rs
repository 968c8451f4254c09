//! A camera behind ROS: colour, aligned depth and intrinsics, from three topics.
//!
//! In: topics. Out: their messages, in the inbox of a [`TopicCamera`], which judges them.

use super::RosError;
use super::link::Link;
use super::messages::sensor_msgs;
use fab_arm::rgbd::topics::{CameraInfo, CameraTopics, Image, Inbox, TopicCamera};
use fab_arm::settings::RosSettings;
use roslibrust::RosMessageType;
use roslibrust::ros1::{NodeError, NodeHandle};
use std::time::Duration;

/// Subscribes to the camera's topics of the settings; whether anything is published shows with the first picture.
///
/// Registering, and each picture later, takes at most `timeout_s` seconds.
pub fn subscribe(
    settings: &RosSettings,
    timeout_s: f64,
) -> Result<TopicCamera<impl Send + use<>>, RosError> {
    let timeout = Duration::from_secs_f64(timeout_s);
    let RosSettings {
        color: Some(color),
        depth: Some(depth),
        info: Some(info),
        ..
    } = settings.clone()
    else {
        return Err(RosError::Setting(
            "`[ros]` does not name the topics `color`, `depth` and `info`".to_owned(),
        ));
    };
    let topics = CameraTopics { color, depth, info };
    let link = Link::open(settings, "camera", timeout)?;
    let inbox = Inbox::default();
    let (node, names, into) = (link.node(), topics.clone(), inbox.clone());
    let registered = link.run(timeout, async move {
        let colors = into.clone();
        follow(&node, &names.color, move |message| {
            colors.color(image(message))
        })
        .await?;
        let depths = into.clone();
        follow(&node, &names.depth, move |message| {
            depths.depth(image(message))
        })
        .await?;
        follow(&node, &names.info, move |message| {
            into.info(projection(message))
        })
        .await
    });
    let why = match registered {
        Some(Ok(())) => return Ok(TopicCamera::new(topics, timeout, inbox, link)),
        Some(Err(error)) => error.to_string(),
        None => format!("no answer within {timeout:?}"),
    };
    let what = format!(
        "the camera's topic `{}` could not be registered",
        topics.color
    );
    Err(RosError::Refused { what, why })
}
async fn follow<T: RosMessageType>(
    node: &NodeHandle,
    topic: &str,
    take: impl Fn(T) + Send + 'static,
) -> Result<(), NodeError> {
    // Two, so that a picture is not lost while the previous one is read; more would only be old.
    let mut topic = node.subscribe::<T>(topic, 2).await?;
    tokio::spawn(async move {
        while let Some(message) = topic.next().await {
            if let Ok(message) = message {
                take(message);
            }
        }
    });
    Ok(())
}

fn image(message: sensor_msgs::Image) -> Image {
    let stamp = &message.header.stamp;
    Image {
        // ROS counts seconds unsigned, as in the message's type.
        stamp_ns: i64::from(stamp.secs as u32) * 1_000_000_000 + i64::from(stamp.nsecs as u32),
        width: message.width,
        height: message.height,
        encoding: message.encoding,
        is_bigendian: message.is_bigendian != 0,
        step: message.step,
        data: message.data,
    }
}

fn projection(message: sensor_msgs::CameraInfo) -> CameraInfo {
    let part = &message.roi;
    CameraInfo {
        width: message.width,
        height: message.height,
        distortion_model: message.distortion_model,
        binning: [message.binning_x, message.binning_y],
        offset_px: [part.x_offset, part.y_offset],
        d: message.D,
        k: message.K,
    }
}
