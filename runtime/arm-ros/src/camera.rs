//! A camera behind ROS: colour, aligned depth and intrinsics, from three topics.
//!
//! In: topics. Out: pictures that were taken after the request, judged by the camera's own stamps. These are compared
//! with this machine's clock, so a camera whose machine has another time is refused with an explanation.

use super::RosError;
use super::link::{Link, bounded_wait};
use super::messages::sensor_msgs::{CameraInfo, Image};
use super::pairs::{PAIR_NS, PairBuffer, Refused, now_ns, store};
use super::picture;
use fab_arm::rgbd::{RgbdError, RgbdSource, Shot};
use fab_arm::settings::RosSettings;
use fab_picture::DepthImage;
use roslibrust::RosMessageType;
use roslibrust::ros1::{NodeError, NodeHandle};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

const POLL: Duration = Duration::from_millis(5);

/// A camera's topics.
pub struct RosCamera {
    color: String,
    depth: Option<String>,
    info: Option<String>,
    timeout: Duration,
    buffer: Arc<Mutex<PairBuffer>>,
    /// Dropped last, because the subscriptions live on its threads.
    _link: Link,
}

impl RosCamera {
    /// Subscribes to the topics of the settings; whether anything is published shows with the first picture.
    ///
    /// Registering, and each picture later, takes at most `timeout_s` seconds. Without a depth topic the depth is 0
    /// everywhere, which means no reading; without an info topic the projection is unknown.
    pub fn subscribe(settings: &RosSettings, timeout_s: f64) -> Result<RosCamera, RosError> {
        let timeout = bounded_wait(timeout_s);
        let Some(color) = settings.color.clone() else {
            return Err(RosError::Setting(
                "`[ros]` names no topic `color`".to_owned(),
            ));
        };
        let link = Link::open(settings, "camera", timeout)?;
        let buffer = Arc::new(Mutex::new(PairBuffer::default()));
        let camera = RosCamera {
            color,
            depth: settings.depth.clone(),
            info: settings.info.clone(),
            timeout,
            buffer: Arc::clone(&buffer),
            _link: link,
        };
        let (node, topics) = (camera._link.node(), [camera.color.clone()]);
        let (depth, info) = (camera.depth.clone(), camera.info.clone());
        let registered = camera._link.run(timeout, async move {
            let [color] = topics;
            follow(&node, &color, &buffer, |buffer, image| {
                store(buffer, image, |buffer| &mut buffer.colors)
            })
            .await?;
            if let Some(depth) = depth {
                follow(&node, &depth, &buffer, |buffer, image| {
                    store(buffer, image, |buffer| &mut buffer.depths)
                })
                .await?;
            }
            if let Some(info) = info {
                follow(&node, &info, &buffer, |buffer, info| {
                    buffer.info = Some(info)
                })
                .await?;
            }
            Ok::<(), NodeError>(())
        });
        let why = match registered {
            Some(Ok(())) => return Ok(camera),
            Some(Err(error)) => error.to_string(),
            None => format!("no answer within {timeout:?}"),
        };
        let what = format!(
            "the camera's topic `{}` could not be registered",
            camera.color
        );
        Err(RosError::Refused { what, why })
    }

    /// Explains why no picture came in time.
    fn missing(&self, buffer: &PairBuffer) -> String {
        let seconds = self.timeout.as_secs_f64();
        let silent = |topic: &str| {
            format!("nothing came on `{topic}` within {seconds} s: is the camera's driver started?")
        };
        let refused = |topic: &str, refused: Refused| {
            let (by_ns, side) = match refused {
                Refused::Old { by_ns } => (by_ns, "before the picture was requested"),
                Refused::Ahead { by_ns } => (by_ns, "in the future"),
            };
            let by_s = by_ns as f64 / 1e9;
            format!(
                "`{topic}` is stamped {by_s:.2} s {side}: do the clocks of both machines agree?"
            )
        };
        let topics = [
            (Some(&self.color), &buffer.colors),
            (self.depth.as_ref(), &buffer.depths),
        ];
        for (topic, arrived) in topics {
            let Some(topic) = topic else { continue };
            match (arrived.pictures.is_empty(), arrived.refused) {
                (false, _) => {}
                (true, Some(last)) => return refused(topic, last),
                (true, None) => return silent(topic),
            }
        }
        match &self.info {
            Some(topic) if buffer.info.is_none() => silent(topic),
            _ => format!(
                "no colour and depth were stamped within {} ms of each other",
                PAIR_NS / 1_000_000
            ),
        }
    }

    fn read(
        &self,
        color: &Image,
        depth: Option<&Image>,
        info: Option<&CameraInfo>,
    ) -> Result<Shot, String> {
        let rgb = picture::color(color)?;
        let size_px = [rgb.width(), rgb.height()];
        let depth_m = match depth {
            Some(depth) => picture::depth(depth)?,
            None => DepthImage::new(rgb.width(), rgb.height()),
        };
        if depth_m.dimensions() != rgb.dimensions() {
            let found = [depth_m.width(), depth_m.height()];
            return Err(format!(
                "its depth has {found:?} pixels and its colour {size_px:?}: use the topic of the depth that is aligned with the colour"
            ));
        }
        let intrinsics = info
            .map(|info| picture::intrinsics(info, size_px))
            .transpose()?
            .flatten();
        Ok(Shot {
            rgb,
            depth_m,
            intrinsics,
        })
    }
}

impl RgbdSource for RosCamera {
    fn name(&self) -> String {
        self.color.clone()
    }

    fn shoot(&mut self) -> Result<Shot, RgbdError> {
        let failed = |why: String| RgbdError {
            camera: self.color.clone(),
            why,
        };
        let deadline = Instant::now() + self.timeout;
        lock(&self.buffer).start(now_ns());
        let found = loop {
            let mut buffer = lock(&self.buffer);
            let is_last = Instant::now() >= deadline;
            let needs_info = self.info.is_some() && buffer.info.is_none();
            let pair = if needs_info {
                None
            } else {
                buffer.pair(self.depth.is_some(), is_last)
            };
            if let Some(pair) = pair {
                break Ok((pair, buffer.info.clone()));
            }
            if is_last {
                break Err(self.missing(&buffer));
            }
            drop(buffer);
            std::thread::sleep(POLL);
        };
        lock(&self.buffer).stop();
        let ((color, depth), info) = found.map_err(failed)?;
        self.read(&color, depth.as_ref(), info.as_ref())
            .map_err(failed)
    }
}

async fn follow<T: RosMessageType>(
    node: &NodeHandle,
    topic: &str,
    buffer: &Arc<Mutex<PairBuffer>>,
    take: impl Fn(&mut PairBuffer, T) + Send + 'static,
) -> Result<(), NodeError> {
    // Two, so that a picture is not lost while the previous one is read; more would only be old.
    let mut topic = node.subscribe::<T>(topic, 2).await?;
    let buffer = Arc::clone(buffer);
    tokio::spawn(async move {
        while let Some(message) = topic.next().await {
            if let Ok(message) = message {
                take(&mut lock(&buffer), message);
            }
        }
    });
    Ok(())
}

fn lock(buffer: &Mutex<PairBuffer>) -> MutexGuard<'_, PairBuffer> {
    buffer.lock().unwrap_or_else(PoisonError::into_inner)
}
