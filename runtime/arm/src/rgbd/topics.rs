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

/// The most pictures of a kind that wait for their counterpart.
const MAX_PENDING: usize = 8;

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
    /// The depth picture, aligned with it. Without one the depth is 0 everywhere, which means no reading.
    pub depth: Option<String>,
    /// The projection; unknown without one.
    pub info: Option<String>,
}

/// Where messages of the camera's topics are put.
#[derive(Clone, Default)]
pub struct Inbox(Arc<Mutex<Arrived>>);

/// What arrived since the request.
#[derive(Default)]
struct Arrived {
    /// The time of the request, nanoseconds since 1970; `None` without one.
    from_ns: Option<i64>,
    colors: Pictures,
    depths: Pictures,
    /// It outlives a request, because some cameras publish it only once.
    info: Option<CameraInfo>,
}

/// The pictures of one topic.
#[derive(Default)]
struct Pictures {
    pending: VecDeque<Image>,
    /// How far the last refused stamp was from the request: before it (negative), or ahead of the clock.
    off_ns: Option<i64>,
}

impl Inbox {
    /// Takes a colour picture.
    pub fn color(&self, image: Image) {
        let mut arrived = self.lock();
        let from_ns = arrived.from_ns;
        arrived.colors.take(image, from_ns);
    }

    /// Takes a depth picture.
    pub fn depth(&self, image: Image) {
        let mut arrived = self.lock();
        let from_ns = arrived.from_ns;
        arrived.depths.take(image, from_ns);
    }

    /// Takes a projection.
    pub fn info(&self, info: CameraInfo) {
        self.lock().info = Some(info);
    }

    /// Forgets earlier pictures, and takes those from now on; or none, without a request.
    fn request(&self, from_ns: Option<i64>) {
        let mut arrived = self.lock();
        arrived.from_ns = from_ns;
        (arrived.colors, arrived.depths) = Default::default();
    }

    fn lock(&self) -> MutexGuard<'_, Arrived> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Pictures {
    /// Keeps a picture that was taken since the request.
    fn take(&mut self, image: Image, from_ns: Option<i64>) {
        let Some(from_ns) = from_ns else {
            return;
        };
        let before_ns = image.stamp_ns.saturating_sub(from_ns);
        let ahead_ns = image.stamp_ns.saturating_sub(now_ns());
        if before_ns < 0 || ahead_ns > AHEAD_NS {
            self.off_ns = Some(before_ns.min(ahead_ns));
            return;
        }
        self.pending.truncate(MAX_PENDING - 1);
        self.pending.push_front(image);
    }
}

impl Arrived {
    /// Returns a colour picture with the depth nearest in time, or with none if none is needed.
    fn pair(&self, needs_depth: bool) -> Option<(Image, Option<Image>)> {
        let mut colors = self.colors.pending.iter();
        if !needs_depth {
            return colors.next().map(|color| (color.clone(), None));
        }
        colors.find_map(|color| {
            let apart_ns = |depth: &&Image| depth.stamp_ns.abs_diff(color.stamp_ns);
            let nearest = self.depths.pending.iter().min_by_key(apart_ns)?;
            let is_near = apart_ns(&nearest) <= PAIR_NS;
            is_near.then(|| (color.clone(), Some(nearest.clone())))
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
    fn missing(&self, arrived: &Arrived) -> String {
        let CameraTopics { color, depth, info } = &self.topics;
        let nothing = |topic: &String| {
            let timeout_s = self.timeout.as_secs_f64();
            format!(
                "nothing came on `{topic}` within {timeout_s} s: is the camera's driver started?"
            )
        };
        for (topic, pictures) in [
            (Some(color), &arrived.colors),
            (depth.as_ref(), &arrived.depths),
        ] {
            let Some(topic) = topic.filter(|_| pictures.pending.is_empty()) else {
                continue;
            };
            let Some(off_ns) = pictures.off_ns else {
                return nothing(topic);
            };
            let by_s = off_ns as f64 / 1e9;
            return format!(
                "`{topic}` is stamped {by_s:+.2} s from the request: do the clocks of both machines agree?"
            );
        }
        match info {
            Some(topic) if arrived.info.is_none() => nothing(topic),
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
        let depth_m = depth.map(picture::depth).transpose()?;
        let intrinsics = info
            .map(|info| picture::intrinsics(info, size_px))
            .transpose()?
            .flatten();
        Shot::aligned(rgb, depth_m, intrinsics)
    }
}

impl<L> RgbdSource for TopicCamera<L> {
    fn name(&self) -> String {
        self.topics.color.clone()
    }

    fn shoot(&mut self) -> Result<Shot, String> {
        let deadline = Instant::now() + self.timeout;
        self.inbox.request(Some(now_ns()));
        let found = loop {
            let is_last = Instant::now() >= deadline;
            let arrived = self.inbox.lock();
            let needs_info = self.topics.info.is_some() && arrived.info.is_none();
            let pair = arrived.pair(self.topics.depth.is_some());
            match pair.filter(|_| !needs_info) {
                Some(pair) => break Ok((pair, arrived.info.clone())),
                None if is_last => break Err(self.missing(&arrived)),
                None => {}
            }
            drop(arrived);
            std::thread::sleep(POLL);
        };
        self.inbox.request(None);
        let ((color, depth), info) = found?;
        self.read(&color, depth.as_ref(), info.as_ref())
    }
}

#[cfg(test)]
mod tests;
