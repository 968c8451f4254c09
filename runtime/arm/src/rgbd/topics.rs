//! A camera whose pictures arrive as messages: colour, aligned depth and intrinsics, each on a topic of its own.
//!
//! In: messages, from whatever brings them (an [`Inbox`]). Out: pictures that were taken after the request,
//! judged by the camera's own stamps. These are compared with this machine's clock, so a camera whose machine has
//! another time is refused with an explanation.

use super::pairs::{PAIR_NS, PairBuffer, Refused, now_ns, store};
use super::{RgbdError, RgbdSource, Shot, picture};
use fab_picture::DepthImage;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

const POLL: Duration = Duration::from_millis(5);

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
pub struct Inbox(Arc<Mutex<PairBuffer>>);

impl Inbox {
    /// Takes a colour picture.
    pub fn color(&self, image: Image) {
        store(&mut self.lock(), image, |buffer| &mut buffer.colors);
    }

    /// Takes a depth picture.
    pub fn depth(&self, image: Image) {
        store(&mut self.lock(), image, |buffer| &mut buffer.depths);
    }

    /// Takes a projection.
    pub fn info(&self, info: CameraInfo) {
        self.lock().info = Some(info);
    }

    fn lock(&self) -> MutexGuard<'_, PairBuffer> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
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
            (Some(&self.topics.color), &buffer.colors),
            (self.topics.depth.as_ref(), &buffer.depths),
        ];
        for (topic, arrived) in topics {
            let Some(topic) = topic else { continue };
            match (arrived.pictures.is_empty(), arrived.refused) {
                (false, _) => {}
                (true, Some(last)) => return refused(topic, last),
                (true, None) => return silent(topic),
            }
        }
        match &self.topics.info {
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

    fn shoot(&mut self) -> Result<Shot, RgbdError> {
        let failed = |why: String| RgbdError {
            camera: self.topics.color.clone(),
            why,
        };
        let deadline = Instant::now() + self.timeout;
        self.inbox.lock().start(now_ns());
        let found = loop {
            let mut buffer = self.inbox.lock();
            let is_last = Instant::now() >= deadline;
            let needs_info = self.topics.info.is_some() && buffer.info.is_none();
            let pair = if needs_info {
                None
            } else {
                buffer.pair(self.topics.depth.is_some(), is_last)
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
        self.inbox.lock().stop();
        let ((color, depth), info) = found.map_err(failed)?;
        self.read(&color, depth.as_ref(), info.as_ref())
            .map_err(failed)
    }
}
