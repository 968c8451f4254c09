//! A camera whose pictures arrive as messages: colour, aligned depth and intrinsics, each on a topic of its own.
//!
//! In: messages, from whatever brings them (an [`Inbox`]). Out: pictures that were taken after the request,
//! judged by the camera's own stamps. These are compared with this machine's clock, so a camera whose machine has
//! another time is refused with an explanation.

use super::{RgbdSource, Shot, picture};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

const POLL: Duration = Duration::from_millis(5);

/// How far the stamps of colour and depth may be apart. Nothing moves while a picture is taken.
const PAIR_NS: u64 = 50_000_000;

/// How far a stamp may be ahead of this machine's clock.
const AHEAD_NS: i64 = 50_000_000;

/// The pictures of a kind that are kept: they arrive in any order.
const MAX_KEPT: usize = 8;

/// A picture in a message (`sensor_msgs/Image`); nothing in it has been checked.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// When it was taken, nanoseconds since 1970 on the camera's clock.
    pub stamp_ns: i64,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The name of the pixels' format, e.g. `rgb8`.
    pub encoding: String,
    /// Whether numbers of more than one byte begin with their highest byte.
    pub is_bigendian: bool,
    /// Bytes in a row.
    pub step: u32,
    /// The rows, one after the other.
    pub data: Vec<u8>,
}

/// A camera's projection in a message (`sensor_msgs/CameraInfo`); nothing in it has been checked.
#[derive(Clone, Debug, Default)]
pub struct CameraInfo {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The name of the distortion model.
    pub distortion_model: String,
    /// Its coefficients.
    pub d: Vec<f64>,
    /// The camera's matrix, row by row, pixels; all 0 if the camera was never calibrated.
    pub k: [f64; 9],
    /// Pixels that were joined to one, across and down; 0 means 1.
    pub binning: [u32; 2],
    /// Where the picture begins in the full one, pixels.
    pub offset_px: [u32; 2],
}

/// The names of a camera's topics.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CameraTopics {
    /// The colour picture.
    pub color: String,
    /// The depth picture, aligned with it.
    pub depth: String,
    /// The projection.
    pub info: String,
}

/// Where messages of the camera's topics are put.
#[derive(Clone, Default)]
pub struct Inbox(Arc<Mutex<Arrived>>);

/// The last messages.
#[derive(Default)]
struct Arrived {
    colors: Pictures,
    depths: Pictures,
    info: Option<CameraInfo>,
}

/// The last pictures of one topic, the newest first.
#[derive(Default)]
struct Pictures {
    kept: VecDeque<Image>,
    /// The newest stamp, also of a picture from a clock that is ahead, which is not kept.
    newest_ns: Option<i64>,
}

impl Inbox {
    /// Takes a colour picture.
    pub fn color(&self, image: Image) {
        self.lock().colors.keep(image);
    }

    /// Takes a depth picture.
    pub fn depth(&self, image: Image) {
        self.lock().depths.keep(image);
    }

    /// Takes a projection.
    pub fn info(&self, info: CameraInfo) {
        self.lock().info = Some(info);
    }

    fn lock(&self) -> MutexGuard<'_, Arrived> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Pictures {
    fn keep(&mut self, image: Image) {
        self.newest_ns = Some(image.stamp_ns);
        if image.stamp_ns <= now_ns().saturating_add(AHEAD_NS) {
            self.kept.truncate(MAX_KEPT - 1);
            self.kept.push_front(image);
        }
    }

    fn since(&self, begun_ns: i64) -> impl Iterator<Item = &Image> {
        let pictures = self.kept.iter();
        pictures.filter(move |image| image.stamp_ns >= begun_ns)
    }
}

impl Arrived {
    /// Returns a colour picture since a time with the depth nearest to it.
    fn pair(&self, begun_ns: i64) -> Option<(Image, Image)> {
        let mut colors = self.colors.since(begun_ns);
        colors.find_map(|color| {
            let apart_ns = |depth: &&Image| depth.stamp_ns.abs_diff(color.stamp_ns);
            let nearest = self.depths.since(begun_ns).min_by_key(apart_ns)?;
            let is_near = apart_ns(&nearest) <= PAIR_NS;
            is_near.then(|| (color.clone(), nearest.clone()))
        })
    }
}

fn now_ns() -> i64 {
    let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH);
    i64::try_from(since_epoch.unwrap_or_default().as_nanos()).unwrap_or(i64::MAX / 2)
}

/// A camera behind topics.
///
/// - `L`: what keeps the subscriptions alive.
pub struct TopicCamera<L> {
    topics: CameraTopics,
    timeout: Duration,
    inbox: Inbox,
    _link: L,
}

impl<L> TopicCamera<L> {
    /// Makes a camera from an inbox that messages are already put into; each picture takes at most `timeout`.
    pub fn new(topics: CameraTopics, timeout: Duration, inbox: Inbox, link: L) -> TopicCamera<L> {
        TopicCamera {
            topics,
            timeout,
            inbox,
            _link: link,
        }
    }

    /// Explains why no picture came in time.
    fn missing(&self, arrived: &Arrived, begun_ns: i64) -> String {
        let CameraTopics { color, depth, info } = &self.topics;
        for (topic, pictures) in [(color, &arrived.colors), (depth, &arrived.depths)] {
            if pictures.since(begun_ns).next().is_some() {
                continue;
            }
            if let Some(newest_ns) = pictures.newest_ns {
                let by_s = newest_ns.saturating_sub(begun_ns) as f64 / 1e9;
                return format!(
                    "the newest picture of `{topic}` is stamped {by_s:+.2} s from the request: is the camera's driver \
                     running, and do the clocks of both machines agree?"
                );
            }
            return self.nothing(topic);
        }
        if arrived.info.is_none() {
            return self.nothing(info);
        }
        format!(
            "no colour and depth were stamped within {} ms of each other",
            PAIR_NS / 1_000_000
        )
    }

    fn nothing(&self, topic: &str) -> String {
        let timeout_s = self.timeout.as_secs_f64();
        format!("nothing came on `{topic}` within {timeout_s} s: is the camera's driver started?")
    }
}

impl<L> RgbdSource for TopicCamera<L> {
    fn name(&self) -> String {
        self.topics.color.clone()
    }

    fn shoot(&mut self) -> Result<Shot, String> {
        let deadline = Instant::now() + self.timeout;
        let begun_ns = now_ns();
        let (color, depth, info) = loop {
            let is_last = Instant::now() >= deadline;
            let arrived = self.inbox.lock();
            if let (Some((color, depth)), Some(info)) = (arrived.pair(begun_ns), &arrived.info) {
                break (color, depth, info.clone());
            }
            if is_last {
                return Err(self.missing(&arrived, begun_ns));
            }
            drop(arrived);
            std::thread::sleep(POLL);
        };
        let rgb = picture::color(&color)?;
        let intrinsics = picture::intrinsics(&info, [rgb.width(), rgb.height()])?;
        Shot::aligned(rgb, Some(picture::depth(&depth)?), intrinsics)
    }
}

#[cfg(test)]
mod tests;
