//! A camera behind ROS 2: colour, aligned depth and intrinsics, from three topics.
//!
//! In: topics. Out: their messages, in the inbox of a [`TopicCamera`], which judges them.

use super::Ros2Error;
use super::link::{Link, Quality, topic_name};
use super::messages::{CameraInfo, Image, Message};
use fab_arm::rgbd::topics::{self, CameraTopics, Inbox, TopicCamera};
use fab_arm::settings::Ros2Settings;
use serde::de::DeserializeOwned;
use std::time::Duration;

/// Subscribes to the camera's topics of the settings; whether anything is published shows with the first picture.
///
/// Each picture takes at most `timeout_s` seconds.
pub fn subscribe(
    settings: &Ros2Settings,
    timeout_s: f64,
) -> Result<TopicCamera<impl Send + use<>>, Ros2Error> {
    let Ros2Settings {
        color: Some(color),
        depth: Some(depth),
        info: Some(info),
        ..
    } = settings.clone()
    else {
        return Err(Ros2Error::Setting(
            "`[ros2]` does not name the topics `color`, `depth` and `info`".to_owned(),
        ));
    };
    let names = CameraTopics { color, depth, info };
    let (link, inbox) = (Link::open(settings)?, Inbox::default());
    let colors = inbox.clone();
    follow(&link, &names.color, move |message| {
        colors.color(image(message));
    })?;
    let depths = inbox.clone();
    follow(&link, &names.depth, move |message| {
        depths.depth(image(message));
    })?;
    let infos = inbox.clone();
    follow(&link, &names.info, move |message| {
        infos.info(projection(message));
    })?;
    Ok(TopicCamera::new(
        names,
        Duration::from_secs_f64(timeout_s),
        inbox,
        link,
    ))
}

fn follow<T: Message + DeserializeOwned + Send + 'static>(
    link: &Link,
    topic: &str,
    take: impl Fn(T) + Send + 'static,
) -> Result<(), Ros2Error> {
    link.listen::<T>(&topic_name(topic), T::TYPE, Quality::Sensor, move |heard| {
        // A picture that cannot be read is one that did not come; the camera says so when it waited in vain.
        if let Ok((message, _)) = heard {
            take(message);
        }
    })
}

fn image(message: Image) -> topics::Image {
    topics::Image {
        stamp_ns: message.header.stamp.nanoseconds(),
        width: message.width,
        height: message.height,
        encoding: message.encoding,
        is_bigendian: message.is_bigendian != 0,
        step: message.step,
        data: message.data.into_vec(),
    }
}

fn projection(message: CameraInfo) -> topics::CameraInfo {
    topics::CameraInfo {
        width: message.width,
        height: message.height,
        distortion_model: message.distortion_model,
        d: message.d,
        k: message.k,
        binning: [message.binning_x, message.binning_y],
        offset_px: [message.roi.x_offset, message.roi.y_offset],
    }
}
