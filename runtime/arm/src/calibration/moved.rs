//! Detects whether the camera was moved since its calibration.
//!
//! In: a calibration with its reference picture, and a new shot. Out: [`Moved`]. Marks of the reference are matched in
//! the new picture. Cloth and arm hide or move some of them, so the motion that most marks share decides.

use super::Calibration;
use crate::rgbd::{Intrinsics, Shot};
use crate::sight::Sight;
use fab_picture::MovedMark;
use image::GrayImage;
use image::imageops::{self, FilterType};

/// The result of a camera check.
#[derive(Clone, Debug, PartialEq)]
pub enum Moved {
    /// The camera is in its old place, as far as can be seen.
    No {
        /// Apparent displacement of the window's corners, pixels of the camera's own picture.
        by_px: f64,
        /// How many marks of the reference agree.
        n_marks: usize,
    },
    /// It was moved.
    ByPx {
        /// Displacement of the farthest of the window's corners, pixels of the camera's own picture.
        by_px: f64,
        /// Rotation of the picture, degrees; clockwise is positive.
        turn_deg: f64,
        /// How many marks of the reference agree.
        n_marks: usize,
    },
    /// Its pictures differ in kind from those it was calibrated with.
    Changed {
        /// What is different.
        what: String,
    },
    /// The check is inconclusive.
    Unsure {
        /// Why not, and what would help.
        why: String,
    },
}

/// The largest apparent displacement of a window's corner, pixels of a picture 640 px wide: about 2 mm at a metre.
const STILL_PX: f64 = 1.5;
/// Approximate width at which pictures are compared.
const COMPARED_PX: u32 = 640;
/// Marks share a motion that predicts their found positions to within this, pixels.
const SHARED_PX: f64 = 1.0;
/// The fewest marks that a reference needs.
const FEW: usize = 12;
/// The fewest marks that must share a motion.
const AGREEING: usize = 8;
/// The smallest share of all marks that must do so.
const AGREEING_SHARE: f64 = 0.2;
/// They must be spread over this share of the picture, or a rotation would go unnoticed.
const APART: f64 = 0.3;

impl Calibration {
    /// Compares a new picture with the one that the calibration was made with.
    pub fn moved(&self, shot: &Shot, sight: &Sight) -> Moved {
        let found = [shot.rgb.width(), shot.rgb.height()];
        let [width, height] = self.terms.size_px;
        if found != self.terms.size_px {
            let what = format!(
                "its pictures have {} x {} px, and had {width} x {height}",
                found[0], found[1]
            );
            return Moved::Changed { what };
        }
        if let (Some(then), Some(now)) = (&self.terms.intrinsics, &shot.intrinsics)
            && let Some(what) = change(then, now)
        {
            return Moved::Changed { what };
        }
        let Some(reference) = &self.reference else {
            return Moved::Unsure {
                why: "the calibration has no picture to compare with; calibrate with `--image PNG`"
                    .to_owned(),
            };
        };
        let compared = self.compare(reference, &imageops::grayscale(&shot.rgb), sight);
        compared.unwrap_or_else(|why| Moved::Unsure { why })
    }

    /// Returns how many marks the reference has for detecting a moved camera, and how many it needs.
    pub fn marks(&self, sight: &Sight) -> [usize; 2] {
        let n = self.reference.as_ref().map_or(0, |reference| {
            (sight.marks)(&reduced(reference, factor(reference))).map_or(0, |marks| marks.len())
        });
        [n, FEW]
    }

    fn compare(
        &self,
        reference: &GrayImage,
        now: &GrayImage,
        sight: &Sight,
    ) -> Result<Moved, String> {
        let times = factor(reference);
        let (reference, now) = (reduced(reference, times), reduced(now, times));
        let known = (sight.marks)(&reference)?;
        let n_known = known.len();
        if n_known < FEW {
            return Ok(Moved::Unsure {
                why: format!(
                    "the calibration's picture shows {n_known} places that can be found again, and {FEW} are needed: \
                     stick a few pieces of printed paper beside the cloth's place and calibrate anew"
                ),
            });
        }
        let found = (sight.find_again)(&reference, &known, &now)?;
        let Some((motion, agreeing)) = shared(&found) else {
            return Ok(unsure(0, n_known));
        };
        let n_marks = agreeing.len();
        let is_enough = n_marks >= AGREEING && n_marks as f64 >= AGREEING_SHARE * n_known as f64;
        if !is_enough {
            return Ok(unsure(n_marks, n_known));
        }
        let extent = |axis: usize| {
            let along = || agreeing.iter().map(|found| found.at_px[axis]);
            along().fold(0.0, f64::max) - along().fold(f64::INFINITY, f64::min)
        };
        let size = [reference.width(), reference.height()].map(f64::from);
        if extent(0) < APART * size[0] || extent(1) < APART * size[1] {
            return Ok(Moved::Unsure {
                why: format!(
                    "the {n_marks} places that are found again lie close together; clear more of the table"
                ),
            });
        }
        let scale = f64::from(times);
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let by = corners.map(|share| {
            let corner = self.terms.window.pixel_at(share).map(|it| it / scale);
            let [u, v] = motion.apply(corner);
            (u - corner[0]).hypot(v - corner[1])
        });
        let by_px = by.into_iter().fold(0.0, f64::max);
        Ok(match by_px <= STILL_PX {
            true => Moved::No {
                by_px: by_px * scale,
                n_marks,
            },
            false => Moved::ByPx {
                by_px: by_px * scale,
                turn_deg: motion.turn().to_degrees(),
                n_marks,
            },
        })
    }
}

