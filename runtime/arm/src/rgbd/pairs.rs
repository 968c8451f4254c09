//! Pairs colour and depth pictures that arrive after a request.
//!
//! In: messages with stamps, in any order. Out: a colour picture with the depth nearest in time; and for rejected
//! pictures, how far their stamps were off.

use super::topics::{CameraInfo, Image};
use std::collections::VecDeque;
use std::time::{SystemTime, UNIX_EPOCH};

/// How far the stamps of colour and depth may be apart.
pub(super) const PAIR_NS: i64 = 50_000_000;

/// How far a stamp may be ahead of this machine's clock.
const AHEAD_NS: i64 = 50_000_000;

/// The most pictures of a kind that wait for their counterpart.
const MAX_PENDING: usize = 8;

/// Pictures that arrived since the request.
#[derive(Default)]
pub(super) struct PairBuffer {
    /// Start of the request, nanoseconds since 1970; `None` without a request.
    requested_at_ns: Option<i64>,
    pub(super) colors: TopicPictures,
    pub(super) depths: TopicPictures,
    pub(super) info: Option<CameraInfo>,
}

/// The pictures of one topic.
#[derive(Default)]
pub(super) struct TopicPictures {
    pub(super) pictures: VecDeque<(i64, Image)>,
    /// By how much the last rejected stamp was too old or too far ahead.
    pub(super) refused: Option<Refused>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Refused {
    Old { by_ns: i64 },
    Ahead { by_ns: i64 },
}

impl PairBuffer {
    /// Starts collecting pictures that were taken since `from_ns`.
    pub(super) fn start(&mut self, from_ns: i64) {
        self.requested_at_ns = Some(from_ns);
        (self.colors, self.depths) = (TopicPictures::default(), TopicPictures::default());
    }

    /// Stops collecting; the intrinsics stay, because some cameras publish them only once.
    pub(super) fn stop(&mut self) {
        self.requested_at_ns = None;
        (self.colors, self.depths) = (TopicPictures::default(), TopicPictures::default());
    }

    /// Removes and returns a colour picture with the depth nearest in time.
    ///
    /// The nearest depth is certain once a later one has arrived, or if `is_last` says that the wait is over.
    pub(super) fn pair(
        &mut self,
        needs_depth: bool,
        is_last: bool,
    ) -> Option<(Image, Option<Image>)> {
        if !needs_depth {
            return self
                .colors
                .pictures
                .pop_front()
                .map(|(_, color)| (color, None));
        }
        let depths = &self.depths.pictures;
        let newest_ns = depths.iter().map(|(stamp_ns, _)| *stamp_ns).max()?;
        let (color, depth) =
            self.colors
                .pictures
                .iter()
                .enumerate()
                .find_map(|(color, (color_ns, _))| {
                    let apart = |depth_ns: i64| depth_ns.abs_diff(*color_ns);
                    let (depth, (depth_ns, _)) = depths
                        .iter()
                        .enumerate()
                        .min_by_key(|(_, (depth_ns, _))| apart(*depth_ns))?;
                    let is_certain = is_last || newest_ns >= *color_ns;
                    (is_certain && apart(*depth_ns) <= PAIR_NS.unsigned_abs())
                        .then_some((color, depth))
                })?;
        let (_, color) = self.colors.pictures.remove(color)?;
        let (_, depth) = self.depths.pictures.remove(depth)?;
        Some((color, Some(depth)))
    }
}

/// Stores a picture if one is requested and it was taken since.
pub(super) fn store(
    buffer: &mut PairBuffer,
    image: Image,
    place: fn(&mut PairBuffer) -> &mut TopicPictures,
) {
    let Some(from_ns) = buffer.requested_at_ns else {
        return;
    };
    let (stamp_ns, now_ns) = (image.stamp_ns, now_ns());
    let arrived = place(buffer);
    if stamp_ns < from_ns {
        arrived.refused = Some(Refused::Old {
            by_ns: from_ns - stamp_ns,
        });
    } else if stamp_ns > now_ns + AHEAD_NS {
        arrived.refused = Some(Refused::Ahead {
            by_ns: stamp_ns - now_ns,
        });
    } else {
        if arrived.pictures.len() == MAX_PENDING {
            arrived.pictures.pop_front();
        }
        arrived.pictures.push_back((stamp_ns, image));
    }
}

pub(super) fn now_ns() -> i64 {
    let since_epoch = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    i64::try_from(since_epoch.as_nanos()).unwrap_or(i64::MAX / 2)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use proptest::prelude::*;

    const MS: i64 = 1_000_000;

    fn image(mark: i64) -> Image {
        Image {
            width: mark as u32,
            ..Image::default()
        }
    }

    fn buffer(colors_ms: &[i64], depths_ms: &[i64]) -> PairBuffer {
        let arrived = |stamps: &[i64]| TopicPictures {
            pictures: stamps
                .iter()
                .map(|stamp| (stamp * MS, image(*stamp)))
                .collect(),
            refused: None,
        };
        PairBuffer {
            colors: arrived(colors_ms),
            depths: arrived(depths_ms),
            ..PairBuffer::default()
        }
    }

    /// Returns the stamps of the pair found, milliseconds.
    fn pair(colors_ms: &[i64], depths_ms: &[i64], is_last: bool) -> Option<(u32, u32)> {
        let (color, depth) = buffer(colors_ms, depths_ms).pair(true, is_last)?;
        Some((color.width, depth.unwrap().width))
    }

    #[test]
    fn colour_waits_for_the_depth_that_is_nearest() {
        assert_eq!(pair(&[100], &[100], false), Some((100, 100)));
        assert_eq!(pair(&[100], &[80], false), None);
        assert_eq!(pair(&[100], &[80], true), Some((100, 80)));
        assert_eq!(pair(&[100], &[80, 110], false), Some((100, 110)));
        assert_eq!(pair(&[100], &[40, 160], true), None);
        assert_eq!(pair(&[100, 133], &[150], false), Some((100, 150)));
        assert_eq!(pair(&[90, 133], &[150], false), Some((133, 150)));
        assert_eq!(pair(&[], &[150], true), None);
        assert_eq!(pair(&[150], &[], true), None);
    }

    #[test]
    fn only_pictures_that_were_taken_since_are_kept() {
        let mut buffer = PairBuffer::default();
        let shift = |by_ms: i64| Image {
            stamp_ns: now_ns() + by_ms * MS,
            ..image(by_ms)
        };
        store(&mut buffer, shift(0), |buffer| &mut buffer.colors);
        assert!(buffer.colors.pictures.is_empty() && buffer.colors.refused.is_none());
        buffer.start(now_ns());
        store(&mut buffer, shift(-200), |buffer| &mut buffer.colors);
        assert!(matches!(buffer.colors.refused, Some(Refused::Old { by_ns }) if by_ns >= 199 * MS));
        store(&mut buffer, shift(500), |buffer| &mut buffer.colors);
        assert!(
            matches!(buffer.colors.refused, Some(Refused::Ahead { by_ns }) if by_ns >= 400 * MS)
        );
        store(&mut buffer, shift(0), |buffer| &mut buffer.colors);
        assert_eq!(buffer.colors.pictures.len(), 1);
    }

    proptest! {
        /// A pair is never farther apart than allowed, and no other depth would have been closer.
        #[test]
        fn a_pair_is_the_nearest_there_is(
            colors in prop::collection::vec(0_i64..400, 0..6),
            depths in prop::collection::vec(0_i64..400, 0..6),
            is_last: bool,
        ) {
            if let Some((color, depth)) = pair(&colors, &depths, is_last) {
                let apart = |depth: i64| (i64::from(color) - depth).abs();
                prop_assert!(apart(i64::from(depth)) <= 50);
                prop_assert!(depths.iter().all(|other| apart(*other) >= apart(i64::from(depth))));
            }
        }
    }
}