fn unsure(n_marks: usize, n_known: usize) -> Moved {
    Moved::Unsure {
        why: format!(
            "of {n_known} places of the calibration's picture {n_marks} are found again: the camera was moved far, or \
             too much of the table is covered or lit otherwise"
        ),
    }
}

/// Describes the difference between intrinsics; `None` if they are equal except for rounding.
pub(super) fn change(then: &Intrinsics, now: &Intrinsics) -> Option<String> {
    let differ = |then: &[f64], now: &[f64], by: f64| {
        let coefficient = |of: &[f64], index: usize| of.get(index).copied().unwrap_or(0.0);
        let n = then.len().max(now.len());
        let is_near = |index| (coefficient(then, index) - coefficient(now, index)).abs() <= by;
        !(0..n).all(is_near)
    };
    let words = |what: &str, then: &[f64], now: &[f64]| {
        Some(format!("its {what} is {now:?}, and was {then:?}"))
    };
    if then.size_px != now.size_px {
        let (then, now) = (then.size_px, now.size_px);
        return Some(format!(
            "its intrinsics are for {now:?} px, and were for {then:?}"
        ));
    }
    if differ(&then.focal_px, &now.focal_px, then.focal_px[0].abs() * 1e-3) {
        return words("focal length", &then.focal_px, &now.focal_px);
    }
    if differ(&then.middle_px, &now.middle_px, 0.5) {
        return words("middle", &then.middle_px, &now.middle_px);
    }
    match differ(&then.distortion, &now.distortion, 1e-3) {
        true => words("distortion", &then.distortion, &now.distortion),
        false => None,
    }
}

/// Returns how many pixels of a picture are merged into one for comparison.
fn factor(picture: &GrayImage) -> u32 {
    let longest = picture.width().max(picture.height());
    ((longest + COMPARED_PX / 2) / COMPARED_PX).max(1)
}

fn reduced(picture: &GrayImage, times: u32) -> GrayImage {
    let (width, height) = picture.dimensions();
    match times {
        1 => picture.clone(),
        _ => imageops::resize(
            picture,
            (width / times).max(1),
            (height / times).max(1),
            FilterType::Triangle,
        ),
    }
}

/// A rotation, scaling and shift of a picture: `(u, v)` to `(a u - b v + c, b u + a v + d)`.
#[derive(Clone, Copy)]
struct Motion {
    a: f64,
    b: f64,
    shift: [f64; 2],
}

impl Motion {
    /// Finds the least-squares motion; `None` if all positions coincide.
    fn of(found: &[MovedMark]) -> Option<Motion> {
        let n = found.len() as f64;
        let mean = |of: fn(&MovedMark) -> [f64; 2]| {
            let sum = found
                .iter()
                .map(of)
                .fold([0.0; 2], |sum, it| [sum[0] + it[0], sum[1] + it[1]]);
            sum.map(|sum| sum / n)
        };
        let to = |it: &MovedMark| [it.at_px[0] + it.moved_px[0], it.at_px[1] + it.moved_px[1]];
        let (from_mean, to_mean) = (mean(|it| it.at_px), mean(to));
        let (mut along, mut across, mut size) = (0.0, 0.0, 0.0);
        for it in found {
            let [u, v] = [it.at_px[0] - from_mean[0], it.at_px[1] - from_mean[1]];
            let there = to(it);
            let [x, y] = [there[0] - to_mean[0], there[1] - to_mean[1]];
            along += u * x + v * y;
            across += u * y - v * x;
            size += u * u + v * v;
        }
        let (a, b) = (along / size, across / size);
        (a.is_finite() && b.is_finite()).then(|| Motion {
            a,
            b,
            shift: [
                to_mean[0] - a * from_mean[0] + b * from_mean[1],
                to_mean[1] - b * from_mean[0] - a * from_mean[1],
            ],
        })
    }

    fn apply(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [
            self.a * u - self.b * v + self.shift[0],
            self.b * u + self.a * v + self.shift[1],
        ]
    }

    fn turn(&self) -> f64 {
        self.b.atan2(self.a)
    }

    /// Returns the marks whose found positions it predicts.
    fn agreeing(&self, found: &[MovedMark]) -> Vec<MovedMark> {
        let is_near = |it: &&MovedMark| {
            let [u, v] = self.apply(it.at_px);
            let off = [
                u - it.at_px[0] - it.moved_px[0],
                v - it.at_px[1] - it.moved_px[1],
            ];
            off[0].hypot(off[1]) <= SHARED_PX
        };
        found.iter().filter(is_near).copied().collect()
    }
}

/// Finds the motion shared by the most marks, and these marks; only small rotations and scalings are plausible.
fn shared(found: &[MovedMark]) -> Option<(Motion, Vec<MovedMark>)> {
    let mut best: Option<(Motion, Vec<MovedMark>)> = None;
    for (index, one) in found.iter().enumerate() {
        for other in &found[index + 1..] {
            let Some(motion) = Motion::of(&[*one, *other]) else {
                continue;
            };
            if (motion.a.hypot(motion.b) - 1.0).abs() > 0.1 || motion.turn().abs() > 0.2 {
                continue;
            }
            let agreeing = motion.agreeing(found);
            if best
                .as_ref()
                .is_none_or(|(_, most)| agreeing.len() > most.len())
            {
                best = Some((motion, agreeing));
            }
        }
    }
    let (_, agreeing) = best?;
    let motion = Motion::of(&agreeing)?;
    Some((motion, agreeing))
}
